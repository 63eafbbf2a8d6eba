// SPDX-License-Identifier: Apache-2.0
// Which of a node's boxes a ray meets, and in what order they are visited: by near, or by far downwards. Ties by
// number. Comparisons are of whole numbers, as words in order: 28 of keys, 3 a child.
// Latency: 1 cycle.
// Throughput: one node per cycle.
// Stall: none, runs free.
module node_order #(
    localparam int CHILDREN = hierarchy_pkg::CHILDREN
) (
    input logic clk_i,
    input logic [CHILDREN-1:0][31:0] near_i,  // where the ray is in each box, in T; a NaN is the canonical one
    input logic [CHILDREN-1:0][31:0] far_i,
    input logic [CHILDREN-1:0][1:0] kinds_i,
    input logic [31:0] floor_i,  // T that counts: from here
    input logic [31:0] limit_i,  // to here
    input logic farthest_i,
    // How many are met; their numbers in order; in that order halves of near or far. What is behind those that are met
    // is not looked at.
    output logic [4+CHILDREN*(3+16)-1:0] found_o
);
  /*verilator inline_module*/
  import hierarchy_pkg::*;
  // ---- Met: the ray is in the box somewhere, and where it counts. Keys: the one that comes first is the least; those
  // of children that are not met are above all others, which come of numbers ----
  logic [CHILDREN-1:0] meets, met_q;
  logic [CHILDREN-1:0][31:0] key, key_q;
  logic [CHILDREN-1:0][15:0] half_key, half_q;
  for (genvar i = 0; i < CHILDREN; i++) begin : child
    logic [31:0] n, f;
    assign n = ordered(near_i[i]);
    assign f = ordered(far_i[i]);
    assign meets[i] = kinds_i[i] != KIND_NONE && n <= f && f >= ordered(floor_i) && n <= ordered(limit_i);
    assign key[i] = (farthest_i ? ~f : n) | {32{!meets[i]}};
    assign half_key[i] = half(farthest_i ? far_i[i] : near_i[i], farthest_i);
  end
  always_ff @(posedge clk_i) {met_q, key_q, half_q} <= {meets, key, half_key};

  // ---- Order: how many come before each, of all eight. Of two one comes before the other: they are compared once ----
  logic [CHILDREN-1:0][CHILDREN-1:0] behind;  // i comes behind k < i
  logic [CHILDREN-1:0][2:0] rank;
  for (genvar i = 0; i < CHILDREN; i++) begin : place
    for (genvar k = 0; k < CHILDREN; k++) begin : other
      assign behind[i][k] = k < i && key_q[k] <= key_q[i];
    end
    logic [2:0] r;
    always_comb begin
      r = 0;
      for (int k = 0; k < CHILDREN; k++) if (k != i) r = r + {2'b0, (k < i) ? behind[i][k] : !behind[k][i]};
    end
    assign rank[i] = r;
  end
  logic [3:0] count;
  logic [CHILDREN-1:0][2:0] order;
  logic [CHILDREN-1:0][15:0] keys;
  always_comb begin
    {count, order, keys} = '0;
    for (int i = 0; i < CHILDREN; i++) begin
      count = count + {3'b0, met_q[i]};
      order[rank[i]] = 3'(i);
      keys[rank[i]] = half_q[i];
    end
  end
  assign found_o = {count, order, keys};
endmodule
