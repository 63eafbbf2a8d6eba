// SPDX-License-Identifier: Apache-2.0
// Parts of triangle against triangle as operators of the dataflow notation, as in triangle.svh. Positions are relative
// to the first vertex of A. Stage times count from the vertices.
`ifndef CDE_TRIANGLE_PAIR_SVH
`define CDE_TRIANGLE_PAIR_SVH
`include "triangle.svh"

// ---- Stage times ----
// A's edges of unit length.
`define TRIANGLE_PAIR_T_ALONG (`TRIANGLE_T_INVERSE + LAT.sqrt + LAT.mul)
`define TRIANGLE_PAIR_FACE_T_W (`TRIANGLE_T_M + `DF_LAT_DOT + 4 * LAT.cmp + 3 * LAT.add)
`define TRIANGLE_PAIR_FACE_T (`POINT_TRIANGLE_T_V(`TRIANGLE_PAIR_FACE_T_W, `TRIANGLE_T_F, `TRIANGLE_T_INVERSE, \
  `TRIANGLE_T_M) + LAT.add)
// For a pair of edges, from its inputs: the normal; t, s, t for that s. Then v and its square, or whether t is at an
// end.
`define LATENCY_TRIANGLE_PAIR_NORMAL (`DF_LAT_DOT + LAT.mul + LAT.add + `DF_LAT_CROSS + `DF_LAT_DOT + \
  `DF_MAX2(LAT.cmp, LAT.sqrt + LAT.div) + LAT.mul)
`define LATENCY_TRIANGLE_PAIR_EDGE (`LATENCY_TRIANGLE_PAIR_NORMAL + \
  (`DF_LAT_CROSS + `DF_LAT_DOT + LAT.mul + 2 * LAT.cmp) + (LAT.mul + LAT.add + LAT.mul + 2 * LAT.cmp) + \
  (LAT.mul + LAT.add + `DF_LAT_DOT + LAT.mul + 2 * LAT.cmp) + `DF_MAX2(LAT.mul + LAT.add + `DF_LAT_DOT, LAT.cmp))
`define TRIANGLE_PAIR_T_AXES `LARGER(`TRIANGLE_PAIR_FACE_T, \
  `TRIANGLE_PAIR_T_ALONG + `LATENCY_TRIANGLE_PAIR_EDGE)

// ---- Operators ----
// Projections of the rows of P on N; the first row is 0.
`define DF_ALONG_ZERO(R, P, N) `DF_CONST(R``_zero, 0) `DF_ROW(R``_p1, P, 1) `DF_ROW(R``_p2, P, 2) \
  `DF_DOT(R``_on1, R``_p1, N) `DF_DOT(R``_on2, R``_p2, N) `DF_VEC(R, R``_zero, R``_on1, R``_on2)
// The row of P farthest along N; the first row is 0.
`define DF_HIGHEST_ZERO(R, P, N) `DF_CONST(R``_zero, 0) `DF_ROW(R``_p1, P, 1) `DF_ROW(R``_p2, P, 2) \
  `DF_DOT(R``_on1, R``_p1, N) `DF_DOT(R``_on2, R``_p2, N) `DF_NEG(R``_minus1, R``_on1) `DF_NEG(R``_minus2, R``_on2) \
  `DF_WHICH3(R``_of, R``_zero, R``_minus1, R``_minus2) `DF_LEAST_ROW(R, R``_of, P)
// For projections P_low .. P_high and Q_low .. Q_high: the distances from P to Q, above, and from Q to P, below. Also
// the sign of the larger one, or of ONE where that is within TIE.
`define DF_SEPARATIONS(R, P, Q, ONE, TIE) \
  `DF_SUB(R``_above, Q``_low, P``_high) `DF_SUB(R``_below, P``_low, Q``_high) \
  `DF_ADD(R``_q, Q``_low, Q``_high) `DF_ADD(R``_p, P``_low, P``_high) `DF_SUB(R``_h, R``_q, R``_p) \
  `DF_SIDE_OF(R``_side, R``_h, TIE, ONE)
`endif
