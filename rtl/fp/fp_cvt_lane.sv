// SPDX-License-Identifier: Apache-2.0
// One lane of fp_cvt: normalise | shift | round. EXP and MAN are the operand's format, EXP_O and MAN_O the result's.
// Latency: CUTS cycles, 0..2.
// Throughput: one result per cycle.
// Stall: none.
module fp_cvt_lane #(
    parameter int EXP   = 8,
    parameter int MAN   = 23,
    parameter int EXP_O = 5,
    parameter int MAN_O = 10,
    parameter int CUTS  = 0,
    parameter bit FLAGS = 0,
    localparam bit LEAST = 0,
    localparam int CW   = formats_pkg::lane_word(EXP, MAN, LEAST),
    localparam int EW   = CW,
    localparam int CO   = formats_pkg::lane_word(EXP_O, MAN_O, LEAST)
) (
    input  logic          clk_i,
    input  logic [CW-1:0] a_i,
    output logic [CO-1:0] r_o,
    output logic [CO-1:0] flags_o
);
  /*verilator inline_module*/
`include "fp_mask.svh"
  localparam int D_NORM = (CUTS >= 1) ? 1 : 0;
  localparam logic [CW-1:0] REBIAS = (ONE << (EXP_O - 1)) - (ONE << (EXP - 1));
  logic [CW-1:0] mag, s, e, zero_n, inf_n, nan_n, nv_n;
  fp_normalise #(.EXP(EXP), .MAN(MAN)) norm (.clk_i, .mag_i(mag), .s_o(s), .e_o(e));
  always_comb begin
    mag = a_i & MAG;
    zero_n = ~some(mag);
    inf_n = special(mag);
    nan_n = is_nan(mag);
  end
  if (FLAGS) begin : g_flags
    assign nv_n = snan(a_i);
  end else begin : g_no_flags
    assign nv_n = '0;
  end

  logic [CW-1:0] rebias_n;
  logic [CO-1:0] m_n, e_n, m, e_r, sign, zero, inf, nan, nv;
  // Far beyond the result's range, the exponent stops at the first value that overflows. So it fits its field in
  // fp_round.
  localparam logic [CW-1:0] LIMIT = ONE << EXP_O;
  assign rebias_n = sel(neg(LIMIT - e - REBIAS), LIMIT, e + REBIAS);
  if (CW == CO) begin : g_same
    assign m_n = s >> 1;  // the lost bit is zero: a container has at least EXP spare bits
    assign e_n = rebias_n;
  end else if (CW > CO) begin : g_narrow
    logic [CW-1:0] high;
    assign high = (s >> (CW - CO + 1)) | (some((s << (CO - 1)) >> 1) & ONE);
    assign m_n = high[CO-1:0];
    assign e_n = rebias_n[CO-1:0];
    logic unused_high;
    assign unused_high = &{1'b0, high, rebias_n};
  end else begin : g_wide
    assign m_n = {1'b0, s, {CO - CW - 1{1'b0}}};
    assign e_n = {{CO - CW{rebias_n[CW-1]}}, rebias_n};
  end
  pipe_reg #(CO, D_NORM) reg_m (.clk_i, .d_i(m_n), .q_o(m));
  pipe_reg #(CO, D_NORM) reg_e (.clk_i, .d_i(e_n), .q_o(e_r));
  pipe_reg #(CO, D_NORM) reg_sign (.clk_i, .d_i({{CO - 1{1'b0}}, a_i[EXP+MAN]} << (EXP_O + MAN_O)), .q_o(sign));
  pipe_reg #(CO, D_NORM) reg_zero (.clk_i, .d_i({CO{zero_n[CW-1]}}), .q_o(zero));
  pipe_reg #(CO, D_NORM) reg_inf (.clk_i, .d_i({CO{inf_n[CW-1]}}), .q_o(inf));
  pipe_reg #(CO, D_NORM) reg_nan (.clk_i, .d_i({CO{nan_n[CW-1]}}), .q_o(nan));
  pipe_reg #(CO, D_NORM) reg_nv (.clk_i, .d_i({CO{nv_n[CW-1]}}), .q_o(nv));
  fp_round #(.EXP(EXP_O), .MAN(MAN_O), .CUT((CUTS >= 2) ? 1 : 0), .FLAGS(FLAGS)) round (
      .clk_i, .m_i(m), .e_i(e_r), .sign_i(sign), .zero_i(zero), .inf_i(inf), .nan_i(nan), .nv_i(nv), .dz_i('0),
      .r_o, .flags_o);
  logic unused_masks;
  assign unused_masks = &{1'b0, zero_n, inf_n, nan_n, nv_n};
endmodule
