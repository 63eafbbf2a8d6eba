// SPDX-License-Identifier: Apache-2.0
// Prepares a solid or a triangle for the nodes of a BVH, once per primary (solid_front() of
// reference/pipes/solid_node.hpp). Its outputs are the upper corner of its box plus M, and the lower corner less M.
// M widens the boxes: M = 2^-16 (R + e) + 16 u W. R is the largest distance along an axis from the centre to the root's
// box. The term e is half the size of the solid's own box. For a triangle, R is measured from end to end of both boxes,
// and e is 0.
// Operators: 1 mul, 8 add, 12 sub, 7 max; an OBB also 9 mul, 6 add, a triangle also 12 min/max.
// Latency: SOLID_T_FRONT cycles (bvh.svh).
// Throughput: LANES solids per cycle.
// Stall: none, runs free.
`include "bvh.svh"
module solid_front #(
    `DF_PARAMETERS,
    parameter int SHAPE = pairs_pkg::SHAPE_SPHERE,
    localparam int WORDS = pairs_pkg::shape_words(SHAPE)
) (
    input logic clk_i,
    input logic [WORDS-1:0][LANES-1:0][CW-1:0] a_i,
    input logic [6:0][LANES-1:0][CW-1:0] root_i,  // root: lower corner x y z, upper corner x y z, 16 u W
    output logic [5:0][LANES-1:0][CW-1:0] r_o     // upper + M x y z, lower - M
);
  /*verilator inline_module*/
  if (EXP != 8 || MAN != 23) $error("solid_front: the format must be fp32");
  `DF_IN(world, root_i[6], 0)
  `DF_CONST(share, `DF_POWER_OF_TWO(-16))
  `SOLID_HALF(half, SHAPE, a_i)
  `SHAPE_HULL(low, high, SHAPE, a_i)

  `DF_VIN(root_lower, root_i[2:0], 0)
  `DF_VIN(root_upper, root_i[5:3], 0)
  `DF_VAT(root_lower_then, root_lower, T_low)
  `DF_VAT(root_upper_then, root_upper, T_low)
  logic [LANES-1:0][CW-1:0] reach_of_root;
  root_reach #(`DF_SAME) of_root (
      .clk_i, .low_i(low), .high_i(high), .root_i({root_upper_then, root_lower_then}), .reach_o(reach_of_root));
  `DF_IN(reach, reach_of_root, T_low + `RAY_T_REACH)
  `DF_PICK(half_x, half, 0)
  `DF_PICK(half_y, half, 1)
  `DF_PICK(half_z, half, 2)
  `DF_MAX(half_xy, half_x, half_y)
  `DF_MAX(half_most, half_xy, half_z)
  `DF_ADD(whole, reach, half_most)
  `DF_MUL(part, whole, share)
  `DF_ADD(margin, part, world)
  `DF_VEC(margins, margin, margin, margin)

  `DF_VADD(upper, high, half)
  `DF_VSUB(lower, low, half)
  `DF_VADD(above, upper, margins)
  `DF_VSUB(below, lower, margins)
  if (T_above != `SOLID_T_FRONT(SHAPE)) $error("solid_front: SOLID_T_FRONT does not match");
  assign r_o = {below, above};
endmodule
