// SPDX-License-Identifier: Apache-2.0
// Sphere against oriented box, in the box's frame: p is the sphere's centre, q is p limited to the box.
// Outside, the distance is |p - q|. Inside, or if |p - q|^2 is subnormal, the face with the least depth counts.
// Ties go to the lowest axis.
// The signed distance is s = distance - r, with n from the sphere to the box. CP = q + (s/2) m, m = -n out of the box.
// F = (s <= 0), T = |s|. 36 add, 37 mul, 1 div, 1 sqrt, 5 compare, 6 min/max.
// Latency: LATENCY cycles; 0 with ARITH = "host".
// Throughput: LANES pairs per cycle. Stall: none, runs free.
`include "pipe.svh"
module sphere_obb #(
    `DF_PARAMETERS
) (
    input logic clk_i,
    input logic [3:0][LANES-1:0][CW-1:0] a_i,  // sphere: c x y z, r
    input logic [14:0][LANES-1:0][CW-1:0] b_i,  // OBB: c x y z, half extents, rotation by rows
    `DISTANCE_OUTPUTS
);
  /*verilator inline_module*/
  localparam logic [CW-1:0] ONE = ((CW'(1) << (EXP - 1)) - 1) << MAN;
  localparam logic [CW-1:0] HALF = ONE - (CW'(1) << MAN);
  localparam logic [CW-1:0] LEAST_NORMAL = CW'(1) << MAN;

  `DF_VIN(a_c, a_i[2:0], 0)
  `DF_IN(a_r, a_i[3], 0)
  `DF_VIN(b_c, b_i[2:0], 0)
  `DF_VIN(extents, b_i[5:3], 0)
  `DF_MATRIX_IN(rotation, b_i[8:6], b_i[11:9], b_i[14:12], 0)
  `DF_CONST(zero, 0)
  `DF_CONST(one, ONE)
  `DF_CONST(half, HALF)
  `DF_CONST(least_normal, LEAST_NORMAL)
  `DF_VCONST(ones, ONE, ONE, ONE)

  // ---- Outside: the nearest point of the box ----
  `DF_VSUB(w, a_c, b_c)
  `DF_TRANSPOSE(axes, rotation)
  `DF_APPLY(p, axes, w)
  `DF_VNEG(minus_extents, extents)
  `DF_VCLAMP(q, p, minus_extents, extents)
  `DF_VSUB(v, p, q)
  `DF_DOT(dd, v, v)
  `DF_LE(outside, least_normal, dd)
  `DF_SQRT(d, dd)
  `DF_DIV(inverse, one, d)
  `DF_VSCALE(direction, v, inverse)

  // ---- Inside: the nearest face ----
  `DF_VABS(p_abs, p)
  `DF_VSUB(depths, extents, p_abs)
  `DF_PICK(depth_x, depths, 0)
  `DF_PICK(depth_y, depths, 1)
  `DF_PICK(depth_z, depths, 2)
  `DF_LEAST3(depth, depth_x, depth_y, depth_z)
  `DF_VMOVE_SIGN(side, p, ones)
  `DF_PICK(side_x, side, 0)
  `DF_PICK(side_y, side, 1)
  `DF_PICK(side_z, side, 2)
  `DF_VEC(face_nx, side_x, zero, zero)
  `DF_VEC(face_ny, zero, side_y, zero)
  `DF_VEC(face_nz, zero, zero, side_z)
  `DF_VSELECT3(face_n, depth_first, depth_second, face_nx, face_ny, face_nz)
  `DF_VMOVE_SIGN(on_face, p, extents)
  `DF_PICK(p_x, p, 0)
  `DF_PICK(p_y, p, 1)
  `DF_PICK(p_z, p, 2)
  `DF_PICK(on_x, on_face, 0)
  `DF_PICK(on_y, on_face, 1)
  `DF_PICK(on_z, on_face, 2)
  `DF_VEC(face_qx, on_x, p_y, p_z)
  `DF_VEC(face_qy, p_x, on_y, p_z)
  `DF_VEC(face_qz, p_x, p_y, on_z)
  `DF_VSELECT3(face_q, depth_first, depth_second, face_qx, face_qy, face_qz)

  // ---- Choice, and back to the world ----
  `DF_NEG(minus_depth, depth)
  `DF_SELECT(distance, outside, d, minus_depth)
  `DF_SUB(s, distance, a_r)
  `DF_VSELECT(m, outside, direction, face_n)
  `DF_VSELECT(surface, outside, q, face_q)
  `DF_MUL(s_half, s, half)
  `DF_VSCALE(beyond, m, s_half)
  `DF_VADD(local_p, surface, beyond)
  `DF_APPLY(world_p, rotation, local_p)
  `DF_VADD(cp, b_c, world_p)
  `DF_APPLY(world_m, rotation, m)
  `DF_VNEG(n, world_m)

  `DISTANCE_RESULT(s, cp, n)
endmodule
