// SPDX-License-Identifier: Apache-2.0
// Stage times of the box rule for pairs with a signed distance (reference/pipes/distance_bound.hpp).
`ifndef CDE_DISTANCE_BOUND_SVH
`define CDE_DISTANCE_BOUND_SVH
`include "convex.svh"

// Outputs of solid_half.sv.
`define SOLID_T_HALF(SHAPE) ((SHAPE == pairs_pkg::SHAPE_OBB) ? `DF_LAT_DOT : 0)
`define SOLID_HALF(R, OF, WORDS) \
  localparam int T_``R = `SOLID_T_HALF(OF); \
  `DF_VECTOR R; \
  solid_half #(`DF_SAME, .SHAPE(OF)) half_``R (.clk_i, .a_i(WORDS), .half_o(R));
// Outputs of shape_hull.sv.
`define SHAPE_T_HULL(SHAPE) ((SHAPE == pairs_pkg::SHAPE_TRIANGLE) ? 2 * LAT.cmp : 0)
`define SHAPE_HULL(LOW, HIGH, OF, WORDS) \
  localparam int T_``LOW = `SHAPE_T_HULL(OF), T_``HIGH = `SHAPE_T_HULL(OF); \
  `DF_VECTOR LOW, HIGH; \
  shape_hull #(`DF_SAME, .SHAPE(OF)) hull_``LOW (.clk_i, .a_i(WORDS), .low_o(LOW), .high_o(HIGH));
// Stage times of distance_bound.sv: half sizes of both shapes, distance, extent, and the result.
`define SHAPE_IS_SOLID(SHAPE) (SHAPE == pairs_pkg::SHAPE_SPHERE || SHAPE == pairs_pkg::SHAPE_OBB)
`define DISTANCE_T_HALF(A, B) (`DF_MAX2(`SOLID_T_HALF(A), `SOLID_T_HALF(B)) + \
  ((`SHAPE_IS_SOLID(A) && `SHAPE_IS_SOLID(B)) ? LAT.add : 0))
`define DISTANCE_T_AWAY(A, B) (`DF_MAX2(`SHAPE_T_HULL(A), `SHAPE_T_HULL(B)) + LAT.add + LAT.cmp)
`define DISTANCE_T_BOUND(A, B) (`DF_MAX2(`DISTANCE_T_AWAY(A, B), `DISTANCE_T_HALF(A, B)) + LAT.cmp + LAT.mul + \
  2 * LAT.add + `DF_MAX3(LAT.cmp, 2 * LAT.add + LAT.sqrt, 2 * LAT.cmp - LAT.mul))
`endif
