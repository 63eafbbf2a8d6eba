// SPDX-License-Identifier: Apache-2.0
// A solid as nodes of a hierarchy see it, once a solid (reference/pipes/ray_node.hpp): the upper corner of its box plus
// M, the lower one less M, and 1 where a ray has 1 / d, so that node_boxes.sv gives gaps of axes; M = 2^-16 (R + e) +
// 16 u W is what boxes are widened by, R the largest distance along an axis from the centre to the root's box, e half
// the size of the solid's own.
// 1 mul, 8 add, 12 sub, 7 max; of an OBB 9 mul, 6 add more.
// Latency: SOLID_T_FRONT clocks (hierarchy.svh). Throughput: LANES solids a clock. Stall: none, runs free.
`include "hierarchy.svh"
module solid_front #(
    `DF_PARAMETERS,
    parameter int SHAPE = pairs_pkg::SHAPE_SPHERE,
    localparam int WORDS = pairs_pkg::shape_words(SHAPE)
) (
    input logic clk_i,
    input logic [WORDS-1:0][LANES-1:0][CW-1:0] a_i,
    input logic [6:0][LANES-1:0][CW-1:0] root_i,  // of the root: lower corner x y z, upper, 16 u W
    output logic [8:0][LANES-1:0][CW-1:0] r_o     // upper + M x y z, lower - M, 1
);
  /*verilator inline_module*/
  if (EXP != 8 || MAN != 23) $error("solid_front: margins are those of fp32");
  `DF_VIN(c, a_i[2:0], 0)
  `DF_IN(world, root_i[6], 0)
  `DF_CONST(share, `DF_POWER_OF_TWO(-16))
  `DF_VCONST(one, `DF_POWER_OF_TWO(0), `DF_POWER_OF_TWO(0), `DF_POWER_OF_TWO(0))
  `SOLID_HALF(half, SHAPE, a_i)

  logic [LANES-1:0][CW-1:0] reach_of_root;
  root_reach #(`DF_SAME) of_root (.clk_i, .o_i(a_i[2:0]), .root_i(root_i[5:0]), .reach_o(reach_of_root));
  `DF_IN(reach, reach_of_root, `RAY_T_REACH)
  `DF_PICK(half_x, half, 0)
  `DF_PICK(half_y, half, 1)
  `DF_PICK(half_z, half, 2)
  `DF_MAX(half_xy, half_x, half_y)
  `DF_MAX(half_most, half_xy, half_z)
  `DF_ADD(whole, reach, half_most)
  `DF_MUL(part, whole, share)
  `DF_ADD(margin, part, world)
  `DF_VEC(margins, margin, margin, margin)

  `DF_VADD(upper, c, half)
  `DF_VSUB(lower, c, half)
  `DF_VADD(above, upper, margins)
  `DF_VSUB(below, lower, margins)
  if (T_above != `SOLID_T_FRONT(SHAPE)) $error("solid_front: SOLID_T_FRONT is another");
  assign r_o = {one, below, above};
endmodule
