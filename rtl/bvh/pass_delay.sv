// SPDX-License-Identifier: Apache-2.0
// Delay line for data of rays or solids, whose latencies differ.
// Latency: T_RAY cycles, or T_SOLID if solid_i.
// Throughput: one value per cycle.
// Stall: none, runs free.
module pass_delay #(
    parameter int W = 1,  // >= 1
    parameter int T_RAY = 0,
    parameter int T_SOLID = 0
) (
    input logic clk_i,
    input logic solid_i,  // changes only between passes
    input logic [W-1:0] d_i,
    output logic [W-1:0] q_o
);
  /*verilator inline_module*/
  localparam int SHORT = (T_RAY < T_SOLID) ? T_RAY : T_SOLID;
  localparam int LONG = T_RAY + T_SOLID - SHORT;
  logic [W-1:0] early, late;
  long_delay #(.W(W), .DEPTH(SHORT)) delay_early (.clk_i, .d_i, .q_o(early));
  long_delay #(.W(W), .DEPTH(LONG - SHORT)) delay_late (.clk_i, .d_i(early), .q_o(late));
  assign q_o = (solid_i == (T_SOLID > T_RAY)) ? late : early;
endmodule
