// SPDX-License-Identifier: Apache-2.0
// Ray against triangle by Pluecker coordinates, the paper's equations (4) to (6). The sign of
// w_ij = D.(p_ij x V_i) + (D x O).p_ij says on which side of the ray the edge p_ij = V_j - V_i runs.
// W = w01 + w12 + w20, t = (N.(O - V0))/W with N = p20 x p01, CP = O + t D. Two-sided. W = 0 (parallel or degenerate)
// is a miss: T = +inf, CP = 0. 54 mul, 1 div, 22 add, 27 sub, 6 compare.
// Latency: LATENCY cycles (13 when every operator takes one); 0 with ARITH = "host".
// Throughput: LANES pairs per cycle.
// Stall: none, runs free.
`include "ray_box.svh"
module ray_triangle_pluecker #(
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

  // ---- Lines of the ray and of the edges: a direction and a moment ----
  `DF_CROSS(qr, d, o)
  `DF_VSUB(p01, v1, v0)
  `DF_VSUB(p12, v2, v1)
  `DF_VSUB(p20, v0, v2)
  `DF_CROSS(q01, p01, v0)
  `DF_CROSS(q12, p12, v1)
  `DF_CROSS(q20, p20, v2)

  // ---- Inner products of the ray with the edges ----
  `define CDE_PRODUCT(W, P, Q) \
    `DF_DOT(W``_moment, d, Q) \
    `DF_DOT(W``_direction, qr, P) \
    `DF_ADD(W, W``_moment, W``_direction)
  `CDE_PRODUCT(w01, p01, q01)
  `CDE_PRODUCT(w12, p12, q12)
  `CDE_PRODUCT(w20, p20, q20)
  `undef CDE_PRODUCT
  `DF_ADD(w01_12, w01, w12)
  `DF_ADD(sum, w01_12, w20)
  // ---- Inside test ----
  `DF_VEC(sides, w01, w12, w20)
  logic [LANES-1:0][CW-1:0] side;
  same_side #(`DF_SAME, .T_UVW(T_sides), .T_DET(T_sum))
      inside_test (
      .clk_i, .uvw_i(sides), .det_i(sum), .inside_o(side));
  `DF_IN(in_edges, side, T_sum + LAT.cmp)

  // ---- Distance and point ----
  `DF_CROSS(n, p20, p01)
  `DF_VSUB(s, o, v0)
  `DF_DOT(tn, n, s)
  logic [LANES-1:0][CW-1:0] numerator, denominator;
  localparam int T_DENOMINATOR = (BOX != 0) ? T_n + `DF_LAT_DOT : T_sum;
  if (BOX != 0) begin : g_normal  // -(N.D); W equals it but for rounding
    `DF_NEG(minus_tn, tn)
    `DF_DOT(nd, n, d)
    assign numerator = minus_tn;
    assign denominator = nd;
  end else begin : g_sum
    assign numerator = tn;
    assign denominator = sum;
  end
  `DF_IN(t_over, numerator, T_tn)
  `DF_IN(t_under, denominator, T_DENOMINATOR)
  `DF_DIV(t, t_over, t_under)
  `DF_BETWEEN(in_range, tmin, t, tmax)
  `DF_AND(met, in_edges, in_range)
  `DF_VSCALE(td, d, t)
  `DF_VADD(cp, o, td)
  `RAY_BOX(hit, met, td, cp)

  `RAY_RESULT(hit, t, cp, (BOX == 0) ? 1 : 0)
  `undef DF_CANON
  `define DF_CANON 1
endmodule
