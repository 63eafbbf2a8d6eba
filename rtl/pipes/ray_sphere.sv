// SPDX-License-Identifier: Apache-2.0
// Ray against the surface of a sphere. The discriminant comes from the centre's distance to the line (Haines et al.,
// Ray Tracing Gems 2019).
//
//   f = o - c, a = d.d, b = -f.d, k = b/a, l = f + k d, D = r^2 - l.l, q = k + sign(b) sqrt(D/a)
//
// The roots are (f.f - r^2)/a/q, no larger than q, and q, in this order when b > 0. No product has more than two
// lengths. T is the first root in [tmin, tmax]. D < 0 is a miss.
// Operators: 22 mul, 2 div, 1 sqrt, 15 add, 5 sub, 5 compare, 1 min/max.
// Latency: latency_o cycles (20 when every operator takes one); 0 with ARITH = "host".
// Throughput: LANES pairs per cycle.
// Stall: none, runs free.
`include "pipe.svh"
module ray_sphere #(
    `DF_PARAMETERS
) (
    input logic clk_i,
    input logic [7:0][LANES-1:0][CW-1:0] a_i,  // ray: o x y z, d x y z, tmin, tmax
    input logic [3:0][LANES-1:0][CW-1:0] b_i,  // sphere: c x y z, r
    `RAY_OUTPUTS
);
  /*verilator inline_module*/
  `undef DF_CANON
  `define DF_CANON 0
  localparam logic [CW-1:0] ONE = ((CW'(1) << (EXP - 1)) - 1) << MAN;

  `DF_VIN(o, a_i[2:0], 0)
  `DF_VIN(d, a_i[5:3], 0)
  `DF_VIN(c, b_i[2:0], 0)
  `DF_IN(r, b_i[3], 0)
  `DF_CONST(zero, 0)
  `DF_CONST(one, ONE)

  `DF_VSUB(f, o, c)
  `DF_DOT(a, d, d)
  `DF_DOT(fd, f, d)
  `DF_NEG(b, fd)
  `DF_DOT(ff, f, f)
  `DF_MUL(rr, r, r)
  `DF_DIV(i, one, a)

  // ---- The line's point nearest to the centre, relative to the centre ----
  `DF_MUL(foot, b, i)
  `DF_VSCALE(foot_d, d, foot)
  `DF_VADD(l, f, foot_d)
  `DF_DOT(ll, l, l)

  `DF_SUB(discriminant, rr, ll)
  `DF_LE(meets, zero, discriminant)
  `DF_MUL(scaled, discriminant, i)
  `DF_SQRT(root, scaled)
  `DF_MOVE_SIGN(root_b, b, root)
  `DF_ADD(tb, foot, root_b)
  `DF_SUB(cc, ff, rr)
  `DF_MUL(cci, cc, i)
  `DF_DIV(ratio, cci, tb)
  `DF_ABS(ratio_size, ratio)
  `DF_ABS(tb_size, tb)
  `DF_MIN(ta_size, ratio_size, tb_size)
  `DF_MOVE_SIGN(ta_b, tb, ta_size)
  `DF_MOVE_SIGN(ta, cci, ta_b)
  `DF_NEGATIVE(backwards, b)
  `DF_SELECT(near, backwards, tb, ta)
  `DF_SELECT(far, backwards, ta, tb)

  ray_crossing #(`DF_SAME, .T_RAY(0), .T_ENTER_LEAVE(T_near), .T_MEETS(T_meets)) crossing (
      .clk_i, .ray_i(a_i), .enter_i(near), .leave_i(far), .meets_i(meets), .f_o, .t_o, .cp_o, .latency_o);
  `undef DF_CANON
  `define DF_CANON 1
endmodule
