// SPDX-License-Identifier: Apache-2.0
// Records of a BVH pass, one per cycle, in the order they occur: hits of mode hits, finished primaries, and bad
// primaries. The words are as in record_maker.sv. With normals, a second record follows each one; it has n in the words
// of CP and the signed distance in T.
// Latency: 1 cycle; hits wait in queues.
// Throughput: one record per cycle.
// Stall: ready_o and bad_ready_o are low while the ring is full or another record goes first. Hits are never stalled:
// hits_free_o reserves their space.
module bvh_records #(
    parameter config_pkg::config_t CONFIG,
    parameter int DEPTH = 128,  // hits that wait, per lane; power of two
    localparam int WORDS = records_pkg::RECORD_WORDS,
    localparam int POINTS = (CONFIG.normals != 0) ? 6 : 3
) (
    input logic clk_i,
    input logic rst_i,
    input logic [2:0] mode_i,  // registers_pkg::MODE_*
    input logic normals_i,

    // The next leaf can go to the pairs: there is room for its hits.
    output logic hits_free_o,
    input logic leaf_i,
    input logic leaf_tested_i,
    input logic [1:0] hit_i,
    input logic [31:0] hit_number_i,
    input logic [1:0][31:0] hit_t_i,
    input logic [POINTS-1:0][1:0][31:0] hit_point_i,
    input logic [1:0][31:0] hit_index_i,

    input logic valid_i,  // a finished primary
    output logic ready_o,
    input logic [31:0] number_i,
    input logic found_i,  // the record names a pair; f_i: the pair is a hit
    input logic f_i,
    input logic [31:0] t_i,
    input logic [POINTS-1:0][31:0] point_i,
    input logic [31:0] index_i,

    input logic bad_valid_i,  // a bad primary
    output logic bad_ready_o,
    input logic [31:0] bad_number_i,

    input logic sram_full_i,
    input logic sram_nearly_full_i,
    output logic write_o,
    output logic [WORDS-1:0][31:0] record_o,
    output logic finished_o,  // a primary has all its records
    output logic empty_o      // nothing waits
);
  localparam logic [31:0] QNAN = 32'(formats_pkg::quiet_nan(CONFIG.exp, CONFIG.man));
  localparam logic [31:0] INFINITE = 32'h7f80_0000;
  localparam int DW = $clog2(DEPTH);
  logic hits, occluded;
  assign hits = mode_i == registers_pkg::MODE_HITS;
  assign occluded = mode_i == registers_pkg::MODE_OCCLUDED;

  // ---- Hits, one queue per lane, and one if secondaries of a leaf come one by one ----
  typedef struct packed {
    logic [31:0] number;
    logic [31:0] t;
    logic [POINTS-1:0][31:0] point;
    logic [31:0] index;
  } hit_t;
  localparam int LANES = (CONFIG.shared_lane != 0) ? 1 : 2;
  hit_t [LANES-1:0] waiting;
  logic [LANES-1:0] some, read;  // some: hits of the lane wait
  logic [DW:0] outstanding_q;  // number of leaves under way
  logic [LANES-1:0][DW:0] free;
  for (genvar l = 0; l < LANES; l++) begin : lane
    hit_t hit;
    always_comb begin
      hit = '{number: hit_number_i, t: hit_t_i[l], point: '0, index: hit_index_i[l]};
      for (int k = 0; k < POINTS; k++) hit.point[k] = hit_point_i[k][l];
    end
    sync_fifo #(.W($bits(hit_t)), .DEPTH(DEPTH), .LATE(1)) queue (
        .clk_i, .rst_i, .write_i(hit_i[l]), .wdata_i(hit), .free_o(free[l]), .count_o(), .some_o(some[l]),
        .rdata_o(waiting[l]), .read_i(read[l]));
  end
  // A leaf can have two hits.
  logic room;
  assign room = (LANES == 1) ? {outstanding_q, 1'b1} < {1'b0, free[0]} :
      outstanding_q < free[0] && outstanding_q < free[LANES-1];
  assign hits_free_o = !hits || room;
  always_ff @(posedge clk_i)
    if (rst_i) outstanding_q <= '0;
    else if (hits) outstanding_q <= outstanding_q + (DW + 1)'(leaf_i) - (DW + 1)'(leaf_tested_i);

  // ---- One record per cycle. A primary's last record follows its hits, which are queued before it arrives ----
  logic ring_ready, record_ready, take_hit, lane_1, take_bad, take, second_q;
  hit_t hit;
  assign ring_ready = !sram_full_i && !(write_o && sram_nearly_full_i);
  assign record_ready = ring_ready && !second_q;  // the second record of a pair goes next
  assign take_hit = record_ready && some != 0;
  assign lane_1 = LANES == 2 && !some[0];
  assign hit = lane_1 ? waiting[LANES-1] : waiting[0];
  assign read = take_hit ? LANES'({lane_1, !lane_1}) : '0;
  logic unused_lane;  // [1] of one lane
  assign unused_lane = &{1'b0, hit_i, hit_t_i, hit_point_i, hit_index_i};
  assign ready_o = record_ready && some == 0;
  assign bad_ready_o = ready_o && !valid_i;
  assign take = valid_i && ready_o;
`ifndef SYNTHESIS
  logic hidden_q;  // a hit was written in the last cycle and cannot be read yet
  logic [31:0] hidden_number_q;
  always_ff @(posedge clk_i) begin
    {hidden_q, hidden_number_q} <= {!rst_i && hit_i[LANES-1:0] != '0, hit_number_i};
    if (!rst_i) assert (!(take && hits && hidden_q && hidden_number_q == number_i)) else
        $error("bvh_records: a primary's end overtakes its hit");
  end
`endif
  assign take_bad = bad_valid_i && bad_ready_o;
  assign finished_o = take || take_bad;
  assign empty_o = some == 0 && !write_o && !second_q;

  records_pkg::record_flags_t flags;
  logic found;
  assign found = take_hit || (found_i && !occluded && !take_bad);
  assign flags = '{normal: 1'b0, bad: take_bad, f: take_hit || (f_i && !take_bad)};
  logic [WORDS-1:0][31:0] record;
  logic [POINTS-1:0][31:0] point;
  assign point = take_bad ? {POINTS{QNAN}} : !found ? '0 : take_hit ? hit.point : point_i;
  always_comb begin
    record[records_pkg::RECORD_FLAGS] = 32'(flags);
    record[records_pkg::RECORD_PRIMARY] = take_hit ? hit.number : take_bad ? bad_number_i : number_i;
    record[records_pkg::RECORD_CP+:3] = point[2:0];
    record[records_pkg::RECORD_INDEX] = !found ? '1 : take_hit ? hit.index : index_i;
    record[records_pkg::RECORD_T] = take_bad ? QNAN : !found ? INFINITE : take_hit ? hit.t : t_i;
  end
  logic written;  // a record is written in this cycle
  assign written = take_hit || (finished_o && !hits);
  if (CONFIG.normals != 0) begin : g_normals
    logic [2:0][31:0] n_q;
    logic [WORDS-1:0][31:0] second;
    logic f_q, bad_q;
    always_comb begin
      second = record_o;
      second[records_pkg::RECORD_FLAGS] = 32'({1'b1, bad_q, f_q});
      second[records_pkg::RECORD_CP+:3] = n_q;
      if (f_q) second[records_pkg::RECORD_T][31] = 1'b1;
    end
    always_ff @(posedge clk_i) begin
      write_o <= !rst_i && (written || (second_q && ring_ready));
      if (second_q && ring_ready) record_o <= second;
      if (written) record_o <= record;
      if (written) {n_q, bad_q, f_q} <= {point[POINTS-1:POINTS-3], flags.bad, flags.f};
      second_q <= !rst_i && (written ? normals_i : second_q && !ring_ready);
    end
  end else begin : g_alone
    assign second_q = 1'b0;
    logic unused;
    assign unused = normals_i;
    always_ff @(posedge clk_i) begin
      write_o <= !rst_i && written;
      record_o <= record;
    end
  end
endmodule
