// SPDX-License-Identifier: Apache-2.0
// One operator of a datapath (dataflow.svh): delays the early operand, then computes.
// Latency: LAT cycles from the later operand; 0 with ARITH = "host".
// Throughput: one result per lane per cycle.
// Stall: none.
module df_operator #(
    parameter int EXP = 8,
    parameter int MAN = 23,
    parameter int LANES = 1,
    parameter int B_LANES = LANES,  // 1: b is one for all lanes
    parameter int OP = formats_pkg::FP_ADD,  // FP_* up to FP_MAX; FP_SQRT takes a_i
    parameter int T_A = 0,
    parameter int T_B = 0,
    parameter int LAT = 1,
    parameter ARITH = "rtl",
    parameter bit CANON = 1,  // as in fp_lanes
    localparam int CW = (1 + EXP + MAN <= 32) ? 32 : 64
) (
    input logic clk_i,
    input logic en_i,
    input logic [LANES-1:0][CW-1:0] a_i,
    input logic [B_LANES-1:0][CW-1:0] b_i,
    output logic [LANES-1:0][CW-1:0] r_o
);
  /*verilator inline_module*/
  localparam int T = (T_A > T_B) ? T_A : T_B;
  logic [LANES-1:0][CW-1:0] a;
  logic [B_LANES-1:0][CW-1:0] b;
  df_pipe_delay #(.W(LANES * CW), .T_A(T_A), .T(T), .ARITH(ARITH)) delay_a (.clk_i, .a_i, .r_o(a));
  df_pipe_delay #(.W(B_LANES * CW), .T_A(T_B), .T(T), .ARITH(ARITH)) delay_b (.clk_i, .a_i(b_i), .r_o(b));
  if (OP < 0 || OP >= formats_pkg::FP_ARITHMETIC) $error("df_operator: unknown OP");
  // fp_add, fp_mul and the other units are built on fp_lanes. One cell instead of one per branch saves memory,
  // because Verilator links all branches below an operator before it knows which one it needs.
  fp_lanes #(.OP(OP), .EXP(EXP), .MAN(MAN), .LANES(LANES), .B_LANES(B_LANES), .LAT(LAT), .ARITH(ARITH), .CANON(CANON))
      cell_u (.clk_i, .en_i, .a_i(a), .b_i(b), .r_o, .flags_o());
endmodule
