// SPDX-License-Identifier: Apache-2.0
// The TURNS candidate axes that a shared unit made in turn, together when the last is ready
// (serial_to_parallel.sv).
// Latency: TURNS - 1 cycles from the first axis; 0 with ARITH = "host".
// Throughput: one set per TURNS cycles.
// Stall: none.
module axis_results #(
    parameter int EXP = 8,
    parameter int MAN = 23,
    parameter int LANES = 1,
    parameter int TURNS = 1,  // 1 or 3
    parameter ARITH = "rtl",
    localparam int CW = (1 + EXP + MAN <= 32) ? 32 : 64
) (
    input logic clk_i,
    input logic [LANES-1:0][CW-1:0] separation_i,
    input logic [2:0][LANES-1:0][CW-1:0] n_i,
    input logic [2:0][LANES-1:0][CW-1:0] v_i,
    input logic [2:0][LANES-1:0][CW-1:0] p_i,
    input logic [LANES-1:0][CW-1:0] d2_i,
    input logic [2:0][LANES-1:0][CW-1:0] f_i,
    input logic [LANES-1:0][CW-1:0] inverse_ff_i,
    output logic [TURNS-1:0][LANES-1:0][CW-1:0] separation_o,
    output logic [TURNS-1:0][2:0][LANES-1:0][CW-1:0] n_o,
    output logic [TURNS-1:0][2:0][LANES-1:0][CW-1:0] v_o,
    output logic [TURNS-1:0][2:0][LANES-1:0][CW-1:0] p_o,
    output logic [TURNS-1:0][LANES-1:0][CW-1:0] d2_o,
    output logic [TURNS-1:0][2:0][LANES-1:0][CW-1:0] f_o,
    output logic [TURNS-1:0][LANES-1:0][CW-1:0] inverse_ff_o
);
  /*verilator inline_module*/
  localparam int LW = LANES * CW;
  serial_to_parallel #(.W(LW), .TURNS(TURNS), .ARITH(ARITH)) separation (
      .clk_i, .d_i(separation_i), .q_o(separation_o));
  serial_to_parallel #(.W(3 * LW), .TURNS(TURNS), .ARITH(ARITH)) n (.clk_i, .d_i(n_i), .q_o(n_o));
  serial_to_parallel #(.W(3 * LW), .TURNS(TURNS), .ARITH(ARITH)) v (.clk_i, .d_i(v_i), .q_o(v_o));
  serial_to_parallel #(.W(3 * LW), .TURNS(TURNS), .ARITH(ARITH)) p (.clk_i, .d_i(p_i), .q_o(p_o));
  serial_to_parallel #(.W(LW), .TURNS(TURNS), .ARITH(ARITH)) d2 (.clk_i, .d_i(d2_i), .q_o(d2_o));
  serial_to_parallel #(.W(3 * LW), .TURNS(TURNS), .ARITH(ARITH)) f (.clk_i, .d_i(f_i), .q_o(f_o));
  serial_to_parallel #(.W(LW), .TURNS(TURNS), .ARITH(ARITH)) inverse_ff (
      .clk_i, .d_i(inverse_ff_i), .q_o(inverse_ff_o));
endmodule
