// SPDX-License-Identifier: Apache-2.0
// Lower bound of the signed distance of two shapes, from their boxes (reference/pipes/distance_bound.hpp).
// It is the distance of boxes that are apart, else the largest distance on an axis. Subtracted is 128 u of the largest
// extent of both boxes along an axis. A solid's box is its centre and half size.
// Operators: 4 mul, 5 add, 10 sub, 1 sqrt, 1 compare, 13 min/max. Each OBB adds 9 mul, 6 add, each triangle 12 min/max,
// and two solids 3 add.
// Latency: DISTANCE_T_BOUND cycles (distance_bound.svh); 0 with ARITH = "host".
// Throughput: LANES pairs per cycle.
// Stall: none.
`include "distance_bound.svh"
module distance_bound #(
    `DF_PARAMETERS,
    parameter int A_SHAPE = pairs_pkg::SHAPE_TRIANGLE,  // sphere, OBB, triangle or AABB
    parameter int B_SHAPE = pairs_pkg::SHAPE_SPHERE,
    localparam int A_WORDS = pairs_pkg::shape_words(A_SHAPE),
    localparam int B_WORDS = pairs_pkg::shape_words(B_SHAPE)
) (
    input logic clk_i,
    input logic [A_WORDS-1:0][LANES-1:0][CW-1:0] a_i,
    input logic [B_WORDS-1:0][LANES-1:0][CW-1:0] b_i,
    output logic [LANES-1:0][CW-1:0] bound_o
);
  /*verilator inline_module*/
  `DF_CONST(share, `DF_POWER_OF_TWO(6 - MAN))
  `SOLID_HALF(a_half, A_SHAPE, a_i)
  `SOLID_HALF(b_half, B_SHAPE, b_i)
  localparam int T_half = `DISTANCE_T_HALF(A_SHAPE, B_SHAPE);
  `DF_VECTOR half;
  if (`SHAPE_IS_SOLID(A_SHAPE) && `SHAPE_IS_SOLID(B_SHAPE)) begin : g_solids
    `DF_VADD(both, a_half, b_half)
    assign half = both;
  end else begin : g_one
    assign half = `SHAPE_IS_SOLID(A_SHAPE) ? a_half : b_half;
    logic unused_half;
    assign unused_half = &{1'b0, a_half, b_half};
  end
  `SHAPE_HULL(low, high, A_SHAPE, a_i)
  `SHAPE_HULL(b_low, b_high, B_SHAPE, b_i)
  `DF_VSUB(below, low, b_high)
  `DF_VSUB(above, b_low, high)
  `DF_VMAX(away, below, above)
  `DF_VSUB(distances, away, half)
  `DF_VABS(below_size, below)
  `DF_VABS(above_size, above)
  `DF_VMAX(reach, below_size, above_size)
  `DF_VADD(size, reach, half)

  `DF_PICK(size_x, size, 0)
  `DF_PICK(size_y, size, 1)
  `DF_PICK(size_z, size, 2)
  `DF_MAX(size_xy, size_x, size_y)
  `DF_MAX(most, size_xy, size_z)
  `DF_MUL(margin, most, share)
  `DF_PICK(distance_x, distances, 0)
  `DF_PICK(distance_y, distances, 1)
  `DF_PICK(distance_z, distances, 2)
  `DF_MAX(distance_xy, distance_x, distance_y)
  `DF_MAX(widest, distance_xy, distance_z)
  `DF_CONST(zero, 0)
  `DF_VCONST(zeros, 0, 0, 0)
  `DF_LT(apart, zero, widest)
  `DF_VMAX(clamped, distances, zeros)
  `DF_DOT(square, clamped, clamped)
  `DF_SQRT(distance, square)
  `DF_SELECT(least, apart, distance, widest)
  `DF_SUB(bound, least, margin)
  if (T_bound != `DISTANCE_T_BOUND(A_SHAPE, B_SHAPE)) $error("distance_bound: DISTANCE_T_BOUND does not match");
  assign bound_o = bound;
endmodule
