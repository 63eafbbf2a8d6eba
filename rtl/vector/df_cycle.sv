// SPDX-License-Identifier: Apache-2.0
// Components of a vector in cyclic order from a dominant axis (df_dominant) of a datapath (dataflow.svh).
// Latency: 0 from the later operand.
// Throughput: one result per lane per cycle.
// Stall: none.
module df_cycle #(
    parameter int CW = 32,
    parameter int LANES = 1,
    parameter ARITH = "rtl",
    parameter int T_M = 0,
    parameter int T_A = 0
) (
    input logic clk_i,
    input logic [1:0][LANES-1:0][CW-1:0] m_i,
    input logic [2:0][LANES-1:0][CW-1:0] a_i,
    output logic [2:0][LANES-1:0][CW-1:0] r_o
);
  /*verilator inline_module*/
  localparam int T = (T_M > T_A) ? T_M : T_A;
  logic [1:0][LANES-1:0][CW-1:0] m;
  logic [2:0][LANES-1:0][CW-1:0] a;
  df_pipe_delay #(.W(2 * LANES * CW), .T_A(T_M), .T(T), .ARITH(ARITH)) delay_m (.clk_i, .a_i(m_i), .r_o(m));
  df_pipe_delay #(.W(3 * LANES * CW), .T_A(T_A), .T(T), .ARITH(ARITH)) delay_a (.clk_i, .a_i, .r_o(a));
  for (genvar k = 0; k < 3; k++) begin : place
    logic [LANES-1:0][CW-1:0] x_or_y;
    lane_select #(.CW(CW), .LANES(LANES)) select_y (.m_i(m[0]), .a_i(a[(1+k)%3]), .b_i(a[k]), .r_o(x_or_y));
    lane_select #(.CW(CW), .LANES(LANES)) select_z (.m_i(m[1]), .a_i(a[(2+k)%3]), .b_i(x_or_y), .r_o(r_o[k]));
  end
endmodule
