// SPDX-License-Identifier: Apache-2.0
// Dot product (vec_dot) of a datapath (dataflow.svh): delays the early operand, then computes.
// Latency: LAT.mul + 2*LAT.add cycles from the later operand; 0 with ARITH = "host".
// Throughput: one result per lane per cycle.
// Stall: none.
module df_dot #(
    parameter int EXP = 8,
    parameter int MAN = 23,
    parameter int LANES = 1,
    parameter int B_LANES = LANES,  // 1: b is one for all lanes
    parameter int T_A = 0,
    parameter int T_B = 0,
    parameter latency_pkg::latency_t LAT = latency_pkg::ONES,
    parameter ARITH = "rtl",
    parameter bit CANON = 1,  // as in fp_lanes
    localparam int CW = (1 + EXP + MAN <= 32) ? 32 : 64
) (
    input logic clk_i,
    input logic en_i,
    input logic [2:0][LANES-1:0][CW-1:0] a_i,
    input logic [2:0][B_LANES-1:0][CW-1:0] b_i,
    output logic [LANES-1:0][CW-1:0] r_o
);
  /*verilator inline_module*/
  localparam int T = (T_A > T_B) ? T_A : T_B;
  logic [2:0][LANES-1:0][CW-1:0] a;
  logic [2:0][B_LANES-1:0][CW-1:0] b;
  df_pipe_delay #(.W(3 * LANES * CW), .T_A(T_A), .T(T), .ARITH(ARITH)) delay_a (.clk_i, .a_i, .r_o(a));
  df_pipe_delay #(.W(3 * B_LANES * CW), .T_A(T_B), .T(T), .ARITH(ARITH)) delay_b (.clk_i, .a_i(b_i), .r_o(b));
  vec_dot #(.EXP(EXP), .MAN(MAN), .LANES(LANES), .B_LANES(B_LANES), .LAT(LAT),
      .ARITH(ARITH), .CANON(CANON)) cell_u (.clk_i, .en_i, .a_i(a), .b_i(b), .r_o);
endmodule
