// SPDX-License-Identifier: Apache-2.0
// Secondaries of leaves, from DDR, where they lie in the order of their upload. Which one is in a slot of the tree
// says a memory beside the nodes, a word a slot (bytes 4 s of the bus), so that a secondary is there once, and its
// number comes with it. A leaf of two takes two beats.
// Latency: 2 clocks and the memory's. Throughput: a beat a clock. Stall: ready_o, ddr_ready_i.
`include "secded.svh"
module leaf_reader #(
    parameter int SLOTS = 32768,  // power of two
    parameter int TAG = 32,       // bits; the lowest: two
    parameter int DEPTH = 256,    // beats that DDR owes, power of two
    parameter int ECC = 0,        // 1: what is in slots has check bits
    localparam int SW = $clog2(SLOTS),
    localparam int BEAT = records_pkg::DDR_WORDS
) (
    input logic clk_bus_i,
    input logic write_i,
    input logic [31:0] addr_i,
    input logic [63:0] data_i,
    input logic [1:0][31:0] flip_i,  // bits that are written wrong

    input logic clk_i,
    input logic rst_i,
    input logic clear_i,  // between passes; what is owed then is dropped
    input logic [31:0] slots_i,  // as many as secondaries
    input logic valid_i,
    output logic ready_o,
    input logic [hierarchy_pkg::PLACE-1:0] slot_i,
    input logic [TAG-1:0] tag_i,

    output card_pkg::ddr_request_t ddr_o,
    input logic ddr_ready_i,
    input logic ddr_valid_i,
    input logic [BEAT-1:0][31:0] ddr_data_i,
    output logic owed_o,  // answers are

    output logic valid_o,
    output logic [TAG-1:0] tag_o,
    output logic [1:0][BEAT-1:0][31:0] words_o,
    output logic [1:0][31:0] index_o,
    output logic fault_o,  // a slot, or the secondary in it, that is not there
    output logic [3:0] fault_kind_o,  // registers_pkg::NODE_FAULT_*
    output logic [31:0] fault_place_o,
    output logic corrected_o  // what is in a slot
);
  localparam int DW = $clog2(DEPTH);
  logic [1:0][31:0] order[SLOTS/2];
  logic unused;
  assign unused = &{1'b0, addr_i, flip_i};
  always_ff @(posedge clk_bus_i) if (write_i) order[addr_i[3+:SW-1]] <= (ECC != 0) ? data_i ^ flip_i : data_i;

  // ---- Slots, one a clock: which secondaries they have ----
  logic second_q, move, asked_q, last_q, beyond_q;  // second_q: that of a leaf of two is next
  logic [31:0] slot, index, index_q, slot_q;
  logic corrected, failed;
  logic [TAG-1:0] tag_q;
  assign slot = second_q ? slot_q + 1 : 32'(slot_i);
  assign move = !asked_q || (ddr_o.valid && ddr_ready_i);
  assign ready_o = move && !second_q;
  always_ff @(posedge clk_i) begin
    if (move) begin
      index_q <= order[slot[SW-1:1]][slot[0]];
      asked_q <= valid_i || second_q;
      if (!second_q) tag_q <= tag_i;
      last_q <= second_q || !tag_i[0];
      second_q <= !second_q && valid_i && tag_i[0];
      slot_q <= slot;
      beyond_q <= slot >= slots_i;
    end
    if (rst_i || clear_i) {asked_q, second_q} <= '0;
  end
  if (ECC != 0) begin : g_ecc
    localparam int R = `SECDED_BITS(32);
    logic [1:0][R-1:0] checks[SLOTS/2];
    logic [1:0][R-1:0] written;
    logic [R-1:0] check_q;
    logic [4:0] count;
    for (genvar w = 0; w < 2; w++) begin : of_beat
      secded_encode #(.W(32)) encode (.data_i(data_i[32*w+:32]), .check_o(written[w]));
    end
    always_ff @(posedge clk_bus_i) if (write_i) checks[addr_i[3+:SW-1]] <= written;
    always_ff @(posedge clk_i) if (move) check_q <= checks[slot[SW-1:1]][slot[0]];
    words_ecc #(.WORDS(1)) correct (.data_i(index_q), .check_i(check_q), .data_o(index), .corrected_o(count),
        .failed_o(failed));
    assign corrected = count[0];
    logic unused_count;
    assign unused_count = &{1'b0, count[4:1]};
  end else begin : g_no_ecc
    assign index = index_q;
    assign {corrected, failed} = '0;
  end
  assign corrected_o = corrected && ddr_o.valid && ddr_ready_i;
  assign fault_o = asked_q && (beyond_q || failed || index >= slots_i);
  assign fault_kind_o = beyond_q ? registers_pkg::NODE_FAULT_SLOT : failed ? registers_pkg::NODE_FAULT_SLOT_BITS :
      registers_pkg::NODE_FAULT_INDEX;
  assign fault_place_o = slot_q;

  // ---- What is owed ----
  logic [DW:0] owed;
  logic last, first_q;
  logic [31:0] index_now;
  logic [TAG-1:0] tag;
  assign ddr_o.valid = asked_q && !fault_o && owed != (DW + 1)'(DEPTH);
  assign ddr_o.word = {index[28:0], 3'b0} + index;  // nine words each
  logic [1+32+TAG-1:0] tags[DEPTH];
  logic [DW:0] write_q, read_q;
  assign owed = write_q - read_q;
  assign owed_o = owed != 0;
  always_ff @(posedge clk_i) begin
    if (ddr_o.valid && ddr_ready_i) begin
      tags[write_q[DW-1:0]] <= {last_q, index, tag_q};
      write_q <= write_q + 1;
    end
    if (ddr_valid_i) read_q <= read_q + 1;
    if (rst_i) {write_q, read_q} <= '0;
  end
  assign {last, index_now, tag} = tags[read_q[DW-1:0]];

  // ---- Beats to leaves ----
  logic [BEAT-1:0][31:0] words_q;
  logic [31:0] first_index_q;
  always_ff @(posedge clk_i) begin
    if (ddr_valid_i && !last) {words_q, first_index_q} <= {ddr_data_i, index_now};
    if (ddr_valid_i) first_q <= !last;
    if (rst_i || clear_i) first_q <= 0;
  end
  assign valid_o = ddr_valid_i && last && !clear_i;
  assign tag_o = tag;
  assign words_o = first_q ? {ddr_data_i, words_q} : {2{ddr_data_i}};
  assign index_o = first_q ? {index_now, first_index_q} : {2{index_now}};

`ifndef SYNTHESIS
  always_ff @(posedge clk_i)
    if (!rst_i) assert (!(ddr_valid_i && owed == 0)) else $error("leaf_reader: data nobody asked for");
`endif
endmodule
