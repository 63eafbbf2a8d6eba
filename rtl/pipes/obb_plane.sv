// SPDX-License-Identifier: Apache-2.0
// Oriented box against plane. The plane has two sides: H = n.c - d, R = sum of e_i |n.u_i|, s = |H| - R, n from the box
// to the plane. With HALF_SPACE the plane is the solid n.x <= d: s = H - R, n points into it. The box's support point
// uses sign(0) = 0, so it is the centroid of the touching edge or face. CP is s/2 beyond it.
// F = (s <= 0), T = |s|. 24 add, 28 mul, 4 compare.
// Latency: LATENCY cycles; 0 with ARITH = "host".
// Throughput: LANES pairs per cycle.
// Stall: none, runs free.
`include "pipe.svh"
module obb_plane #(
    `DF_PARAMETERS,
    parameter bit HALF_SPACE = 0
) (
    input logic clk_i,
    input logic [14:0][LANES-1:0][CW-1:0] a_i,  // OBB: c x y z, half extents, rotation by rows
    input logic [3:0][LANES-1:0][CW-1:0] b_i,  // plane: n x y z, d
    `DISTANCE_OUTPUTS
);
  /*verilator inline_module*/
  localparam logic [CW-1:0] ONE = ((CW'(1) << (EXP - 1)) - 1) << MAN;
  localparam logic [CW-1:0] HALF = ONE - (CW'(1) << MAN);

  `DF_VIN(c, a_i[2:0], 0)
  `DF_VIN(half_extents, a_i[5:3], 0)
  `DF_MATRIX_IN(rotation, a_i[8:6], a_i[11:9], a_i[14:12], 0)
  `DF_VIN(plane_n, b_i[2:0], 0)
  `DF_IN(plane_d, b_i[3], 0)
  `DF_CONST(half, HALF)
  `DF_VCONST(zeros, 0, 0, 0)

  `DF_DOT(on_n, plane_n, c)
  `DF_SUB(height, on_n, plane_d)
  `DF_TRANSPOSE(axes, rotation)
  `DF_APPLY(cosine, axes, plane_n)
  `DF_VABS(cosine_abs, cosine)
  `DF_VMUL(h, half_extents, cosine_abs)
  `DF_PICK(h_x, h, 0)
  `DF_PICK(h_y, h, 1)
  `DF_PICK(h_z, h, 2)
  `DF_ADD(h_xy, h_x, h_y)
  `DF_ADD(radius, h_xy, h_z)
  // The box's side of the plane, as a sign. A half-space is always below.
  localparam int T_up = HALF_SPACE ? `DF_CONSTANT : T_height;
  `DF_SCALAR up;
  assign up = HALF_SPACE ? {LANES{ONE}} : height;
  `DF_MOVE_SIGN(distance, up, height)
  `DF_SUB(s, distance, radius)

  // Away from the box's side of the plane.
  `DF_VFLIP(n_up, up, plane_n)
  `DF_VNEG(n, n_up)
  // The support point along n, in the box's frame.
  `DF_VFLIP(corner_up, up, half_extents)
  `DF_VNEG(corner_down, corner_up)
  `DF_VMOVE_SIGN(corner, cosine, corner_down)
  `DF_VEQ(level, cosine, zeros)
  `DF_VSELECT_EACH(local_p, level, zeros, corner)
  `DF_APPLY(offset, rotation, local_p)
  `DF_MUL(s_half, s, half)
  `DF_VSCALE(beyond, n, s_half)
  `DF_VADD(from_c, offset, beyond)
  `DF_VADD(cp, c, from_c)

  `DISTANCE_RESULT(s, cp, n)
endmodule
