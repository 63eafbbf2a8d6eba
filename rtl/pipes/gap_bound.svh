// SPDX-License-Identifier: Apache-2.0
// Stage times of the box rule of triangles and solids (reference/pipes/gap_bound.hpp).
`ifndef CDE_GAP_BOUND_SVH
`define CDE_GAP_BOUND_SVH
`include "convex.svh"

// Of solid_half.sv.
`define SOLID_T_HALF(SHAPE) ((SHAPE == pairs_pkg::SHAPE_OBB) ? `DF_LAT_DOT : 0)
`define SOLID_HALF(R, SHAPE, WORDS) \
  localparam int T_``R = `SOLID_T_HALF(SHAPE); \
  `DF_VECTOR R; \
  solid_half #(`DF_SAME, .SHAPE(SHAPE)) half_``R (.clk_i, .a_i(WORDS), .half_o(R));
// Of gap_bound.sv.
`define GAP_T_BOUND(SHAPE) (`DF_MAX2(3 * LAT_CMP + LAT_ADD, `SOLID_T_HALF(SHAPE)) + 2 * LAT_CMP + LAT_MUL + 2 * LAT_ADD)
`endif
