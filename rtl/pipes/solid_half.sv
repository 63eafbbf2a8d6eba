// SPDX-License-Identifier: Apache-2.0
// Half size of a solid's own box, per axis (reference/pipes/distance_bound.hpp). It is r for a sphere and |R| h for an
// OBB.
// It is 0 for a triangle or an AABB, whose box shape_hull.sv gives. OBB: 9 mul, 6 add.
// Latency: SOLID_T_HALF cycles (distance_bound.svh); 0 with ARITH = "host".
// Throughput: LANES solids per cycle.
// Stall: none.
`include "distance_bound.svh"
module solid_half #(
    `DF_PARAMETERS,
    parameter int SHAPE = pairs_pkg::SHAPE_SPHERE,  // sphere, OBB, triangle or AABB
    localparam int WORDS = pairs_pkg::shape_words(SHAPE)
) (
    input logic clk_i,
    input logic [WORDS-1:0][LANES-1:0][CW-1:0] a_i,
    output logic [2:0][LANES-1:0][CW-1:0] half_o
);
  /*verilator inline_module*/
  if (SHAPE == pairs_pkg::SHAPE_OBB) begin : g_obb
    `DF_VIN(extents, a_i[5:3], 0)
    `DF_VIN(row_0, a_i[8:6], 0)
    `DF_VIN(row_1, a_i[11:9], 0)
    `DF_VIN(row_2, a_i[14:12], 0)
    `DF_BOX_RADIUS(radius_0, row_0, extents)
    `DF_BOX_RADIUS(radius_1, row_1, extents)
    `DF_BOX_RADIUS(radius_2, row_2, extents)
    if (T_radius_0 != `SOLID_T_HALF(SHAPE)) $error("solid_half: SOLID_T_HALF does not match");
    assign half_o = {radius_2, radius_1, radius_0};
    logic unused_c;
    assign unused_c = &{1'b0, a_i[2:0]};
  end else if (SHAPE == pairs_pkg::SHAPE_SPHERE) begin : g_sphere
    assign half_o = {3{a_i[3]}};
    logic unused_c;
    assign unused_c = &{1'b0, a_i[2:0], clk_i};
  end else if (SHAPE == pairs_pkg::SHAPE_TRIANGLE || SHAPE == pairs_pkg::SHAPE_AABB) begin : g_hull
    assign half_o = '0;
    logic unused;
    assign unused = &{1'b0, a_i, clk_i};
  end else begin : g_illegal
    $error("solid_half: SHAPE must be a sphere, OBB, triangle or AABB");
  end
endmodule
