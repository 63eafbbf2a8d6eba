// SPDX-License-Identifier: Apache-2.0
// Finds which of a node's boxes a ray hits, and the order of visits: by near, or by far descending, ties by number.
// Comparisons are on integers, as ordered words: 28 of keys, 3 per child.
// Latency: 1 cycle.
// Throughput: one node per cycle.
// Stall: none, runs free.
module node_order #(
    localparam int CHILDREN = bvh_pkg::CHILDREN
) (
    input logic clk_i,
    input logic [CHILDREN-1:0][31:0] near_i,  // T interval of the ray in each box, with far_i; a NaN is canonical
    input logic [CHILDREN-1:0][31:0] far_i,
    input logic [CHILDREN-1:0][1:0] kinds_i,
    input logic [31:0] floor_i,  // lowest T that counts
    input logic [31:0] limit_i,  // highest T that counts
    input logic farthest_i,
    // The number of hit children; their numbers in order; upper halves of near or far in that order. Entries after the
    // hit children are not used.
    output logic [4+CHILDREN*(3+16)-1:0] found_o
);
  /*verilator inline_module*/
  import bvh_pkg::*;
  // ---- Hit: the ray's interval in the box is not empty and overlaps the T that counts. Keys: the least key is first
  // in the order. The key of a child that is not hit is above the key of every number ----
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

  // ---- Order: the rank of a child counts the children before it, of all eight. Each two are compared once ----
  logic [CHILDREN-1:0][CHILDREN-1:0] behind;  // i is after k, for k < i
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
