// SPDX-License-Identifier: Apache-2.0
// Certified filters: stage times of the parts, and operators that two parts share.
// See docs/background/certified_filters.md and `host/include/cde/reference/filter/`.
`ifndef CDE_FILTER_SVH
`define CDE_FILTER_SVH
`include "convex.svh"

// ---- body.sv: stage times of the words relative to a shape's origin, and of its reach ----
`define BODY_CORNERS(SHAPE) ((SHAPE) == pairs_pkg::SHAPE_TRIANGLE || (SHAPE) == pairs_pkg::SHAPE_AABB)
`define LATENCY_BODY_REST(SHAPE) (`BODY_CORNERS(SHAPE) ? LAT.add : 0)
`define LATENCY_BODY_REACH(SHAPE) (`LATENCY_BODY_REST(SHAPE) + (((SHAPE) == pairs_pkg::SHAPE_TRIANGLE) ? 3 * LAT.add : \
  ((SHAPE) == pairs_pkg::SHAPE_SPHERE) ? 0 : 2 * LAT.add))
// ---- body_support.sv: stage time of its result, from the times of its operands ----
`define T_SUPPORT(SHAPE, T_REST, T_N, T_NN) (((SHAPE) == pairs_pkg::SHAPE_SPHERE) ? (T_NN) + LAT.add + 2 * LAT.mul : \
  ((SHAPE) == pairs_pkg::SHAPE_OBB) ? `DF_MAX2(T_REST, T_N) + 2 * `DF_LAT_DOT : \
  ((SHAPE) == pairs_pkg::SHAPE_TRIANGLE) ? `DF_MAX2(T_REST, T_N) + `DF_LAT_DOT + 2 * LAT.cmp : \
  `DF_MAX2(T_REST, (T_N) + LAT.cmp) + `DF_LAT_DOT)

// Shapes relative to their origins: rest_a and rest_b, the vector between the origins, and S, the sum of all sizes
// (docs/background/certified_filters.md). Inputs: a_i and b_i at time 0, SHAPE_A, SHAPE_B.
`define PAIR_SIZE \
  localparam int T_rest_a = `LATENCY_BODY_REST(SHAPE_A); \
  localparam int T_rest_b = `LATENCY_BODY_REST(SHAPE_B); \
  localparam int T_reach_a = `LATENCY_BODY_REACH(SHAPE_A); \
  localparam int T_reach_b = `LATENCY_BODY_REACH(SHAPE_B); \
  logic [A_WORDS-4:0][LANES-1:0][CW-1:0] rest_a; \
  logic [B_WORDS-4:0][LANES-1:0][CW-1:0] rest_b; \
  `DF_SCALAR reach_a; \
  `DF_SCALAR reach_b; \
  body #(`DF_SAME, .SHAPE(SHAPE_A)) body_a (.clk_i, .words_i(a_i), .rest_o(rest_a), .reach_o(reach_a)); \
  body #(`DF_SAME, .SHAPE(SHAPE_B)) body_b (.clk_i, .words_i(b_i), .rest_o(rest_b), .reach_o(reach_b)); \
  `DF_VIN(origin_a, a_i[2:0], 0) \
  `DF_VIN(origin_b, b_i[2:0], 0) \
  `DF_VSUB(between, origin_b, origin_a) \
  `DF_NORM1(apart, between) \
  `DF_ADD(reach, reach_a, reach_b) \
  `DF_ADD(size, reach, apart)
`endif
