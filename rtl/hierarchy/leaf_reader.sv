// SPDX-License-Identifier: Apache-2.0
// Secondaries of leaves, from DDR, where they lie in the order of their upload. Which one is in a slot of the tree
// says a memory beside the nodes, a word a slot (bytes 4 s of the bus), so that a secondary is there once, and its
// number comes with it. A leaf of two takes two beats.
// Latency: 2 clocks and the memory's. Throughput: a beat a clock. Stall: ready_o, ddr_ready_i.
module leaf_reader #(
    parameter int SLOTS = 32768,  // power of two
    parameter int TAG = 32,       // bits; the lowest: two
    parameter int DEPTH = 256,    // beats that DDR owes, power of two
    localparam int SW = $clog2(SLOTS),
    localparam int BEAT = records_pkg::DDR_WORDS
) (
    input logic clk_bus_i,
    input logic write_i,
    input logic [31:0] addr_i,
    input logic [63:0] data_i,

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
    output logic [2:0] fault_kind_o,  // registers_pkg::NODE_FAULT_*
    output logic [31:0] fault_place_o
);
  localparam int DW = $clog2(DEPTH);
  logic [1:0][31:0] order[SLOTS/2];
  logic unused;
  assign unused = &{1'b0, addr_i};
  always_ff @(posedge clk_bus_i) if (write_i) order[addr_i[3+:SW-1]] <= data_i;

  // ---- Slots, one a clock: which secondaries they have ----
  logic second_q, move, asked_q, last_q, beyond_q;  // second_q: that of a leaf of two is next
  logic [31:0] slot, index_q, slot_q;
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
  assign fault_o = asked_q && (beyond_q || index_q >= slots_i);
  assign fault_kind_o = beyond_q ? registers_pkg::NODE_FAULT_SLOT : registers_pkg::NODE_FAULT_INDEX;
  assign fault_place_o = slot_q;

  // ---- What is owed ----
  logic [DW:0] owed;
  logic last, first_q;
  logic [31:0] index;
  logic [TAG-1:0] tag;
  assign ddr_o.valid = asked_q && !fault_o && owed != (DW + 1)'(DEPTH);
  assign ddr_o.word = {index_q[28:0], 3'b0} + index_q;  // nine words each
  logic [1+32+TAG-1:0] tags[DEPTH];
  logic [DW:0] write_q, read_q;
  assign owed = write_q - read_q;
  assign owed_o = owed != 0;
  always_ff @(posedge clk_i) begin
    if (ddr_o.valid && ddr_ready_i) begin
      tags[write_q[DW-1:0]] <= {last_q, index_q, tag_q};
      write_q <= write_q + 1;
    end
    if (ddr_valid_i) read_q <= read_q + 1;
    if (rst_i) {write_q, read_q} <= '0;
  end
  assign {last, index, tag} = tags[read_q[DW-1:0]];

  // ---- Beats to leaves ----
  logic [BEAT-1:0][31:0] words_q;
  logic [31:0] first_index_q;
  always_ff @(posedge clk_i) begin
    if (ddr_valid_i && !last) {words_q, first_index_q} <= {ddr_data_i, index};
    if (ddr_valid_i) first_q <= !last;
    if (rst_i || clear_i) first_q <= 0;
  end
  assign valid_o = ddr_valid_i && last && !clear_i;
  assign tag_o = tag;
  assign words_o = first_q ? {ddr_data_i, words_q} : {2{ddr_data_i}};
  assign index_o = first_q ? {index, first_index_q} : {2{index}};

`ifndef SYNTHESIS
  always_ff @(posedge clk_i)
    if (!rst_i) assert (!(ddr_valid_i && owed == 0)) else $error("leaf_reader: data nobody asked for");
`endif
endmodule
