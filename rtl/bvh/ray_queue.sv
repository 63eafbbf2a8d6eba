// SPDX-License-Identifier: Apache-2.0
// Queue of a pass's primaries, a ring in memory that the bus writes. Primary n is at byte 32 (n mod RAYS). A primary of
// more than 8 words is at 64 (n mod RAYS / 2). The unit takes primaries up to the number that the host has provided.
// Each primary is checked against the input contract, while it waits in a queue.
// Latency: 3 cycles plus shape_check's.
// Throughput: one primary per cycle.
// Stall: pop_i.
`include "bvh.svh"
module ray_queue #(
    parameter config_pkg::config_t CONFIG,
    localparam int RAYS = CONFIG.ray_places,
    localparam ARITH = config_pkg::arith(CONFIG.host),
    localparam bvh_pkg::traversals_t TRAVERSALS = bvh_pkg::card_traversals(CONFIG),
    localparam int WORDS = bvh_pkg::traverser_words(TRAVERSALS),
    localparam int AW = $clog2(RAYS)
) (
    input logic clk_bus_i,
    input logic write_i,
    input logic [31:0] addr_i,
    input logic [63:0] data_i,

    input logic clk_i,
    input logic rst_i,  // between passes: the next primary is number 0
    input logic [bvh_pkg::TRAVERSAL_BITS-1:0] traversal_i,  // traversal kind of the pass
    input logic [31:0] provided_i,  // primaries provided by the host
    output logic [31:0] taken_o,  // primaries whose place is free again
    output logic valid_o,
    output logic [WORDS-1:0][31:0] ray_o,
    output logic [31:0] number_o,
    output logic bad_o,
    input logic pop_i
);
  localparam int T_CHECK = config_pkg::check_latency(CONFIG.lat);
  // A shared front takes a ray per FRONT_CYCLES cycles. Then fewer places are enough, at best in distributed memory.
  localparam bit SHARED = CONFIG.node_cycles != 1 && !bvh_pkg::has_solids(TRAVERSALS) &&
      !bvh_pkg::has_front(TRAVERSALS, bvh_pkg::FRONT_RAY_SPHERE);
  localparam int BUSY = SHARED ? (T_CHECK + 5) / `FRONT_CYCLES + 2 : T_CHECK + 5;  // places in use at this rate
  localparam int DEPTH = (BUSY < 16) ? 16 : 1 << $clog2(BUSY);
  localparam int DW = $clog2(DEPTH);
  logic [DW:0] places_q;
  logic unused;
  assign unused = &{1'b0, addr_i, traversal_i};
  logic [31:0] next_q;  // next primary to take
  logic [WORDS-1:0][31:0] place;
  if (WORDS > bvh_pkg::PLACE_WORDS) begin : g_wide
    // Even and odd places: a primary takes one, or both of a row.
    logic [3:0][63:0] even[RAYS/2], odd[RAYS/2];
    always_ff @(posedge clk_bus_i) begin
      if (write_i && !addr_i[5]) even[addr_i[6+:AW-1]][addr_i[4:3]] <= data_i;
      if (write_i && addr_i[5]) odd[addr_i[6+:AW-1]][addr_i[4:3]] <= data_i;
    end
    logic both;
    logic [16*32-WORDS*32-1:0] unused_word;
    logic [AW-2:0] row;
    assign both = bvh_pkg::wide(int'(traversal_i));
    assign row = both ? next_q[AW-2:0] : next_q[AW-1:1];
    logic [3:0][63:0] first;
    assign first = (both || !next_q[0]) ? even[row] : odd[row];
    assign {unused_word, place} = {odd[row], first};
  end else begin : g_narrow
    // A place that the bus writes is not in use.
    (* no_rw_check *) logic [3:0][63:0] ring[RAYS];
    always_ff @(posedge clk_bus_i) if (write_i) ring[addr_i[5+:AW]][addr_i[4:3]] <= data_i;
    assign place = ring[next_q[AW-1:0]];
  end
  assign taken_o = next_q;

  // ---- At most as many primaries are under way as the queue has places ----
  logic request, read_q, requested_q, checked;
  logic [31:0] number_read_q, number_q;
  logic [WORDS-1:0][31:0] ray_read_q, ray_q;  // read: what the ring delivers
  assign request = next_q != provided_i && places_q != 0;
  always_ff @(posedge clk_i) begin
    {ray_read_q, ray_q} <= {place, ray_read_q};
    {number_read_q, number_q} <= {next_q, number_read_q};
    {read_q, requested_q} <= rst_i ? '0 : {request, read_q};
    if (request) next_q <= next_q + 1;
    places_q <= places_q + (DW + 1)'(pop_i) - (DW + 1)'(request);
    if (rst_i) begin
      next_q <= '0;
      places_q <= (DW + 1)'(DEPTH);
    end
  end

  // ---- The check, for the shape of the pass ----
  logic [pairs_pkg::SHAPES-1:0] bad_of;
  logic bad;
  for (genvar s = 0; s < pairs_pkg::SHAPES; s++) begin : shape
    if (bvh_pkg::has_traverser(TRAVERSALS, s)) begin : g_present
      localparam int P_WORDS = pairs_pkg::shape_words(s);
      logic [P_WORDS-1:0][0:0][31:0] words;
      logic [0:0][31:0] bad_now;
      assign words = ray_q[P_WORDS-1:0];
      shape_check #(
          .SHAPE(s), .EXP(CONFIG.exp), .MAN(CONFIG.man), .LAT(CONFIG.lat), .ARITH(ARITH)
      ) contract (
          .clk_i, .en_i(1'b1), .words_i(words), .bad_o(bad_now));
      pipe_delay #(.W(1), .FROM(ARITH == "rtl" ? T_CHECK : 0), .TO(T_CHECK)) delay_bad (
          .clk_i, .d_i(bad_now[0][0]), .q_o(bad_of[s]));
      logic unused_mask;
      assign unused_mask = &{1'b0, bad_now};
    end else begin : g_absent
      assign bad_of[s] = 1'b0;
    end
  end
  assign bad = ((TRAVERSALS & (TRAVERSALS - 1)) == 0) ? bad_of != '0 :
      bad_of[bvh_pkg::traverser_shape(int'(traversal_i))];
  pipe_delay_valid #(.TO(T_CHECK)) delay_requested (.clk_i, .rst_i, .valid_i(requested_q), .valid_o(checked));
  sync_fifo #(.W((1 + WORDS) * 32), .DEPTH(DEPTH), .LATE(1)) queue (
      .clk_i, .rst_i, .write_i(requested_q), .wdata_i({number_q, ray_q}), .free_o(), .count_o(), .some_o(),
      .rdata_o({number_o, ray_o}), .read_i(pop_i));
  sync_fifo #(.W(1), .DEPTH(DEPTH), .LATE(1)) queue_checked (
      .clk_i, .rst_i, .write_i(checked), .wdata_i(bad), .free_o(), .count_o(), .some_o(valid_o), .rdata_o(bad_o),
      .read_i(pop_i));
endmodule
