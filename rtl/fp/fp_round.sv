// SPDX-License-Identifier: Apache-2.0
// Rounding of one lane, shared by product, quotient, root and conversions: shift right | round to nearest even and
// pack.
// m_i: significand with weights 2 (top bit), 1, 1/2, ... and a sticky bit at the bottom, value in [1, 4) or anything if
// a mask says so. e_i: biased exponent of that value less one, two's complement. Masks: zero, infinity, NaN, in rising
// priority.
// Latency: CUT clocks, 0..1. Throughput: one a clock. Stall: none.
module fp_round #(
    parameter int EXP   = 8,
    parameter int MAN   = 23,
    parameter int CUT   = 0,
    parameter bit FLAGS = 0,
    localparam int CW   = (1 + EXP + MAN <= 32 && MAN <= 23) ? 32 : 64
) (
    input  logic          clk_i,
    input  logic [CW-1:0] m_i,
    input  logic [CW-1:0] e_i,
    input  logic [CW-1:0] sign_i,
    input  logic [CW-1:0] zero_i,
    input  logic [CW-1:0] inf_i,
    input  logic [CW-1:0] nan_i,
    input  logic [CW-1:0] nv_i,   // masks of the flags that are known before rounding
    input  logic [CW-1:0] dz_i,
    output logic [CW-1:0] r_o,
    output logic [CW-1:0] flags_o
);
  /*verilator inline_module*/
`include "fp_mask.svh"
  localparam int DROP = CW - 2 - MAN;  // bits below the last place
  localparam logic [CW-1:0] HALF = (ONE << (DROP - 1)) - 1;
  localparam logic [CW-1:0] REST = (ONE << DROP) - 1;

  // Leading one to CW-2; below the normal range further right, so that the hidden bit becomes 0.
  logic [CW-1:0] top_s, e_s, tiny_s, n_s, norm_s, ef_s, norm, ef, sign, zero, inf, nan;
  always_comb begin
    top_s = m_i >> (CW - 1);
    e_s = e_i + top_s;
    tiny_s = neg(e_s);
    n_s = top_s - (e_s & tiny_s);
    n_s = (n_s | neg(SHIFT_MAX - n_s)) & SHIFT_MAX;
    norm_s = m_i >> n_s[AB-1:0];
    norm_s = norm_s | (some(m_i ^ (norm_s << n_s[AB-1:0])) & ONE);
    ef_s = e_s & ~tiny_s;
  end
  fp_cut #(CW, CUT) cut_norm (.clk_i, .d_i(norm_s), .q_o(norm));
  fp_cut #(CW, CUT) cut_ef (.clk_i, .d_i(ef_s), .q_o(ef));
  fp_cut #(CW, CUT) cut_sign (.clk_i, .d_i(sign_i), .q_o(sign));
  fp_cut #(CW, CUT) cut_zero (.clk_i, .d_i(zero_i), .q_o(zero));
  fp_cut #(CW, CUT) cut_inf (.clk_i, .d_i(inf_i), .q_o(inf));
  fp_cut #(CW, CUT) cut_nan (.clk_i, .d_i(nan_i), .q_o(nan));

  // The hidden bit completes the exponent, a carry runs into it, and overflow stops at infinity.
  logic [CW-1:0] p;
  always_comb begin
    p = ((ef << MAN) + ((norm + HALF + ((norm >> DROP) & ONE)) >> DROP)) & ~zero;
    r_o = sel(nan, QNAN, sign | sel(neg(INF - p) | inf, INF, p));
  end

  // Tiny after rounding: below the smallest normal even if rounded at full precision, that is, with the significand
  // shifted by top_s only and no carry out of the value just below the normal range.
  if (FLAGS) begin : g_flags
    logic [CW-1:0] full_s, carry_s, uf_s, uf, nv, dz, of, nx, special;
    always_comb begin
      full_s = (m_i >> top_s[0]) | (m_i & ONE);
      carry_s = neg(full_s + HALF + ((full_s >> DROP) & ONE));
      uf_s = tiny_s & ~(carry_s & ~neg(e_s + ONE));
    end
    fp_cut #(CW, CUT) cut_uf (.clk_i, .d_i(uf_s), .q_o(uf));
    fp_cut #(CW, CUT) cut_nv (.clk_i, .d_i(nv_i), .q_o(nv));
    fp_cut #(CW, CUT) cut_dz (.clk_i, .d_i(dz_i), .q_o(dz));
    always_comb begin
      special = zero | inf | nan;
      of = ~neg(p - INF) & ~special;
      nx = (some(norm & REST) & ~special) | of;
      flags_o = (nv & CW'(16)) | (dz & CW'(8)) | (of & CW'(4)) | (nx & uf & CW'(2)) | (nx & ONE);
    end
  end else begin : g_no_flags
    logic unused_masks;
    assign unused_masks = &{1'b0, nv_i, dz_i};
    assign flags_o = '0;
  end
endmodule
