// SPDX-License-Identifier: Apache-2.0
// Output stage of a convex pipe: F = (s <= 0), T = |s|. A NaN in n becomes the canonical NaN, since a wire may have
// flipped its sign. All outputs are registered together. 1 compare.
// Latency: to stage time LATENCY; 0 with ARITH = "host".
// Throughput: LANES pairs per cycle.
// Stall: none.
`include "dataflow.svh"
module distance_result #(
    `DF_PARAMETERS,
    parameter int T_S = 0,  // stage times of the inputs
    parameter int T_CP = 0,
    parameter int T_N = 0,
    parameter int LATENCY = 1  // stage time of the outputs: at least T_S + LAT.cmp
) (
    input logic clk_i,
    input logic [LANES-1:0][CW-1:0] s_i,
    input logic [2:0][LANES-1:0][CW-1:0] cp_i,
    input logic [2:0][LANES-1:0][CW-1:0] n_i,
    output logic [LANES-1:0][CW-1:0] f_o,
    output logic [LANES-1:0][CW-1:0] t_o,
    output logic [2:0][LANES-1:0][CW-1:0] cp_o,
    output logic [2:0][LANES-1:0][CW-1:0] n_o
);
  /*verilator inline_module*/
  localparam logic [CW-1:0] QNAN = (((CW'(1) << EXP) - 1) << MAN) | (CW'(1) << (MAN - 1));
  logic [LANES-1:0][CW-1:0] f, t, zero;
  logic [2:0][LANES-1:0][CW-1:0] n, nan;
  assign zero = '0;
  fp_cmp #(.EXP(EXP), .MAN(MAN), .LANES(LANES), .LAT(LAT.cmp), .OP(formats_pkg::FP_LE), .ARITH(ARITH))
      cmp_s (.clk_i, .a_i(s_i), .b_i(zero), .m_o(f), .flags_o());
  fp_sign #(.EXP(EXP), .MAN(MAN), .LANES(LANES), .OP(formats_pkg::SIGN_ABS), .ARITH(ARITH))
      abs_s (.a_i(s_i), .b_i(s_i), .r_o(t));
  for (genvar k = 0; k < 3; k++) begin : g_canonical
    fp_class #(.EXP(EXP), .MAN(MAN), .LANES(LANES), .OP(formats_pkg::CLASS_NAN), .ARITH(ARITH))
        class_n (.a_i(n_i[k]), .m_o(nan[k]));
    lane_select #(.CW(CW), .LANES(LANES)) select_n (.m_i(nan[k]), .a_i({LANES{QNAN}}), .b_i(n_i[k]), .r_o(n[k]));
  end
  pipe_delay #(.W(LANES * CW), .FROM(T_S + LAT.cmp), .TO(LATENCY), .ARITH(ARITH)) delay_f (.clk_i, .d_i(f), .q_o(f_o));
  pipe_delay #(.W(LANES * CW), .FROM(T_S), .TO(LATENCY), .ARITH(ARITH)) delay_t (.clk_i, .d_i(t), .q_o(t_o));
  pipe_delay #(.W(3 * LANES * CW), .FROM(T_CP), .TO(LATENCY), .ARITH(ARITH)) delay_cp (.clk_i, .d_i(cp_i), .q_o(cp_o));
  pipe_delay #(.W(3 * LANES * CW), .FROM(T_N), .TO(LATENCY), .ARITH(ARITH)) delay_n (.clk_i, .d_i(n), .q_o(n_o));
endmodule
