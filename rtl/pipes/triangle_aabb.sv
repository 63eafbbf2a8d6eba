// SPDX-License-Identifier: Apache-2.0
// Triangle against axis-aligned box. Positions are relative to the box's lower corner first, then to its centre, so the
// centre is never rounded in world coordinates (triangle_box.sv). The signed distance is s, n points from the triangle
// to the box, and CP is the midpoint of the witness points. F = (s <= 0), T = |s|.
// Operators: 477 add, 534 mul, 16 div, 11 sqrt, 128 compare, 127 min/max.
// With SAT_II = 3, candidate axes share units. Operators then: 335 add, 336 mul, 10 div, 5 sqrt, 102 compare, 79
// min/max.
// Latency: LATENCY cycles; 0 with ARITH = "host".
// Throughput: LANES pairs per SAT_II cycles.
// Stall: none, runs free.
`include "triangle.svh"
module triangle_aabb #(
    `DF_PARAMETERS,
    parameter int SAT_II = 1  // 1 or 3
) (
    input logic clk_i,
    input logic enter_i,  // a pair enters; used with SAT_II = 3
    input logic [8:0][LANES-1:0][CW-1:0] a_i,  // triangle: v0 x y z, v1, v2
    input logic [5:0][LANES-1:0][CW-1:0] b_i,  // AABB: min x y z, max
    `DISTANCE_OUTPUTS
);
  /*verilator inline_module*/
  localparam logic [CW-1:0] HALF = ((CW'(1) << (EXP - 1)) - 2) << MAN;
  localparam int T_IN = `SAT_T_IN;
  logic [8:0][LANES-1:0][CW-1:0] triangle;
  logic [5:0][LANES-1:0][CW-1:0] box;
  logic [1:0] phase_in;
  pair_hold #(.SAT_II(SAT_II), .A_BITS(9 * LANES * CW), .B_BITS(6 * LANES * CW), .ARITH(ARITH)) hold (
      .clk_i, .enter_i, .a_i, .b_i, .a_o(triangle), .b_o(box), .phase_o(phase_in));
  `DF_PHASE_IN(phase, phase_in, T_IN)
  `DF_MATRIX_IN(vertices, triangle[2:0], triangle[5:3], triangle[8:6], T_IN)
  `DF_VIN(low, box[2:0], T_IN)
  `DF_MATRIX_IN(lows, box[2:0], box[2:0], box[2:0], T_IN)
  `DF_VIN(high, box[5:3], T_IN)
  `DF_CONST(half, HALF)

  `DF_VSUB(widths, high, low)
  `DF_VSCALE(extents, widths, half)
  `DF_MAT(centres, extents, extents, extents)
  `DF_MSUB(from_low, vertices, lows)
  `DF_MSUB(p, from_low, centres)
  logic [LANES-1:0][CW-1:0] s_found;
  logic [2:0][LANES-1:0][CW-1:0] n_found, middle_found;
  `DF_PHASE_AT(phase_p, phase, T_p)
  `DF_VAT(half_p, extents, T_p)
  triangle_box #(`DF_SAME, .SAT_II(SAT_II)) signed_distance (
      .clk_i, .phase_i(phase_p), .a_i(half_p), .p_i(p), .s_o(s_found), .n_o(n_found), .middle_o(middle_found));
  `DF_IN(s, s_found, T_p + `LATENCY_TRIANGLE_BOX)
  `DF_VIN(n_box, n_found, T_p + `LATENCY_TRIANGLE_BOX)
  `DF_VIN(middle, middle_found, T_p + `LATENCY_TRIANGLE_BOX)
  `DF_VADD(from_corner, half_p, middle)
  `DF_VADD(cp, low, from_corner)
  `DF_VNEG(n, n_box)

  `DISTANCE_RESULT(s, cp, n)
endmodule
