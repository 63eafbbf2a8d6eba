// SPDX-License-Identifier: Apache-2.0
// Rounding of one lane, shared by product, quotient, root and conversions: count | shift right | round to nearest even
// | pack.
// Input m_i is a significand with weights 2 (bit TOP), 1, 1/2, ... and a sticky bit at the bottom. Its value is in [1,
// 4), or arbitrary if a mask is set. Input e_i is that value's biased exponent less one, in two's complement.
// The masks zero, infinity and NaN have rising priority.
// Latency: CUT_COUNT + CUT + CUT_PACK cycles, each 0..1.
// Throughput: one result per cycle.
// Stall: none.
module fp_round #(
    parameter int EXP   = 8,
    parameter int MAN   = 23,
    parameter bit LEAST = 0,
    parameter int CUT_COUNT = 0,
    parameter int CUT   = 0,
    parameter int CUT_PACK = 0,
    parameter bit FLAGS = 0,
    localparam int CW   = formats_pkg::lane_word(EXP, MAN, LEAST),
    localparam int EW   = formats_pkg::lane_exponent(EXP, MAN, LEAST)
) (
    input  logic          clk_i,
    input  logic [CW-1:0] m_i,
    input  logic [EW-1:0] e_i,
    input  logic [CW-1:0] sign_i,
    input  logic [CW-1:0] zero_i,
    input  logic [CW-1:0] inf_i,
    input  logic [CW-1:0] nan_i,
    input  logic [CW-1:0] nv_i,   // masks of flags known before rounding
    input  logic [CW-1:0] dz_i,
    output logic [CW-1:0] r_o,
    output logic [CW-1:0] flags_o
);
  /*verilator inline_module*/
`include "fp_mask.svh"
  localparam int TOP = formats_pkg::round_top(EXP, MAN, LEAST);
  localparam int DROP = TOP - 1 - MAN;  // bits below the last place

  // Count the right shift that moves the leading one to TOP - 1. Below the normal range the shift is larger, so that
  // the hidden bit becomes 0.
  logic [EW-1:0] top_c, e_c, tiny_c, n_c, n, ef_c, ef_s, ef;
  logic [CW-1:0] m, sign_s, zero_s, inf_s, nan_s, norm_s, norm, sign, zero, inf, nan;
  always_comb begin
    top_c = EW'(m_i >> TOP);
    e_c = e_i + top_c;
    tiny_c = negative(e_c);
    n_c = at_most(top_c - (e_c & tiny_c));
    ef_c = e_c & ~tiny_c;
  end
  pipe_reg #(CW, CUT_COUNT) reg_m (.clk_i, .d_i(m_i), .q_o(m));
  pipe_reg #(EW, CUT_COUNT) reg_n (.clk_i, .d_i(n_c), .q_o(n));
  pipe_reg #(EW, CUT_COUNT) reg_ef_s (.clk_i, .d_i(ef_c), .q_o(ef_s));
  pipe_reg #(CW, CUT_COUNT) reg_sign_s (.clk_i, .d_i(sign_i), .q_o(sign_s));
  pipe_reg #(CW, CUT_COUNT) reg_zero_s (.clk_i, .d_i(zero_i), .q_o(zero_s));
  pipe_reg #(CW, CUT_COUNT) reg_inf_s (.clk_i, .d_i(inf_i), .q_o(inf_s));
  pipe_reg #(CW, CUT_COUNT) reg_nan_s (.clk_i, .d_i(nan_i), .q_o(nan_s));

  // Shift right.
  logic unused_bits;
  assign unused_bits = &{1'b0, n};
  assign norm_s = (m >> n[AB-1:0]) | (lost(m, n[AB-1:0]) & ONE);
  pipe_reg #(CW, CUT) reg_norm (.clk_i, .d_i(norm_s), .q_o(norm));
  pipe_reg #(EW, CUT) reg_ef (.clk_i, .d_i(ef_s), .q_o(ef));
  pipe_reg #(CW, CUT) reg_sign (.clk_i, .d_i(sign_s), .q_o(sign));
  pipe_reg #(CW, CUT) reg_zero (.clk_i, .d_i(zero_s), .q_o(zero));
  pipe_reg #(CW, CUT) reg_inf (.clk_i, .d_i(inf_s), .q_o(inf));
  pipe_reg #(CW, CUT) reg_nan (.clk_i, .d_i(nan_s), .q_o(nan));

  // Round and pack.
  logic [CW-1:0] past, inexact;
  fp_pack #(.EXP(EXP), .MAN(MAN), .LEAST(LEAST), .DROP(DROP), .CUT(CUT_PACK)) pack (
      .clk_i, .norm_i(norm), .ef_i(ef), .sign_i(sign), .zero_i(zero), .inf_i(inf), .nan_i(nan), .r_o, .past_o(past),
      .inexact_o(inexact));

  // Tiny after rounding: the result is below the smallest normal even if rounded at full precision. Then the
  // significand is shifted by top_c only, and rounding just below the normal range gives no carry.
  if (FLAGS) begin : g_flags
    localparam logic [CW-1:0] HALF = (ONE << (DROP - 1)) - 1;
    localparam int DELAY = CUT_COUNT + CUT + CUT_PACK;
    logic [EW-1:0] next_c;
    logic [CW-1:0] full_c, carry_c, uf_c, uf, nv, dz, special_c, specials, nx;
    always_comb begin
      full_c = (m_i >> top_c[0]) | (m_i & ONE);
      carry_c = neg((full_c + HALF + ((full_c >> DROP) & ONE)) << (CW - 1 - TOP));
      next_c = e_c + E_ONE;
      uf_c = {CW{tiny_c[EW-1]}} & ~(carry_c & {CW{~next_c[EW-1]}});
      special_c = zero_i | inf_i | nan_i;
    end
    pipe_reg #(CW, DELAY) reg_uf (.clk_i, .d_i(uf_c), .q_o(uf));
    pipe_reg #(CW, DELAY) reg_nv (.clk_i, .d_i(nv_i), .q_o(nv));
    pipe_reg #(CW, DELAY) reg_dz (.clk_i, .d_i(dz_i), .q_o(dz));
    pipe_reg #(CW, DELAY) reg_special (.clk_i, .d_i(special_c), .q_o(specials));
    always_comb begin
      nx = (inexact & ~specials) | past;
      flags_o = (nv & CW'(16)) | (dz & CW'(8)) | (past & CW'(4)) | (nx & uf & CW'(2)) | (nx & ONE);
    end
  end else begin : g_no_flags
    logic unused_masks;
    assign unused_masks = &{1'b0, nv_i, dz_i, past, inexact};
    assign flags_o = '0;
  end
endmodule
