// SPDX-License-Identifier: Apache-2.0
// The order in which a node's children are visited: those that are hit by ascending key, ties by number. Each pair of
// keys is compared once: 28 comparisons.
// Latency: NODE_T_ORDER cycles (bvh.svh).
// Throughput: one node per cycle.
// Stall: none, runs free.
`include "bvh.svh"
module node_order #(
    parameter int KEY = bvh_pkg::RAY_KEY,  // bits of a key
    parameter int STORED = KEY,            // bits of a key on the stack
    localparam int CHILDREN = bvh_pkg::CHILDREN
) (
    input logic clk_i,
    input logic [CHILDREN-1:0] met_i,
    input logic [CHILDREN-1:0][KEY-1:0] key_i,
    input logic [CHILDREN-1:0][STORED-1:0] stored_i,
    // The number of hit children; their numbers in order; the stored keys of all children, by number. Numbers after
    // the hit children are not used.
    output logic [4+CHILDREN*(3+STORED)-1:0] found_o
);
  /*verilator inline_module*/
  if (`NODE_T_ORDER != 3) $error("node_order: NODE_T_ORDER does not match");

  // ---- Comparisons. A child that is not hit is behind those that are ----
  logic [CHILDREN-1:0] met_1;
  logic [CHILDREN-1:0][STORED-1:0] stored_1, stored_2;
  logic [CHILDREN-1:0][CHILDREN-1:0] behind, behind_1;  // i is after k, for k < i
  for (genvar i = 0; i < CHILDREN; i++) begin : child
    for (genvar k = 0; k < CHILDREN; k++) begin : other
      assign behind[i][k] = k < i && {!met_i[k], key_i[k]} <= {!met_i[i], key_i[i]};
    end
  end
  always_ff @(posedge clk_i) {met_1, stored_1, behind_1} <= {met_i, stored_i, behind};

  // ---- Ranks: the number of children before a child, of all eight ----
  logic [CHILDREN-1:0][2:0] rank, rank_2;
  logic [3:0] count, count_2;
  always_comb begin
    {rank, count} = '0;
    for (int i = 0; i < CHILDREN; i++) begin
      count = count + {3'b0, met_1[i]};
      for (int k = 0; k < CHILDREN; k++)
        if (k != i) rank[i] = rank[i] + {2'b0, (k < i) ? behind_1[i][k] : !behind_1[k][i]};
    end
  end
  always_ff @(posedge clk_i) {rank_2, count_2, stored_2} <= {rank, count, stored_1};

  // ---- In order ----
  logic [CHILDREN-1:0][2:0] order;
  always_comb begin
    order = '0;
    for (int i = 0; i < CHILDREN; i++) order[rank_2[i]] = 3'(i);
  end
  always_ff @(posedge clk_i) found_o <= {count_2, order, stored_2};
endmodule
