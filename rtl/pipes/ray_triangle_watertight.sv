// SPDX-License-Identifier: Apache-2.0
// Ray against triangle after Woop, Benthin and Wald 2013. Space is sheared so that the ray runs along its dominant
// axis. The edge functions U, V, W are evaluated in the plane across that axis, and each product is rounded. So both
// triangles at an edge see the ray on the same side of it, and closed meshes do not leak.
// T = (U Az + V Bz + W Cz)/det/D_kz with det = U + V + W. D_kz divides last, so only lengths are multiplied before.
// CP is the barycentric point. Two-sided. det = 0 (edge-on or without area) is a miss: T = +inf, CP = 0.
// Operators: 30 mul, 3 div, 13 add, 18 sub, 8 compare.
// Latency: LATENCY cycles (17 when every operator takes one); 0 with ARITH = "host".
// Throughput: LANES pairs per cycle.
// Stall: none, runs free.
`include "ray_box.svh"
module ray_triangle_watertight #(
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
  localparam logic [CW-1:0] ONE = ((CW'(1) << (EXP - 1)) - 1) << MAN;

  `RAY_IN
  `DF_VIN(v0, b_i[2:0], 0)
  `DF_VIN(v1, b_i[5:3], 0)
  `DF_VIN(v2, b_i[8:6], 0)
  `DF_CONST(one, ONE)

  // ---- Shear, of the ray alone ----
  `DF_DOMINANT(kz, d)
  `DF_CYCLE(dk, kz, d)
  `DF_PICK(dk_z, dk, 0)
  `DF_PICK(dk_x, dk, 1)
  `DF_PICK(dk_y, dk, 2)
  `DF_DIV(sz, one, dk_z)
  `DF_MUL(sx, dk_x, sz)
  `DF_MUL(sy, dk_y, sz)

  // ---- Vertices relative to the ray's origin, sheared: (P_kx - Sx P_kz, P_ky - Sy P_kz, P_kz) ----
  `define CDE_SHEAR(P, V) \
    `DF_VSUB(P, V, o) \
    `DF_CYCLE(P``_k, kz, P) \
    `DF_PICK(P``z, P``_k, 0) \
    `DF_PICK(P``_kx, P``_k, 1) \
    `DF_PICK(P``_ky, P``_k, 2) \
    `DF_MUL(P``_sx, sx, P``z) \
    `DF_MUL(P``_sy, sy, P``z) \
    `DF_SUB(P``x, P``_kx, P``_sx) \
    `DF_SUB(P``y, P``_ky, P``_sy)
  `CDE_SHEAR(a, v0)
  `CDE_SHEAR(b, v1)
  `CDE_SHEAR(c, v2)
  `undef CDE_SHEAR

  // ---- Edge functions: exchanging two vertices flips the sign and nothing else ----
  `define CDE_EDGE(R, P, Q) \
    `DF_MUL(R``_xy, P``x, Q``y) \
    `DF_MUL(R``_yx, P``y, Q``x) \
    `DF_SUB(R, R``_xy, R``_yx)
  `CDE_EDGE(u, c, b)
  `CDE_EDGE(v, a, c)
  `CDE_EDGE(w, b, a)
  `undef CDE_EDGE
  `DF_ADD(uv, u, v)
  `DF_ADD(det, uv, w)
  // ---- Inside test ----
  `DF_VEC(weights, u, v, w)
  logic [LANES-1:0][CW-1:0] side;
  same_side #(`DF_SAME, .T_UVW(T_weights), .T_DET(T_det))
      inside_test (
      .clk_i, .uvw_i(weights), .det_i(det), .inside_o(side));
  `DF_IN(in_edges, side, T_det + LAT.cmp)

  // ---- Distance and point ----
  `DF_VEC(depths, az, bz, cz)
  `DF_DOT(tn, weights, depths)
  `DF_DIV(along, tn, det)
  `DF_MUL(t, along, sz)
  `DF_BETWEEN(in_range, tmin, t, tmax)
  `DF_AND(met, in_edges, in_range)
  `DF_DIV(i, one, det)
  `DF_VSCALE(coordinates, weights, i)
  `DF_VIN(abc_x, {c[0], b[0], a[0]}, T_a)
  `DF_VIN(abc_y, {c[1], b[1], a[1]}, T_a)
  `DF_VIN(abc_z, {c[2], b[2], a[2]}, T_a)
  `DF_DOT(hit_x, coordinates, abc_x)
  `DF_DOT(hit_y, coordinates, abc_y)
  `DF_DOT(hit_z, coordinates, abc_z)
  `DF_VEC(hit_point, hit_x, hit_y, hit_z)
  `DF_VADD(cp, o, hit_point)

  // ---- The box rule applies to o + t d ----
  logic [2:0][LANES-1:0][CW-1:0] step, point;
  localparam int T_STEP = T_t + LAT.mul;
  if (BOX != 0) begin : g_point
    `DF_VSCALE(t_d, d, t)
    `DF_VADD(o_t_d, o, t_d)
    assign step = t_d;
    assign point = o_t_d;
  end else begin : g_no_point
    assign {step, point} = '0;
  end
  `DF_VIN(td, step, T_STEP)
  `DF_VIN(p, point, T_STEP + LAT.add)
  `RAY_BOX(hit, met, td, p)

  `RAY_RESULT(hit, t, cp, 2)
  `undef DF_CANON
  `define DF_CANON 1
endmodule
