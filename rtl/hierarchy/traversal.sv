// SPDX-License-Identifier: Apache-2.0
// Rays through a hierarchy. A ray has a context, and of each context one operation is under way: a node is read and
// its boxes tested, the secondaries of a leaf are fetched and tested, or the next of these is chosen from its stack. No
// unit ever waits, but for leaves that memory does not give yet; what waits are contexts, in queues that hold all of
// them, so none can overflow and nothing can lock.
//
//   rays -> ray_front -> UNITS x traversal_bank -> leaves -> fetch -> pair pipe -> better of (T, index) -+
//                            |  ^                                                                        |
//               records <----+  +------------------------------------------------------------------------+
//
// A ray that comes has a free context (ray_ready_o); what is fetched comes back with the tag that was asked with.
// Latency: that of the way. Throughput: UNITS nodes, a leaf, a ray and a record a clock. Stall:
// ray_ready_o, fetch_ready_i, record_ready_i.
`include "hierarchy.svh"
`include "ray_box.svh"
module traversal #(
    parameter int CONTEXTS = 256,  // powers of two
    parameter int UNITS = 2,       // of nodes, each with its share of the contexts
    parameter int ALGORITHM = 0,   // of ray-triangle, pairs_pkg::ALGORITHM_*, all with the box rule
    parameter int LAT_ADD = 1,
    parameter int LAT_MUL = 1,
    parameter int LAT_DIV = 1,
    parameter int LAT_CMP = 1,
    parameter ARITH = "rtl",
    localparam int EXP = 8,
    localparam int MAN = 23,
    localparam int LANES = 2,  // secondaries of a leaf
    localparam int LAT_SQRT = 1,
    localparam int CX = $clog2(CONTEXTS),
    localparam int TAG = `AT_BITS(CX) + 1
) (
    input logic clk_i,
    input logic rst_i,
    // Node memory, a port a unit, whose answer is there the clock after.
    input logic [31:0] nodes_i,  // that it has
    output logic [UNITS-1:0] node_read_o,
    output logic [UNITS-1:0][hierarchy_pkg::PLACE-1:0] node_at_o,
    input logic [UNITS-1:0][hierarchy_pkg::NODE_WORDS-1:0][31:0] node_i,
    // What holds for all rays.
    input logic [6:0][31:0] root_i,  // of its box: lower corner x y z, upper, 16 u W (ray_front.sv)
    input logic [2:0] goal_i,        // hierarchy_pkg::GOAL_*
    // Rays: o x y z, d x y z, tmin, tmax, and their numbers.
    input logic ray_valid_i,
    output logic ray_ready_o,
    input logic [7:0][31:0] ray_i,
    input logic [31:0] number_i,
    // Secondaries of leaves, one or two from a slot on, and their indices. fetched_valid_i, which is a clock gate's
    // enable, comes from a register.
    output logic fetch_valid_o,
    input logic fetch_ready_i,
    output logic [hierarchy_pkg::PLACE-1:0] fetch_slot_o,
    output logic [TAG-1:0] fetch_tag_o,  // and its lowest bit: two
    input logic fetched_valid_i,
    input logic [TAG-1:0] fetched_tag_i,
    input logic [LANES-1:0][8:0][31:0] fetched_i,
    input logic [LANES-1:0][31:0] index_i,
    // Hits of goal hits, as they are found. Nobody waits for who takes them: there is room for those of all leaves that
    // are asked for (fetch_ready_i).
    output logic tested_o,  // a leaf has been, and its hits are
    output logic [LANES-1:0] hit_o,
    output logic [31:0] hit_number_o,
    output logic [LANES-1:0][31:0] hit_t_o,
    output logic [2:0][LANES-1:0][31:0] hit_cp_o,
    output logic [LANES-1:0][31:0] hit_index_o,
    // Records, one a ray, behind its hits; of goal hits they say no more than that.
    output logic record_valid_o,
    input logic record_ready_i,
    output logic [31:0] number_o,
    output logic f_o,
    output logic [31:0] t_o,
    output logic [2:0][31:0] cp_o,
    output logic [31:0] index_o,
    output hierarchy_pkg::events_t events_o,
    output logic [4:0] deepest_o,  // stack since reset: groups
    output logic [3:0] fault_o,    // registers_pkg::NODE_FAULT_*; who sees one ends the pass
    output logic [hierarchy_pkg::PLACE-1:0] fault_place_o
);
  import hierarchy_pkg::*;
  if (CONTEXTS < 2 * UNITS || (CONTEXTS & (CONTEXTS - 1)) != 0) $error("traversal: CONTEXTS must be a power of two");
  if ((UNITS & (UNITS - 1)) != 0) $error("traversal: UNITS must be a power of two");
  `HIERARCHY_TYPES(CX)
  localparam int BANK = $clog2(UNITS);
  // The bank of a context.
  `define CDE_OWN(CONTEXT) (CONTEXT % CX'(UNITS) == CX'(u))

  // ---- What is kept of a ray ----
  typedef struct packed {
    logic f;
    logic [31:0] t;
    logic [2:0][31:0] cp;
    logic [31:0] index;
  } best_t;
  logic [7:0][31:0] rays[CONTEXTS];
  logic [31:0] numbers[CONTEXTS];
  best_t bests[CONTEXTS];

  // ---- Rays that come ----
  logic [CX:0] fresh_q;  // contexts that never had a ray
  logic [CX:0] free_count;
  logic [CX-1:0] free, taken;
  logic take, keep_valid, record_read;
  logic [CX-1:0] done;
  sync_fifo #(.W(CX), .DEPTH(CONTEXTS)) queue_free (
      .clk_i, .rst_i, .write_i(record_read), .wdata_i(done), .room_o(), .count_o(free_count), .rdata_o(free),
      .read_i(take && fresh_q[CX]));
  assign taken = fresh_q[CX] ? free : fresh_q[CX-1:0];
  assign ray_ready_o = (!fresh_q[CX] || free_count != 0) && !keep_valid;
  assign take = ray_valid_i && ray_ready_o;
  always_ff @(posedge clk_i) begin
    if (take && !fresh_q[CX]) fresh_q <= fresh_q + 1;
    if (rst_i) fresh_q <= '0;
    if (take) begin
      rays[taken] <= ray_i;
      numbers[taken] <= number_i;
    end
  end
  localparam int T_FRONT = `RAY_T_FRONT;
  logic [8:0][31:0] front_now, front;
  logic front_valid;
  logic [CX-1:0] front_context;
  // The host back end computes in the second clock, with a clock of its own: where no ray comes, nothing is computed.
  localparam int T_NOW = (ARITH == "rtl") ? T_FRONT : 1;
  logic [12:0][31:0] front_of;  // the ray, and the root's box
  if (ARITH == "rtl") begin : g_at_once
    assign front_of = {root_i, ray_i[5:0]};
  end else begin : g_next_clock
    logic clk;
    clock_gate gate (.clk_i, .enable_i(take), .clk_o(clk));
    always_ff @(posedge clk) front_of <= {root_i, ray_i[5:0]};
  end
  ray_front #(
      .LANES(1), .LAT_ADD(LAT_ADD), .LAT_MUL(LAT_MUL), .LAT_DIV(LAT_DIV), .LAT_CMP(LAT_CMP), .ARITH(ARITH)
  ) of_ray (
      .clk_i, .a_i(front_of[5:0]), .root_i(front_of[12:6]), .r_o(front_now));
  align #(.W(9 * 32), .FROM(T_NOW), .TO(T_FRONT), .MEMORY(5)) align_front (.clk_i, .d_i(front_now), .q_o(front));
  align #(.W(CX), .TO(T_FRONT)) align_taken (.clk_i, .d_i(taken), .q_o(front_context));
  align_valid #(.TO(T_FRONT)) align_take (.clk_i, .rst_i, .valid_i(take), .valid_o(front_valid));

  // ---- Banks ----
  logic [UNITS-1:0] leaf_valid, leaf_ready, done_valid, done_ready, reads;
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
        .CONTEXTS(CONTEXTS / UNITS), .CX(CX), .LAT_ADD(LAT_ADD), .LAT_MUL(LAT_MUL), .LAT_CMP(LAT_CMP),
        .ARITH(ARITH)
    ) bank (
        .clk_i, .rst_i, .nodes_i, .node_read_o(node_read_o[u]), .node_at_o(node_at_o[u]), .node_i(node_i[u]),
        .farthest_i(farthest_q),
        .interval_write_i(`CDE_OWN(interval_context) ? interval_write : '0),
        .interval_context_i(interval_context[CX-1:BANK]),
        .interval_i(interval), .front_valid_i(front_valid && `CDE_OWN(front_context)),
        .front_context_i(front_context), .front_i(front), .leaf_valid_o(leaf_valid[u]),
        .leaf_ready_i(leaf_ready[u]), .leaf_o(leaf[u]), .tested_valid_i(keep_valid && `CDE_OWN(tested.context_)),
        .tested_i(tested), .done_valid_o(done_valid[u]), .done_ready_i(done_ready[u]), .done_o(dones[u]),
        .visits_o(reads[u]), .level_o(levels[u]), .fault_o(faults[u]), .fault_place_o(fault_places[u]));
  end
  // Banks take turns: the one whose turn it is, else the next that has something.
  logic [UNITS-1:0] leaf_from, done_from;
  turns #(.N(UNITS)) leaf_turns (.clk_i, .rst_i, .some_i(leaf_valid), .taken_i(fetch_ready_i), .from_o(leaf_from));
  turns #(.N(UNITS)) done_turns (.clk_i, .rst_i, .some_i(done_valid), .taken_i(record_ready_i), .from_o(done_from));

  // ---- Leaves ----
  visit_t leaves;
  always_comb begin
    leaves = '0;
    for (int u = 0; u < UNITS; u++) if (leaf_from[u]) leaves = leaf[u];
  end
  assign fetch_valid_o = leaf_valid != '0;
  assign fetch_slot_o = leaves.place;
  assign fetch_tag_o = {leaves.at, leaves.two};
  assign leaf_ready = leaf_from & {UNITS{fetch_ready_i}};
  logic fetched_q, two_q;
  at_t fetched_at_q;
  logic [7:0][LANES-1:0][31:0] pipe_a;
  logic [8:0][LANES-1:0][31:0] pipe_b;
  logic [7:0][31:0] fetched_ray_q;
  logic [LANES-1:0][8:0][31:0] words_q;
  logic [LANES-1:0][31:0] index_q;
  // What the pipe computes with has a clock of its own: where nothing is fetched, nothing is computed.
  logic fetched_clk;
  clock_gate gate_fetched (.clk_i, .enable_i(fetched_valid_i), .clk_o(fetched_clk));
  always_ff @(posedge clk_i) begin
    fetched_q <= fetched_valid_i && !rst_i;
    {fetched_at_q, two_q} <= fetched_tag_i;
    index_q <= index_i;
  end
  always_ff @(posedge fetched_clk) begin
    fetched_ray_q <= rays[fetched_tag_i[TAG-1-:CX]];
    words_q <= fetched_i;
  end
  for (genvar l = 0; l < LANES; l++) begin : lane
    for (genvar w = 0; w < 8; w++) begin : a assign pipe_a[w][l] = fetched_ray_q[w]; end
    for (genvar w = 0; w < 9; w++) begin : b assign pipe_b[w][l] = words_q[l][w]; end
  end
  // When the pipe has o + t d: for Badouel's t it takes an addition more, for the watertight one the shear in front.
  localparam int T_POINT = 5 * LAT_ADD + 3 * LAT_MUL + LAT_DIV +
      ((ALGORITHM == int'(pairs_pkg::ALGORITHM_BADOUEL)) ? LAT_ADD :
       (ALGORITHM == int'(pairs_pkg::ALGORITHM_WATERTIGHT)) ?
       `DF_MAX2(2 * LAT_CMP + LAT_DIV + LAT_MUL, LAT_ADD) + 2 * LAT_MUL : 0);
  // The rule comes last, but for Badouel's inside test, which needs that point, too.
  localparam int T_IN_BOX = `RAY_T_IN_BOX(T_POINT - LAT_ADD, T_POINT);
  localparam int T_INSIDE = `DF_MAX2(2 * LAT_ADD + LAT_MUL + 2 * LAT_CMP, T_POINT) + 3 * LAT_ADD + LAT_MUL + LAT_CMP;
  // The pipe's latency, which it says itself: asserted below.
  localparam int T_PAIR =
      ((ALGORITHM == int'(pairs_pkg::ALGORITHM_BADOUEL)) ? `DF_MAX2(T_IN_BOX, T_INSIDE) : T_IN_BOX) + 1;
  logic [LANES-1:0][31:0] f_now, t_now, f, t, index;
  logic [2:0][LANES-1:0][31:0] cp_now, cp, unused_n;
  logic [15:0] latency;
  pair_pipe #(`DF_SAME, .PAIR(int'(pairs_pkg::PAIR_RAY_TRIANGLE)), .ALGORITHM(ALGORITHM), .BOX(1)) pipe (
      .clk_i, .enter_i(fetched_q), .a_i(pipe_a), .b_i(pipe_b), .f_o(f_now), .t_o(t_now), .cp_o(cp_now),
      .n_o(unused_n), .latency_o(latency));
  align #(.W(5 * LANES * 32), .FROM(ARITH == "rtl" ? T_PAIR : 0), .TO(T_PAIR), .MEMORY(5)) align_pair (
      .clk_i, .d_i({f_now, t_now, cp_now}), .q_o({f, t, cp}));
  logic two;
  at_t keep_at_soon;
  align #(.W($bits(at_t)), .TO(T_PAIR - 1)) align_soon (.clk_i, .d_i(fetched_at_q), .q_o(keep_at_soon));
  align #(.W($bits(at_t)), .TO(1)) align_at (.clk_i, .d_i(keep_at_soon), .q_o(keep_at));
  align #(.W(1 + LANES * 32), .TO(T_PAIR), .MEMORY(5)) align_index (.clk_i, .d_i({two_q, index_q}), .q_o({two, index}));
  align_valid #(.TO(T_PAIR)) align_fetched (.clk_i, .rst_i, .valid_i(fetched_q), .valid_o(keep_valid));

  // ---- The better of what a ray had and what it found ----
  best_t best_q, best;
  logic [LANES-1:0] counts;
  always_ff @(posedge clk_i) best_q <= bests[keep_at_soon.context_];
  // T is no -0, so that words are equal where numbers are.
  function automatic logic better(input logic [31:0] t_1, input logic [31:0] index_1, input logic [31:0] t_2,
                                  input logic [31:0] index_2);
    if (goal_i == GOAL_ANY || goal_i == GOAL_OCCLUDED || t_1 == t_2) return index_1 < index_2;
    return (goal_i == GOAL_FARTHEST) == (ordered(t_1) > ordered(t_2));
  endfunction
  always_comb begin
    best = best_q;
    for (int l = 0; l < LANES; l++) begin
      best_t one;
      one = '{f: 1'b1, t: t[l], cp: {cp[2][l], cp[1][l], cp[0][l]}, index: index[l]};
      counts[l] = f[l][0] && (l == 0 || two);
      if (counts[l] && goal_i != GOAL_HITS && (!best.f || better(one.t, one.index, best.t, best.index))) best = one;
    end
  end
  always_ff @(posedge clk_i) hit_number_o <= numbers[keep_at_soon.context_];
  assign tested_o = keep_valid;
  assign hit_o = (keep_valid && goal_i == GOAL_HITS) ? counts : '0;
  assign hit_t_o = t;
  assign hit_cp_o = cp;
  assign hit_index_o = index;
  // A hit leaves less of T that counts; the first of goal occluded ends the way.
  always_comb begin
    interval_write = {2{take}};
    interval_context = taken;
    interval = ray_i[7:6];
    tested = keep_at;
    if (keep_valid) begin
      interval_write = {best.f && goal_i == GOAL_NEAREST, best.f && goal_i == GOAL_FARTHEST};
      interval_context = keep_at.context_;
      interval = {2{best.t}};
      if (best.f && goal_i == GOAL_OCCLUDED) tested.level = '0;
    end
  end
  always_ff @(posedge clk_i) if (keep_valid || take) bests[interval_context] <= keep_valid ? best : '0;

  // ---- Records ----
  always_comb begin
    done = '0;
    for (int u = 0; u < UNITS; u++) if (done_from[u]) done = dones[u];
  end
  assign record_valid_o = done_valid != '0;
  assign done_ready = done_from & {UNITS{record_ready_i}};
  assign record_read = record_valid_o && record_ready_i;
  assign number_o = numbers[done];
  assign {f_o, t_o, cp_o, index_o} = bests[done];
  `undef CDE_OWN

  // ---- What is counted, and what is wrong ----
  assign events_o.nodes = 4'($countones(reads));
  assign events_o.leaves = 4'(fetch_valid_o && fetch_ready_i);
  assign events_o.secondaries = fetched_q ? 4'd1 + 4'(two_q) : '0;
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
    if (!rst_i)
      assert (latency == 16'(T_PAIR)) else $error("traversal: the pipe takes %0d clocks, not %0d", latency, T_PAIR);
`endif
endmodule
