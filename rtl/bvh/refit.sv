// SPDX-License-Identifier: Apache-2.0
// Refits the boxes of a BVH after triangles moved: every node's origin, exponents and bytes, from the last node to the
// first. The children of a node stay. A child's number is larger than its parent's (bvh::check), so its words are
// new before they are read. The software version host/include/cde/reference/refit.hpp is the same bit by bit.
//
//   node memory -> refit_traversal -+-> fetch -> refit_leaf -> boxes of leaves -+-> refit_encode -> node memory
//                                   +-> refit_node ----------> boxes of nodes --+
//
// A node holds a context from the request of its children until its boxes are encoded, in order. Only refit_traversal
// waits: for memory, for a context, and for a child that is not written yet.
// A triangle with a NaN or a coordinate beyond 2^40 ends the refit. The output bad_o then comes with its slot, the
// first in the order of the work. The nodes from that triangle's own node up to the root keep their
// words, and the other nodes are new. The ray front takes the root's box as its words say (box_of() there).
// When done_o is high, every request has been answered. After a reset, no answer to an earlier request may come.
// Latency: the traversal of all nodes.
// Throughput: one child per cycle, and one more cycle per node.
// Stall: fetch_ready_i.
module refit #(
    parameter int CONTEXTS = 8,  // nodes under way: a power of two, 2 or more
    localparam int CX = $clog2(CONTEXTS),
    localparam int TAG = CX + 4
) (
    input logic clk_i,
    input logic rst_i,
    input logic start_i,  // not while busy
    input logic [bvh_pkg::PLACE-1:0] first_node_i,  // nodes before it keep their words
    input logic [bvh_pkg::PLACE-1:0] node_count_i,
    output logic busy_o,
    output logic done_o,  // one cycle
    output logic bad_o,   // high until the next start
    output logic [bvh_pkg::PLACE-1:0] bad_slot_o,
    // Node memory: a read returns the word one cycle later, as it was before that cycle's write.
    output logic read_o,
    output logic [bvh_pkg::PLACE-1:0] read_at_o,
    input logic [bvh_pkg::NODE_WORDS-1:0][31:0] node_i,
    output logic write_o,
    output logic [bvh_pkg::PLACE-1:0] write_at_o,
    output logic [bvh_pkg::NODE_WORDS-1:0][31:0] node_o,
    // Secondaries of leaves, one or two from a slot on, as in traversal.sv. They come in any order.
    output logic fetch_valid_o,
    input logic fetch_ready_i,
    output logic [bvh_pkg::PLACE-1:0] fetch_slot_o,
    output logic [TAG-1:0] fetch_tag_o,  // its lowest bit: two secondaries
    input logic fetched_valid_i,
    input logic [TAG-1:0] fetched_tag_i,
    input logic [1:0][8:0][31:0] fetched_i
);
  import bvh_pkg::*;
  localparam int HEADER = 2 * PLACE + 16;
  localparam int T_LEAF = 1 + 3;  // a register, and refit_leaf.sv
  localparam int T_NODE = 1 + 5;  // node memory, and refit_node.sv
  if (CONTEXTS < 2 || (CONTEXTS & (CONTEXTS - 1)) != 0) $error("refit: CONTEXTS must be a power of two");

  // ---- Start and end ----
  logic busy_q, done_q, bad_q, over;
  logic [PLACE-1:0] written_q;  // this node and those after it have been written
  logic [CX+3:0] outstanding_q;  // outstanding leaves
  logic [7:0] recent_q;         // activity in the last cycles: longer than any of the pipes
  assign over = busy_q && (bad_q ? recent_q == '0 : written_q == first_node_i);
  always_ff @(posedge clk_i) begin
    if (start_i) busy_q <= 1'b1;
    else if (over) busy_q <= 1'b0;
    done_q <= over;
    if (rst_i) {busy_q, done_q} <= '0;
    outstanding_q <= outstanding_q + (CX+4)'(fetch_valid_o && fetch_ready_i) - (CX+4)'(fetched_valid_i);
    if (rst_i) outstanding_q <= '0;
  end
  assign busy_o = busy_q;
  assign done_o = done_q;
  assign bad_o = bad_q;

  // ---- Contexts, in a ring ----
  logic [CX:0] head_q, tail_q;
  logic [CX-1:0] head;
  logic open, leave, child_read, two;
  logic [HEADER-1:0] header;
  logic [CX+2:0] child_at;
  logic [HEADER-1:0] headers[CONTEXTS];
  logic [CONTEXTS-1:0][CHILDREN-1:0] missing_q;  // outstanding boxes
  assign head = head_q[CX-1:0];
  refit_traversal #(.CX(CX)) traversal (
      .clk_i, .rst_i, .start_i, .stop_i(bad_q), .first_i(first_node_i), .count_i(node_count_i), .written_i(written_q),
      .context_free_i(tail_q - head_q != (CX+1)'(CONTEXTS)), .context_i(tail_q[CX-1:0]), .open_o(open),
      .header_o(header),
      .read_o, .read_at_o, .node_i, .child_o(child_read), .child_at_o(child_at), .fetch_valid_o,
      .fetch_ready_i, .fetch_slot_o, .fetch_two_o(two));
  assign fetch_tag_o = {child_at, two};

  // ---- Boxes ----
  logic fetched_q, fetched_two_q, leaf_valid, node_valid, leaf_some, node_some, unused_flag, unused_any;
  logic [CX+2:0] fetched_at_q, leaf_at, node_at, box_at;
  logic [1:0][8:0][31:0] fetched_words_q;
  logic [5:0][31:0] new_leaf, new_node, leaf_box, node_box, leaf_all, node_all;
  logic [1:0] new_bad, leaf_bad, any_bad;
  always_ff @(posedge clk_i) begin
    fetched_q <= fetched_valid_i && !rst_i;
    {fetched_at_q, fetched_two_q} <= fetched_tag_i;
    fetched_words_q <= fetched_i;
  end
  refit_leaf leaf (.clk_i, .two_i(fetched_two_q), .triangles_i(fetched_words_q), .box_o(new_leaf), .bad_o(new_bad));
  refit_node node (.clk_i, .node_i, .box_o(new_node));
  pipe_delay_valid #(.FROM(1), .TO(T_LEAF)) delay_leaf (.clk_i, .rst_i, .valid_i(fetched_q), .valid_o(leaf_valid));
  pipe_delay_valid #(.TO(T_NODE)) delay_node (.clk_i, .rst_i, .valid_i(child_read), .valid_o(node_valid));
  pipe_delay #(.W(CX + 3), .FROM(1), .TO(T_LEAF)) delay_leaf_at (.clk_i, .d_i(fetched_at_q), .q_o(leaf_at));
  pipe_delay #(.W(CX + 3), .TO(T_NODE)) delay_node_at (.clk_i, .d_i(child_at), .q_o(node_at));
  refit_boxes #(.CONTEXTS(CONTEXTS), .FLAGS(2)) leaves (
      .clk_i, .open_i(open), .open_context_i(tail_q[CX-1:0]), .write_i(leaf_valid), .write_at_i(leaf_at),
      .box_i(new_leaf), .flags_i(new_bad), .read_at_i(box_at), .box_o(leaf_box), .flags_o(leaf_bad), .some_o(leaf_some),
      .all_o(leaf_all), .any_o(any_bad));
  refit_boxes #(.CONTEXTS(CONTEXTS), .FLAGS(1)) nodes (
      .clk_i, .open_i(open), .open_context_i(tail_q[CX-1:0]), .write_i(node_valid), .write_at_i(node_at),
      .box_i(new_node), .flags_i(1'b0), .read_at_i(box_at), .box_o(node_box), .flags_o(unused_flag),
      .some_o(node_some), .all_o(node_all), .any_o(unused_any));

  logic [CHILDREN-1:0] opened;  // children of the node that opens
  for (genvar i = 0; i < CHILDREN; i++) begin : kid assign opened[i] = header[2*i+:2] != KIND_NONE; end
  for (genvar c = 0; c < CONTEXTS; c++) begin : arrivals
    logic [CHILDREN-1:0] leaf_here, node_here;
    assign leaf_here = CHILDREN'(leaf_valid && leaf_at[CX+2:3] == CX'(c)) << leaf_at[2:0];
    assign node_here = CHILDREN'(node_valid && node_at[CX+2:3] == CX'(c)) << node_at[2:0];
    always_ff @(posedge clk_i)
      missing_q[c] <= (open && tail_q[CX-1:0] == CX'(c)) ? opened : missing_q[c] & ~(leaf_here | node_here);
  end
  always_ff @(posedge clk_i) begin
    if (open) begin
      headers[tail_q[CX-1:0]] <= header;
      tail_q <= tail_q + 1;
    end
    if (leave) head_q <= head_q + 1;
    if (rst_i || start_i) {head_q, tail_q} <= '0;
  end

  // ---- The oldest node with all its boxes: the box of all children, then child after child ----
  logic [CHILDREN-1:0] rest_q, kids;
  logic [CHILDREN-1:0][1:0] kinds;
  logic [PLACE-1:0] first_slot, first_node, slot_q;
  logic [2:0] child;
  logic first, step, some, seeking_q, bad_here;
  logic [5:0][31:0] all, box;
  assign {first_slot, first_node, kinds} = headers[head];
  assign box_at = {head, child};
  assign step = rest_q != '0;
  assign first = !step && head_q != tail_q && missing_q[head] == '0 && !bad_q;
  always_comb begin
    child = '0;
    for (int i = CHILDREN - 1; i >= 0; i--) if (rest_q[i]) child = 3'(i);
  end
  for (genvar i = 0; i < CHILDREN; i++) begin : mask assign kids[i] = kinds[i] != KIND_NONE; end
  always_comb begin
    all = leaf_some ? leaf_all : node_all;
    for (int k = 0; k < 3; k++)
      if (leaf_some && node_some) begin
        if (node_all[k] < all[k]) all[k] = node_all[k];
        if (node_all[3+k] > all[3+k]) all[3+k] = node_all[3+k];
      end
    box = first ? all : (kinds[child] == KIND_NODE) ? node_box : leaf_box;
  end
  assign some = leaf_some && any_bad != '0;
  assign leave = (first && kids == '0) || (step && (rest_q & (rest_q - 1)) == '0);
  assign bad_here = step && seeking_q && !bad_q && kinds[child] != KIND_NODE && leaf_bad != '0;
  always_ff @(posedge clk_i) begin
    if (step) begin
      rest_q <= rest_q & (rest_q - 1);
      if (kinds[child] == KIND_ONE) slot_q <= slot_q + 1;
      if (kinds[child] == KIND_TWO) slot_q <= slot_q + 2;
    end
    if (first) begin
      rest_q <= kids;
      slot_q <= first_slot;
      seeking_q <= some;
    end
    if (bad_here) begin
      bad_q <= 1'b1;
      bad_slot_o <= slot_q + PLACE'(!leaf_bad[0]);
    end
    if (rst_i || start_i) {rest_q, bad_q} <= '0;
  end

  // ---- Words ----
  logic encoded, childless;
  refit_encode encode (
      .clk_i, .rst_i, .valid_i((first && !some) || (step && !seeking_q)), .first_i(first), .last_i(leave),
      .child_i(child), .box_i(box), .header_i(headers[head]), .valid_o(encoded), .node_o);
  // A node without children keeps its words.
  assign childless = kinds_of(node_o) == '0;
  assign write_o = encoded && !childless;
  assign write_at_o = written_q - 1;
  always_ff @(posedge clk_i) begin
    if (encoded) written_q <= written_q - 1;
    if (start_i) written_q <= node_count_i;
  end
  always_ff @(posedge clk_i)
    recent_q <= rst_i ? '0 : {recent_q[6:0], first || step || child_read || fetched_valid_i || outstanding_q != '0};

  logic unused;
  assign unused = &{1'b0, first_node, unused_flag, unused_any};

`ifndef SYNTHESIS
  always_ff @(posedge clk_i)
    if (!rst_i) begin
      assert (!(start_i && busy_q)) else $error("refit: started while busy");
      assert (!(fetched_valid_i && outstanding_q == '0)) else $error("refit: answer without a request");
    end
`endif
endmodule
