// SPDX-License-Identifier: Apache-2.0
// Parts of the convex pipes as operators of the dataflow notation. A part is a module that takes its inputs at its own
// stage time 0 and gives all outputs at one time, LATENCY_* below. A part says where an input or output needs another
// time. Each part refuses to elaborate if its stage times do not add up to that latency. Parts in generate loops are
// not listed here: the pipes instantiate them directly.
`ifndef CDE_CONVEX_SVH
`define CDE_CONVEX_SVH
`include "pipe.svh"

// ---- Shared units for candidate axes: SAT_II = 1 or 3 cycles per pair (pair_hold.sv) ----
`define SAT_TURNS ((ARITH == "rtl") ? SAT_II : 1)
`define SAT_T_IN ((SAT_II != 1) ? 1 : 0)
`define SAT_WAIT (SAT_II - 1)

// ---- Stage times of parts ----
`define LATENCY_TURNED (LAT.mul + 2 * LAT.add)
`define LATENCY_PERPENDICULAR (`DF_LAT_DOT + 2 * LAT.mul + LAT.add)
`define LATENCY_FACE_AXIS (2 * LAT.cmp + LAT.add + `DF_LAT_DOT)
`define LATENCY_EDGE_NORMAL (LAT.mul + LAT.add + `DF_MAX2(LAT.cmp, LAT.sqrt + LAT.div) + LAT.mul)
// The critical path: across, t, s, rest, t for that s. Then the vector between the nearest points and its square, or
// whether that t is at an end.
`define LATENCY_EDGE_AXIS ((LAT.add + LAT.mul + LAT.add) + (LAT.mul + 2 * LAT.cmp) + \
  (LAT.mul + LAT.add + 2 * LAT.cmp) + LAT.add + \
  (2 * LAT.mul + LAT.add + 2 * LAT.cmp) + `DF_MAX2(LAT.mul + LAT.add + `DF_LAT_DOT, LAT.cmp))
`define LATENCY_OBB_FACE (3 * LAT.add + `LATENCY_FACE_AXIS)
`define LATENCY_OBB_EDGE (LAT.mul + 3 * LAT.add + LAT.cmp + `LATENCY_EDGE_AXIS)
`define LATENCY_OBB_SUPPORT (`DF_LAT_DOT + 4 * LAT.add)
`define LATENCY_LEAST(COUNT) ($clog2(COUNT) * LAT.cmp)
`define LATENCY_NEAREST(COUNT) (`LATENCY_LEAST(COUNT) + `LATENCY_PERPENDICULAR)
`define LATENCY_WITNESS(COUNT) (`SAT_WAIT + 2 * `LATENCY_LEAST(COUNT) + `DF_MAX2(LAT.add, LAT.cmp) + LAT.cmp + \
  LAT.mul + LAT.add + \
  `DF_LAT_DOT)
`define LATENCY_SETTLE (`DF_MAX2(LAT.add, LAT.mul) + LAT.add + 2 * LAT.cmp + LAT.add)
`define LATENCY_POLISH (`DF_MAX2(`DF_MAX2(2 * LAT.cmp + LAT.mul, LAT.add + `DF_LAT_DOT) + LAT.cmp, LAT.add + \
  `DF_LAT_DOT + LAT.div + LAT.cmp) + \
  LAT.mul + LAT.add)

// ---- Operators ----
// AB + CD, the sum of two products.
`define DF_DOT2(R, A, B, C, D) `DF_MUL(R``_ab, A, B) `DF_MUL(R``_cd, C, D) `DF_ADD(R, R``_ab, R``_cd)
// |x| + |y| + |z|.
`define DF_NORM1(R, V) `DF_VABS(R``_abs, V) `DF_PICK(R``_x, R``_abs, 0) `DF_PICK(R``_y, R``_abs, 1) \
  `DF_PICK(R``_z, R``_abs, 2) \
  `DF_ADD(R``_xy, R``_x, R``_y) `DF_ADD(R, R``_xy, R``_z)
// a.|n|: half the width along n of a box with half extents a.
`define DF_BOX_RADIUS(R, N, A) `DF_VABS(R``_n, N) `DF_DOT(R, A, R``_n)
// Mask: a squared length can be a divisor, because it is not subnormal.
`define DF_USABLE(M, SQUARED) `DF_CONST(M``_least, CW'(1) << MAN) `DF_LE(M, M``_least, SQUARED)
// 1 / X where the mask is set, else 0.
`define DF_RECIPROCAL_OR_ZERO(R, M, X) `DF_CONST(R``_one, ((CW'(1) << (EXP - 1)) - 1) << MAN) `DF_CONST(R``_zero, 0) \
  `DF_DIV(R``_quotient, R``_one, X) `DF_SELECT(R, M, R``_quotient, R``_zero)
// Q moved by F, against the sign of X.
`define DF_AGAINST(R, Q, X, F) `DF_VFLIP(R``_f, X, F) `DF_VSUB(R, Q, R``_f)
// The vector with A on axis I, and B and C on the next two axes.
`define DF_VAXES(R, I, A, B, C) `DF_VEC(R``_cycle, A, B, C) localparam int T_``R = T_``R``_cycle; `DF_VECTOR R; \
  for (genvar k = 0; k < 3; k++) begin : axis_``R assign R[(I+k)%3] = R``_cycle[k]; end
// Length D and direction N of V. Mask M: they are usable, because V.V is a normal number.
`define DF_DIRECTION(N, D, M, V) `DF_DOT(N``_squared, V, V) `DF_USABLE(M, N``_squared) `DF_SQRT(D, N``_squared) \
  `DF_CONST(N``_one, ((CW'(1) << (EXP - 1)) - 1) << MAN) `DF_DIV(N``_inverse, N``_one, D) `DF_VSCALE(N, V, N``_inverse)
// Leading component of the unit vector N: M_x, M_y or else z, the first beyond 5/16. Also that component of V.
`define DF_LEADING(M, N) `DF_CONST(M``_least, CW'(`DF_POWER_OF_TWO(-2)) | (CW'(1) << (MAN - 2))) \
  `DF_PICK(M``_n_x, N, 0) `DF_PICK(M``_n_y, N, 1) \
  `DF_ABS(M``_size_x, M``_n_x) `DF_ABS(M``_size_y, M``_n_y) `DF_LT(M``_x, M``_least, M``_size_x) \
    `DF_LT(M``_y, M``_least, M``_size_y)
`define DF_LEAD(R, M, V) `DF_PICK(R``_v_x, V, 0) `DF_PICK(R``_v_y, V, 1) `DF_PICK(R``_v_z, V, 2) \
  `DF_SELECT3(R, M``_x, M``_y, R``_v_x, R``_v_y, R``_v_z)
// The side of a candidate axis that has the larger signed distance: the sign of the height H. Where H is within TIE, it
// is the sign of ORIENTATION.
`define DF_SIDE_OF(R, H, TIE, ORIENTATION) `DF_ABS(R``_size, H) `DF_LE(R``_ties, R``_size, TIE) \
  `DF_SELECT(R, R``_ties, ORIENTATION, H)
// Three vectors as rows of a matrix.
`define DF_MAT(R, X, Y, Z) localparam int T_``R = `DF_MAX3(T_``X, T_``Y, T_``Z); `DF_MATRIX R; \
  df_pipe_delay #(.W(3 * LANES * CW), .T_A(T_``X), .T(T_``R), .ARITH(ARITH)) delay_x_``R ( \
      .clk_i, .a_i(X), .r_o(R[0])); \
  df_pipe_delay #(.W(3 * LANES * CW), .T_A(T_``Y), .T(T_``R), .ARITH(ARITH)) delay_y_``R ( \
      .clk_i, .a_i(Y), .r_o(R[1])); \
  df_pipe_delay #(.W(3 * LANES * CW), .T_A(T_``Z), .T(T_``R), .ARITH(ARITH)) delay_z_``R (.clk_i, .a_i(Z), .r_o(R[2]));
`define DF_MAT_AT(R, A, TIME) localparam int T_``R = TIME; `DF_MATRIX R; \
  df_pipe_delay #(.W(9 * LANES * CW), .T_A(T_``A), .T(TIME), .ARITH(ARITH)) delay_``R (.clk_i, .a_i(A), .r_o(R));
// Row K of a matrix.
`define DF_ROW(R, M, K) localparam int T_``R = T_``M; `DF_VECTOR R; assign R = M[K];

// ---- Parts ----
`define DF_TURNED(R, X) localparam int T_``R = T_``X + `LATENCY_TURNED; `DF_VECTOR R; \
  turned #(`DF_SAME) turned_``R (.clk_i, .x_i(X), .r_o(R));
// V less its part along F. INVERSE is 1 / F.F or 0.
`define DF_PERPENDICULAR(R, V, F, INVERSE) localparam int T_``R = `DF_MAX3(T_``V, T_``F, T_``INVERSE) + \
  `LATENCY_PERPENDICULAR; \
  `DF_VECTOR R; \
  perpendicular #(`DF_SAME, .T_V(T_``V), .T_F(T_``F), .T_INVERSE(T_``INVERSE)) \
    perpendicular_``R ( \
      .clk_i, .v_i(V), .f_i(F), .inverse_ff_i(INVERSE), .r_o(R));
// The points are x = (v, p). NEAR_V, NEAR_P and FAR_V, FAR_P give R_V, R_P, and the SLACK of NEAR.
`define DF_POLISH(R_V, R_P, SLACK, NEAR_V, NEAR_P, FAR_V, FAR_P, TIE) \
  localparam int T_``R_V = `DF_MAX2(`DF_MAX3(T_``NEAR_V, T_``NEAR_P, T_``TIE), `DF_MAX2(T_``FAR_V, T_``FAR_P)) + \
    `LATENCY_POLISH, T_``R_P = T_``R_V, T_``SLACK = T_``R_V; \
  `DF_VECTOR R_V, R_P; `DF_SCALAR SLACK; \
  polish #(`DF_SAME, .T_NEAR_V(T_``NEAR_V), .T_NEAR_P(T_``NEAR_P), .T_FAR_V(T_``FAR_V), .T_FAR_P(T_``FAR_P), \
      .T_TIE(T_``TIE)) polish_``R_V ( \
      .clk_i, .near_v_i(NEAR_V), .near_p_i(NEAR_P), .far_v_i(FAR_V), .far_p_i(FAR_P), .tie_i(TIE), .v_o(R_V), \
        .p_o(R_P), .slack_o(SLACK));
// The second polishing step counts if it does not raise the slack. FAR_V is farthest against it.
`define DF_NEARER(V, P, SLACK, ONCE_V, ONCE_P, ONCE_SLACK, TWICE_V, TWICE_P, FAR_V) \
  `DF_VSUB(SLACK``_e, FAR_V, TWICE_V) `DF_DOT(SLACK``_minus, TWICE_V, SLACK``_e) \
  `DF_NEG(SLACK``_after, SLACK``_minus) `DF_LT(SLACK``_worse, ONCE_SLACK, SLACK``_after) \
  `DF_SELECT(SLACK, SLACK``_worse, ONCE_SLACK, SLACK``_after) \
  `DF_VSELECT(V, SLACK``_worse, ONCE_V, TWICE_V) `DF_VSELECT(P, SLACK``_worse, ONCE_P, TWICE_P)
// Distance from the nearest point with length D, direction N and SLACK: ALONG is the signed distance along N. The
// distance lies between D and the larger of ALONG and AXES_S; S is the middle of the two.
`define DF_POINT_DISTANCE(ALONG, S, N, D, SLACK, AXES_S) `DF_MUL(ALONG``_less, SLACK, N``_inverse) \
  `DF_SUB(ALONG, D, ALONG``_less) \
  `DF_MAX(S``_low, AXES_S, ALONG) `DF_ADD(S``_twice, D, S``_low) `DF_CONST(S``_half, CW'(`DF_POWER_OF_TWO(-1))) \
  `DF_MUL(S, S``_twice, S``_half)

// Witness points of the chosen axis FROM: the same point of B, and the nearest point of box A to its ideal place, S N
// away.
// Operators: 9 add, 3 mul, 6 min/max.
`define DF_SETTLE(V, P, FROM_V, FROM_P, S, N, HALF) `DF_VADD(V``_q, FROM_P, FROM_V) `DF_VSCALE(V``_apart, N, S) \
  `DF_VSUB(V``_ideal, V``_q, V``_apart) \
  `DF_VNEG(V``_low, HALF) `DF_VCLAMP(P, V``_ideal, V``_low, HALF) `DF_VSUB(V, V``_q, P)

// ---- Choice between two results (S, N, V, P): AXES_* of the axes, POINT_* of the polished point of B - A ----
// The point counts if the bodies are apart, D is FIT, and the distance ALONG its direction is at most TIE below
// AXES_S. So the axes decide when the distance is too small for the point to have a direction.
`define DF_DECIDE(S, N, V, P, AXES_S, AXES_N, AXES_V, AXES_P, POINT_S, POINT_N, POINT_V, POINT_P, FIT, ALONG, TIE) \
  `DF_CONST(S``_zero, 0) `DF_LT(S``_apart, S``_zero, AXES_S) `DF_SUB(S``_tied, AXES_S, TIE) \
    `DF_LE(S``_confirmed, S``_tied, ALONG) \
  `DF_AND(S``_usable, S``_apart, FIT) `DF_AND(S``_point, S``_usable, S``_confirmed) \
  `DF_SELECT(S, S``_point, POINT_S, AXES_S) `DF_VSELECT(N, S``_point, POINT_N, AXES_N) \
  `DF_VSELECT(V, S``_point, POINT_V, AXES_V) `DF_VSELECT(P, S``_point, POINT_P, AXES_P)
`endif
