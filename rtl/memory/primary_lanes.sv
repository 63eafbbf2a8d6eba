// SPDX-License-Identifier: Apache-2.0
// Primary register file of one lane group: ROWS rows of LANES primaries, WORDS words per slot. In hardware it is one
// block RAM per lane.
// Latency: 0; reads are combinational, and the operators behind register them.
// Throughput: one slot written and one row read per cycle.
module primary_lanes #(
    parameter int CW = 32,
    parameter int LANES = 1,
    parameter int ROWS = 256,
    parameter int WORDS = 8,
    localparam int ROW_W = (ROWS > 1) ? $clog2(ROWS) : 1,
    localparam int LANE_W = (LANES > 1) ? $clog2(LANES) : 1
) (
    input logic clk_i,
    input logic write_i,
    input logic [ROW_W-1:0] write_row_i,
    input logic [LANE_W-1:0] write_lane_i,
    input logic [WORDS-1:0][CW-1:0] slot_i,
    input logic [ROW_W-1:0] row_i,
    output logic [WORDS-1:0][LANES-1:0][CW-1:0] a_o
);
  /*verilator inline_module*/
  for (genvar k = 0; k < WORDS; k++) begin : word
    logic [LANES-1:0][CW-1:0] mem[ROWS];
    always_ff @(posedge clk_i) if (write_i) mem[write_row_i][write_lane_i] <= slot_i[k];
    assign a_o[k] = mem[row_i];
  end
endmodule
