// SPDX-License-Identifier: Apache-2.0
// Steps through slots, one per cycle. The slots are of one range, or of the ranges of an object table's entries 0 to
// objects_i - 1. Ranges follow each other without a gap, however short they are: the table is read one entry ahead.
// Latency: 1 cycle from start_i to the first slot.
// Throughput: one slot per cycle.
// Stall: step_i; a slot stays until it is high.
module address_generator #(
    parameter int ENTRIES = 0,  // entries of the table; 0: no table
    localparam int ENTRY_W = (ENTRIES > 1) ? $clog2(ENTRIES) : 1
) (
    input logic clk_i,
    input logic rst_i,
    input logic start_i,
    input logic stop_i,
    input logic step_i,
    input pairs_pkg::words_t stride_i,  // address difference between slots
    input logic [ENTRY_W:0] objects_i,  // 0: the range first_i, count_i
    input logic [31:0] first_i,
    input logic [31:0] count_i,

    output logic [ENTRY_W-1:0] entry_o,  // entry to read; range_i shows it in the next cycle
    input logic [1:0][31:0] range_i,     // first, count

    output logic valid_o,
    output logic [31:0] address_o,        // address of the slot: its number times the stride
    output logic [31:0] slot_o,           // number of the slot; without objects, its position in the range
    output logic [ENTRY_W-1:0] object_o,  // object of the slot
    output logic last_o
);
  logic [31:0] remaining_q, address_q, slot_q;
  logic more, follow, by_object;
  logic [31:0] first, count;
  logic some_q;  // remaining_q is not 0
  assign valid_o = some_q;
  assign address_o = address_q;
  assign slot_o = slot_q;
  assign last_o = remaining_q == 1 && !more;
  assign follow = step_i && remaining_q == 1 && more;

  if (ENTRIES > 0) begin : g_objects
    logic [ENTRY_W:0] ahead_q, ahead;  // the entry at range_i
    assign ahead = start_i ? (ENTRY_W + 1)'(1) : follow ? ahead_q + 1'b1 : (valid_o) ? ahead_q : '0;
    assign entry_o = ENTRY_W'(ahead);
    assign by_object = objects_i != 0;
    assign more = ahead_q < objects_i;
    assign object_o = ENTRY_W'(ahead_q - 1'b1);
    assign first = by_object ? range_i[0] : first_i;
    assign count = by_object ? range_i[1] : count_i;
    always_ff @(posedge clk_i) ahead_q <= rst_i ? '0 : ahead;
  end else begin : g_range
    logic unused;
    assign unused = &{1'b0, objects_i, range_i};
    assign entry_o = '0;
    assign by_object = 1'b0;
    assign more = 1'b0;
    assign object_o = '0;
    assign first = first_i;
    assign count = count_i;
  end

  always_ff @(posedge clk_i) begin
    if (step_i) begin
      remaining_q <= remaining_q - 1;
      some_q <= remaining_q != 1;
      address_q <= address_q + 32'(stride_i);
      slot_q <= slot_q + 1;
    end
    if (start_i || follow) begin
      remaining_q <= count;
      some_q <= count != 0;
      address_q <= first * 32'(stride_i);
      slot_q <= by_object ? first : '0;
    end
    if (rst_i || (stop_i && !start_i)) begin
      remaining_q <= 0;
      some_q <= 0;
    end
  end
`ifndef SYNTHESIS
  always_ff @(posedge clk_i)
    if (!rst_i) assert (!(step_i && !valid_o)) else $error("address_generator: a step past the end");
`endif
endmodule
