// SPDX-License-Identifier: Apache-2.0
// Lowest and highest points of a shape, per axis (reference/pipes/distance_bound.hpp). They are a triangle's least and
// largest coordinates, an AABB's corners, or a solid's centre, which solid_half.sv extends.
// Operators: 12 min/max for a triangle, else none.
// Latency: SHAPE_T_HULL cycles (distance_bound.svh); 0 with ARITH = "host".
// Throughput: LANES shapes per cycle.
// Stall: none.
`include "distance_bound.svh"
module shape_hull #(
    `DF_PARAMETERS,
    parameter int SHAPE = pairs_pkg::SHAPE_SPHERE,  // sphere, OBB, triangle or AABB
    localparam int WORDS = pairs_pkg::shape_words(SHAPE)
) (
    input logic clk_i,
    input logic [WORDS-1:0][LANES-1:0][CW-1:0] a_i,
    output logic [2:0][LANES-1:0][CW-1:0] low_o,
    output logic [2:0][LANES-1:0][CW-1:0] high_o
);
  /*verilator inline_module*/
  if (SHAPE == pairs_pkg::SHAPE_TRIANGLE) begin : g_triangle
    `DF_VIN(v0, a_i[2:0], 0)
    `DF_VIN(v1, a_i[5:3], 0)
    `DF_VIN(v2, a_i[8:6], 0)
    `DF_VMIN(low_01, v0, v1)
    `DF_VMIN(low, low_01, v2)
    `DF_VMAX(high_01, v0, v1)
    `DF_VMAX(high, high_01, v2)
    if (T_low != `SHAPE_T_HULL(SHAPE)) $error("shape_hull: SHAPE_T_HULL does not match");
    assign {high_o, low_o} = {high, low};
  end else if (SHAPE == pairs_pkg::SHAPE_AABB) begin : g_aabb
    assign {high_o, low_o} = a_i;
    logic unused;
    assign unused = clk_i;
  end else begin : g_solid
    assign {high_o, low_o} = {2{a_i[2:0]}};
    logic unused;
    assign unused = &{1'b0, a_i[WORDS-1:3], clk_i};
  end
endmodule
