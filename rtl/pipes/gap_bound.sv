// SPDX-License-Identifier: Apache-2.0
// What the signed gap of a triangle and a sphere or OBB is not below, as their boxes say: the largest gap of an axis,
// less 128 u of how far the triangle's box reaches from the solid's centre and the solid from there
// (reference/pipes/gap_bound.hpp).
// 1 mul, 3 add, 10 sub, 22 min/max; of an OBB 9 mul, 6 add more.
// Latency: GAP_T_BOUND clocks (gap_bound.svh); 0 with ARITH = "host". Throughput: LANES pairs a clock. Stall: none.
`include "gap_bound.svh"
module gap_bound #(
    `DF_PARAMETERS,
    parameter int SHAPE = pairs_pkg::SHAPE_SPHERE,  // of the solid: sphere or OBB
    localparam int B_WORDS = pairs_pkg::shape_words(SHAPE)
) (
    input logic clk_i,
    input logic [8:0][LANES-1:0][CW-1:0] a_i,  // triangle: v0 x y z, v1, v2
    input logic [B_WORDS-1:0][LANES-1:0][CW-1:0] b_i,
    output logic [LANES-1:0][CW-1:0] bound_o
);
  /*verilator inline_module*/
  `DF_VIN(v0, a_i[2:0], 0)
  `DF_VIN(v1, a_i[5:3], 0)
  `DF_VIN(v2, a_i[8:6], 0)
  `DF_VIN(c, b_i[2:0], 0)
  `DF_CONST(share, `DF_POWER_OF_TWO(6 - MAN))
  `SOLID_HALF(half, SHAPE, b_i)

  `DF_VMIN(low_01, v0, v1)
  `DF_VMIN(low, low_01, v2)
  `DF_VMAX(high_01, v0, v1)
  `DF_VMAX(high, high_01, v2)
  `DF_VSUB(below, low, c)
  `DF_VSUB(above, c, high)
  `DF_VMAX(away, below, above)
  `DF_VSUB(gap, away, half)
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
  `DF_PICK(gap_x, gap, 0)
  `DF_PICK(gap_y, gap, 1)
  `DF_PICK(gap_z, gap, 2)
  `DF_MAX(gap_xy, gap_x, gap_y)
  `DF_MAX(widest, gap_xy, gap_z)
  `DF_SUB(bound, widest, margin)
  if (T_bound != `GAP_T_BOUND(SHAPE)) $error("gap_bound: GAP_T_BOUND is another");
  assign bound_o = bound;
endmodule
