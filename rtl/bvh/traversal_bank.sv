// SPDX-License-Identifier: Apache-2.0
// Contexts of one traversal unit, and the node or leaf that each visits next. A node is read and its boxes tested. The
// context visits the first hit child at once, and the others wait on its stack. It takes the next child from the stack
// when a leaf has been tested or a node had no hit. With ahead_i it does so when a leaf has been sent.
// For rays, a choice compares the child's key with key_limit.sv.
// Latency per visit: the node reader's, and NODE_T_RAY + 3 cycles (bvh.svh) or NODE_T_SOLID + 3. Per choice:
// NODE_T_LIMIT + 2 for rays, 3 for solids, 2 for primaries that have finished.
// Throughput: one node per CYCLES cycles, and one choice per cycle.
// Stall: leaf_ready_i and done_ready_i only. Contexts wait in queues that hold all of them.
`include "bvh.svh"
module traversal_bank #(
    parameter int CONTEXTS = 128,  // power of two
    parameter int CX = 8,          // bits of a context's number; the lowest bits select the bank
    parameter latency_pkg::latency_t LAT = latency_pkg::ONES,
    parameter ARITH = "rtl",
    parameter int RAYS = 1,        // 0: only solids
    parameter int SOLIDS = 1,      // 0: only rays
    parameter int CYCLES = 1,      // per node: 1, 2 or 4
    parameter int PINNED = 4096,   // node_reader.sv
    parameter int LINES = 0,
    parameter int WAYS = 4,
    parameter bit HALVES = 0,
    localparam int CB = $clog2(CONTEXTS)
) (
    input logic clk_i,
    input logic rst_i,
    // Node memory; a read returns one cycle later.
    input logic [31:0] nodes_i,  // number of nodes
    output logic node_read_o,
    output logic [bvh_pkg::PLACE-1:0] node_at_o,
    output logic node_second_o,  // with HALVES: the second half
    input logic [bvh_pkg::NODE_WORDS-1:0][31:0] node_i,
    // Nodes in DDR, with LINES.
    input logic [31:0] node_base_i,  // word of node 0
    input logic reset_i,  // rst_i also ends a pass; requests are forgotten with this reset only
    output card_pkg::ddr_request_t ddr_o,
    input logic ddr_ready_i,
    input logic ddr_valid_i,
    input logic [records_pkg::DDR_WORDS-1:0][31:0] ddr_data_i,
    output logic outstanding_o,
    output logic cached_o,   // a node that is not pinned is read
    output logic fetched_o,  // a node is requested from DDR
    input logic farthest_i,
    input logic solid_i,
    input logic ahead_i,  // contexts go on while their leaves are tested
    input logic new_i,  // the context of the interval gets a primary
    // The T interval that counts, from and to: of a new primary, and as hits are found.
    input logic [1:0] interval_write_i,
    input logic [CB-1:0] interval_context_i,  // without the bank's bits
    input logic [1:0][31:0] interval_i,
    // Ray input.
    input logic front_valid_i,
    input logic [CX-1:0] front_context_i,
    input logic [8:0][31:0] front_i,
    // Leaves to test, and contexts whose leaf has been tested.
    output logic leaf_valid_o,
    input logic leaf_ready_i,
    output logic [`VISIT_BITS(CX)-1:0] leaf_o,
    input logic tested_valid_i,
    input logic [`AT_BITS(CX)-1:0] tested_i,
    // Contexts that have finished.
    output logic done_valid_o,
    input logic done_ready_i,
    output logic [CX-1:0] done_o,
    output logic visits_o,  // a node is read
    output logic [4:0] level_o,  // level of a group put on a stack, from 1; else 0
    output logic [3:0] fault_o,  // registers_pkg::NODE_FAULT_*; 0: none
    output logic [bvh_pkg::PLACE-1:0] fault_place_o
);
  import bvh_pkg::*;
  `BVH_TYPES(CX)
  localparam int KEY = `NODE_KEY(SOLIDS);
  `BVH_GROUP(KEY)
  localparam int LW = $clog2(LEVELS);
  localparam int BANK = CX - CB;  // bits that select the bank

  // A context has one operation under way, so no place of fronts, groups and nexts is written while it is read.
  (* no_rw_check *) logic [8:0][31:0] fronts[CONTEXTS];
  logic [31:0] floors[CONTEXTS], limits[CONTEXTS];
  (* no_rw_check *) group_t groups[CONTEXTS*LEVELS];
  // Visited children of a group; not used for a fresh group, which has one.
  (* no_rw_check *) logic [3:0] nexts[CONTEXTS*LEVELS];
  always_ff @(posedge clk_i) begin
    if (front_valid_i) fronts[front_context_i[CX-1:BANK]] <= front_i;
    if (interval_write_i[0]) floors[interval_context_i] <= interval_i[0];
    if (interval_write_i[1]) limits[interval_context_i] <= interval_i[1];
  end

  `define CDE_QUEUE(NAME, TYPE) \
    logic NAME``_write, NAME``_read, NAME``_some; TYPE NAME``_in, NAME; \
    sync_fifo #(.W($bits(TYPE)), .DEPTH(CONTEXTS)) queue_``NAME ( \
        .clk_i, .rst_i, .write_i(NAME``_write), .wdata_i(NAME``_in), .free_o(), .count_o(), .some_o(NAME``_some), \
        .rdata_o(NAME), .read_i(NAME``_read));
  `CDE_QUEUE(started, logic [CX-1:0])
  `CDE_QUEUE(nearer, visit_t)   // nodes to read: first children, and others
  `CDE_QUEUE(others, visit_t)
  `CDE_QUEUE(first_leaves, visit_t)
  `CDE_QUEUE(other_leaves, visit_t)
  `CDE_QUEUE(missed, at_t)      // inputs of a choice: nodes without hits, leaves, groups that came too late
  `CDE_QUEUE(tested, at_t)
  `CDE_QUEUE(dropped, at_t)
  `CDE_QUEUE(done, logic [CX-1:0])
  `undef CDE_QUEUE
  assign started_write = front_valid_i;
  assign started_in = front_context_i;

  // ---- Leaves that a context runs ahead of: sent and not back yet ----
  localparam int SENT = 13;  // bits of the counts, for more leaves than pipes and memory hold
  logic [SENT-1:0] sent[CONTEXTS], back[CONTEXTS];
  // One cycle after the leaf has left.
  logic leaf_sent_q;
  at_t sent_at_q;
  assign tested_write = ahead_i ? leaf_sent_q : tested_valid_i;
  assign tested_in = ahead_i ? sent_at_q : tested_i;
  always_ff @(posedge clk_i) begin
    leaf_sent_q <= ahead_i && leaf_valid_o && leaf_ready_i && !rst_i;
    sent_at_q <= leaf_o[`VISIT_BITS(CX)-1-:`AT_BITS(CX)];
    if (leaf_sent_q) sent[sent_at_q.context_[CX-1:BANK]] <= sent[sent_at_q.context_[CX-1:BANK]] + 1;
    // A new primary has none. Otherwise interval_context_i is the leaf's context.
    if (tested_valid_i && ahead_i) back[interval_context_i] <= back[interval_context_i] + 1;
    if (new_i) back[interval_context_i] <= sent[interval_context_i];
  end

  // ---- Nodes ----
  localparam int T_RAY = (RAYS != 0) ? `NODE_T_RAY(CYCLES) : `NODE_T_SOLID;
  localparam int T_SOLID = (SOLIDS != 0) ? `NODE_T_SOLID : `NODE_T_RAY(CYCLES);
  at_t visit, reading, visit_q, met_at;
  logic [PLACE-1:0] visit_place, reading_place, visit_node_q;
  logic visit_ready, read, visit_valid_q, group_valid, ray_valid, solid_valid;
  logic [8:0][31:0] front_q;
  logic [1:0][31:0] interval_q;
  group_t group;
  logic [NODE_WORDS-1:0][31:0] node;
  assign nearer_read = nearer_some && visit_ready;
  assign others_read = others_some && !nearer_some && visit_ready;
  assign started_read = started_some && !nearer_some && !others_some && visit_ready;
  assign visit = nearer_some ? nearer.at : others_some ? others.at : '{context_: started, level: '0, fresh: '0};
  assign visit_place = nearer_some ? nearer.place : others_some ? others.place : '0;
  node_reader #(
      .CONTEXTS(CONTEXTS), .CX(CX), .CYCLES(CYCLES), .PINNED(PINNED), .LINES(LINES), .WAYS(WAYS),
      .HALVES(HALVES)
  ) reader (
      .clk_i, .rst_i(reset_i), .clear_i(rst_i), .nodes_i, .base_i(node_base_i),
      .valid_i(nearer_some || others_some || started_some),
      .ready_o(visit_ready), .at_i(visit), .place_i(visit_place), .valid_o(read), .at_o(reading),
      .place_o(reading_place), .node_o(node), .chip_read_o(node_read_o), .chip_at_o(node_at_o),
      .chip_second_o(node_second_o), .chip_node_i(node_i),
      .ddr_o, .ddr_ready_i, .ddr_valid_i, .ddr_data_i, .outstanding_o, .cached_o, .fetched_o);
  always_ff @(posedge clk_i) begin
    if (read) begin
      front_q <= fronts[reading.context_[CX-1:BANK]];
      interval_q <= {limits[reading.context_[CX-1:BANK]], floors[reading.context_[CX-1:BANK]]};
      visit_q <= reading;
      visit_node_q <= reading_place;
    end
    visit_valid_q <= read && !rst_i;
  end
  assign visits_o = visit_valid_q;
  traversal_unit #(
      .LAT(LAT), .ARITH(ARITH), .RAYS(RAYS), .SOLIDS(SOLIDS), .CYCLES(CYCLES)
  ) unit (
      .clk_i, .valid_i(visit_valid_q), .front_i(front_q), .floor_i(interval_q[0]), .limit_i(interval_q[1]), .farthest_i,
      .solid_i, .node_i(node), .group_o(group));
  pass_delay #(.W($bits(at_t)), .T_RAY(T_RAY), .T_SOLID(T_SOLID)) delay_visit (
      .clk_i, .solid_i, .d_i(visit_q), .q_o(met_at));
  pipe_delay_valid #(.TO(T_RAY)) delay_ray (.clk_i, .rst_i, .valid_i(visit_valid_q), .valid_o(ray_valid));
  pipe_delay_valid #(.TO(T_SOLID)) delay_solid (.clk_i, .rst_i, .valid_i(visit_valid_q), .valid_o(solid_valid));
  assign group_valid = solid_i ? solid_valid : ray_valid;

  // The first child's kind, and one cycle later its place.
  logic group_some_q, group_push, first_is_node;
  at_t group_at, group_at_q;
  logic [2:0] first, first_q;
  logic [1:0] first_kind, first_kind_q;
  logic [2*CHILDREN-1:0] kinds_q;
  logic [PLACE-1:0] first_base_q;  // place of the first child of the same kind
  logic [2*CHILDREN-3:0] behind_first;
  assign group_push = group_valid && group.count > 1;
  assign first = group.order[0];
  assign {behind_first, first_kind} = group.kinds >> {first, 1'b0};
  always_comb begin
    group_at = met_at;
    if (group.count > 1) begin
      group_at.level = met_at.level + 1;
      group_at.fresh[met_at.level[LW-1:0]] = 1'b1;
    end
  end
  always_ff @(posedge clk_i) begin
    group_some_q <= group_valid && group.count != 0 && !rst_i;
    {group_at_q, first_q, first_kind_q, kinds_q} <= {group_at, first, first_kind, group.kinds};
    first_base_q <= (first_kind == KIND_NODE) ? group.node : group.slot;
  end
  assign first_is_node = first_kind_q == KIND_NODE;
  always_ff @(posedge clk_i) if (group_push) groups[{met_at.context_[CX-1:BANK], met_at.level[LW-1:0]}] <= group;
  assign missed_write = group_valid && group.count == 0;
  assign missed_in = met_at;
  assign nearer_in = '{
      at: group_at_q,
      place: first_base_q + PLACE'(ahead(kinds_q, first_q, first_is_node)),
      two: first_kind_q == KIND_TWO};
  assign first_leaves_in = nearer_in;
  assign nearer_write = group_some_q && first_is_node;
  assign first_leaves_write = group_some_q && !first_is_node;

  // ---- The next child of the top group ----
  at_t choice, choice_q;
  logic choice_valid, choice_valid_q;
  logic [LW-1:0] top, top_q;
  group_t top_group_q;
  logic [3:0] next_q;
  logic [1:0][31:0] choice_interval_q;
  logic [SENT-1:0] sent_q, back_q;
  assign choice_valid = missed_some || tested_some || dropped_some;
  assign missed_read = missed_some;
  assign tested_read = tested_some && !missed_some;
  assign dropped_read = dropped_some && !missed_some && !tested_some;
  assign choice = missed_some ? missed : tested_some ? tested : dropped;
  assign top = choice.level[LW-1:0] - 1;
  always_ff @(posedge clk_i) begin
    top_group_q <= groups[{choice.context_[CX-1:BANK], top}];
    next_q <= nexts[{choice.context_[CX-1:BANK], top}];
    choice_interval_q <= {limits[choice.context_[CX-1:BANK]], floors[choice.context_[CX-1:BANK]]};
    {sent_q, back_q} <= {sent[choice.context_[CX-1:BANK]], back[choice.context_[CX-1:BANK]]};
    {choice_q, top_q} <= {choice, top};
    choice_valid_q <= choice_valid && !rst_i;
  end

  // next + 1, without a carry chain, whose wires would be long.
  function automatic logic [3:0] after(input logic [3:0] next);
    for (int b = 0; b < 4; b++) after[b] = next[b] ^ ((4'b1111 >> (4 - b)) & ~next) == 0;
  endfunction
  // The number of the child, and one cycle later the child, before it is known whether it counts. A context has one
  // choice under way, so its stack does not change.
  typedef struct packed {
    at_t at;
    logic [3:0] next;
    logic last;
    logic [2:0] number;
    logic [2*CHILDREN-1:0] kinds;
    logic [PLACE-1:0] node;
    logic [PLACE-1:0] slot;
    logic [CHILDREN-1:0][KEY-1:0] keys;
    logic [31:0] limit;
  } picked_t;
  typedef struct packed {
    at_t at;
    logic [3:0] next;
    logic last;
    logic [PLACE-1:0] place;
    logic [1:0] kind;
    logic [KEY-1:0] key;
    logic beyond;  // for solids
  } child_t;
  picked_t picked, picked_q;
  logic picked_valid_q;
  child_t child, child_then;  // child's place is the first of its kind, child_ahead before it
  logic [3:0] child_ahead;
  logic [2*CHILDREN-3:0] behind_child;
  logic [3*CHILDREN-4:0] later;
  logic done_now, child_valid;
  always_comb begin
    picked.at = choice_q;
    picked.next = choice_q.fresh[top_q] ? 4'd1 : next_q;
    {later, picked.number} = top_group_q.order >> (5'd3 * 5'(picked.next[2:0]));
    picked.last = after(picked.next) == top_group_q.count;
    picked.kinds = top_group_q.kinds;
    {picked.node, picked.slot} = {top_group_q.node, top_group_q.slot};
    picked.keys = top_group_q.keys;
    picked.limit = choice_interval_q[1];
  end
  always_ff @(posedge clk_i) begin
    picked_q <= picked;
    picked_valid_q <= child_valid && !rst_i;
  end
  always_comb begin
    {child.at, child.next, child.last} = {picked_q.at, picked_q.next, picked_q.last};
    {behind_child, child.kind} = picked_q.kinds >> {picked_q.number, 1'b0};
    child.place = child.kind == KIND_NODE ? picked_q.node : picked_q.slot;
    child_ahead = ahead(picked_q.kinds, picked_q.number, child.kind == KIND_NODE);
    child.key = picked_q.keys[picked_q.number];
    child.beyond = SOLIDS != 0 && ordered({16'(child.key), 16'd0}) > ordered(picked_q.limit);
  end
  assign done_now = choice_valid_q && choice_q.level == 0 && sent_q == back_q;
  assign done_write = done_now;
  assign done_in = choice_q.context_;

  // Whether it counts.
  localparam int T_CHOICE = (RAYS != 0) ? `NODE_T_LIMIT : 0;
  localparam int T_CHILD = (RAYS != 0) ? T_CHOICE - 1 : 0;
  localparam int T_SOLID_CHILD = (SOLIDS != 0) ? 0 : T_CHILD;
  logic child_valid_then, is_solid, beyond, empty, chosen;
  at_t choice_at;
  logic [LW-1:0] top_then;
  logic [RAY_KEY-1:0] key_most;
  assign is_solid = RAYS == 0 || (SOLIDS != 0 && solid_i);
  assign child_valid = choice_valid_q && !done_now;
  // Without solids, registers before and behind the sum of its place: the path is long, and the delay line may be a
  // memory.
  localparam int EARLY = (SOLIDS != 0) ? 0 : 1;
  child_t child_early, child_placed, child_known;
  logic [3:0] ahead_early;
  pipe_delay #(.W($bits(child_t) + 4), .TO(EARLY)) delay_early (
      .clk_i, .d_i({child, child_ahead}), .q_o({child_early, ahead_early}));
  always_comb begin
    child_placed = child_early;
    child_placed.place = child_early.place + PLACE'(ahead_early);
  end
  pipe_delay #(.W($bits(child_t)), .TO(EARLY)) delay_placed (.clk_i, .d_i(child_placed), .q_o(child_known));
  pass_delay #(.W($bits(child_t)), .T_RAY(T_CHILD - 2 * EARLY), .T_SOLID(T_SOLID_CHILD - 2 * EARLY)) delay_child (
      .clk_i, .solid_i(is_solid), .d_i(child_known), .q_o(child_then));
  if (RAYS != 0) begin : g_rays
    pipe_delay_valid #(.TO(T_CHOICE)) delay_child_valid (
        .clk_i, .rst_i, .valid_i(child_valid), .valid_o(child_valid_then));
    key_limit #(.ARITH(ARITH)) limit_of_keys (
        .clk_i, .valid_i(choice_valid_q), .time_i(choice_interval_q[!farthest_i]), .reference_i(top_group_q.t_ref),
        .scale_i(top_group_q.scale), .farthest_i, .limit_o(key_most));
  end else begin : g_no_rays
    assign key_most = '1;
    assign child_valid_then = picked_valid_q;
    logic unused_scale;
    assign unused_scale = &{1'b0, top_group_q.t_ref, top_group_q.scale, choice_interval_q[0]};
  end
  always_comb begin
    // Children are in order: if one is beyond the interval, so are all later ones.
    beyond = is_solid ? child_then.beyond : child_then.key[RAY_KEY-1:0] > key_most;
    empty = child_then.at.level == 0;
    top_then = child_then.at.level[LW-1:0] - 1;
    choice_at = child_then.at;
    choice_at.fresh[top_then] = 1'b0;
    if (!empty && (beyond || child_then.last)) choice_at.level = child_then.at.level - 1;
  end
  logic decided;
  assign decided = is_solid ? picked_valid_q : child_valid_then;
  assign chosen = decided && !empty && !beyond;
  assign dropped_write = decided && (empty || beyond);  // or it asks again
  assign dropped_in = choice_at;
  assign others_in = '{at: choice_at, place: child_then.place, two: child_then.kind == KIND_TWO};
  assign other_leaves_in = others_in;
  assign others_write = chosen && child_then.kind == KIND_NODE;
  assign other_leaves_write = chosen && child_then.kind != KIND_NODE;
  always_ff @(posedge clk_i)
    if (chosen) nexts[{child_then.at.context_[CX-1:BANK], top_then}] <= child_then.next + 1;

  // ---- Outputs ----
  assign leaf_valid_o = first_leaves_some || other_leaves_some;
  assign leaf_o = first_leaves_some ? first_leaves : other_leaves;
  assign first_leaves_read = first_leaves_some && leaf_ready_i;
  assign other_leaves_read = other_leaves_some && !first_leaves_some && leaf_ready_i;
  assign done_valid_o = done_some;
  assign done_o = done;
  assign done_read = done_some && done_ready_i;
  logic unused;
  assign unused = &{1'b0, nearer.two, others.two, behind_first, behind_child, later};

  // ---- Invalid BVHs ----
  logic too_deep;
  assign too_deep = group_push && int'(met_at.level) >= LEVELS;
  assign level_o = group_push ? 5'(met_at.level) + 1 : '0;
  always_comb begin
    fault_o = '0;
    fault_place_o = too_deep ? group.node : visit_node_q;
    if (too_deep) fault_o = registers_pkg::NODE_FAULT_DEPTH;
    else if (visit_valid_q && 32'(visit_node_q) >= nodes_i) fault_o = registers_pkg::NODE_FAULT_NODE;
  end
endmodule
