// SPDX-License-Identifier: Apache-2.0
// Secondaries of leaves on their way to a lane that tests one per TURNS cycles. They wait in a queue, which has room
// for all that have been requested. A leaf's secondaries follow each other.
// Latency: 1 cycle, and until turn TURNS - 1.
// Throughput: one secondary per TURNS cycles.
// Stall: room_o is low while the queue has no room for a leaf.
module leaf_queue #(
    parameter int WORDS = 9,   // of a secondary
    parameter int TAG = 32,    // bits; the lowest bit says that the leaf has two secondaries
    parameter int TURNS = 4,   // 1, 2, 4 or 8
    parameter int DEPTH = 64   // power of two
) (
    input logic clk_i,
    input logic rst_i,
    input logic [2:0] turn_i,
    output logic room_o,
    input logic leaf_i,  // a leaf is requested, with one secondary or two
    input logic two_i,
    input logic valid_i,
    input logic last_i,
    input logic [TAG-1:0] tag_i,
    input logic [WORDS-1:0][31:0] words_i,
    input logic [31:0] index_i,
    output logic valid_o,
    output logic last_o,
    output logic [TAG-1:0] tag_o,
    output logic [WORDS-1:0][31:0] words_o,
    output logic [31:0] index_o
);
  localparam int DW = $clog2(DEPTH);
  logic some;
  logic [DW:0] outstanding_q;
  sync_fifo #(.W(1 + TAG + 32 * WORDS + 32), .DEPTH(DEPTH), .LATE(1)) queue (
      .clk_i, .rst_i, .write_i(valid_i), .wdata_i({last_i, tag_i, words_i, index_i}), .free_o(), .count_o(),
      .some_o(some), .rdata_o({last_o, tag_o, words_o, index_o}), .read_i(valid_o));
  assign valid_o = some && turn_i == 3'(TURNS - 1);
  assign room_o = outstanding_q <= (DW + 1)'(DEPTH - 2);
  always_ff @(posedge clk_i)
    if (rst_i) outstanding_q <= '0;
    else
      outstanding_q <= outstanding_q + (DW + 1)'(leaf_i) + (DW + 1)'(leaf_i && two_i) - (DW + 1)'(valid_o);
endmodule
