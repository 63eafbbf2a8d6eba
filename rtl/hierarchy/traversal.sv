// SPDX-License-Identifier: Apache-2.0
// Rays through a hierarchy. A ray has a context, and of each context one operation is under way: a node is read and
// its boxes tested, the secondaries of a leaf are fetched and tested, or the next of these is chosen from its stack. No
// unit ever waits, but for leaves that memory does not give yet; what waits are contexts, in queues that hold all of
// them, so none can overflow and nothing can lock.
//
//   rays -> ray_front -> started -+                   +-> leaves -> fetch -> pair_pipe -> better of (T, index) -+
//                                 +-> nodes -> node_unit -> group on the stack -> advance <----------------------+
//                                 +------------------------------------------------+-> done -> records
//
// A ray that comes has a free context (ray_ready_o); what is fetched comes back with the tag that was asked with.
// Latency: that of the way. Throughput: a node, a leaf and a choice a clock. Stall: ray_ready_o, fetch_ready_i,
// record_ready_i.
`include "hierarchy.svh"
`include "ray_box.svh"
module traversal #(
    parameter int CONTEXTS = 256,  // power of two
    parameter int NODES = 4096,    // that there is memory for
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
    localparam int SW = $clog2(hierarchy_pkg::LEVELS + 1),
    localparam int NW = $clog2(NODES),
    localparam int TAG = CX + SW + 1
) (
    input logic clk_i,
    input logic rst_i,
    // Node memory, written between passes.
    input logic node_write_i,
    input logic [NW-1:0] node_at_i,
    input logic [hierarchy_pkg::NODE_WORDS-1:0][31:0] node_i,
    // What holds for all rays.
    input logic [6:0][31:0] root_i,  // of its box: lower corner x y z, upper, 16 u W (ray_front.sv)
    input logic [2:0] goal_i,        // hierarchy_pkg::GOAL_*
    // Rays: o x y z, d x y z, tmin, tmax, and their numbers.
    input logic ray_valid_i,
    output logic ray_ready_o,
    input logic [7:0][31:0] ray_i,
    input logic [31:0] number_i,
    // Secondaries of leaves, one or two from a slot on, and their indices.
    output logic fetch_valid_o,
    input logic fetch_ready_i,
    output logic [hierarchy_pkg::PLACE-1:0] fetch_slot_o,
    output logic [TAG-1:0] fetch_tag_o,  // and its lowest bit: two
    input logic fetched_valid_i,
    input logic [TAG-1:0] fetched_tag_i,
    input logic [LANES-1:0][8:0][31:0] fetched_i,
    input logic [LANES-1:0][31:0] index_i,
    // Records, one a ray.
    output logic record_valid_o,
    input logic record_ready_i,
    output logic [31:0] number_o,
    output logic f_o,
    output logic [31:0] t_o,
    output logic [2:0][31:0] cp_o,
    output logic [31:0] index_o,
    // Since reset.
    output logic [31:0] nodes_o,
    output logic [31:0] secondaries_o
);
  import hierarchy_pkg::*;
  if (CONTEXTS < 2 || (CONTEXTS & (CONTEXTS - 1)) != 0) $error("traversal: CONTEXTS must be a power of two");
  if (NW > PLACE) $error("traversal: more nodes than a node can name");
  typedef struct packed {
    logic [CX-1:0] context_;
    logic [SW-1:0] level;  // groups on its stack
  } at_t;
  typedef struct packed {
    at_t at;
    logic [PLACE-1:0] place;
    logic two;
  } visit_t;
  typedef struct packed {
    at_t at;
    logic fresh;  // the group on top is new
  } step_t;

  // ---- What is kept of a ray ----
  typedef struct packed {
    logic f;
    logic [31:0] t;
    logic [2:0][31:0] cp;
    logic [31:0] index;
  } best_t;
  logic [7:0][31:0] rays[CONTEXTS];
  logic [31:0] numbers[CONTEXTS];
  logic [8:0][31:0] fronts[CONTEXTS];
  logic [1:0][31:0] intervals[CONTEXTS];  // T that counts: from, to
  best_t bests[CONTEXTS];
  logic [NODE_WORDS-1:0][31:0] nodes[NODES];
  always_ff @(posedge clk_i) if (node_write_i) nodes[node_at_i] <= node_i;

  // ---- Queues of contexts ----
  `define CDE_QUEUE(NAME, TYPE) \
    logic NAME``_write, NAME``_read, NAME``_some; TYPE NAME``_in, NAME; logic [CX:0] NAME``_count; \
    assign NAME``_some = NAME``_count != 0; \
    sync_fifo #(.W($bits(TYPE)), .DEPTH(CONTEXTS)) queue_``NAME ( \
        .clk_i, .rst_i, .write_i(NAME``_write), .wdata_i(NAME``_in), .room_o(), .count_o(NAME``_count), \
        .rdata_o(NAME), .read_i(NAME``_read));
  `CDE_QUEUE(free, logic [CX-1:0])
  `CDE_QUEUE(started, logic [CX-1:0])
  `CDE_QUEUE(visits, visit_t)   // of nodes
  `CDE_QUEUE(leaves, visit_t)
  `CDE_QUEUE(visited, step_t)   // three ways to the choice of the next
  `CDE_QUEUE(tested, at_t)
  `CDE_QUEUE(dropped, at_t)
  `CDE_QUEUE(done, logic [CX-1:0])
  `undef CDE_QUEUE

  // ---- Rays that come ----
  logic [CX:0] fresh_q;  // contexts that never had a ray
  logic [CX-1:0] taken;
  logic take;
  assign taken = fresh_q[CX] ? free : fresh_q[CX-1:0];
  assign ray_ready_o = (!fresh_q[CX] || free_some) && !keep_valid;
  assign take = ray_valid_i && ray_ready_o;
  assign free_read = take && fresh_q[CX];
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
  ray_front #(
      .LANES(1), .LAT_ADD(LAT_ADD), .LAT_MUL(LAT_MUL), .LAT_DIV(LAT_DIV), .LAT_CMP(LAT_CMP), .ARITH(ARITH)
  ) of_ray (
      .clk_i, .a_i(ray_i[5:0]), .root_i, .r_o(front_now));
  align #(.W(9 * 32), .FROM(ARITH == "rtl" ? T_FRONT : 0), .TO(T_FRONT)) align_front (
      .clk_i, .d_i(front_now), .q_o(front));
  align #(.W(CX), .TO(T_FRONT)) align_taken (.clk_i, .d_i(taken), .q_o(front_context));
  align_valid #(.TO(T_FRONT)) align_take (.clk_i, .rst_i, .valid_i(take), .valid_o(front_valid));
  always_ff @(posedge clk_i) if (front_valid) fronts[front_context] <= front;
  assign started_write = front_valid;
  assign started_in = front_context;

  // ---- Nodes: those chosen, and roots of rays that come ----
  localparam int T_UNIT = `NODE_T_UNIT;
  at_t visit;
  logic [NW-1:0] visit_node;
  logic visit_valid, visit_valid_q, group_valid;
  at_t visit_at_q, group_at;
  logic [NODE_WORDS-1:0][31:0] node_q;
  logic [8:0][31:0] node_front_q;
  logic [1:0][31:0] node_interval_q;
  group_t group;
  assign visit = visits_some ? visits.at : {started, SW'(0)};
  assign visit_node = visits_some ? visits.place[NW-1:0] : '0;
  logic unused;
  assign unused = visits.two;
  assign visit_valid = visits_some || started_some;
  assign visits_read = visits_some;
  assign started_read = !visits_some && started_some;
  always_ff @(posedge clk_i) begin
    node_q <= nodes[visit_node];
    node_front_q <= fronts[visit.context_];
    node_interval_q <= intervals[visit.context_];
    visit_at_q <= visit;
    visit_valid_q <= visit_valid && !rst_i;
  end
  node_unit #(
      .LAT_ADD(LAT_ADD), .LAT_MUL(LAT_MUL), .LAT_CMP(LAT_CMP), .ARITH(ARITH)
  ) unit (
      .clk_i, .ray_i(node_front_q), .floor_i(node_interval_q[0]), .limit_i(node_interval_q[1]),
      .farthest_i(goal_i == GOAL_FARTHEST), .node_i(node_q), .group_o(group));
  align #(.W($bits(at_t)), .TO(T_UNIT)) align_visit (.clk_i, .d_i(visit_at_q), .q_o(group_at));
  align_valid #(.TO(T_UNIT)) align_visit_valid (
      .clk_i, .rst_i, .valid_i(visit_valid_q), .valid_o(group_valid));

  // ---- Stacks: a group of children a level, and how many of them have been visited ----
  group_t groups[CONTEXTS*LEVELS];
  logic [3:0] nexts[CONTEXTS*LEVELS];
  logic group_push;
  assign group_push = group_valid && group.count != 0;
  always_ff @(posedge clk_i) if (group_push) groups[{group_at.context_, group_at.level[SW-2:0]}] <= group;
  assign visited_write = group_valid;
  assign visited_in = {group_at.context_, group_at.level + SW'(group_push), group_push};

  // ---- The next step of a ray ----
  // A node of which no child is met leaves the group below it on top, of which some have been visited.
  step_t choice, choice_q;
  logic choice_valid, choice_valid_q;
  logic [SW-2:0] top, top_q;
  group_t group_q;
  logic [3:0] next_q, next;
  logic [1:0][31:0] choice_interval_q;
  assign choice = visited_some ? visited : tested_some ? {tested, 1'b0} : {dropped, 1'b0};
  assign top = (SW - 1)'(choice.at.level - SW'(1));
  assign choice_valid = visited_some || tested_some || dropped_some;
  assign visited_read = visited_some;
  assign tested_read = tested_some && !visited_some;
  assign dropped_read = dropped_some && !visited_some && !tested_some;
  always_ff @(posedge clk_i) begin
    group_q <= groups[{choice.at.context_, top}];
    next_q <= nexts[{choice.at.context_, top}];
    choice_interval_q <= intervals[choice.at.context_];
    {choice_q, top_q} <= {choice, top};
    choice_valid_q <= choice_valid && !rst_i;
  end
  assign next = choice_q.fresh ? '0 : next_q;

  logic [2:0] child;
  logic [31:0] key;
  logic beyond, last, empty;
  visit_t chosen;
  always_comb begin
    child = group_q.order[next[2:0]];
    key = ordered({group_q.keys[next[2:0]], 16'd0});
    // In order: where one comes too late, so do those behind it.
    beyond = (goal_i == GOAL_FARTHEST) ? key < ordered(choice_interval_q[0]) : key > ordered(choice_interval_q[1]);
    last = next + 1 == group_q.count;
    empty = choice_q.at.level == 0;
    chosen = '{
        at: '{context_: choice_q.at.context_, level: choice_q.at.level - SW'(last)},
        place: (group_q.kinds[child] == KIND_NODE ? group_q.node : group_q.slot) +
               PLACE'(ahead(group_q.kinds, child)),
        two: group_q.kinds[child] == KIND_TWO};
  end
  assign done_write = choice_valid_q && empty;
  assign done_in = choice_q.at.context_;
  assign dropped_write = choice_valid_q && !empty && beyond;
  assign dropped_in = '{context_: choice_q.at.context_, level: choice_q.at.level - 1};
  assign visits_write = choice_valid_q && !empty && !beyond && group_q.kinds[child] == KIND_NODE;
  assign leaves_write = choice_valid_q && !empty && !beyond && group_q.kinds[child] != KIND_NODE;
  assign visits_in = chosen;
  assign leaves_in = chosen;
  always_ff @(posedge clk_i) if (choice_valid_q) nexts[{choice_q.at.context_, top_q}] <= next + 1;

  // ---- Leaves ----
  assign fetch_valid_o = leaves_some;
  assign fetch_slot_o = leaves.place;
  assign fetch_tag_o = {leaves.at, leaves.two};
  assign leaves_read = leaves_some && fetch_ready_i;
  logic fetched_q, two_q;
  at_t fetched_at_q;
  logic [7:0][LANES-1:0][31:0] pipe_a;
  logic [8:0][LANES-1:0][31:0] pipe_b;
  logic [7:0][31:0] fetched_ray_q;
  logic [LANES-1:0][8:0][31:0] words_q;
  logic [LANES-1:0][31:0] index_q;
  always_ff @(posedge clk_i) begin
    fetched_q <= fetched_valid_i && !rst_i;
    {fetched_at_q, two_q} <= fetched_tag_i;
    fetched_ray_q <= rays[fetched_tag_i[TAG-1-:CX]];
    {words_q, index_q} <= {fetched_i, index_i};
  end
  for (genvar l = 0; l < LANES; l++) begin : lane
    for (genvar w = 0; w < 8; w++) begin : a assign pipe_a[w][l] = fetched_ray_q[w]; end
    for (genvar w = 0; w < 9; w++) begin : b assign pipe_b[w][l] = words_q[l][w]; end
  end
  // The pipe's latency, which it says itself: asserted below.
  localparam int T_CP = 5 * LAT_ADD + 3 * LAT_MUL + LAT_DIV;
  localparam int T_PAIR = `RAY_T_IN_BOX(T_CP - LAT_ADD, T_CP) + 1;
  logic [LANES-1:0][31:0] f_now, t_now, f, t, index;
  logic [2:0][LANES-1:0][31:0] cp_now, cp;
  logic [15:0] latency;
  ray_triangle_moller #(`DF_SAME, .B_LANES(LANES), .BOX(1)) pipe (
      .clk_i, .a_i(pipe_a), .b_i(pipe_b), .f_o(f_now), .t_o(t_now), .cp_o(cp_now), .latency_o(latency));
  align #(.W(5 * LANES * 32), .FROM(ARITH == "rtl" ? T_PAIR : 0), .TO(T_PAIR)) align_pair (
      .clk_i, .d_i({f_now, t_now, cp_now}), .q_o({f, t, cp}));
  logic keep_valid, two;
  at_t keep_at, keep_at_soon;
  align #(.W($bits(at_t)), .TO(T_PAIR - 1)) align_soon (.clk_i, .d_i(fetched_at_q), .q_o(keep_at_soon));
  align #(.W($bits(at_t)), .TO(1)) align_at (.clk_i, .d_i(keep_at_soon), .q_o(keep_at));
  align #(.W(1 + LANES * 32), .TO(T_PAIR)) align_index (.clk_i, .d_i({two_q, index_q}), .q_o({two, index}));
  align_valid #(.TO(T_PAIR)) align_fetched (.clk_i, .rst_i, .valid_i(fetched_q), .valid_o(keep_valid));

  // ---- The better of what a ray had and what it found ----
  best_t best_q, best;
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
      one = '{f: f[l][0], t: t[l], cp: {cp[2][l], cp[1][l], cp[0][l]}, index: index[l]};
      if (one.f && (l == 0 || two) && (!best.f || better(one.t, one.index, best.t, best.index))) best = one;
    end
  end
  logic [1:0][31:0] interval;
  logic ends;
  logic [1:0][31:0] keep_interval_q;
  always_ff @(posedge clk_i) keep_interval_q <= intervals[keep_at_soon.context_];
  always_comb begin
    interval = keep_interval_q;
    if (best.f && goal_i == GOAL_NEAREST) interval[1] = best.t;
    if (best.f && goal_i == GOAL_FARTHEST) interval[0] = best.t;
    ends = best.f && goal_i == GOAL_OCCLUDED;
  end
  always_ff @(posedge clk_i) begin
    if (keep_valid) {bests[keep_at.context_], intervals[keep_at.context_]} <= {best, interval};
    else if (take) {bests[taken], intervals[taken]} <= {best_t'('0), ray_i[7:6]};
  end
  assign tested_write = keep_valid;
  assign tested_in = '{context_: keep_at.context_, level: ends ? '0 : keep_at.level};

  // ---- Records ----
  assign record_valid_o = done_some;
  assign done_read = done_some && record_ready_i;
  assign number_o = numbers[done];
  assign {f_o, t_o, cp_o, index_o} = bests[done];
  assign free_write = done_read;
  assign free_in = done;

  always_ff @(posedge clk_i) begin
    if (visit_valid_q) nodes_o <= nodes_o + 1;
    if (fetched_q) secondaries_o <= secondaries_o + 1 + 32'(two_q);
    if (rst_i) {nodes_o, secondaries_o} <= '0;
  end

`ifndef SYNTHESIS
  always_ff @(posedge clk_i)
    if (!rst_i) begin
      assert (latency == 16'(T_PAIR)) else $error("traversal: the pipe takes %0d clocks, not %0d", latency, T_PAIR);
      assert (!group_push || int'(group_at.level) < LEVELS) else $error("traversal: a tree deeper than the stack");
    end
`endif
endmodule
