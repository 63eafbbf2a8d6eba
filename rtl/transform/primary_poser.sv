// SPDX-License-Identifier: Apache-2.0
// Transforms ("poses") the primaries of a pass before it starts. Every slot of every primary object goes from the RAM
// of written primaries through the transformer into the lanes. It works only after writes: a new transform or primary
// makes it pose the objects again. A new range, number of objects, shape or split also makes it restore all primaries
// first, as some may have left their object. Where objects overlap, the last one counts.
// Latency: n + T_DONE + 1 cycles for n slots of objects, and PRIMARIES + 2 more with a restore, until the check results
// of the posed slots.
// Throughput: one slot per cycle.
// Stall: none.
module primary_poser #(
    parameter int PRIMARIES = 256,
    parameter int ENTRIES = 64,
    parameter int T_COMMIT = 4,  // from a slot at the transformer's input to its output
    parameter int T_JUDGED = 9,  // from that input to the check result; the same in both back ends
    localparam int PRIM_W = $clog2(PRIMARIES),
    localparam int ENTRY_W = $clog2(ENTRIES)
) (
    input logic clk_i,      // clock of the engine
    input logic clk_bus_i,  // runs during a beat and with done_o
    input logic rst_i,
    input logic primary_write_i,
    input logic transform_write_i,
    input logic range_write_i,
    input logic [31:0] objects_i,
    input logic [1:0][pairs_pkg::SHAPE_BITS-1:0] shapes_i,  // of the pass
    input logic [PRIM_W-1:0] split_i,

    output logic pose_request_o,
    input logic pose_i,    // high while it may work
    output logic done_o,  // one cycle

    output logic [ENTRY_W-1:0] range_entry_o,
    input logic [1:0][31:0] range_i,
    output logic [ENTRY_W-1:0] transform_entry_o,
    output logic [PRIM_W-1:0] read_o,   // slot that the RAM shows in the next cycle, when it enters the transformer
    output pairs_pkg::shape_t shape_o,  // of that slot
    output logic plain_o,
    output logic moving_o,              // a slot is read or in the transformer
    output logic commit_o,              // the slot at the transformer's output goes to the lanes
    output logic [PRIM_W-1:0] number_o
);
  localparam int T_DONE = T_JUDGED + 2;
  localparam int T_MOVING = (T_COMMIT > 0) ? T_COMMIT - 1 : 0;  // age of the oldest slot in the transformer

  // ---- Is work necessary? ----
  localparam int KEY_W = 32 + 2 * pairs_pkg::SHAPE_BITS + PRIM_W;
  logic dirty_q, ranges_q;
  logic [KEY_W-1:0] key, key_q;
  assign key = (objects_i == 0) ? '0 : {objects_i, shapes_i, split_i};
  assign pose_request_o = key != key_q || (objects_i != 0 && (dirty_q || ranges_q));
  always_ff @(posedge clk_bus_i) begin
    if (done_o) begin
      {dirty_q, ranges_q} <= '0;
      key_q <= key;
    end
    if (primary_write_i || transform_write_i) dirty_q <= 1;
    if (range_write_i) ranges_q <= 1;
    if (rst_i) begin
      {dirty_q, ranges_q} <= '0;
      key_q <= '0;
    end
  end

  // ---- Restore, then the objects ----
  typedef enum logic [1:0] {REST, RESTORE, OBJECTS} state_e;
  state_e state_q;
  logic start, by_object, slot_valid, last;
  logic [31:0] slot, address;
  logic [ENTRY_W-1:0] object;
  logic [T_DONE-1:0] in_flight;  // slots in flight, by age
  assign by_object = (state_q == REST) ? key == key_q && !ranges_q : 1'b1;  // next work
  assign start = pose_i && !slot_valid && !in_flight[0] && (state_q == REST || (state_q == RESTORE && objects_i != 0));
  address_generator #(.ENTRIES(ENTRIES)) addresses (
      .clk_i, .rst_i(rst_i || !pose_i), .start_i(start), .stop_i(1'b0), .step_i(slot_valid),
      .stride_i(pairs_pkg::WORDS_BITS'(1)),
      .objects_i((start ? by_object : state_q == OBJECTS) ? (ENTRY_W + 1)'(objects_i) : '0), .first_i(32'd0),
      .count_i(32'(PRIMARIES)), .entry_o(range_entry_o), .range_i, .valid_o(slot_valid), .address_o(address),
      .slot_o(slot), .object_o(object), .last_o(last));
  always_ff @(posedge clk_i) begin
    in_flight <= T_DONE'({in_flight, slot_valid});
    if (start) state_q <= by_object ? OBJECTS : RESTORE;
    if (rst_i || !pose_i) begin
      state_q <= REST;
      in_flight <= '0;
    end
  end
  assign done_o = pose_i && !slot_valid && in_flight == '0 && (state_q == OBJECTS ||
      (state_q == RESTORE && objects_i == 0));
  assign transform_entry_o = object;
  assign read_o = PRIM_W'(slot);

  assign plain_o = state_q == RESTORE;
  assign shape_o = shapes_i[read_o >= split_i];
  assign moving_o = slot_valid || (T_COMMIT > 0 && in_flight[T_MOVING:0] != '0);

  // The slot is at the transformer's input one cycle after its step.
  logic [PRIM_W-1:0] number_q;
  always_ff @(posedge clk_i) number_q <= PRIM_W'(slot);
  pipe_delay #(.W(PRIM_W), .FROM(0), .TO(T_COMMIT)) delay_number (.clk_i, .d_i(number_q), .q_o(number_o));
  assign commit_o = in_flight[T_COMMIT];
  logic unused;
  assign unused = &{1'b0, address, last, slot};
endmodule
