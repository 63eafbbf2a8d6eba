// SPDX-License-Identifier: Apache-2.0
// Triangle against sphere, relative to the sphere's centre: the closest point of the triangle over all seven regions,
// polished twice. The triangle is flat and two-sided, and s = distance - r. If the centre is so near the plane that the
// direction to it is lost, n is the plane's normal. The normal points from the triangle to the sphere.
// CP = pA + (s/2) n, where pA is the closest point. F = (s <= 0), T = |s|.
// Operators: 146 add, 171 mul, 7 div, 2 sqrt, 33 compare, 16 min/max.
// Latency: LATENCY cycles; 0 with ARITH = "host".
// Throughput: LANES pairs per cycle.
// Stall: none, runs free.
`include "triangle.svh"
module triangle_sphere #(
    `DF_PARAMETERS
) (
    input logic clk_i,
    input logic [8:0][LANES-1:0][CW-1:0] a_i,  // triangle: v0 x y z, v1, v2
    input logic [3:0][LANES-1:0][CW-1:0] b_i,  // sphere: c x y z, r
    `DISTANCE_OUTPUTS
);
  /*verilator inline_module*/
  localparam logic [CW-1:0] HALF = ((CW'(1) << (EXP - 1)) - 2) << MAN;
  localparam logic [CW-1:0] TIE = ((CW'(1) << (EXP - 1)) - CW'(MAN)) << MAN;  // 4 u = 2^(1-MAN)
  `DF_MATRIX_IN(vertices, a_i[2:0], a_i[5:3], a_i[8:6], 0)
  `DF_VIN(c, b_i[2:0], 0)
  `DF_MATRIX_IN(centres, b_i[2:0], b_i[2:0], b_i[2:0], 0)
  `DF_IN(r, b_i[3], 0)
  `DF_CONST(half, HALF)
  `DF_CONST(tie_width, TIE)

  // ---- The centre relative to the vertices, and the vector to it from the closest point ----
  `DF_MSUB(p, centres, vertices)
  `DF_MNEG(w, p)
  `DF_TRIANGLE(t, p)
  `DF_POINT_TRIANGLE(closest, w, t)
  logic unused_d2;
  assign unused_d2 = &{1'b0, closest_d2};
  `DF_VNEG(start, closest_v)
  `DF_VNEG(start_p, start)

  // ---- Distances closer than `tie` are equal ----
  `DF_REACH(reach, p)
  `DF_ADD(size, reach, r)
  `DF_MUL(tie, tie_width, size)

  // ---- Polished twice, each time towards the vertex farthest against the direction ----
  `DF_MAT_AT(p_start, p, T_start)
  `DF_LOWEST(far1, p_start, start)
  `DF_VNEG(far1_p, far1)
  `DF_POLISH(once, once_p, start_slack, start, start_p, far1, far1_p, tie)
  `DF_MAT_AT(p_once, p_start, T_once)
  `DF_LOWEST(far2, p_once, once)
  `DF_VNEG(far2_p, far2)
  `DF_POLISH(x, x_p, once_slack, once, once_p, far2, far2_p, tie)
  logic unused_slack;
  assign unused_slack = &{1'b0, start_slack, once_slack};

  // ---- The plane's result, and the point's if its distance is not less ----
  `DF_VFLIP(plane_up, closest_h, t_m)
  `DF_VNEG(plane_n, plane_up)
  `DF_ABS(plane_distance, closest_h)
  `DF_VSCALE(to_plane, plane_n, plane_distance)
  `DF_VNEG(plane_p, to_plane)
  `DF_DIRECTION(x_n, distance, x_usable, x)
  `DF_LEAST_ALONG(distance_along, p_once, x_n)
  `DF_SUB(enough, plane_distance, tie)
  `DF_LE(x_holds, enough, distance_along)
  `DF_AND(point, x_usable, x_holds)
  `DF_SELECT(centre_distance, point, distance, plane_distance)
  `DF_VSELECT(n, point, x_n, plane_n)
  `DF_VSELECT(a_p, point, x_p, plane_p)

  `DF_SUB(s, centre_distance, r)
  `DF_MUL(s_half, s, half)
  `DF_VSCALE(beyond, n, s_half)
  `DF_VADD(from_c, a_p, beyond)
  `DF_VADD(cp, c, from_c)

  `DISTANCE_RESULT(s, cp, n)
endmodule
