// SPDX-License-Identifier: Apache-2.0
// One lane of fp_from_int: magnitude, count zeros, normalise | shift | round.
// Latency: CUTS cycles, 0..2.
// Throughput: one result per cycle.
// Stall: none.
module fp_from_int_lane #(
    parameter int EXP      = 8,
    parameter int MAN      = 23,
    parameter int CW       = 32,  // bits of the integer, 32 or 64
    parameter bit UNSIGNED = 0,
    parameter int CUTS     = 0,
    parameter bit FLAGS    = 0,
    localparam bit LEAST   = 0,
    localparam int EW      = CW,
    localparam int CO      = formats_pkg::lane_word(EXP, MAN, LEAST)
) (
    input  logic          clk_i,
    input  logic [CW-1:0] a_i,
    output logic [CO-1:0] r_o,
    output logic [CO-1:0] flags_o
);
  /*verilator inline_module*/
`include "fp_mask.svh"
  localparam int D_NORM = (CUTS >= 1) ? 1 : 0;
  localparam int TOP = (1 << (EXP - 1)) + CW - 3;
  localparam logic [CO-1:0] TOP_EXPONENT = CO'(TOP);  // the top bit's biased exponent, less one
  logic [CW-1:0] minus, mag, s, n, zero_n;
  always_comb begin
    minus = UNSIGNED ? ONE - ONE : neg(a_i);
    mag = (a_i ^ minus) - minus;
    n = lzc(mag);
    s = mag << n[AB-1:0];
    zero_n = ~some((a_i >> 1) | (a_i & ONE));
  end
  logic [CO-1:0] m_n, e_n, m, e, sign, zero;
  if (CW == CO) begin : g_same
    assign m_n = (s >> 1) | (s & ONE);
    assign e_n = TOP_EXPONENT - n;
  end else if (CW > CO) begin : g_narrow
    logic [CW-1:0] high;
    assign high = (s >> (CW - CO + 1)) | (some((s << (CO - 1)) >> 1) & ONE);
    assign m_n = high[CO-1:0];
    assign e_n = TOP_EXPONENT - n[CO-1:0];
    logic unused_high;
    assign unused_high = &{1'b0, high, n};
  end else begin : g_wide
    assign m_n = {1'b0, s, {CO - CW - 1{1'b0}}};
    assign e_n = TOP_EXPONENT - {{CO - CW{1'b0}}, n};
  end
  pipe_reg #(CO, D_NORM) reg_m (.clk_i, .d_i(m_n), .q_o(m));
  pipe_reg #(CO, D_NORM) reg_e (.clk_i, .d_i(e_n), .q_o(e));
  pipe_reg #(CO, D_NORM) reg_sign (.clk_i, .d_i({{CO - 1{1'b0}}, minus[0]} << (EXP + MAN)), .q_o(sign));
  pipe_reg #(CO, D_NORM) reg_zero (.clk_i, .d_i({CO{zero_n[CW-1]}}), .q_o(zero));
  fp_round #(.EXP(EXP), .MAN(MAN), .CUT((CUTS >= 2) ? 1 : 0), .FLAGS(FLAGS)) round (
      .clk_i, .m_i(m), .e_i(e), .sign_i(sign), .zero_i(zero), .inf_i('0), .nan_i('0), .nv_i('0), .dz_i('0),
      .r_o, .flags_o);
  logic unused_masks;
  assign unused_masks = &{1'b0, zero_n};
endmodule
