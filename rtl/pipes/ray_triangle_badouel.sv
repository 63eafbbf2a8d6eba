// SPDX-License-Identifier: Apache-2.0
// Ray against triangle after Badouel 1990, the paper's equations (1) and (2): N = E1 x E2, t = (N.V0 - N.O)/N.D,
// P = O + t D. Two barycentric coordinates of P in the plane's dominant projection are compared with N_k unscaled.
// Two-sided. N.D = 0 (parallel or degenerate) is a miss: T = +inf, CP = 0. 22 mul, 1 div, 10 add, 14 sub, 8 compare.
// Latency: LATENCY cycles (16 when every operator takes one, also with BOX); 0 with ARITH = "host".
// Throughput: LANES pairs per cycle.
// Stall: none, runs free.
`include "ray_box.svh"
module ray_triangle_badouel #(
    `RAY_TRIANGLE_PARAMETERS
) (
    input logic clk_i,
    input logic [7:0][LANES-1:0][CW-1:0] a_i,  // ray: o x y z, d x y z, tmin, tmax
    input logic [8:0][LANES-1:0][CW-1:0] b_i,  // triangle: v0 x y z, v1, v2
    `RAY_OUTPUTS
);
  /*verilator inline_module*/
  `undef DF_CANON
  `define DF_CANON 0

  `RAY_IN
  `DF_VIN(v0, b_i[2:0], 0)
  `DF_VIN(v1, b_i[5:3], 0)
  `DF_VIN(v2, b_i[8:6], 0)
  `DF_CONST(zero, 0)

  // ---- Plane ----
  `DF_VSUB(e1, v1, v0)
  `DF_VSUB(e2, v2, v0)
  `DF_CROSS(n, e1, e2)
  `DF_DOT(w, n, v0)
  `DF_DOT(s, n, o)
  `DF_DOT(nd, n, d)
  `DF_SUB(tn, w, s)
  `DF_DIV(t, tn, nd)
  `DF_VSCALE(td, d, t)
  `DF_VADD(p, o, td)

  // ---- Dominant projection: components 1 and 2 are in the plane, 0 is across it ----
  `DF_DOMINANT(kz, n)
  `DF_CYCLE(n_k, kz, n)
  `DF_CYCLE(v0_k, kz, v0)
  `DF_CYCLE(e1_k, kz, e1)
  `DF_CYCLE(e2_k, kz, e2)
  `DF_CYCLE(p_k, kz, p)
  logic unused_components;
  assign unused_components = &{1'b0, n_k[2:1], v0_k[0], e1_k[0], e2_k[0], p_k[0]};
  `DF_PICK(nk, n_k, 0)
  `DF_PICK(v0_i, v0_k, 1)
  `DF_PICK(v0_j, v0_k, 2)
  `DF_PICK(e1_i, e1_k, 1)
  `DF_PICK(e1_j, e1_k, 2)
  `DF_PICK(e2_i, e2_k, 1)
  `DF_PICK(e2_j, e2_k, 2)
  `DF_PICK(p_i, p_k, 1)
  `DF_PICK(p_j, p_k, 2)

  // ---- Barycentric coordinates times N_k ----
  `DF_SUB(g, p_i, v0_i)
  `DF_SUB(h, p_j, v0_j)
  `DF_MUL(g_e2, g, e2_j)
  `DF_MUL(h_e2, h, e2_i)
  `DF_SUB(alpha, g_e2, h_e2)
  `DF_MUL(h_e1, h, e1_i)
  `DF_MUL(g_e1, g, e1_j)
  `DF_SUB(beta, h_e1, g_e1)
  `DF_ADD(sum, alpha, beta)

  // ---- Decision ----
  `DF_MOVE_SIGN(alpha_s, nk, alpha)
  `DF_MOVE_SIGN(beta_s, nk, beta)
  `DF_MOVE_SIGN(sum_s, nk, sum)
  `DF_ABS(nk_size, nk)
  `DF_ABS(nd_size, nd)
  `DF_LE(alpha_in, zero, alpha_s)
  `DF_LE(beta_in, zero, beta_s)
  `DF_LE(sum_in, sum_s, nk_size)
  `DF_LT(crosses, zero, nd_size)
  `DF_BETWEEN(in_range, tmin, t, tmax)
  `DF_AND(both_in, alpha_in, beta_in)
  `DF_AND(meets, crosses, in_range)
  `DF_AND(in_triangle, both_in, sum_in)
  `DF_AND(met, in_triangle, meets)
  `RAY_BOX(hit, met, td, p)

  `RAY_RESULT(hit, t, p, (BOX == 0) ? 1 : 0)
  `undef DF_CANON
  `define DF_CANON 1
endmodule
