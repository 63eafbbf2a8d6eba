// SPDX-License-Identifier: Apache-2.0
// Choice of a datapath (dataflow.svh): a if the lane mask is set, else b.
// Latency: 0 from the latest operand.
// Throughput: one result per lane per cycle.
// Stall: none.
module df_select #(
    parameter int CW = 32,
    parameter int LANES = 1,
    parameter ARITH = "rtl",
    parameter int T_M = 0,
    parameter int T_A = 0,
    parameter int T_B = 0
) (
    input logic clk_i,
    input logic [LANES-1:0][CW-1:0] m_i,
    input logic [LANES-1:0][CW-1:0] a_i,
    input logic [LANES-1:0][CW-1:0] b_i,
    output logic [LANES-1:0][CW-1:0] r_o
);
  /*verilator inline_module*/
  localparam int T_AB = (T_A > T_B) ? T_A : T_B;
  localparam int T = (T_M > T_AB) ? T_M : T_AB;
  logic [LANES-1:0][CW-1:0] m, a, b;
  df_pipe_delay #(.W(LANES * CW), .T_A(T_M), .T(T), .ARITH(ARITH)) delay_m (.clk_i, .a_i(m_i), .r_o(m));
  df_pipe_delay #(.W(LANES * CW), .T_A(T_A), .T(T), .ARITH(ARITH)) delay_a (.clk_i, .a_i, .r_o(a));
  df_pipe_delay #(.W(LANES * CW), .T_A(T_B), .T(T), .ARITH(ARITH)) delay_b (.clk_i, .a_i(b_i), .r_o(b));
  lane_select #(.CW(CW), .LANES(LANES)) select (.m_i(m), .a_i(a), .b_i(b), .r_o);
endmodule
