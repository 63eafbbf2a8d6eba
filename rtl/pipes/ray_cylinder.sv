// SPDX-License-Identifier: Apache-2.0
// Ray against the surface of a solid cylinder with flat caps. The ray's interval within the infinite cylinder is
// A t^2 + 2 B t + C <= 0. It is intersected with the interval between the cap planes. The vectors are n = d x a, m = w
// x a.
// All is divided by A first, so no product has more than two lengths. The discriminant is r^2/A - (e/A)^2, which is
// B^2 - AC by Lagrange's identity. There e is taken without the part of w along the axis. Along the axis (A = 0, or so
// small that r^2/A = inf) and across it (d.a = 0), an interval is unbounded or empty.
// Operators: 44 mul, 3 div, 1 sqrt, 16 add, 16 sub, 10 compare, 3 min/max.
// Latency: latency_o cycles (21 when every operator takes one); 0 with ARITH = "host".
// Throughput: LANES pairs per cycle.
// Stall: none, runs free.
`include "pipe.svh"
module ray_cylinder #(
    `DF_PARAMETERS
) (
    input logic clk_i,
    input logic [7:0][LANES-1:0][CW-1:0] a_i,  // ray: o x y z, d x y z, tmin, tmax
    input logic [7:0][LANES-1:0][CW-1:0] b_i,  // cylinder: c x y z, axis x y z, half height, radius
    `RAY_OUTPUTS
);
  /*verilator inline_module*/
  `undef DF_CANON
  `define DF_CANON 0
  localparam logic [CW-1:0] ONE = ((CW'(1) << (EXP - 1)) - 1) << MAN;
  localparam logic [CW-1:0] INF = ((CW'(1) << EXP) - 1) << MAN;

  `DF_VIN(o, a_i[2:0], 0)
  `DF_VIN(d, a_i[5:3], 0)
  `DF_VIN(c, b_i[2:0], 0)
  `DF_VIN(axis, b_i[5:3], 0)
  `DF_IN(h, b_i[6], 0)
  `DF_IN(r, b_i[7], 0)
  `DF_CONST(zero, 0)
  `DF_CONST(one, ONE)
  `DF_CONST(inf, INF)
  `DF_NEG(minus_inf, inf)

  `DF_VSUB(w, o, c)
  `DF_DOT(wz, w, axis)
  `DF_DOT(dz, d, axis)

  // ---- Within the infinite cylinder ----
  `DF_CROSS(n, d, axis)
  `DF_CROSS(m, w, axis)
  `DF_MUL(rr, r, r)
  `DF_DOT(aa, n, n)
  `DF_DOT(bb, m, n)
  `DF_DOT(mm, m, m)
  `DF_SUB(cc, mm, rr)
  `DF_VSCALE(along, axis, wz)
  `DF_VSUB(g, w, along)
  `DF_DOT(e, g, n)
  `DF_DIV(ia, one, aa)
  `DF_MUL(rri, rr, ia)
  `DF_MUL(bi, bb, ia)
  `DF_MUL(ci, cc, ia)
  `DF_MUL(ei, e, ia)
  `DF_MUL(eei, ei, ei)
  `DF_SUB(discriminant, rri, eei)
  `DF_SQRT(root, discriminant)
  `DF_MOVE_SIGN(root_b, bb, root)
  `DF_ADD(minus_q, bi, root_b)
  `DF_NEG(q, minus_q)
  `DF_DIV(c_over_q, ci, q)
  `DF_ABS(ratio_size, c_over_q)
  `DF_ABS(q_size, q)
  `DF_MIN(cq_size, ratio_size, q_size)
  `DF_MOVE_SIGN(cq_q, q, cq_size)
  `DF_MOVE_SIGN(cq, ci, cq_q)
  `DF_NEGATIVE(backwards, bb)
  `DF_SELECT(first, backwards, cq, q)
  `DF_SELECT(last, backwards, q, cq)
  `DF_LT(slanted, rri, inf)
  `DF_SELECT(lateral_low, slanted, first, minus_inf)
  `DF_SELECT(lateral_high, slanted, last, inf)
  `DF_LE(line_meets, zero, discriminant)
  `DF_LE(axis_near, cc, zero)
  `DF_SELECT(lateral, slanted, line_meets, axis_near)

  // ---- Between the caps ----
  `DF_DIV(i, one, dz)
  `DF_NEG(minus_h, h)
  `DF_SUB(to_bottom, minus_h, wz)
  `DF_SUB(to_top, h, wz)
  `DF_MUL(bottom, to_bottom, i)
  `DF_MUL(top, to_top, i)
  `DF_NEGATIVE(down, dz)
  `DF_SELECT(cap_first, down, top, bottom)
  `DF_SELECT(cap_last, down, bottom, top)
  `DF_ABS(i_size, i)
  `DF_LT(steep, i_size, inf)
  `DF_SELECT(cap_low, steep, cap_first, minus_inf)
  `DF_SELECT(cap_high, steep, cap_last, inf)
  `DF_ABS(height, wz)
  `DF_LE(level, height, h)
  `DF_OR(caps, steep, level)

  // ---- Both ----
  `DF_MAX(enter, lateral_low, cap_low)
  `DF_MIN(leave, lateral_high, cap_high)
  `DF_LE(in_order, enter, leave)
  `DF_OR(moves, slanted, steep)
  `DF_AND(both, lateral, caps)
  `DF_AND(there, both, moves)
  `DF_AND(meets, there, in_order)

  ray_crossing #(`DF_SAME, .T_RAY(0), .T_ENTER_LEAVE(T_enter), .T_MEETS(T_meets)) crossing (
      .clk_i, .ray_i(a_i), .enter_i(enter), .leave_i(leave), .meets_i(meets), .f_o, .t_o, .cp_o, .latency_o);
  `undef DF_CANON
  `define DF_CANON 1
endmodule
