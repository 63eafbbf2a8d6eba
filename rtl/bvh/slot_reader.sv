// SPDX-License-Identifier: Apache-2.0
// For each slot of a leaf, the numbers of its secondary and of its object. Slots are in memories beside the nodes. With
// EXTERNAL they are in DDR, and a leaf takes one beat, or two beats with objects.
// Latency: 1 cycle. With EXTERNAL 3 cycles plus the memory's latency.
// Throughput: one slot per cycle; with EXTERNAL at most one leaf per two cycles.
// Stall: ready_o, take_i, ddr_ready_i.
module slot_reader #(
    parameter int SLOTS = 32768,  // power of two
    parameter int TAG = 32,       // bits; the lowest bit says that the leaf has two slots
    parameter int ECC = 0,        // 1: words on chip have check bits
    parameter int OBJECTS = 0,    // most objects of a pass; 0: slots have none
    parameter int EXTERNAL = 0,
    parameter int DEPTH = 32,     // leaves under way with EXTERNAL, power of two
    localparam int BEAT = records_pkg::DDR_WORDS,
    localparam int PLACE = bvh_pkg::PLACE
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
    input logic [1:0][31:0] base_i,  // words of slot 0 in DDR: of its object, of its secondary
    input logic objects_i,  // the pass has objects
    input logic valid_i,
    output logic ready_o,
    input logic [PLACE-1:0] slot_i,  // first slot of a leaf
    input logic [TAG-1:0] tag_i,

    output card_pkg::ddr_request_t ddr_o,
    input logic ddr_ready_i,
    input logic ddr_valid_i,
    input logic [BEAT-1:0][31:0] ddr_data_i,
    output logic outstanding_o,  // beats are outstanding, or will be by this cycle's request

    output logic valid_o,
    input logic take_i,
    output logic [31:0] slot_o,
    output logic [TAG-1:0] tag_o,
    output logic last_o,    // of the leaf
    output logic beyond_o,  // there is no such slot
    output logic [31:0] index_o,
    output logic [31:0] object_o,
    output logic [1:0] corrected_o,
    output logic [1:0] failed_o
);
  localparam int SW = $clog2(SLOTS);
  logic move, second_q, some;  // second_q: the second slot of a leaf is next
  logic [31:0] slot, slot_q;
  logic [TAG-1:0] tag, tag_q;
  assign move = !valid_o || take_i;
  assign {slot_o, tag_o} = {slot_q, tag_q};
  assign beyond_o = slot_q >= slots_i;
  always_ff @(posedge clk_i) begin
    if (move) begin
      valid_o <= some || second_q;
      if (!second_q) tag_q <= tag;
      last_o <= second_q || !tag[0];
      second_q <= !second_q && some && tag[0];
      slot_q <= slot;
    end
    if (rst_i || clear_i) {valid_o, second_q} <= '0;
  end

  if (EXTERNAL == 0) begin : g_on_chip
    assign some = valid_i;
    assign tag = tag_i;
    assign slot = second_q ? slot_q + 1 : 32'(slot_i);
    assign ready_o = move && !second_q;
    logic write_objects;
    assign write_objects = OBJECTS != 0 && addr_i[2+SW];
    slot_memory #(.SLOTS(SLOTS), .ECC(ECC)) order (
        .clk_bus_i, .write_i(write_i && !write_objects), .addr_i, .data_i, .flip_i, .clk_i, .read_i(move),
        .slot_i(slot[SW-1:0]), .word_o(index_o), .corrected_o(corrected_o[0]), .failed_o(failed_o[0]));
    if (OBJECTS != 0) begin : g_objects
      slot_memory #(.SLOTS(SLOTS), .ECC(ECC)) slot_objects (
          .clk_bus_i, .write_i(write_i && write_objects), .addr_i, .data_i, .flip_i, .clk_i, .read_i(move),
          .slot_i(slot[SW-1:0]), .word_o(object_o), .corrected_o(corrected_o[1]), .failed_o(failed_o[1]));
    end else begin : g_still
      assign object_o = '0;
      assign {corrected_o[1], failed_o[1]} = '0;
      logic unused_address;
      assign unused_address = &{1'b0, addr_i};
    end
    assign ddr_o = '0;
    assign outstanding_o = 1'b0;
    logic unused;
    assign unused = &{1'b0, base_i, objects_i, ddr_ready_i, ddr_valid_i, ddr_data_i};
  end else begin : g_external
    localparam int DW = $clog2(DEPTH);
    logic rst;
    assign rst = rst_i || clear_i;
    // Requests.
    logic asking_q, half_q, objects, asked, last_asked;
    logic [PLACE-1:0] asking_slot_q;
    logic [TAG-1:0] asking_tag_q;
    logic [DW:0] under_way_q;
    logic leave, left_q;  // left_q: a leaf left in the last cycle
    assign objects = OBJECTS != 0 && objects_i;
    assign asked = ddr_o.valid && ddr_ready_i;
    assign last_asked = asked && half_q == objects;
    assign ready_o = !asking_q && under_way_q != (DW + 1)'(DEPTH);
    assign ddr_o.valid = asking_q;  // can be high in the first cycle of clear_i
    assign ddr_o.words = 4'd2;
    // A slot beyond the last is not read beyond DDR. The output beyond_o tells of it.
    assign ddr_o.word = base_i[half_q] + ((32'(asking_slot_q) < slots_i) ? 32'(asking_slot_q) : '0);
    always_ff @(posedge clk_i) begin
      if (ready_o) begin
        asking_q <= valid_i;
        {asking_slot_q, asking_tag_q} <= {slot_i, tag_i};
      end else if (last_asked) asking_q <= 1'b0;
      half_q <= half_q ^ (asked && objects);
      under_way_q <= under_way_q + (DW + 1)'(valid_i && ready_o) - (DW + 1)'(left_q);
      left_q <= leave;
      if (rst) {asking_q, half_q, under_way_q, left_q} <= '0;
    end
    // Answers.
    typedef struct packed {
      logic [PLACE-1:0] slot;
      logic [TAG-1:0] tag;
    } leaf_t;
    leaf_t waiting, head;
    logic [1:0][31:0] first_q, indices, slot_objects;
    logic second_beat_q, whole;
    logic [DW+1:0] outstanding_q;
    sync_fifo #(.W($bits(leaf_t)), .DEPTH(DEPTH)) queue_waiting (
        .clk_i, .rst_i(rst), .write_i(last_asked), .wdata_i({asking_slot_q, asking_tag_q}), .free_o(), .count_o(),
        .some_o(), .rdata_o(waiting), .read_i(whole));
    sync_fifo #(.W($bits(leaf_t) + 128), .DEPTH(DEPTH), .LATE(1)) queue_arrived (
        .clk_i, .rst_i(rst), .write_i(whole),
        .wdata_i({waiting, ddr_data_i[1:0], objects ? first_q : ddr_data_i[1:0]}), .free_o(), .count_o(), .some_o(some),
        .rdata_o({head, slot_objects, indices}), .read_i(leave));
    assign whole = ddr_valid_i && second_beat_q == objects && !rst;
    assign outstanding_o = outstanding_q != 0 || ddr_o.valid;
    always_ff @(posedge clk_i) begin
      if (ddr_valid_i) first_q <= ddr_data_i[1:0];
      second_beat_q <= second_beat_q ^ (ddr_valid_i && objects);
      if (rst) second_beat_q <= 1'b0;
      outstanding_q <= rst_i ? '0 : outstanding_q + (DW + 2)'(asked) - (DW + 2)'(ddr_valid_i);
    end
    // Slots.
    assign tag = head.tag;
    assign slot = 32'(head.slot) + 32'(second_q);
    assign leave = move && (second_q || (some && !tag[0]));
    always_ff @(posedge clk_i)
      if (move) begin
        index_o <= indices[second_q];
        object_o <= (OBJECTS != 0) ? slot_objects[second_q] : '0;
      end
    assign {corrected_o, failed_o} = '0;  // ddr_check.sv
    logic unused;
    assign unused = &{1'b0, clk_bus_i, write_i, addr_i, data_i, flip_i, slot_objects, ddr_data_i};
`ifndef SYNTHESIS
    always_ff @(posedge clk_i)
      if (!rst_i) begin
        assert (!(ddr_valid_i && outstanding_q == 0)) else $error("slot_reader: data without a request");
      end
`endif
  end
endmodule
