// SPDX-License-Identifier: Apache-2.0
// Choice of a datapath (dataflow.svh), the same in every lane: a if the control bit is set, else b.
// Latency: 0 from the latest operand.
// Throughput: one result per cycle.
// Stall: none.
module df_choose #(
    parameter int W = 1,
    parameter ARITH = "rtl",
    parameter int T_C = 0,
    parameter int T_A = 0,
    parameter int T_B = 0
) (
    input logic clk_i,
    input logic c_i,
    input logic [W-1:0] a_i,
    input logic [W-1:0] b_i,
    output logic [W-1:0] r_o
);
  /*verilator inline_module*/
  localparam int T_AB = (T_A > T_B) ? T_A : T_B;
  localparam int T = (T_C > T_AB) ? T_C : T_AB;
  logic c;
  logic [W-1:0] a, b;
  df_pipe_delay #(.W(1), .T_A(T_C), .T(T), .ARITH(ARITH)) delay_c (.clk_i, .a_i(c_i), .r_o(c));
  df_pipe_delay #(.W(W), .T_A(T_A), .T(T), .ARITH(ARITH)) delay_a (.clk_i, .a_i, .r_o(a));
  df_pipe_delay #(.W(W), .T_A(T_B), .T(T), .ARITH(ARITH)) delay_b (.clk_i, .a_i(b_i), .r_o(b));
  assign r_o = c ? a : b;
endmodule
