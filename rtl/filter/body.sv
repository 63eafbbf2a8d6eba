// SPDX-License-Identifier: Apache-2.0
// Splits a shape into its origin (centre or first corner), its words relative to that, and its reach. The reach bounds
// the distance from the origin to any point of the shape. Sphere: r. Box: the sum of the half extents, 2 add. Triangle
// and AABB: corners less the origin, and their sizes; 11 add and 5 add.
// Latency: LATENCY_BODY_REST, LATENCY_BODY_REACH (`filter.svh`); 0 with ARITH = "host".
// Throughput: one shape per lane per cycle.
// Stall: none.
`include "filter.svh"
module body #(
    `DF_PARAMETERS,
    parameter int SHAPE = pairs_pkg::SHAPE_SPHERE,
    localparam int WORDS = pairs_pkg::shape_words(SHAPE)
) (
    input logic clk_i,
    input logic [WORDS-1:0][LANES-1:0][CW-1:0] words_i,
    output logic [WORDS-4:0][LANES-1:0][CW-1:0] rest_o,
    output logic [LANES-1:0][CW-1:0] reach_o
);
  /*verilator inline_module*/
  if (SHAPE == pairs_pkg::SHAPE_SPHERE) begin : g_sphere
    logic unused;
    assign unused = &{1'b0, clk_i, words_i[2:0]};
    assign rest_o = words_i[3];
    assign reach_o = words_i[3];
  end else if (SHAPE == pairs_pkg::SHAPE_OBB) begin : g_obb
    `DF_IN(x, words_i[3], 0)
    `DF_IN(y, words_i[4], 0)
    `DF_IN(z, words_i[5], 0)
    `DF_ADD(xy, x, y)
    `DF_ADD(xyz, xy, z)
    if (T_xyz != `LATENCY_BODY_REACH(SHAPE)) $error("body: latency");
    logic unused;
    assign unused = &{1'b0, words_i[2:0]};
    assign rest_o = words_i[WORDS-1:3];
    assign reach_o = xyz;
  end else if (SHAPE == pairs_pkg::SHAPE_TRIANGLE) begin : g_triangle
    `DF_VIN(v0, words_i[2:0], 0)
    `DF_VIN(v1, words_i[5:3], 0)
    `DF_VIN(v2, words_i[8:6], 0)
    `DF_VSUB(e1, v1, v0)
    `DF_VSUB(e2, v2, v0)
    `DF_NORM1(size1, e1)
    `DF_NORM1(size2, e2)
    `DF_ADD(sizes, size1, size2)
    if (T_sizes != `LATENCY_BODY_REACH(SHAPE) || T_e2 != `LATENCY_BODY_REST(SHAPE)) $error("body: latency");
    assign rest_o = {e2, e1};
    assign reach_o = sizes;
  end else if (SHAPE == pairs_pkg::SHAPE_AABB) begin : g_aabb
    `DF_VIN(low, words_i[2:0], 0)
    `DF_VIN(high, words_i[5:3], 0)
    `DF_VSUB(edges, high, low)
    `DF_NORM1(sizes, edges)
    if (T_sizes != `LATENCY_BODY_REACH(SHAPE) || T_edges != `LATENCY_BODY_REST(SHAPE)) $error("body: latency");
    assign rest_o = edges;
    assign reach_o = sizes;
  end else begin : g_illegal
    $error("body: no such SHAPE");
  end
endmodule
