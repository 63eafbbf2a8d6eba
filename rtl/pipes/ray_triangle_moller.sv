// SPDX-License-Identifier: Apache-2.0
// Ray against triangle, Möller and Trumbore 1997, the paper's equation (3). E1 = V1-V0, E2 = V2-V0, S = O-V0.
// P = D x E2, Q = S x E1, det = P.E1, u = P.S, v = Q.D, t = (Q.E2)/det, CP = O + t D.
// The hit decision compares u, v and u+v with det unscaled, so it does not wait for the one division.
// Two-sided. det = 0 (parallel or degenerate) is a miss: T = +inf, CP = 0.
// 27 multipliers, 1 divider, 12 adders, 15 subtractors, 8 comparators.
// Latency: LATENCY cycles (10 when every operator takes one); 0 with ARITH = "host".
// Throughput: LANES pairs per cycle.
// Stall: none, runs free.
`include "ray_box.svh"
module ray_triangle_moller #(
    `RAY_TRIANGLE_PARAMETERS
) (
    input logic clk_i,
    input logic [7:0][LANES-1:0][CW-1:0] a_i,    // ray: o x y z, d x y z, tmin, tmax
    input logic [8:0][B_LANES-1:0][CW-1:0] b_i,  // triangle: v0 x y z, v1, v2
    `RAY_OUTPUTS
);
  /*verilator inline_module*/
  `undef DF_CANON
  `define DF_CANON 0

  `RAY_IN
  `DF_SHARED_VIN(v0, b_i[2:0], 0)
  `DF_SHARED_VIN(v1, b_i[5:3], 0)
  `DF_SHARED_VIN(v2, b_i[8:6], 0)
  `DF_CONST(zero, 0)

  // ---- Edges: computed once for all lanes when the triangle is broadcast ----
  `DF_SHARED_VSUB(e1, v1, v0)
  `DF_SHARED_VSUB(e2, v2, v0)
  `DF_VSUB(s, o, v0)
  `DF_CROSS(p, d, e2)
  `DF_CROSS(q, s, e1)
  `DF_DOT(det, p, e1)
  `DF_DOT(u, p, s)
  `DF_DOT(v, q, d)
  `DF_DOT(tn, q, e2)

  // ---- Inside test against |det|: the sign of det is moved to u, v and u+v ----
  `DF_ADD(uv, u, v)
  `DF_ABS(size, det)
  `DF_MOVE_SIGN(u_side, det, u)
  `DF_MOVE_SIGN(v_side, det, v)
  `DF_MOVE_SIGN(uv_side, det, uv)
  `DF_BETWEEN(in_u, zero, u_side, size)
  `DF_BETWEEN(in_v, zero, v_side, size)
  `DF_LT(not_flat, zero, size)
  `DF_LE(in_uv, uv_side, size)
  `DF_IN(in_edges, in_u & in_v & not_flat, T_not_flat)
  `DF_AT(in_edges_uv, in_edges, T_in_uv)
  `DF_IN(in_triangle, in_edges_uv & in_uv, T_in_uv)

  // ---- Distance and point. A hit has a finite CP, so its T is also finite; BOX accepts nothing else ----
  `DF_DIV(t, tn, det)
  `DF_BETWEEN(in_range, tmin, t, tmax)
  `DF_AND(met, in_triangle, in_range)
  `DF_VSCALE(td, d, t)
  `DF_VADD(cp, o, td)
  `RAY_BOX(hit, met, td, cp)

  `RAY_RESULT(hit, t, cp, (BOX == 0) ? 1 : 0)
  `undef DF_CANON
  `define DF_CANON 1
endmodule
