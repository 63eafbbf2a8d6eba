// SPDX-License-Identifier: Apache-2.0
// Visits the nodes of a BVH from the last to the first, with their children: requests leaves, and reads nodes that
// have been written. A node opens when a context is free. The next node's words are read ahead, in a cycle without a
// child read.
// Latency: 3 cycles to the first child.
// Throughput: one child per cycle.
// Stall: fetch_ready_i, context_free_i, written_i.
module refit_traversal #(
    parameter int CX = 3,  // bits of a context's number, >= 1
    localparam int HEADER = 2 * bvh_pkg::PLACE + 16
) (
    input logic clk_i,
    input logic rst_i,
    input logic start_i,
    input logic stop_i,  // no more requests
    input logic [bvh_pkg::PLACE-1:0] first_i,  // the last node to open
    input logic [bvh_pkg::PLACE-1:0] count_i,
    input logic [bvh_pkg::PLACE-1:0] written_i,  // this node and those after it have been written
    // Contexts.
    input logic context_free_i,
    input logic [CX-1:0] context_i,  // the next free context
    output logic open_o,
    output logic [HEADER-1:0] header_o,  // of the node that opens the context: first slot, first node, kinds
    // Node memory.
    output logic read_o,
    output logic [bvh_pkg::PLACE-1:0] read_at_o,
    input bvh_pkg::node_t node_i,  // read by the previous cycle's address
    output logic child_o,            // the node read is a child
    output logic [CX+2:0] child_at_o,  // context and child of the node read and of the leaf requested
    // Leaves.
    output logic fetch_valid_o,
    input logic fetch_ready_i,
    output logic [bvh_pkg::PLACE-1:0] fetch_slot_o,
    output logic fetch_two_o
);
  import bvh_pkg::*;

  // ---- The next node's words ----
  logic [PLACE-1:0] remaining_q;  // nodes not read yet
  logic due_q, header_q, read_header;
  logic [HEADER-1:0] words_q;
  always_ff @(posedge clk_i) begin
    due_q <= read_header;
    if (read_header) remaining_q <= remaining_q - 1;
    if (open_o) header_q <= 1'b0;
    if (due_q) begin
      header_q <= 1'b1;
      words_q <= {first_slot_of(node_i), first_node_of(node_i), kinds_of(node_i)};
    end
    if (rst_i || stop_i) {due_q, header_q, remaining_q} <= '0;
    if (start_i) remaining_q <= count_i - first_i;
  end

  // ---- Children of the open node, from the first on ----
  logic [CX-1:0] context_q;
  logic [CHILDREN-1:0] rest_q, kids;
  logic [CHILDREN-1:0][1:0] kinds_q;
  logic [PLACE-1:0] node_q, slot_q;
  logic [2:0] child;
  logic is_node, read_child, taken, last;
  always_comb begin
    child = '0;
    for (int i = CHILDREN - 1; i >= 0; i--) if (rest_q[i]) child = 3'(i);
    for (int i = 0; i < CHILDREN; i++) kids[i] = words_q[2*i+:2] != KIND_NONE;
  end
  assign is_node = kinds_q[child] == KIND_NODE;
  assign read_child = rest_q != '0 && is_node && node_q >= written_i;
  assign fetch_valid_o = rest_q != '0 && !is_node;
  assign fetch_slot_o = slot_q;
  assign fetch_two_o = kinds_q[child] == KIND_TWO;
  assign taken = read_child || (fetch_valid_o && fetch_ready_i);
  assign last = taken && (rest_q & (rest_q - 1)) == '0;
  assign open_o = header_q && context_free_i && (rest_q == '0 || last) && !stop_i;
  assign header_o = words_q;
  always_ff @(posedge clk_i) begin
    if (taken) begin
      rest_q <= rest_q & (rest_q - 1);
      if (is_node) node_q <= node_q + 1;
      else slot_q <= slot_q + 1 + PLACE'(fetch_two_o);
    end
    if (open_o) begin
      context_q <= context_i;
      rest_q <= kids;
      {slot_q, node_q, kinds_q} <= words_q;
    end
    if (rst_i || stop_i) rest_q <= '0;
  end

  // ---- Node reads ----
  assign read_header = !read_child && remaining_q != '0 && !due_q && (!header_q || open_o);
  assign read_o = read_child || read_header;
  assign read_at_o = read_child ? node_q : first_i + remaining_q - 1;
  assign child_o = read_child;
  assign child_at_o = {context_q, child};
endmodule
