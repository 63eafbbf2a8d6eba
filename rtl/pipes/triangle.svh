// SPDX-License-Identifier: Apache-2.0
// Parts of the convex pipes with a triangle, as operators of the dataflow notation, as in convex.svh.
`ifndef CDE_TRIANGLE_SVH
`define CDE_TRIANGLE_SVH
`include "convex.svh"

// For stage times built from others: a macro that repeats its arguments grows too fast.
`define LARGER(A, B) formats_pkg::larger(A, B)

// ---- Stage times of the outputs of triangle_parts, from the vertices: edges, 1 / f.f, which edge is longest, normal
`define TRIANGLE_T_F (LAT.add)
`define TRIANGLE_T_INVERSE (LAT.add + `DF_LAT_DOT + `LARGER(LAT.cmp, LAT.div))
`define TRIANGLE_T_LONGEST (LAT.add + `DF_LAT_DOT + 3 * LAT.cmp)
`define TRIANGLE_T_I (`LARGER(`TRIANGLE_T_LONGEST, `TRIANGLE_T_INVERSE) + LAT.mul)
// A face's normal, or a line's if the triangle has no area.
`define TRIANGLE_T_M (`LARGER(`LARGER(`TRIANGLE_T_LONGEST + `DF_LAT_DOT, `TRIANGLE_T_I) + \
  LAT.mul + LAT.add + `DF_LAT_CROSS, `LARGER(`TRIANGLE_T_LONGEST + LAT.cmp, `TRIANGLE_T_I)) + \
  `DF_LAT_DOT + LAT.cmp + LAT.sqrt + LAT.div + LAT.mul)

// Triangle R from the matrix P of its vertices: R_f are the edges (rows). Also R_inverse_ff, R_longest0, R_longest1,
// R_m and R_flat.
`define DF_TRIANGLE(R, P) \
  localparam int T_``R``_f = T_``P + `TRIANGLE_T_F, T_``R``_inverse_ff = T_``P + `TRIANGLE_T_INVERSE; \
  localparam int T_``R``_longest0 = T_``P + `TRIANGLE_T_LONGEST, T_``R``_longest1 = T_``R``_longest0; \
  localparam int T_``R``_m = T_``P + `TRIANGLE_T_M, T_``R``_flat = T_``R``_m; \
  `DF_MATRIX R``_f; `DF_VECTOR R``_inverse_ff, R``_m; `DF_SCALAR R``_longest0, R``_longest1, R``_flat; \
  triangle_parts #(`DF_SAME) parts_``R ( \
      .clk_i, .p_i(P), .f_o(R``_f), .inverse_ff_o(R``_inverse_ff), .longest0_o(R``_longest0), \
        .longest1_o(R``_longest1), .m_o(R``_m), \
      .flat_o(R``_flat));

// ---- Stage times of the outputs of point_triangle; W, T: signals relative to the vertices, prefix of a triangle ----
`define POINT_TRIANGLE_T_EDGE(W, F, INVERSE) (`LARGER(`LARGER(W, F) + `DF_LAT_DOT, INVERSE) + LAT.mul + 2 * LAT.cmp + \
  LAT.mul + LAT.add + \
  `DF_LAT_DOT + LAT.cmp + `LATENCY_PERPENDICULAR)
`define POINT_TRIANGLE_T_INSIDE(W, F, M) `LARGER(`LARGER(`LARGER(W, F) + `DF_LAT_CROSS, M) + `DF_LAT_DOT + LAT.cmp, \
  `LARGER(W, M) + `DF_LAT_DOT + LAT.mul)
`define POINT_TRIANGLE_T_V(W, F, INVERSE, M) `LARGER(`POINT_TRIANGLE_T_EDGE(W, F, INVERSE), \
  `POINT_TRIANGLE_T_INSIDE(W, F, M))

// The point given as W (matrix, point - vertex) relative to the vertices of triangle T. R_v goes from the closest point
// of T to it, R_d2 = |R_v|^2. R_h is its signed distance from the plane.
`define DF_POINT_TRIANGLE(R, W, T) \
  localparam int T_``R``_v = `POINT_TRIANGLE_T_V(T_``W, T_``T``_f, T_``T``_inverse_ff, T_``T``_m), T_``R``_d2 = \
    T_``R``_v; \
  localparam int T_``R``_h = `DF_MAX2(T_``W, T_``T``_m) + `DF_LAT_DOT; \
  `DF_VECTOR R``_v; `DF_SCALAR R``_d2, R``_h; \
  point_triangle #(`DF_SAME, .T_W(T_``W), .T_F(T_``T``_f), .T_INVERSE(T_``T``_inverse_ff), \
      .T_LONGEST(T_``T``_longest0), .T_M(T_``T``_m)) point_``R ( \
      .clk_i, .w_i(W), .f_i(T``_f), .inverse_ff_i(T``_inverse_ff), .longest0_i(T``_longest0), \
        .longest1_i(T``_longest1), .m_i(T``_m), \
      .flat_i(T``_flat), .v_o(R``_v), .d2_o(R``_d2), .h_o(R``_h));

