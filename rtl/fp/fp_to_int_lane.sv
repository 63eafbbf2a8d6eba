// SPDX-License-Identifier: Apache-2.0
// One lane of fp_to_int: normalise, shift | round, saturate. A value out of range saturates, and NaN gives the largest
// integer; both raise NV alone. An inexact result raises NX. CW is the wider of the two containers.
// Latency: CUTS cycles, 0..1.
// Throughput: one result per cycle.
// Stall: none.
module fp_to_int_lane #(
    parameter int EXP      = 8,
    parameter int MAN      = 23,
    parameter int INT      = 32,  // bits of the integer, 32 or 64
    parameter bit UNSIGNED = 0,
    parameter bit TRUNCATE = 0,   // 0: to nearest even; 1: toward zero
    parameter int CUTS     = 0,
    parameter bit FLAGS    = 0,
    localparam bit LEAST   = 0,
    localparam int CI      = formats_pkg::lane_word(EXP, MAN, LEAST)
) (
    input  logic           clk_i,
    input  logic [CI-1:0]  a_i,
    output logic [INT-1:0] r_o,
    output logic [INT-1:0] flags_o
);
  /*verilator inline_module*/
  localparam int CW = (INT > CI) ? INT : CI;  // the working width
  localparam int EW = CW;
`include "fp_mask.svh"
  localparam int D_SHIFT = (CUTS >= 1) ? 1 : 0;
  localparam int TOP_EXPONENT = (1 << (EXP - 1)) + CW - 3;
  localparam logic [CW-1:0] TOP = CW'(TOP_EXPONENT);  // biased exponent less one of a value that needs no shift
  logic [CI-1:0] s_i, e_i;
  logic [CW-1:0] a, s, e, nan_n, minus_n, n, far_n, whole_n, high_n, q_n, tail_n, over_n;
  fp_normalise #(.EXP(EXP), .MAN(MAN)) norm (
      .clk_i, .mag_i({{CI - EXP - MAN{1'b0}}, a_i[EXP+MAN-1:0]}), .s_o(s_i), .e_o(e_i));
  if (CW == CI) begin : g_same
    assign a = a_i;
    assign s = s_i;
    assign e = e_i;
  end else begin : g_wide
    assign a = {{CW - CI{1'b0}}, a_i};
    assign s = {s_i, {CW - CI{1'b0}}};
    assign e = {{CW - CI{e_i[CI-1]}}, e_i};
  end
  // q is the integer part. tail holds the half bit and a sticky bit below it.
  always_comb begin
    nan_n = is_nan(a & MAG);
    minus_n = neg(a << (CW - 1 - EXP - MAN)) & ~nan_n;
    n = TOP - e;                   // right shift
    over_n = neg(n) | special(a & MAG);
    far_n = neg(SHIFT_MAX + ONE - n);  // below one half
    whole_n = neg(n - ONE);        // no fraction
    n = (n - ONE) & ~whole_n;
    n = (n | neg(SHIFT_MAX - n)) & SHIFT_MAX;
    high_n = s >> n[AB-1:0];
    tail_n = some(s ^ (high_n << n[AB-1:0])) & ONE;
    tail_n = sel(far_n, some(s >> 1) & ONE, ((high_n & ONE) << 1) | tail_n) & ~whole_n;
    q_n = sel(whole_n, s, high_n >> 1) & ~far_n;
  end
  logic [CW-1:0] q, tail, minus, over;
  pipe_reg #(CW, D_SHIFT) reg_q (.clk_i, .d_i(q_n), .q_o(q));
  pipe_reg #(CW, D_SHIFT) reg_tail (.clk_i, .d_i(tail_n), .q_o(tail));
  pipe_reg #(CW, D_SHIFT) reg_minus (.clk_i, .d_i(minus_n), .q_o(minus));
  pipe_reg #(CW, D_SHIFT) reg_over (.clk_i, .d_i(over_n | nan_n), .q_o(over));

  localparam logic [CW-1:0] ALL = ~(ONE - ONE) >> (CW - INT);
  logic [CW-1:0] up, r, past, limit;
  always_comb begin
    up = TRUNCATE ? ONE - ONE : (tail >> 1) & (tail | q) & ONE;
    r = q + up;
    if (UNSIGNED) begin
      past = (some((r >> 1) | (r & ONE)) & minus) | ((CW > INT) ? some(r >> (INT - 1) >> 1) : ONE - ONE);
      limit = ALL & ~minus;
    end else begin
      past = some((r + minus) >> (INT - 1)) & some((r >> 1) | (r & ONE));
      limit = (ALL >> 1) - minus;
    end
    past = past | over;
    r = sel(past, limit, (r ^ minus) - minus);
  end
  assign r_o = r[INT-1:0];
  if (FLAGS) begin : g_flags
    logic [CW-1:0] f;
    assign f = (past & (ONE << 4)) | (some(tail) & ~past & ONE);
    assign flags_o = f[INT-1:0];
  end else begin : g_no_flags
    assign flags_o = '0;
  end
  if (CW > INT && FLAGS) begin : g_narrow_flags
    logic unused_flags;
    assign unused_flags = &{1'b0, g_flags.f};
  end
  if (CW > INT) begin : g_narrow
    logic unused_high;
    assign unused_high = &{1'b0, r};
  end
endmodule
