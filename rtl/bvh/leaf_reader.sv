// SPDX-License-Identifier: Apache-2.0
// Reads the secondaries of leaves from DDR, where they are in the order of their upload. A slot of the BVH names its
// secondary (slot_reader.sv). So DDR holds each secondary once, and the slot gives its index.
// A secondary takes one beat, or two beats if it has more than 9 words. With OBJECTS, a slot also names its object, and
// secondaries go through the external transformer.
// Latency: slot_reader.sv, 2 cycles, the memory's latency and T_MOVED.
// Throughput: one beat per cycle.
// Stall: ready_o, ddr_ready_i.
module leaf_reader #(
    parameter int SLOTS = 32768,  // power of two
    parameter int WORDS = 9,      // of the largest secondary, at least one beat
    parameter int TAG = 32,       // bits; the lowest bit says that the leaf has two secondaries
    parameter int DEPTH = 256,    // secondaries requested from DDR or being transformed, power of two
    parameter int ECC = 0,        // 1: slot words have check bits
    parameter int OBJECTS = 0,    // most objects of a pass; 0: nothing moves
    parameter int EXTERNAL = 0,   // 1: slots are in DDR
    parameter int T_TRANSFORM = 0,
    parameter ARITH = "rtl",
    localparam int OBJECT_W = (OBJECTS > 1) ? $clog2(OBJECTS) : 1,
    localparam int T_MOVED = (OBJECTS != 0) ? 1 + T_TRANSFORM : 0,
    localparam int BEAT = records_pkg::DDR_WORDS
) (
    input logic clk_bus_i,
    input logic write_i,
    input logic [31:0] addr_i,  // secondaries of slots, and from 4 SLOTS on their objects
    input logic [63:0] data_i,
    input logic [1:0][31:0] flip_i,  // injected bit errors of a write

    input logic clk_i,
    input logic rst_i,
    input logic clear_i,  // between passes; drops outstanding requests
    input logic [31:0] slots_i,  // slots of the BVH
    input logic [1:0][31:0] slot_base_i,  // with EXTERNAL, words of slot 0 in DDR: of its object, of its secondary
    input logic [31:0] secondaries_i,  // number of secondaries in DDR
    input pairs_pkg::words_t words_i,  // words per secondary
    input logic [31:0] objects_i,  // 0: secondaries are not transformed
    input logic valid_i,
    output logic ready_o,
    input logic [bvh_pkg::PLACE-1:0] slot_i,
    input logic [TAG-1:0] tag_i,

    output card_pkg::ddr_request_t ddr_o,
    input logic ddr_ready_i,
    input logic ddr_valid_i,
    input logic [BEAT-1:0][31:0] ddr_data_i,
    output logic [3:0] ddr_words_o,  // words of the beat that belong to a secondary
    output card_pkg::ddr_request_t slot_ddr_o,
    input logic slot_ddr_ready_i,
    input logic slot_ddr_valid_i,
    output logic outstanding_o,  // reads are outstanding, or will be by this cycle's request

    // To the object table and the transformer, as in secondary_regfile.sv.
    output logic [OBJECT_W-1:0] transform_entry_o,  // object of the arriving secondary
    output logic moving_o,
    input logic clk_moving_i,
    output logic [WORDS-1:0][31:0] unmoved_o,
    input logic [WORDS-1:0][31:0] moved_i,

    output logic valid_o,  // a whole leaf
    output logic [TAG-1:0] tag_o,
    output logic one_valid_o,  // each secondary: words_o[1] and index_o[1], with tag_o
    output logic one_last_o,
    output logic [1:0][WORDS-1:0][31:0] words_o,
    output logic [1:0][31:0] index_o,
    output logic fault_o,  // a slot, or the secondary or object in it, does not exist
    output logic [3:0] fault_kind_o,  // registers_pkg::NODE_FAULT_*
    output logic [31:0] fault_place_o,
    output logic [1:0] corrected_o  // corrected words of a slot
);
  localparam int DW = $clog2(DEPTH);
  localparam int TAG_W = 1 + OBJECT_W + 32 + TAG;

  // ---- Slots ----
  logic requested, last_slot, beyond, no_object;
  logic wide, half_q, taken, take, whole_requested;  // half_q: the second beat of a secondary is next
  if (WORDS > BEAT) begin : g_two_beats
    assign wide = 32'(words_i) > BEAT;
    always_ff @(posedge clk_i) half_q <= wide && half_q != taken && !rst_i;
  end else begin : g_a_beat
    assign {wide, half_q} = '0;
    logic unused_wide;
    assign unused_wide = wide;
  end
  logic [31:0] index, object;
  logic [1:0] corrected, failed;
  logic [TAG-1:0] slot_tag;
  logic slots_outstanding;
  slot_reader #(
      .SLOTS(SLOTS), .TAG(TAG), .ECC(ECC), .OBJECTS(OBJECTS), .EXTERNAL(EXTERNAL)
  ) slots (
      .clk_bus_i, .write_i, .addr_i, .data_i, .flip_i, .clk_i, .rst_i, .clear_i, .slots_i,
      .base_i(slot_base_i), .objects_i(objects_i != 0), .valid_i, .ready_o, .slot_i, .tag_i, .ddr_o(slot_ddr_o),
      .ddr_ready_i(slot_ddr_ready_i), .ddr_valid_i(slot_ddr_valid_i), .ddr_data_i, .outstanding_o(slots_outstanding),
      .valid_o(requested), .take_i(take), .slot_o(fault_place_o), .tag_o(slot_tag), .last_o(last_slot),
      .beyond_o(beyond), .index_o(index), .object_o(object), .corrected_o(corrected), .failed_o(failed));
  assign no_object = OBJECTS != 0 && objects_i != 0 && object >= objects_i;
  assign corrected_o = corrected & {2{whole_requested}};
  assign fault_o = requested && (beyond || failed != 0 || index >= secondaries_i || no_object);
  assign fault_kind_o = beyond ? registers_pkg::NODE_FAULT_SLOT :
      (failed != 0) ? registers_pkg::NODE_FAULT_SLOT_BITS :
      no_object ? registers_pkg::NODE_FAULT_OBJECT : registers_pkg::NODE_FAULT_INDEX;

  // ---- Secondaries requested or being transformed ----
  logic [DW:0] outstanding, write_q, read_q;
  logic last, valid;
  logic [31:0] index_now;
  logic [TAG-1:0] tag;
  logic [OBJECT_W-1:0] unused_object;
  (* no_rw_check *) logic [TAG_W-1:0] tags[DEPTH];  // DDR answers two cycles after a request at the earliest
  // Their addresses wait in a queue. A pass that ends does not drop them.
  logic [2:0] requests_free;
  logic [31:0] request;
  sync_fifo #(.W(32), .DEPTH(4)) queue_requests (
      .clk_i, .rst_i, .write_i(whole_requested), .wdata_i(index * 32'(words_i)), .free_o(requests_free),
      .count_o(), .some_o(ddr_o.valid), .rdata_o(request), .read_i(taken && half_q == wide));
  // A slot with a fault is taken without a request.
  logic full_q;
  assign take = requested && requests_free != 0 && !full_q;
  assign whole_requested = take && !fault_o;
  assign taken = ddr_o.valid && ddr_ready_i;
  assign ddr_o.word = request + (half_q ? BEAT : 0);
  assign ddr_o.words = half_q ? 4'(32'(words_i) - BEAT) : wide ? 4'(BEAT) : 4'(words_i);
  assign outstanding = write_q - read_q;
  assign outstanding_o = outstanding != 0 || whole_requested || slots_outstanding;  // includes this cycle's requests
  always_ff @(posedge clk_i) begin
    if (whole_requested) begin
      tags[write_q[DW-1:0]] <= {last_slot, object[OBJECT_W-1:0], index, slot_tag};
      write_q <= write_q + 1;
    end
    if (valid) read_q <= read_q + 1;
    // The room for secondaries, one cycle ahead.
    full_q <= !rst_i && !valid && (full_q || (outstanding == (DW + 1)'(DEPTH - 1) && whole_requested));
    if (rst_i) {write_q, read_q} <= '0;
  end
  assign {last, unused_object, index_now, tag} = tags[read_q[DW-1:0]];

  // ---- Beats to secondaries ----
  logic whole;
  logic [WORDS-1:0][31:0] arrived;
  if (WORDS > BEAT) begin : g_two
    logic [BEAT-1:0][31:0] low_q;
    logic low_valid_q;
    always_ff @(posedge clk_i) begin
      if (ddr_valid_i) low_q <= ddr_data_i;
      low_valid_q <= !rst_i && wide && (low_valid_q != ddr_valid_i);
    end
    assign whole = ddr_valid_i && wide == low_valid_q;
    assign arrived = wide ? {ddr_data_i[WORDS-BEAT-1:0], low_q} : (WORDS * 32)'(ddr_data_i);
    assign ddr_words_o = !wide ? 4'(words_i) : low_valid_q ? 4'(32'(words_i) - BEAT) : 4'(BEAT);
  end else begin : g_one
    assign whole = ddr_valid_i;
    assign arrived = ddr_data_i;
    assign ddr_words_o = 4'(words_i);
  end

  // ---- Transform of its object ----
  logic [WORDS-1:0][31:0] moved;
  if (OBJECTS != 0) begin : g_moved
    logic [DW:0] arrived_q;
    logic [WORDS-1:0][31:0] unmoved_q;
    logic [T_MOVED:0] in_flight;
    logic [T_MOVED-1:0] in_flight_q;
    always_ff @(posedge clk_i) begin
      if (whole) arrived_q <= arrived_q + 1;
      if (rst_i) arrived_q <= '0;
      in_flight_q <= rst_i ? '0 : in_flight[T_MOVED-1:0];
    end
    always_ff @(posedge clk_moving_i) unmoved_q <= arrived;
    assign in_flight = {in_flight_q, whole};
    assign valid = in_flight[T_MOVED];
    assign transform_entry_o = tags[arrived_q[DW-1:0]][TAG+32+:OBJECT_W];
    assign unmoved_o = unmoved_q;
    // The host back end computes in the cycle after the register.
    assign moving_o = (ARITH == "rtl") ? in_flight[T_MOVED-1:0] != '0 : whole;
    pipe_delay #(.W(WORDS * 32), .FROM((ARITH == "rtl") ? T_MOVED : 1), .TO(T_MOVED)) delay_moved (
        .clk_i, .d_i(moved_i), .q_o(moved));
  end else begin : g_as_they_are
    assign valid = whole;
    assign moved = arrived;
    assign transform_entry_o = '0;
    assign moving_o = 1'b0;
    assign unmoved_o = '0;
    logic unused;
    assign unused = &{1'b0, clk_moving_i, moved_i};
  end

  // ---- Secondaries to leaves ----
  logic first_q;
  logic [WORDS-1:0][31:0] words_q;
  logic [31:0] first_index_q;
  always_ff @(posedge clk_i) begin
    if (valid && !last) {words_q, first_index_q} <= {moved, index_now};
    if (valid) first_q <= !last;
    if (rst_i || clear_i) first_q <= 0;
  end
  assign valid_o = valid && last && !clear_i;
  assign tag_o = tag;
  assign one_valid_o = valid && !clear_i;
  assign one_last_o = last;
  assign words_o = first_q ? {moved, words_q} : {2{moved}};
  assign index_o = first_q ? {index_now, first_index_q} : {2{index_now}};

`ifndef SYNTHESIS
  logic requested_q;
  always_ff @(posedge clk_i) begin
    requested_q <= whole_requested;
    if (!rst_i) begin
      assert (!(ddr_valid_i && outstanding == 0)) else $error("leaf_reader: data without a request");
      assert (!(valid && requested_q && outstanding == 1)) else $error("leaf_reader: data in one cycle");
    end
  end
`endif
endmodule