// ---- Triangle against box, in the box's frame: stage times from the vertices ----
`define LATENCY_TRIANGLE_BOX_FACE (4 * LAT.cmp + LAT.add + `LATENCY_FACE_AXIS)
`define LATENCY_TRIANGLE_BOX_EDGE (`LATENCY_EDGE_NORMAL + `LATENCY_EDGE_AXIS)
`define TRIANGLE_BOX_T_M1 (LAT.add + `LATENCY_TURNED + `DF_LAT_CROSS)
`define TRIANGLE_FACE_T_W (`TRIANGLE_T_M + `DF_LAT_DOT + 3 * LAT.cmp + 2 * LAT.add)
`define TRIANGLE_FACE_T `POINT_TRIANGLE_T_V(`TRIANGLE_FACE_T_W, `TRIANGLE_T_F, `TRIANGLE_T_INVERSE, `TRIANGLE_T_M)
`define TRIANGLE_BOX_T_AXES `LARGER(`TRIANGLE_FACE_T, `LARGER(`TRIANGLE_BOX_T_M1, `TRIANGLE_T_INVERSE) + \
  `LATENCY_TRIANGLE_BOX_EDGE + `SAT_WAIT)
`define LATENCY_TRIANGLE_BOX_SUPPORT (`DF_LAT_DOT + LAT.cmp + LAT.add)
`define TRIANGLE_BOX_T_ALONG (`TRIANGLE_BOX_T_AXES + `LATENCY_NEAREST(13) + \
  3 * `LATENCY_TRIANGLE_BOX_SUPPORT + 2 * `LATENCY_POLISH + \
  (LAT.add + `DF_LAT_DOT + LAT.cmp) + `DF_LAT_DOT + LAT.sqrt + LAT.div + LAT.mul + LAT.add)
`define LATENCY_TRIANGLE_BOX (`LARGER(`TRIANGLE_BOX_T_AXES + `LATENCY_WITNESS(13) + `LATENCY_SETTLE, \
  `TRIANGLE_BOX_T_ALONG + LAT.cmp) + \
  LAT.mul + LAT.add)

// For the rows of a matrix P: the least P.N, and its row.
`define DF_ALONG(R, P, N) `DF_APPLY(R``_along, P, N) `DF_PICK(R``_0, R``_along, 0) `DF_PICK(R``_1, R``_along, 1) \
  `DF_PICK(R``_2, R``_along, 2)
`define DF_LEAST_ALONG(R, P, N) `DF_ALONG(R, P, N) `DF_LEAST3(R, R``_0, R``_1, R``_2)
`define DF_LOWEST(R, P, N) `DF_ALONG(R``_of, P, N) `DF_WHICH3(R``_of, R``_of_0, R``_of_1, R``_of_2) \
  `DF_LEAST_ROW(R, R``_of, P)
// The row that DF_WHICH3 chose.
`define DF_LEAST_ROW(R, WHICH, P) `DF_ROW(R``_0, P, 0) `DF_ROW(R``_1, P, 1) `DF_ROW(R``_2, P, 2) \
  `DF_VSELECT3(R, WHICH``_first, WHICH``_second, R``_0, R``_1, R``_2)
// The least and the largest component of V.
`define DF_SPAN(LOW, HIGH, V) `DF_PICK(LOW``_0, V, 0) `DF_PICK(LOW``_1, V, 1) `DF_PICK(LOW``_2, V, 2) \
  `DF_MIN(LOW``_12, LOW``_1, LOW``_2) `DF_MIN(LOW, LOW``_0, LOW``_12) `DF_MAX(HIGH``_12, LOW``_1, LOW``_2) \
    `DF_MAX(HIGH, LOW``_0, HIGH``_12)
// Largest |p|_1 of the rows of P: their reach from the origin.
`define DF_REACH(R, P) `DF_ROW(R``_p0, P, 0) `DF_ROW(R``_p1, P, 1) `DF_ROW(R``_p2, P, 2) `DF_NORM1(R``_0, R``_p0) \
  `DF_NORM1(R``_1, R``_p1) \
  `DF_NORM1(R``_2, R``_p2) `DF_MAX(R``_12, R``_1, R``_2) `DF_MAX(R, R``_0, R``_12)
// For a projection LOW .. HIGH and a box's RADIUS about 0: the larger of the distances above and below the box, and its
// SIDE, a sign.
`define DF_SIDE(SIDE, SEPARATION, LOW, HIGH, RADIUS, TIE, ORIENTATION) \
  `DF_SUB(SEPARATION``_above, LOW, RADIUS) `DF_NEG(SEPARATION``_top, HIGH) \
  `DF_SUB(SEPARATION``_below, SEPARATION``_top, RADIUS) `DF_MAX(SEPARATION, SEPARATION``_above, SEPARATION``_below) \
  `DF_ADD(SIDE``_h, LOW, HIGH) \
  `DF_SIDE_OF(SIDE, SIDE``_h, TIE, ORIENTATION)
`endif
