// SPDX-License-Identifier: Apache-2.0
// Secondaries of leaves, from DDR, where they lie in the order of their upload. Which one is in a slot of the tree
// says a memory beside the nodes, so that a secondary is there once, and its number comes with it. A leaf of two takes
// two beats. With OBJECTS a second memory says whose it is, and beats go through the transformer, which is outside.
// Latency: 2 clocks, the memory's and T_MOVED. Throughput: a beat a clock. Stall: ready_o, ddr_ready_i.
module leaf_reader #(
    parameter int SLOTS = 32768,  // power of two
    parameter int TAG = 32,       // bits; the lowest: two
    parameter int DEPTH = 256,    // beats that DDR owes or that are being moved, power of two
    parameter int ECC = 0,        // 1: what is in slots has check bits
    parameter int OBJECTS = 0,    // that a pass can have at most; 0: nothing moves
    parameter int T_TRANSFORM = 0,
    parameter ARITH = "rtl",
    localparam int SW = $clog2(SLOTS),
    localparam int OBJECT_W = (OBJECTS > 1) ? $clog2(OBJECTS) : 1,
    localparam int T_MOVED = (OBJECTS != 0) ? 1 + T_TRANSFORM : 0,
    localparam int BEAT = records_pkg::DDR_WORDS
) (
    input logic clk_bus_i,
    input logic write_i,
    input logic [31:0] addr_i,  // slots' secondaries, and from 4 SLOTS on whose they are
    input logic [63:0] data_i,
    input logic [1:0][31:0] flip_i,  // bits that are written wrong

    input logic clk_i,
    input logic rst_i,
    input logic clear_i,  // between passes; what is owed then is dropped
    input logic [31:0] slots_i,  // of the tree
    input logic [31:0] secondaries_i,  // from the first in DDR on
    input logic [3:0] words_i,  // of each: at most a beat
    input logic [31:0] objects_i,  // 0: secondaries as they are
    input logic valid_i,
    output logic ready_o,
    input logic [hierarchy_pkg::PLACE-1:0] slot_i,
    input logic [TAG-1:0] tag_i,

    output card_pkg::ddr_request_t ddr_o,
    input logic ddr_ready_i,
    input logic ddr_valid_i,
    input logic [BEAT-1:0][31:0] ddr_data_i,
    output logic owed_o,  // answers are

    // To the table of objects and the transformer, as in secondary_regfile.sv.
    output logic [OBJECT_W-1:0] transform_entry_o,  // of the beat that arrives
    output logic moving_o,
    input logic clk_moving_i,
    output logic [BEAT-1:0][31:0] unmoved_o,
    input logic [BEAT-1:0][31:0] moved_i,

    output logic valid_o,
    output logic [TAG-1:0] tag_o,
    output logic [1:0][BEAT-1:0][31:0] words_o,
    output logic [1:0][31:0] index_o,
    output logic fault_o,  // a slot, or the secondary or the object in it, that is not there
    output logic [3:0] fault_kind_o,  // registers_pkg::NODE_FAULT_*
    output logic [31:0] fault_place_o,
    output logic [1:0] corrected_o  // words of what is in a slot
);
  localparam int DW = $clog2(DEPTH);
  localparam int TAG_W = 1 + OBJECT_W + 32 + TAG;

  // ---- Slots, one a clock: which secondaries they have ----
  logic second_q, move, asked_q, last_q, beyond_q;  // second_q: that of a leaf of two is next
  logic [31:0] slot, index, slot_q;
  logic [1:0] corrected, failed;
  logic [TAG-1:0] tag_q;
  assign slot = second_q ? slot_q + 1 : 32'(slot_i);
  assign move = !asked_q || (ddr_o.valid && ddr_ready_i);
  assign ready_o = move && !second_q;
  always_ff @(posedge clk_i) begin
    if (move) begin
      asked_q <= valid_i || second_q;
      if (!second_q) tag_q <= tag_i;
      last_q <= second_q || !tag_i[0];
      second_q <= !second_q && valid_i && tag_i[0];
      slot_q <= slot;
      beyond_q <= slot >= slots_i;
    end
    if (rst_i || clear_i) {asked_q, second_q} <= '0;
  end
  logic write_objects;
  assign write_objects = OBJECTS != 0 && addr_i[2+SW];
  slot_memory #(.SLOTS(SLOTS), .ECC(ECC)) order (
      .clk_bus_i, .write_i(write_i && !write_objects), .addr_i, .data_i, .flip_i, .clk_i, .read_i(move),
      .slot_i(slot[SW-1:0]), .word_o(index), .corrected_o(corrected[0]), .failed_o(failed[0]));
  logic [31:0] object;
  logic no_object;
  if (OBJECTS != 0) begin : g_objects
    slot_memory #(.SLOTS(SLOTS), .ECC(ECC)) whose (
        .clk_bus_i, .write_i(write_i && write_objects), .addr_i, .data_i, .flip_i, .clk_i, .read_i(move),
        .slot_i(slot[SW-1:0]), .word_o(object), .corrected_o(corrected[1]), .failed_o(failed[1]));
    assign no_object = objects_i != 0 && object >= objects_i;
  end else begin : g_still
    assign object = '0;
    assign {corrected[1], failed[1], no_object} = '0;
    logic unused;
    assign unused = &{1'b0, objects_i, addr_i, object};
  end
  assign corrected_o = corrected & {2{ddr_o.valid && ddr_ready_i}};
  assign fault_o = asked_q && (beyond_q || failed != 0 || index >= secondaries_i || no_object);
  assign fault_kind_o = beyond_q ? registers_pkg::NODE_FAULT_SLOT :
      (failed != 0) ? registers_pkg::NODE_FAULT_SLOT_BITS :
      no_object ? registers_pkg::NODE_FAULT_OBJECT : registers_pkg::NODE_FAULT_INDEX;
  assign fault_place_o = slot_q;

  // ---- What is owed, and being moved ----
  logic [DW:0] owed, write_q, read_q;
  logic last, valid;
  logic [31:0] index_now;
  logic [TAG-1:0] tag;
  logic [OBJECT_W-1:0] unused_object;
  logic [TAG_W-1:0] tags[DEPTH];
  assign ddr_o.valid = asked_q && !fault_o && owed != (DW + 1)'(DEPTH);
  assign ddr_o.word = index * 32'(words_i);
  assign owed = write_q - read_q;
  assign owed_o = owed != 0;
  always_ff @(posedge clk_i) begin
    if (ddr_o.valid && ddr_ready_i) begin
      tags[write_q[DW-1:0]] <= {last_q, object[OBJECT_W-1:0], index, tag_q};
      write_q <= write_q + 1;
    end
    if (valid) read_q <= read_q + 1;
    if (rst_i) {write_q, read_q} <= '0;
  end
  assign {last, unused_object, index_now, tag} = tags[read_q[DW-1:0]];

  // ---- Each by its object's transform ----
  logic [BEAT-1:0][31:0] beat;
  if (OBJECTS != 0) begin : g_moved
    logic [DW:0] arrived_q;
    logic [BEAT-1:0][31:0] unmoved_q;
    logic [T_MOVED:0] on_its_way;
    logic [T_MOVED-1:0] on_its_way_q;
    always_ff @(posedge clk_i) begin
      if (ddr_valid_i) arrived_q <= arrived_q + 1;
      if (rst_i) arrived_q <= '0;
      on_its_way_q <= rst_i ? '0 : on_its_way[T_MOVED-1:0];
    end
    always_ff @(posedge clk_moving_i) unmoved_q <= ddr_data_i;
    assign on_its_way = {on_its_way_q, ddr_valid_i};
    assign valid = on_its_way[T_MOVED];
    assign transform_entry_o = tags[arrived_q[DW-1:0]][TAG+32+:OBJECT_W];
    assign unmoved_o = unmoved_q;
    // The host back end computes in the clock behind the register.
    assign moving_o = (ARITH == "rtl") ? on_its_way[T_MOVED-1:0] != '0 : ddr_valid_i;
    align #(.W(BEAT * 32), .FROM((ARITH == "rtl") ? T_MOVED : 1), .TO(T_MOVED)) align_moved (
        .clk_i, .d_i(moved_i), .q_o(beat));
  end else begin : g_as_they_are
    assign valid = ddr_valid_i;
    assign beat = ddr_data_i;
    assign transform_entry_o = '0;
    assign moving_o = 1'b0;
    assign unmoved_o = '0;
    logic unused;
    assign unused = &{1'b0, clk_moving_i, moved_i};
  end

  // ---- Beats to leaves ----
  logic first_q;
  logic [BEAT-1:0][31:0] words_q;
  logic [31:0] first_index_q;
  always_ff @(posedge clk_i) begin
    if (valid && !last) {words_q, first_index_q} <= {beat, index_now};
    if (valid) first_q <= !last;
    if (rst_i || clear_i) first_q <= 0;
  end
  assign valid_o = valid && last && !clear_i;
  assign tag_o = tag;
  assign words_o = first_q ? {beat, words_q} : {2{beat}};
  assign index_o = first_q ? {index_now, first_index_q} : {2{index_now}};

`ifndef SYNTHESIS
  always_ff @(posedge clk_i)
    if (!rst_i) assert (!(ddr_valid_i && owed == 0)) else $error("leaf_reader: data nobody asked for");
`endif
endmodule
