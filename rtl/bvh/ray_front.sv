// SPDX-License-Identifier: Apache-2.0
// Prepares a ray for the nodes of a BVH, once per ray: o, mt = M' |1 / d| and 1 / d (integer_ray() of
// host/src/reference/integer_node.cpp). mt is the T in which the ray moves by the margin M' along an axis.
// M' = 13/16 (2^-16 R + 16 u W). R is the largest distance along an axis from o to the root's box.
// A component of d counts as at least 2^-80. For rays that meet spheres, M' is infinite where no bound of the pipe's
// roundings is known for the sizes of R and d. Such a ray hits all boxes.
// Operators: 5 mul, 3 div, 1 add, 6 sub, 8 min/max; with spheres also 2 mul, 2 compare, 2 max.
// Latency: RAY_T_FRONT cycles (bvh.svh).
// Throughput: LANES rays per cycle.
// Stall: none, runs free.
`include "bvh.svh"
module ray_front #(
    `DF_PARAMETERS,
    parameter int LEAF = pairs_pkg::SHAPE_TRIANGLE  // secondaries of the rays: triangles or spheres
) (
    input logic clk_i,
    input logic [5:0][LANES-1:0][CW-1:0] a_i,     // ray: o x y z, d x y z
    input logic [6:0][LANES-1:0][CW-1:0] root_i,  // root: lower corner x y z, upper corner x y z, 16 u W
    output logic [8:0][LANES-1:0][CW-1:0] r_o     // o x y z, mt, 1 / d with the sign of d
);
  /*verilator inline_module*/
  if (EXP != 8 || MAN != 23) $error("ray_front: the format must be fp32");
  `DF_VIN(o, a_i[2:0], 0)
  `DF_VIN(d, a_i[5:3], 0)
  `DF_IN(world, root_i[6], 0)
  // 13/16 2^-16, and 13/16.
  `DF_CONST(share, CW'(`DF_POWER_OF_TWO(-17)) | (CW'(5) << (MAN - 3)))
  `DF_CONST(world_share, CW'(`DF_POWER_OF_TWO(-1)) | (CW'(5) << (MAN - 3)))
  `DF_CONST(one, `DF_POWER_OF_TWO(0))
  `DF_VCONST(least, `DF_POWER_OF_TWO(-80), `DF_POWER_OF_TWO(-80), `DF_POWER_OF_TWO(-80))

  `DF_VABS(d_size, d)

  // ---- Distance to the far end of the root's box, and the margin ----
  logic [LANES-1:0][CW-1:0] reach_of_root;
  root_reach #(`DF_SAME) of_root (
      .clk_i, .low_i(a_i[2:0]), .high_i(a_i[2:0]), .root_i(root_i[5:0]), .reach_o(reach_of_root));
  `DF_IN(reach, reach_of_root, `RAY_T_REACH)
  `DF_MUL(part, reach, share)
  `DF_MUL(world_part, world, world_share)
  `DF_ADD(margin_known, part, world_part)
  logic [LANES-1:0][CW-1:0] known;  // lane mask
  if (LEAF == pairs_pkg::SHAPE_SPHERE) begin : g_spheres
    `DF_CONST(least_share, `DF_POWER_OF_TWO(-42))
    `DF_CONST(most_share, `DF_POWER_OF_TWO(37))
    `DF_PICK(d_x, d_size, 0)
    `DF_PICK(d_y, d_size, 1)
    `DF_PICK(d_z, d_size, 2)
    `DF_MAX(d_xy, d_x, d_y)
    `DF_MAX(d_most, d_xy, d_z)
    `DF_MUL(least_reach, d_most, least_share)
    `DF_MUL(most_reach, d_most, most_share)
    `DF_BETWEEN(in_range, least_reach, reach, most_reach)
    if (T_in_range != `RAY_T_IN_RANGE(LEAF)) $error("ray_front: RAY_T_IN_RANGE does not match");
    assign known = in_range;
  end else begin : g_triangles
    assign known = '1;
  end
  `DF_IN(is_known, known, `RAY_T_IN_RANGE(LEAF))
  `DF_CONST(infinite, formats_pkg::infinity(EXP, MAN))
  `DF_SELECT(margin, is_known, margin_known, infinite)

  // ---- 1 / d ----
  `DF_VMAX(d_least, d_size, least)
  `DF_VMOVE_SIGN(divisor, d, d_least)
  `DF_PICK(divisor_x, divisor, 0)
  `DF_PICK(divisor_y, divisor, 1)
  `DF_PICK(divisor_z, divisor, 2)
  `DF_DIV(inverse_x, one, divisor_x)
  `DF_DIV(inverse_y, one, divisor_y)
  `DF_DIV(inverse_z, one, divisor_z)
  `DF_VEC(inverse, inverse_x, inverse_y, inverse_z)
  `DF_VABS(inverse_size, inverse)
  `DF_VSCALE(margin_t, inverse_size, margin)

  localparam int T_FRONT = `RAY_T_FRONT(LEAF);
  if (T_margin_t != T_FRONT) $error("ray_front: RAY_T_FRONT does not match");
  `DF_VAT(o_out, o, T_FRONT)
  `DF_VAT(inverse_out, inverse, T_FRONT)
  assign r_o = {inverse_out, margin_t, o_out};
endmodule
