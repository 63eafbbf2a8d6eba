// SPDX-License-Identifier: Apache-2.0
// Traversal of a BVH by rays and solids. Each primary has a context with one operation under way. It reads a node and
// tests its boxes, fetches and tests the secondaries of a leaf, or chooses the next visit from its stack.
// Units wait only for leaves that memory does not deliver. Contexts wait in queues that hold all of them, so no queue
// overflows and no deadlock is possible. In a pass of few primaries, pipes are mostly empty, so contexts do not wait
// for their leaves. They go on with the current best result, and end when all leaves have been tested (ahead_i).
//
//   rays -> ray_front -> UNITS x traversal_bank -> leaves -> fetch -> pair pipe -> better of (T, index) -+
//                            |  ^                                                                        |
//               records <----+  +------------------------------------------------------------------------+
//
// A new primary needs a free context (ray_ready_o). A fetched leaf returns with the tag of its request.
// Latency: depends on the nodes and leaves visited.
// Throughput: UNITS / CYCLES nodes, one leaf, one primary and one record per cycle.
// Stall: ray_ready_o, fetch_ready_i, record_ready_i.
`include "bvh.svh"
module traversal #(
    parameter int CONTEXTS = 256,  // powers of two
    parameter int UNITS = 2,       // traversal units, each with its share of the contexts
    parameter int CYCLES = 1,      // per node of a unit: 1, 2 or 4
    parameter int PINNED = 4096,   // nodes on chip, if LINES is not 0 (node_reader.sv)
    parameter bit HALVES = 0,      // node_reader.sv
    parameter int LINES = 0,       // of each unit's cache
    parameter int WAYS = 4,
    parameter bvh_pkg::traversals_t TRAVERSALS = 1,  // bvh_pkg::card_traversals
    // 0, or cycles per secondary of one lane (CONFIG's SHARED_LANE). With gates the lane is outside.
    parameter int SERIAL = 0,
    parameter int ALGORITHM = 0,   // ray-triangle: pairs_pkg::ALGORITHM_*
    parameter int NORMALS = 0,     // 1: solids have normals
    parameter latency_pkg::latency_t LAT = latency_pkg::ONES,
    parameter ARITH = "rtl",
    localparam int LANES = 2,  // secondaries of a leaf
    localparam int RESULTS = (SERIAL != 0) ? 1 : LANES,  // at a time
    localparam int WORDS = bvh_pkg::traverser_words(TRAVERSALS),
    localparam int LEAF = bvh_pkg::leaf_words(TRAVERSALS),
    localparam int POINTS = (NORMALS != 0) ? 6 : 3,  // words of CP and n
    localparam int CX = $clog2(CONTEXTS),
    localparam int TAG = `AT_BITS(CX) + 1
) (
    input logic clk_i,
    input logic rst_i,
    // Node memory, one port per unit; a read returns one cycle later.
    input logic [31:0] nodes_i,  // number of nodes
    output logic [UNITS-1:0] node_read_o,
    output logic [UNITS-1:0][bvh_pkg::PLACE-1:0] node_at_o,
    output logic [UNITS-1:0] node_second_o,  // with HALVES: the second half
    input logic [UNITS-1:0][bvh_pkg::NODE_WORDS-1:0][31:0] node_i,
    // Nodes in DDR, with LINES.
    input logic reset_i,  // of the card; rst_i also ends a pass
    input logic [31:0] node_base_i,  // word of node 0
    output card_pkg::ddr_request_t [UNITS-1:0] node_ddr_o,
    input logic [UNITS-1:0] node_ddr_ready_i,
    input logic [UNITS-1:0] node_ddr_valid_i,
    input logic [records_pkg::DDR_WORDS-1:0][31:0] ddr_data_i,
    output logic [UNITS-1:0] node_outstanding_o,
    // Settings of all primaries.
    input logic [6:0][31:0] root_i,  // root's box: lower corner x y z, upper corner x y z, 16 u W (ray_front.sv)
    input logic [2:0] goal_i,        // bvh_pkg::GOAL_*
    input logic [bvh_pkg::TRAVERSAL_BITS-1:0] traversal_i,
    input logic ahead_i,
    // Primaries and their numbers: rays (o x y z, d x y z, tmin, tmax) or solids.
    input logic ray_valid_i,
    output logic ray_ready_o,
    input logic [WORDS-1:0][31:0] ray_i,
    input logic [31:0] number_i,
    // Secondaries of leaves, one or two from a slot on, and their indices. The input fetched_valid_i must come from a
    // register, because it drives the enable of a clock gate.
    output logic fetch_valid_o,
    input logic fetch_ready_i,
    output logic [bvh_pkg::PLACE-1:0] fetch_slot_o,
    output logic [TAG-1:0] fetch_tag_o,  // its lowest bit: two secondaries
    // With SERIAL it comes with each secondary, in fetched_i[1] and index_i[1].
    input logic fetched_valid_i,
    input logic fetched_last_i,  // with SERIAL: the leaf's last secondary
    input logic [TAG-1:0] fetched_tag_i,
    input logic [LANES-1:0][LEAF-1:0][31:0] fetched_i,
    input logic [LANES-1:0][31:0] index_i,
    // The lane outside, and the turn in which it is.
    input logic [2:0] turn_i,
    output card_pkg::lane_operands_t lane_o,
    input card_pkg::lane_results_t lane_i,
    // Hits of goal hits, as they are found. Never back-pressured: fetch_ready_i reserves space for the hits of every
    // outstanding leaf request.
    output logic tested_o,  // a leaf has been tested
    output logic [LANES-1:0] hit_o,  // hits of a leaf, with SERIAL of a secondary in [0]
    output logic [31:0] hit_number_o,
    output logic [LANES-1:0][31:0] hit_t_o,
    output logic [POINTS-1:0][LANES-1:0][31:0] hit_point_o,
    output logic [LANES-1:0][31:0] hit_index_o,
    // Records, one per primary, after its hits. With goal hits they only mark the end.
    output logic record_valid_o,
    input logic record_ready_i,
    output logic [31:0] number_o,
    output logic found_o,  // the record names a pair; f_o: the pair is a hit
    output logic f_o,
    output logic [31:0] t_o,
    output logic [POINTS-1:0][31:0] point_o,
    output logic [31:0] index_o,
    output bvh_pkg::events_t events_o,
    output logic [4:0] deepest_o,  // deepest stack since reset, in groups
    output logic [3:0] fault_o,    // registers_pkg::NODE_FAULT_*; a fault ends the pass
    output logic [bvh_pkg::PLACE-1:0] fault_place_o
);
  import bvh_pkg::*;
  if (CONTEXTS < 2 * UNITS || (CONTEXTS & (CONTEXTS - 1)) != 0) $error("traversal: CONTEXTS must be a power of two");
  if ((UNITS & (UNITS - 1)) != 0) $error("traversal: UNITS must be a power of two");
  `BVH_TYPES(CX)
  localparam bit HAS_RAYS = has_rays(TRAVERSALS);
  localparam bit SOLIDS = has_solids(TRAVERSALS);
  localparam bit ONE = (TRAVERSALS & (TRAVERSALS - 1)) == 0;  // one kind of traversal: there is nothing to choose
  localparam logic [31:0] SIGN = 32'h8000_0000, INFINITE = 32'h7f80_0000;
  logic is_solid;  // the pass's primaries are solids: T is a signed distance until the record
  assign is_solid = !HAS_RAYS || (SOLIDS && solid(int'(traversal_i)));
  localparam int BANK = $clog2(UNITS);
  // The bank of a context.
  `define CDE_OWN(CONTEXT) (CONTEXT % CX'(UNITS) == CX'(u))

  // ---- State per primary ----
  typedef struct packed {
    logic f;
    logic [31:0] t;
    logic [POINTS-1:0][31:0] point;
    logic [31:0] index;
  } best_t;
  // A context gets a primary after its last result has been read. A word of `bests` that is written is not used in the
  // same cycle (again_late_q).
  (* no_rw_check *) logic [WORDS-1:0][31:0] rays[CONTEXTS];
  (* no_rw_check *) logic [31:0] numbers[CONTEXTS];
  (* no_rw_check *) best_t bests[CONTEXTS];

  // ---- Ray input ----
  logic [CX:0] fresh_q;  // contexts that never had a primary
  logic free_again;
  logic [CX-1:0] free, taken;
  logic free_some, free_next, some_q;  // a register keeps the next free context
  logic take, front_ready, keep_valid, keep_last, better_valid, better_last, record_read;
  logic [CX-1:0] done;  // of the record
  sync_fifo #(.W(CX), .DEPTH(CONTEXTS)) queue_free (
      .clk_i, .rst_i, .write_i(record_read), .wdata_i(done), .free_o(), .count_o(), .some_o(free_again), .rdata_o(free),
      .read_i(free_next && fresh_q[CX]));
  assign free_some = !fresh_q[CX] || free_again;
  assign free_next = free_some && (!some_q || take);
  assign ray_ready_o = some_q && !better_valid && front_ready;
  assign take = ray_valid_i && ray_ready_o;
  always_ff @(posedge clk_i) begin
    if (free_next) begin
      taken <= fresh_q[CX] ? free : fresh_q[CX-1:0];
      if (!fresh_q[CX]) fresh_q <= fresh_q + 1;
    end
    some_q <= !rst_i && (free_some || (some_q && !take));
    if (rst_i) fresh_q <= '0;
    if (take) begin
      rays[taken] <= ray_i;
      numbers[taken] <= number_i;
    end
  end
  // The secondaries that a kind of ray front is for.
  function automatic int front_leaf(input int kind);
    front_leaf = (kind == FRONT_RAY_SPHERE) ? pairs_pkg::SHAPE_SPHERE : pairs_pkg::SHAPE_TRIANGLE;
  endfunction
  function automatic bit ray_front_kind(input int kind);
    ray_front_kind = kind == FRONT_RAY_SPHERE || kind == pairs_pkg::SHAPE_RAY;
  endfunction
  // With more cycles per node than one, rays that meet triangles share the operators of ray_front_shared.sv.
  function automatic bit shares_front(input int kind);
    shares_front = CYCLES != 1 && kind == pairs_pkg::SHAPE_RAY;
  endfunction
  function automatic int t_front_of(input int kind);
    t_front_of = shares_front(kind) ? `FRONT_T_SHARED :
        ray_front_kind(kind) ? `RAY_T_FRONT(front_leaf(kind)) : `SOLID_T_FRONT(kind);
  endfunction
  function automatic int slowest_front();
    slowest_front = 0;
    for (int k = 0; k < FRONTS; k++)
      if (has_front(TRAVERSALS, k) && t_front_of(k) > slowest_front) slowest_front = t_front_of(k);
  endfunction
  localparam int T_FRONT = slowest_front();
  logic [FRONTS-1:0][8:0][31:0] fronts;
  logic [8:0][31:0] front;
  logic front_valid;
  logic [CX-1:0] front_context;
  logic [$clog2(FRONTS)-1:0] kind;
  assign kind = ($clog2(FRONTS))'(front_kind(int'(traversal_i)));
  // A shared front starts in phase 0. One ray waits for it.
  logic [$clog2(`FRONT_CYCLES)-1:0] phase_q;
  logic shared, start, waits_q;
  logic [CX-1:0] starting, waiting_q;
  assign shared = shares_front(ONE ? front_kind($clog2(TRAVERSALS)) : int'(kind));
  assign front_ready = !shared || !waits_q;
  assign start = shared ? phase_q == '0 && waits_q : take;
  assign starting = shared ? waiting_q : taken;
  always_ff @(posedge clk_i) begin
    phase_q <= rst_i ? '0 : phase_q + 1'b1;
    waits_q <= !rst_i && shared && (take || (waits_q && !start));
    if (take) waiting_q <= taken;
  end
  for (genvar k = 0; k < FRONTS; k++) begin : front_of
    if (has_front(TRAVERSALS, k)) begin : g_present
      localparam int F_WORDS = ray_front_kind(k) ? 6 : pairs_pkg::shape_words(k);
      localparam int T_OWN = t_front_of(k);
      // The host back end computes in the second cycle. It has its own clock, so without a primary it computes nothing.
      localparam int T_NOW = (ARITH == "rtl") ? T_OWN : 1;
      logic [F_WORDS+6:0][31:0] words;  // the primary's words, and the root's box
      logic [8:0][31:0] now;
      if (ARITH == "rtl") begin : g_at_once
        assign words = {root_i, ray_i[F_WORDS-1:0]};
      end else begin : g_next_clock
        logic clk;
        clock_gate gate (.clk_i, .enable_i(take && (ONE || int'(kind) == k)), .clk_o(clk));
        always_ff @(posedge clk) words <= {root_i, ray_i[F_WORDS-1:0]};
      end
      if (shares_front(k) && ARITH == "rtl") begin : g_shared
        logic leaves;
        pipe_delay_valid #(.TO(T_OWN)) delay_leaves (.clk_i, .rst_i, .valid_i(start), .valid_o(leaves));
        ray_front_shared #(.LAT(LAT)) of_ray (
            .clk_i, .rst_i, .phase_i(phase_q), .enter_i(take), .leave_i(leaves), .ray_i(words[5:0]),
            .root_i(words[12:6]), .r_o(now));
      end else if (ray_front_kind(k)) begin : g_ray
        ray_front #(
            .LEAF(front_leaf(k)), .LANES(1), .LAT(LAT), .ARITH(ARITH)
        ) of_ray (
            .clk_i, .a_i(words[5:0]), .root_i(words[12:6]), .r_o(now));
      end else begin : g_solid
        solid_front #(
            .SHAPE(k), .LANES(1), .LAT(LAT), .ARITH(ARITH)
        ) of_solid (
            .clk_i, .a_i(words[F_WORDS-1:0]), .root_i(words[F_WORDS+:7]), .r_o(now[5:0]));
        assign now[8:6] = '0;
      end
      pipe_delay #(.W(9 * 32), .FROM(T_NOW), .TO(T_FRONT), .MEMORY(5)) delay_front (.clk_i, .d_i(now), .q_o(fronts[k]));
    end else begin : g_absent
      assign fronts[k] = '0;
    end
  end
  assign front = ONE ? fronts[front_kind($clog2(TRAVERSALS))] : fronts[kind];
  pipe_delay #(.W(CX), .TO(T_FRONT)) delay_taken (.clk_i, .d_i(starting), .q_o(front_context));
  pipe_delay_valid #(.TO(T_FRONT)) delay_take (.clk_i, .rst_i, .valid_i(start), .valid_o(front_valid));

  // ---- Banks ----
  logic [UNITS-1:0] leaf_valid, leaf_ready, done_valid, done_ready, reads, cached, fetched;
  visit_t [UNITS-1:0] leaf;
  logic [UNITS-1:0][CX-1:0] dones;
  logic [UNITS-1:0][4:0] levels;
  logic [UNITS-1:0][3:0] faults;
  logic [UNITS-1:0][PLACE-1:0] fault_places;
  at_t keep_at, tested;
  logic [1:0] interval_write;
  logic [1:0][31:0] interval;
  logic [CX-1:0] interval_context;
  logic farthest_q;
  always_ff @(posedge clk_i) farthest_q <= goal_i == GOAL_FARTHEST;
  for (genvar u = 0; u < UNITS; u++) begin : unit
    traversal_bank #(
        .CONTEXTS(CONTEXTS / UNITS), .CX(CX), .LAT(LAT),
        .ARITH(ARITH), .RAYS(32'(HAS_RAYS)), .SOLIDS(32'(SOLIDS)), .CYCLES(CYCLES),
        .PINNED(PINNED), .LINES(LINES), .WAYS(WAYS), .HALVES(HALVES)
    ) bank (
        .clk_i, .rst_i, .nodes_i, .node_read_o(node_read_o[u]), .node_at_o(node_at_o[u]),
        .node_second_o(node_second_o[u]), .node_i(node_i[u]),
        .node_base_i, .reset_i, .ddr_o(node_ddr_o[u]), .ddr_ready_i(node_ddr_ready_i[u]),
        .ddr_valid_i(node_ddr_valid_i[u]), .ddr_data_i, .outstanding_o(node_outstanding_o[u]), .cached_o(cached[u]),
        .fetched_o(fetched[u]),
        .farthest_i(farthest_q), .solid_i(is_solid), .ahead_i,
        .new_i(take && `CDE_OWN(interval_context)),
        .interval_write_i(`CDE_OWN(interval_context) ? interval_write : '0),
        .interval_context_i(interval_context[CX-1:BANK]),
        .interval_i(interval), .front_valid_i(front_valid && `CDE_OWN(front_context)),
        .front_context_i(front_context), .front_i(front), .leaf_valid_o(leaf_valid[u]),
        .leaf_ready_i(leaf_ready[u]), .leaf_o(leaf[u]),
        .tested_valid_i(better_valid && better_last && `CDE_OWN(tested.context_)),
        .tested_i(tested), .done_valid_o(done_valid[u]), .done_ready_i(done_ready[u]), .done_o(dones[u]),
        .visits_o(reads[u]), .level_o(levels[u]), .fault_o(faults[u]), .fault_place_o(fault_places[u]));
  end
  // Round-robin arbiter of the banks.
  logic leaf_room;  // for the secondaries of a leaf
  logic done_move;  // a finished primary goes to the record
  logic [UNITS-1:0] leaf_grant, done_grant;
  rr_arbiter #(.N(UNITS)) leaf_arbiter (
      .clk_i, .rst_i, .request_i(leaf_valid), .taken_i(fetch_ready_i && leaf_room), .grant_o(leaf_grant));
  rr_arbiter #(.N(UNITS)) done_arbiter (
      .clk_i, .rst_i, .request_i(done_valid), .taken_i(done_move), .grant_o(done_grant));

  // ---- Leaves ----
  visit_t leaves;
  always_comb begin
    leaves = '0;
    for (int u = 0; u < UNITS; u++) if (leaf_grant[u]) leaves = leaf[u];
  end
  assign fetch_valid_o = leaf_valid != '0 && leaf_room;
  assign fetch_slot_o = leaves.place;
  assign fetch_tag_o = {leaves.at, leaves.two};
  assign leaf_ready = leaf_grant & {UNITS{fetch_ready_i && leaf_room}};
  logic [1:0] tested_now;
  logic [RESULTS-1:0] f, present;
  logic [RESULTS-1:0][31:0] t, key, index;
  logic [POINTS-1:0][RESULTS-1:0][31:0] point;
  at_t keep_at_next;
  logic unused_next;
  assign unused_next = &{1'b0, keep_at_next.level, keep_at_next.fresh};
  logic serial_valid, serial_last;
  logic [TAG-1:0] serial_tag;
  logic [LANES-1:0][LEAF-1:0][31:0] serial;
  logic [LANES-1:0][31:0] serial_index;
  if (SERIAL != 0) begin : g_serial
    leaf_queue #(.WORDS(LEAF), .TAG(TAG), .TURNS(SERIAL), .DEPTH(SERIAL == 8 ? 16 : 64)) one_by_one (
        .clk_i, .rst_i, .turn_i, .room_o(leaf_room), .leaf_i(fetch_valid_o && fetch_ready_i), .two_i(fetch_tag_o[0]),
        .valid_i(fetched_valid_i), .last_i(fetched_last_i), .tag_i(fetched_tag_i), .words_i(fetched_i[1]),
        .index_i(index_i[1]), .valid_o(serial_valid), .last_o(serial_last), .tag_o(serial_tag), .words_o(serial[0]),
        .index_o(serial_index[0]));
    assign {serial[1], serial_index[1]} = '0;
    logic unused_first;
    assign unused_first = &{1'b0, fetched_i[0], index_i[0]};
  end else begin : g_at_once
    assign leaf_room = 1'b1;
    assign {serial_valid, serial_last, serial_tag} = {fetched_valid_i, 1'b1, fetched_tag_i};
    assign {serial, serial_index} = {fetched_i, index_i};
    logic unused_last;
    assign unused_last = &{1'b0, fetched_last_i, turn_i};
  end
  leaf_pairs #(
      .TRAVERSALS(TRAVERSALS), .SERIAL(SERIAL), .ALGORITHM(ALGORITHM), .NORMALS(NORMALS), .AT($bits(at_t)), .LAT(LAT),
      .ARITH(ARITH)
  ) pairs (
      .clk_i, .rst_i, .traversal_i, .valid_i(serial_valid), .last_i(serial_last), .at_i(serial_tag[TAG-1:1]),
      .two_i(serial_tag[0]), .primary_i(rays[serial_tag[TAG-1-:CX]]), .secondaries_i(serial), .index_i(serial_index),
      .lane_o, .lane_i, .tested_o(tested_now),
      .next_o(keep_at_next), .valid_o(keep_valid), .last_o(keep_last), .at_o(keep_at), .f_o(f), .present_o(present),
      .t_o(t), .key_o(key), .point_o(point), .index_o(index));

  // ---- The better of the best result so far and the new ones ----
  // The first step chooses among the results of a leaf that come together. One cycle later, the second step compares
  // with the best so far.
  best_t best_q, best;
  logic by_index_q;
  always_ff @(posedge clk_i) by_index_q <= goal_i == GOAL_ANY || goal_i == GOAL_OCCLUDED;
  // Two zeros are equal: a solid's distance may be either. The comparisons have few levels of logic.
  function automatic logic better(input logic [31:0] t_1, input logic [31:0] index_1, input logic [31:0] t_2,
                                  input logic [31:0] index_2);
    logic same, greater, farther;
    same = t_1[30:0] == t_2[30:0];
    greater = t_1[30:0] > t_2[30:0];
    farther = (t_1[31] != t_2[31]) ? t_2[31] : t_1[31] ? !greater : greater;
    if (t_1[31] != t_2[31]) same = t_1[30:0] == 0 && t_2[30:0] == 0;
    better = (by_index_q || same) ? index_1 < index_2 : farthest_q == farther;
  endfunction
  // For solids, the least distance counts, whether they meet or not.
  logic [RESULTS-1:0] counts;
  assign counts = (is_solid && goal_i == GOAL_NEAREST) ? present : f;
  logic chosen;
  best_t one, one_q;
  logic [31:0] best_key;  // of the chosen one
  at_t better_at;
  logic improved;
  always_comb begin
    chosen = '0;
    for (int l = 1; l < RESULTS; l++)
      chosen = counts[l] && (!counts[0] || better(t[l], index[l], t[0], index[0]));
    one = '{f: counts[chosen] && goal_i != GOAL_HITS, t: t[chosen], point: '0, index: index[chosen]};
    for (int k = 0; k < POINTS; k++) one.point[k] = point[k][chosen];
  end
  logic now_valid, now_last, improved_now;
  at_t now_at;
  best_t one_then, best_then;
  logic [31:0] now_key;
  assign improved_now = one_q.f && (!best_q.f || better(one_q.t, one_q.index, best_q.t, best_q.index));
  // With eight turns, the result of the comparison is used one cycle later.
  localparam int JUDGED = (SERIAL == 8) ? 1 : 0;
  if (JUDGED == 0) begin : g_at_once_better
    assign better_valid = now_valid;
  end else begin : g_late_better
    always_ff @(posedge clk_i) better_valid <= now_valid && !rst_i;
  end
  pipe_delay #(.W(2 + $bits(at_t) + 32 + 2 * $bits(best_t)), .TO(JUDGED)) delay_best (
      .clk_i, .d_i({improved_now, now_last, now_at, now_key, one_q, best_q}),
      .q_o({improved, better_last, better_at, best_key, one_then, best_then}));
  assign best = improved ? one_then : best_then;
  // If a context runs ahead of its leaves, its leaves can follow each other directly, or with one cycle between. The
  // results of a lane with turns do not.
  localparam bit CLOSE = SERIAL < 4;
  logic again_q, again_late_q;  // the leaf is of the context of the leaf before, and of the second leaf before
  best_t read_q, read_late_q, kept_q;
  always_ff @(posedge clk_i) begin
    read_q <= bests[keep_at_next.context_];
    again_late_q <= CLOSE && now_valid && now_at.context_ == keep_at_next.context_;
    read_late_q <= again_late_q ? kept_q : read_q;
    again_q <= CLOSE && now_valid && now_at.context_ == keep_at.context_;
    kept_q <= best;
    now_valid <= keep_valid && !rst_i;
    {now_last, now_at, now_key, one_q} <= {keep_last, keep_at, key[chosen], one};
  end
  assign best_q = again_q ? kept_q : read_late_q;
  always_ff @(posedge clk_i) hit_number_o <= numbers[keep_at_next.context_];
  assign tested_o = keep_valid && keep_last;
  for (genvar l = 0; l < LANES; l++) begin : hit
    localparam int R = (l < RESULTS) ? l : 0;
    assign hit_o[l] = l < RESULTS && keep_valid && goal_i == GOAL_HITS && counts[R];
    assign hit_t_o[l] = is_solid ? t[R] & ~SIGN : t[R];
    assign hit_index_o[l] = index[R];
    for (genvar k = 0; k < POINTS; k++) begin : word
      assign hit_point_o[k][l] = point[k][R];
    end
  end
  // A hit shrinks the T interval, and an occlusion query stops at its first hit. For solids, the interval is of keys up
  // to the key of the best distance (node_distances.sv), without a lower bound.
  always_comb begin
    interval_write = {2{take}};
    interval_context = taken;
    interval = !is_solid ? ray_i[7:6] : {(goal_i == GOAL_NEAREST) ? INFINITE : 32'd0, INFINITE | SIGN};
    tested = better_at;
    if (better_valid) begin
      interval_write = {improved && (goal_i == GOAL_NEAREST || goal_i == GOAL_OCCLUDED),
                        improved && goal_i == GOAL_FARTHEST};
      interval_context = better_at.context_;
      interval = {is_solid ? best_key : best.t, best.t};
      if (best.f && goal_i == GOAL_OCCLUDED) begin
        tested.level = '0;
        interval[1] = INFINITE | SIGN;
      end
    end
  end
  always_ff @(posedge clk_i) if (better_valid || take) bests[interval_context] <= better_valid ? best : '0;

  // ---- Records ----
  logic [CX-1:0] done_next;
  best_t answer;
  always_comb begin
    done_next = '0;
    for (int u = 0; u < UNITS; u++) if (done_grant[u]) done_next = dones[u];
  end
  assign done_move = !record_valid_o || record_ready_i;
  assign done_ready = done_grant & {UNITS{done_move}};
  assign record_read = record_valid_o && record_ready_i;
  always_ff @(posedge clk_i) begin
    if (done_move) begin
      record_valid_o <= done_valid != '0;
      {done, number_o, answer} <= {done_next, numbers[done_next], bests[done_next]};
    end
    if (rst_i) record_valid_o <= 1'b0;
  end
  assign found_o = answer.f;
  assign f_o = answer.f && (!is_solid || goal_i != GOAL_NEAREST || answer.t[31]);
  assign t_o = is_solid ? answer.t & ~SIGN : answer.t;
  assign {point_o, index_o} = {answer.point, answer.index};
  `undef CDE_OWN

  // ---- Counters and faults ----
  assign events_o.nodes = 4'($countones(reads));
  assign events_o.leaves = 4'(fetch_valid_o && fetch_ready_i);
  assign events_o.secondaries = 4'(tested_now);
  always_comb begin
    {events_o.cached, events_o.fetched} = '0;
    for (int u = 0; u < UNITS; u++) begin
      events_o.cached = events_o.cached + 4'(cached[u]);
      events_o.fetched = events_o.fetched + 4'(fetched[u]);
    end
  end
  logic [4:0] deepest;
  always_comb begin
    deepest = deepest_o;
    {fault_o, fault_place_o} = '0;
    for (int u = 0; u < UNITS; u++) begin
      if (levels[u] > deepest) deepest = levels[u];
      if (fault_o == 0) {fault_o, fault_place_o} = {faults[u], fault_places[u]};
    end
  end
  always_ff @(posedge clk_i) deepest_o <= rst_i ? '0 : deepest;
`ifndef SYNTHESIS
  always_ff @(posedge clk_i)
    if (!rst_i) assert (!(take && serial_valid && serial_tag[TAG-1-:CX] == taken)) else
        $error("traversal: a ray is read and written at once");
`endif
endmodule
