// SPDX-License-Identifier: Apache-2.0
// BVH passes of rays or solids. The host provides the primaries. Nodes and the contents of leaf slots are in their own
// memories, with a cache also in DDR (node_reader.sv). Secondaries come from DDR. Records carry the primaries' numbers
// and come in the order found.
// A pass ends when every primary has its record, or with a fault if the memory holds no valid BVH.
// A pass without primaries refits the boxes of the nodes (refit.sv), if all are on chip.
// Latency: see traversal.sv.
// Throughput: see traversal.sv; a primary takes four beats of the bus.
// Stall: the record ring.
`include "bvh.svh"
module bvh_unit #(
    parameter config_pkg::config_t CONFIG,
    localparam int UNITS = CONFIG.traversal_units,
    localparam int READERS = config_pkg::bvh_readers(CONFIG),
    localparam bvh_pkg::traversals_t TRAVERSALS = bvh_pkg::card_traversals(CONFIG),
    localparam int PRIMARY = bvh_pkg::traverser_words(TRAVERSALS),
    localparam int LEAF = bvh_pkg::leaf_words(TRAVERSALS),
    localparam int POINTS = (CONFIG.normals != 0) ? 6 : 3,
    localparam int WORDS = records_pkg::RECORD_WORDS,
    localparam int BEAT = records_pkg::DDR_WORDS,
    localparam int OBJECTS = (CONFIG.transform != pairs_pkg::TRANSFORM_NONE) ? CONFIG.objects : 0,
    localparam int OBJECT_W = (OBJECTS > 1) ? $clog2(OBJECTS) : 1
) (
    input logic clk_core_i,
    input logic clk_bus_i,
    input logic rst_i,
    // The bus: memories, written between passes, and registers.
    input card_pkg::access_t access_i,
    output logic [63:0] rdata_o,
    output logic provided_good_o,  // for REG_RAYS
    output logic [2:0] good_o,     // as in bvh_registers.sv

    input logic valid_i,
    output logic ready_o,
    input logic abort_i,
    input card_pkg::pass_t pass_i,
    output logic busy_o,
    output logic [bvh_pkg::TRAVERSAL_BITS-1:0] traversal_o,  // traversal kind of the pass
    output logic done_o,
    output logic fault_o,  // the finished pass failed
    output logic [7:0] corrected_o,  // words corrected in this cycle, in the memories of nodes and slots

    // Readers of DDR: [0] leaves, with a cache also [1] slots and then each traversal unit.
    output card_pkg::ddr_request_t [READERS-1:0] ddr_o,
    input logic [READERS-1:0] ddr_ready_i,
    input logic [READERS-1:0] ddr_valid_i,
    input logic [BEAT-1:0][31:0] ddr_data_i,
    output logic [READERS-1:0][3:0] ddr_words_o,

    // To the object table and the transformer (leaf_reader.sv).
    output logic [OBJECT_W-1:0] transform_entry_o,
    output logic moving_o,
    input logic clk_moving_i,
    output logic [LEAF-1:0][31:0] unmoved_o,
    input logic [LEAF-1:0][31:0] moved_i,

    // The lane, with SHARED_LANE and gates, and its turn.
    input logic [2:0] turn_i,
    output card_pkg::lane_operands_t lane_o,
    input card_pkg::lane_results_t lane_i,

    input logic sram_full_i,
    input logic sram_nearly_full_i,
    output logic write_o,
    output logic [WORDS-1:0][31:0] record_o
);
  import bvh_pkg::*;
  localparam int NODES = config_pkg::chip_nodes(CONFIG);
  localparam int NW = $clog2(NODES);
  localparam bit CACHED = CONFIG.node_cache != 0;
  // Memories of nodes are half as wide, if nothing needs a whole node in one cycle.
  localparam bit HALVES = CACHED && CONFIG.node_cycles == 4 && CONFIG.ecc == 0 && CONFIG.host == 0 &&
      !has_solids(TRAVERSALS);
  localparam int CONTEXTS = CONFIG.contexts;
  localparam int CX = $clog2(CONTEXTS);
  localparam int TAG = `AT_BITS(CX) + 1;
  localparam int T_TRANSFORM = pairs_pkg::transform_latency(CONFIG.pairs, CONFIG.swap != 0, CONFIG.transform,
      CONFIG.lat.add, CONFIG.lat.mul);
  localparam int REFIT_CONTEXTS = 8;
  localparam int REFIT_TAG = $clog2(REFIT_CONTEXTS) + 4;

  typedef enum logic [1:0] {IDLE, RUN, FLUSH} state_t;
  state_t state_q;
  logic clk, rst_q, rst, running, refitting, wrong;
  logic [2:0] mode_q;
  logic normals_q;
  logic [TRAVERSAL_BITS-1:0] traversal_q, traversal_now;  // traversal kind of this pass, and of the next one
  // A constant if the card has one kind.
  assign traversal_now = ($countones(TRAVERSALS) == 1) ? TRAVERSAL_BITS'($clog2(TRAVERSALS)) :
      busy_o ? traversal_q : {pass_i.pair[0], pass_i.swap[0]};
  assign traversal_o = traversal_q;
  logic [31:0] secondaries_q, objects_q, finished_q;
  logic [31:0] taken, provided, ray_count, nodes, first_node, slots;
  logic finished, records_empty;
  assign running = state_q == RUN;
  assign refitting = !CACHED && running && mode_q == registers_pkg::MODE_REFIT;
  assign rst = rst_i || rst_q;  // reset of the traversal, which starts afresh with every pass
  assign busy_o = state_q != IDLE;
  assign ready_o = state_q == IDLE;
  // Idle while it waits for the host: every primary provided so far has its record.
  logic waits;
  assign waits = running && !refitting && finished_q == provided && finished_q != ray_count && records_empty;
  clock_gate gate (.clk_i(clk_core_i), .enable_i(valid_i | abort_i | (busy_o & !waits) | rst_i), .clk_o(clk));

  // ---- Registers ----
  // Writes come one cycle late: the wires from the bus to the memories are long.
  card_pkg::access_t written_q;
  always_ff @(posedge clk_bus_i) begin
    written_q <= access_i;
    if (rst_i) written_q.write <= 0;
  end
  logic refit_write;  // a refit writes a node
  logic [PLACE-1:0] refit_read_at, refit_write_at;
  logic [NODE_WORDS-1:0][31:0] refitted;
  logic [6:0][31:0] root;
  logic [2:0][31:0] bases;  // words in DDR: objects of slots, slots, nodes
  events_t events, counted_q;
  logic [4:0] deepest, deepest_q;
  logic [35:0] fault_q;
  registers_pkg::node_flip_t flip;
  logic [19:0][31:0] flips;  // faults injected in the words of a node, and of a beat of slots
  always_comb begin
    flips = '0;
    for (int w = 0; w < 20; w++) if (int'(flip.word) == w) flips[w] = flip.bits;
  end
  logic unused_flip;
  assign unused_flip = &{1'b0, flip.reserved};
  bvh_registers #(.CONFIG(CONFIG)) registers (
      .clk_bus_i, .clk_i(clk), .rst_i, .access_i, .written_i(written_q), .rdata_o, .provided_good_o, .good_o,
      .busy_i(busy_o),
      .wide_i(PRIMARY > PLACE_WORDS && wide(int'(traversal_now))),
      .clear_i(valid_i && ready_o), .taken_i(taken), .provided_o(provided), .ray_count_o(ray_count), .nodes_o(nodes),
      .first_node_o(first_node), .slots_o(slots), .bases_o(bases), .root_o(root), .events_i(counted_q),
      .deepest_i(deepest_q), .fault_i(fault_q), .flip_o(flip),
      .new_root_i(refit_write && refit_write_at == '0), .node_i(refitted));

  // ---- Memories ----
  logic [UNITS-1:0][PLACE-1:0] node_at;
  logic [UNITS-1:0][NW-1:0] node_row;
  logic [UNITS-1:0][NODE_WORDS-1:0][31:0] node;
  logic [UNITS-1:0] node_second;
  logic node_access, clk_nodes;
  for (genvar u = 0; u < UNITS; u++) begin : unit
    assign node_row[u] = (refitting && u == 0) ? refit_read_at[NW-1:0] : node_at[u][NW-1:0];
  end
  assign node_access = written_q.write && written_q.space == registers_pkg::SPACE_NODES;
  clock_gate gate_nodes (.clk_i(clk_core_i), .enable_i(node_access | refitting | rst_i), .clk_o(clk_nodes));
  logic [UNITS-1:0][4:0] node_corrected;
  logic [UNITS-1:0] node_failed, node_read, node_read_q;
  logic [UNITS-1:0][NW-1:0] node_row_q;
  node_memory #(.NODES(NODES), .READERS(UNITS), .ECC(CONFIG.ecc), .HALVES(HALVES)) node_chips (
      .clk_write_i(clk_nodes), .write_i(node_access), .addr_i(written_q.addr), .data_i(written_q.data),
      .flip_i(flips[17:0]),
      .refit_i(refit_write), .refit_at_i(refit_write_at[NW-1:0]), .refit_node_i(refitted), .clk_i(clk),
      .at_i(node_row), .second_i(node_second), .node_o(node), .corrected_o(node_corrected), .failed_o(node_failed));

  // ---- Primaries ----
  logic ray_valid, ray_bad, ray_pop, ray_ready, bad_ready;
  logic [PRIMARY-1:0][31:0] ray;
  logic [31:0] ray_number;
  ray_queue #(.CONFIG(CONFIG)) rays (
      .clk_bus_i, .write_i(written_q.write && written_q.space == registers_pkg::SPACE_RAYS), .addr_i(written_q.addr),
      .data_i(written_q.data), .clk_i(clk), .rst_i(rst), .traversal_i(traversal_q), .provided_i(provided),
      .taken_o(taken), .valid_o(ray_valid), .ray_o(ray), .number_o(ray_number), .bad_o(ray_bad), .pop_i(ray_pop));
  // A bad primary leaves the queue one cycle after its record.
  logic bad_now, bad_gone_q;
  assign bad_now = ray_valid && ray_bad && !bad_gone_q;
  always_ff @(posedge clk) bad_gone_q <= bad_now && bad_ready && !rst;
  assign ray_pop = ray_valid && (ray_bad ? bad_gone_q : ray_ready);

  // ---- Traversal ----
  card_pkg::ddr_request_t [UNITS-1:0] node_ddr;
  logic [UNITS-1:0] node_ddr_ready, node_ddr_valid, node_outstanding;
  logic fetch_valid, fetch_ready, fetched_valid, one_valid, one_last, leaf_ready, hits_free;
  logic [PLACE-1:0] fetch_slot;
  logic [TAG-1:0] fetch_tag, fetched_tag;
  logic [1:0][LEAF-1:0][31:0] fetched;
  logic [1:0][BEAT-1:0][31:0] triangles;
  logic [1:0][31:0] index, hit_t, hit_index;
  logic [1:0] hit;
  logic [POINTS-1:0][1:0][31:0] hit_point;
  logic [31:0] hit_number, number, t, best_index;
  logic [POINTS-1:0][31:0] point;
  logic tested, record_valid, record_ready, found, f;
  logic [3:0] traversal_fault;
  logic [PLACE-1:0] traversal_place;
  logic [2:0] goal;
  assign goal = (mode_q == registers_pkg::MODE_OCCLUDED) ? GOAL_OCCLUDED : (mode_q == registers_pkg::MODE_HITS) ?
      GOAL_HITS : mode_q;
  traversal #(
      .CONTEXTS(CONTEXTS), .UNITS(UNITS), .CYCLES(CONFIG.node_cycles), .PINNED(NODES), .LINES(CONFIG.node_cache),
      .WAYS(CONFIG.node_ways), .HALVES(HALVES), .TRAVERSALS(TRAVERSALS), .SERIAL(CONFIG.shared_lane),
      .ALGORITHM(CONFIG.algorithm), .NORMALS(CONFIG.normals), .LAT(CONFIG.lat), .ARITH(config_pkg::arith(CONFIG.host))
  ) traversal (
      .clk_i(clk), .rst_i(rst), .nodes_i(nodes), .node_read_o(node_read), .node_at_o(node_at),
      .node_second_o(node_second), .node_i(node),
      .reset_i(rst_i), .node_base_i(bases[0]), .node_ddr_o(node_ddr), .node_ddr_ready_i(node_ddr_ready),
      .node_ddr_valid_i(node_ddr_valid), .ddr_data_i, .node_outstanding_o(node_outstanding),
      .root_i(root), .goal_i(goal), .traversal_i(traversal_q),
      .ahead_i(ray_count <= AHEAD),
      .ray_valid_i(ray_valid && !ray_bad), .ray_ready_o(ray_ready), .ray_i(ray), .number_i(ray_number),
      .fetch_valid_o(fetch_valid), .fetch_ready_i(fetch_ready), .fetch_slot_o(fetch_slot), .fetch_tag_o(fetch_tag),
      .fetched_valid_i((CONFIG.shared_lane != 0 ? one_valid : fetched_valid) && !refitting),
      .fetched_last_i(one_last), .fetched_tag_i(fetched_tag), .fetched_i(fetched), .index_i(index), .turn_i, .lane_o,
      .lane_i,
      .tested_o(tested), .hit_o(hit), .hit_number_o(hit_number), .hit_t_o(hit_t), .hit_point_o(hit_point),
      .hit_index_o(hit_index), .record_valid_o(record_valid), .record_ready_i(record_ready), .number_o(number),
      .found_o(found), .f_o(f), .t_o(t), .point_o(point), .index_o(best_index), .events_o(events), .deepest_o(deepest),
      .fault_o(traversal_fault), .fault_place_o(traversal_place));

  // ---- Secondaries ----
  logic leaf_fault, outstanding, leaves_outstanding;
  card_pkg::ddr_request_t slot_ddr;
  logic slot_ddr_ready, slot_ddr_valid;
  logic [3:0] leaf_fault_kind;
  logic [1:0] slot_corrected;
  logic [31:0] leaf_place;
  logic leaf_valid, refit_fetch;
  logic [PLACE-1:0] leaf_slot, refit_slot;
  logic [TAG-1:0] leaf_tag;
  logic [REFIT_TAG-1:0] refit_tag;
  pairs_pkg::words_t leaf_words_q;  // per secondary
  always_ff @(posedge clk)
    leaf_words_q <= pairs_pkg::WORDS_BITS'(pairs_pkg::shape_words(leaf_shape(int'(traversal_q))));
  assign fetch_ready = leaf_ready && hits_free && !refitting;
  assign leaf_valid = refitting ? refit_fetch : fetch_valid && hits_free;
  assign leaf_slot = refitting ? refit_slot : fetch_slot;
  assign leaf_tag = refitting ? TAG'(refit_tag) : fetch_tag;
  leaf_reader #(
      .SLOTS(SLOTS_PER_NODE * NODES), .WORDS(LEAF), .TAG(TAG), .ECC(CONFIG.ecc), .OBJECTS(OBJECTS),
      .EXTERNAL(32'(CACHED)),
      .ARITH(config_pkg::arith(CONFIG.host)), .T_TRANSFORM(T_TRANSFORM)
  ) leaves (
      .clk_bus_i, .write_i(written_q.write && written_q.space == registers_pkg::SPACE_SLOTS), .addr_i(written_q.addr),
      .data_i(written_q.data), .flip_i(flips[19:18]), .clk_i(clk), .rst_i, .clear_i(rst && !refitting),
      .slots_i(slots), .slot_base_i(bases[2:1]), .secondaries_i(secondaries_q),
      .words_i(leaf_words_q),
      .objects_i(objects_q), .valid_i(leaf_valid), .ready_o(leaf_ready), .slot_i(leaf_slot), .tag_i(leaf_tag),
      .ddr_o(ddr_o[0]), .ddr_ready_i(ddr_ready_i[0]), .ddr_valid_i(ddr_valid_i[0]), .ddr_data_i,
      .ddr_words_o(ddr_words_o[0]), .slot_ddr_o(slot_ddr), .slot_ddr_ready_i(slot_ddr_ready),
      .slot_ddr_valid_i(slot_ddr_valid), .outstanding_o(leaves_outstanding), .transform_entry_o, .moving_o,
      .clk_moving_i, .unmoved_o, .moved_i, .valid_o(fetched_valid), .tag_o(fetched_tag),
      .one_valid_o(one_valid), .one_last_o(one_last),
      .words_o(fetched), .index_o(index), .fault_o(leaf_fault), .fault_kind_o(leaf_fault_kind),
      .fault_place_o(leaf_place), .corrected_o(slot_corrected));

  assign outstanding = leaves_outstanding || node_outstanding != 0;
  if (CACHED) begin : g_readers
    assign ddr_o[READERS-1:1] = {node_ddr, slot_ddr};
    assign {node_ddr_ready, slot_ddr_ready} = ddr_ready_i[READERS-1:1];
    assign {node_ddr_valid, slot_ddr_valid} = ddr_valid_i[READERS-1:1];
    assign ddr_words_o[READERS-1:1] = {{UNITS{4'(BEAT)}}, 4'd2};
  end else begin : g_on_chip
    assign {node_ddr_ready, slot_ddr_ready, node_ddr_valid, slot_ddr_valid} = '0;
    logic unused_ddr;
    assign unused_ddr = &{1'b0, node_ddr, slot_ddr, bases};
  end

  // ---- Refit. The card cannot refit nodes in DDR ----
  logic clk_refit, refit_comes, refit_start_q, refit_rst, refit_busy, refit_read, refit_writes, refit_done, refit_bad;
  logic [PLACE-1:0] refit_bad_slot;
  assign refit_rst = rst_i || !refitting;
  assign refit_write = refit_writes && refitting;  // an aborted refit stops in any state, so its outputs are masked
  assign triangles = {fetched[1][BEAT-1:0], fetched[0][BEAT-1:0]};
  if (CACHED) begin : g_no_refit
    assign {clk_refit, refit_comes, refit_busy, refit_read, refit_writes, refit_done, refit_bad, refit_fetch} = '0;
    assign {refit_bad_slot, refit_read_at, refit_write_at, refitted, refit_slot, refit_tag} = '0;
    logic unused_triangles;
    assign unused_triangles = &{1'b0, triangles, clk_refit, refit_start_q, fetched_tag};
  end else begin : g_refit
    assign refit_comes = state_q == IDLE && valid_i && pass_i.mode == registers_pkg::MODE_REFIT;
    clock_gate gate_refit (.clk_i(clk_core_i), .enable_i(refit_comes | refitting | rst_i), .clk_o(clk_refit));
    refit #(.CONTEXTS(REFIT_CONTEXTS)) boxes (
        .clk_i(clk_refit), .rst_i(refit_rst), .start_i(refit_start_q), .first_node_i(first_node[PLACE-1:0]),
        .node_count_i(nodes[PLACE-1:0]), .busy_o(refit_busy), .done_o(refit_done), .bad_o(refit_bad),
        .bad_slot_o(refit_bad_slot), .read_o(refit_read), .read_at_o(refit_read_at), .node_i(node[0]),
        .write_o(refit_writes), .write_at_o(refit_write_at), .node_o(refitted), .fetch_valid_o(refit_fetch),
        .fetch_ready_i(leaf_ready && refitting), .fetch_slot_o(refit_slot), .fetch_tag_o(refit_tag),
        .fetched_valid_i(fetched_valid && refitting), .fetched_tag_i(fetched_tag[REFIT_TAG-1:0]),
        .fetched_i(triangles));
`ifndef SYNTHESIS
    always_ff @(posedge clk_refit)
      if (!refit_rst) assert (!(refit_write && refit_read && refit_read_at == refit_write_at)) else
          $error("bvh_unit: a node is read and written at once");
`endif
  end
  logic unused;
  assign unused = &{1'b0, refit_busy, refit_read_at, first_node};

  // ---- Records ----
  bvh_records #(.CONFIG(CONFIG)) records (
      .clk_i(clk), .rst_i(rst || abort_i), .mode_i(mode_q), .normals_i(normals_q), .hits_free_o(hits_free),
      .leaf_i(fetch_valid && fetch_ready), .leaf_tested_i(tested), .hit_i(hit), .hit_number_i(hit_number),
      .hit_t_i(hit_t), .hit_point_i(hit_point), .hit_index_i(hit_index), .valid_i(record_valid), .ready_o(record_ready),
      .number_i(number), .found_i(found), .f_i(f), .t_i(t), .point_i(point), .index_i(best_index),
      .bad_valid_i(bad_now), .bad_ready_o(bad_ready), .bad_number_i(ray_number), .sram_full_i,
      .sram_nearly_full_i, .write_o, .record_o, .finished_o(finished), .empty_o(records_empty));

  // ---- Invalid BVHs. In a valid BVH, a primary finishes before it has read every node once. A refit writes
  // a node in less than a million cycles ----
  localparam int PATIENCE = 20;
  logic [31+CX:0] idle_reads_q;
  logic [PATIENCE:0] idle_cycles_q;
  logic endless, finished_all;
  assign endless = refitting ? idle_cycles_q[PATIENCE] : idle_reads_q > {nodes, CX'(0)};
  // Bit errors in the nodes that are read.
  logic bits_failed;
  logic [NW-1:0] failed_row;
  always_comb begin
    corrected_o = 8'($countones(slot_corrected));
    bits_failed = 1'b0;
    failed_row = '0;
    for (int u = 0; u < UNITS; u++)
      if (node_read_q[u]) begin
        corrected_o = corrected_o + 8'(node_corrected[u]);
        if (node_failed[u]) {bits_failed, failed_row} = {1'b1, node_row_q[u]};
      end
  end
  always_ff @(posedge clk) begin
    node_read_q <= !running ? '0 : refitting ? UNITS'(refit_read) : node_read;
    node_row_q <= node_row;
  end
  assign wrong = bits_failed || (traversal_fault != 0 && !refitting) || leaf_fault || endless;
  assign finished_all = refitting ? refit_done : running && finished_q == ray_count && records_empty;
  assign done_o = finished_all || (state_q == FLUSH && !outstanding && fault_q != 0);
  assign fault_o = fault_q != 0;
  // The reset of the traversal has a register of its own: its wires are long.
  state_t state;
  always_comb begin
    state = state_q;
    case (state_q)
      IDLE: if (valid_i) state = RUN;
      RUN: if (wrong) state = FLUSH; else if (finished_all) state = IDLE;
      default: if (!outstanding) state = IDLE;
    endcase
    if (abort_i && busy_o) state = FLUSH;
    if (rst_i) state = IDLE;
  end
  always_ff @(posedge clk) begin
    idle_reads_q <= (finished || rst) ? '0 : idle_reads_q + (32 + CX)'(events.nodes);
    counted_q <= running ? events : '0;
    // `finished` comes late, so it selects and is not added.
    if (rst) finished_q <= '0;
    else if (finished) finished_q <= finished_q + 1;
    if (running && !refitting) deepest_q <= deepest;
    idle_cycles_q <= (refit_write || refit_rst) ? '0 : idle_cycles_q + 1;
    refit_start_q <= refit_comes && !rst_i;
    state_q <= state;
    rst_q <= state != RUN || (!CACHED && (valid_i && ready_o ? pass_i.mode : mode_q) == registers_pkg::MODE_REFIT);
    case (state_q)
      IDLE:
        if (valid_i) begin
          mode_q <= pass_i.mode;
          traversal_q <= traversal_now;
          normals_q <= pass_i.normals;
          secondaries_q <= pass_i.count;
          objects_q <= pass_i.objects;
          fault_q <= '0;
        end
      RUN:
        if (wrong) begin
          fault_q <= bits_failed ? {registers_pkg::NODE_FAULT_NODE_BITS, 32'(failed_row)} :
              (traversal_fault != 0 && !refitting) ? {traversal_fault, 32'(traversal_place)} :
              leaf_fault ? {leaf_fault_kind, leaf_place} : {registers_pkg::NODE_FAULT_ENDLESS, 32'(node_row_q[0])};
        end else if (finished_all) begin
          if (refitting && refit_bad) fault_q <= {registers_pkg::NODE_FAULT_SECONDARY, 32'(refit_bad_slot)};
        end
      default: ;
    endcase
    if (abort_i && busy_o) fault_q <= '0;
    if (rst_i) {fault_q, deepest_q} <= '0;
  end
endmodule
