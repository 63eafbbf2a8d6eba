// SPDX-License-Identifier: Apache-2.0
// Shared by the parts of the cylinder pairs: phases of a pass, latencies, and parts as operators. Each part takes its
// inputs at its own stage time 0 and gives its outputs at the latency named here. It refuses to elaborate if its stage
// times do not fit.
`ifndef CDE_CYLINDER_SVH
`define CDE_CYLINDER_SVH
`include "pipe.svh"

// ---- BODY: shape of the primary ----
`define BODY_CYLINDER 0
`define BODY_BOX 1
`define BODY_TRIANGLE 2

// ---- Phases of a pass (host/include/cde/reference/pipes/cylinder/schedule.hpp) ----
`define PHASE_FRAME 4'd0
`define PHASE_AXIS 4'd1
`define PHASE_CENTRE 4'd2
`define PHASE_VERTEX 4'd3
`define PHASE_CAP 4'd4
`define PHASE_SIDE 4'd5
`define PHASE_BESIDE 4'd6
`define PHASE_SAMPLE 4'd7
`define PHASE_REFINE 4'd8
`define PHASE_POLE 4'd9
`define PHASE_START 4'd10
`define PHASE_NEWTON 4'd11
`define PHASE_TOUCH 4'd12
`define PHASE_PROJECT 4'd13

// ---- The control word of a pass: [3:0] phase, [5:4] track, [13:6] index ----
`define PASS_W 14
`define PASS_PHASE(P) P[3:0]
`define PASS_TRACK(P) P[5:4]
`define PASS_INDEX(P) P[13:6]
`define PASS_INDEX_LOW(P) P[7:6]
// Witness points: first projections between the features that n touches, then between those that it nearly touches. The
// last two are between the solids. From UNSHIFTED on, solids that are clearly apart are not moved. After that, a pass
// tries the normal that the previous pass found.
`define PROJECTIONS 8'd4
`define WIDE_PROJECTIONS 8'd7
`define UNSHIFTED (`WIDE_PROJECTIONS - 8'd4)
`define PASS_TRIAL(P) (`PASS_TRACK(P) == 1 && `PASS_INDEX(P) > `UNSHIFTED)

// ---- Latencies of parts ----
`define LATENCY_NORMALISE (`DF_LAT_DOT + `DF_MAX2(LAT.cmp, LAT.sqrt + LAT.div) + LAT.mul)
`define LATENCY_RIM (`DF_LAT_CROSS + `DF_LAT_DOT + LAT.sqrt + `DF_MAX2(LAT.cmp, LAT.div) + 2 * LAT.mul)
`define LATENCY_REACH (formats_pkg::larger(`LATENCY_RIM, `DF_LAT_DOT + 2 * LAT.cmp) + LAT.add)
`define LATENCY_EVALUATOR (`LATENCY_REACH + 2 * LAT.add)
// The front's raw normal: cross products and the test for a usable normal. For a polyhedron: from a vertex, or the test
// for a flat triangle.
`define LATENCY_CYLINDER_RAW (`DF_LAT_CROSS + `DF_MAX2(`DF_LAT_CROSS, `DF_LAT_DOT + LAT.cmp))
`define LATENCY_POLYHEDRON_RAW (((BODY == `BODY_BOX) ? 3 : 1) * LAT.add + `DF_LAT_DOT + `DF_MAX2( \
  `DF_LAT_CROSS + LAT.sqrt + LAT.add + LAT.mul + `DF_MAX3(LAT.mul, LAT.add, LAT.cmp), 2 * LAT.mul + 2 * LAT.cmp))
`define LATENCY_FRONT (((BODY == `BODY_CYLINDER) ? `LATENCY_CYLINDER_RAW : `LATENCY_POLYHEDRON_RAW) + \
  `LATENCY_NORMALISE)
// Circle: the slope of the new normal, which may become an end of the bracket. Then Newton's normal and the test that
// it stays in the bracket, or the tie.
`define LATENCY_SLOPE (`DF_LAT_CROSS + `DF_LAT_DOT)
`define LATENCY_TIE (LAT.add + `DF_LAT_DOT + LAT.add + 2 * LAT.mul + 2 * LAT.cmp + LAT.add)
`define LATENCY_ENDS ((BODY == `BODY_CYLINDER) ? `LATENCY_SLOPE + LAT.cmp : `DF_MAX2(`LATENCY_SLOPE, LAT.cmp) + \
  2 * LAT.cmp)
`define LATENCY_CIRCLE formats_pkg::larger(`LATENCY_ENDS + `LATENCY_TIE, \
  formats_pkg::larger(`LATENCY_SLOPE + 3 * LAT.mul + 3 * LAT.add + LAT.div, \
  `LATENCY_ENDS + `DF_LAT_CROSS) + `DF_LAT_DOT + LAT.cmp)
`define LATENCY_POLE (3 * `DF_LAT_DOT + 4 * LAT.mul + 3 * LAT.add + LAT.cmp + `DF_LAT_DOT + LAT.add + LAT.mul + \
  `DF_MAX2(LAT.sqrt, LAT.mul) + \
  LAT.div + 2 * LAT.cmp + LAT.mul + LAT.add)
`define LATENCY_NEWTON (4 * LAT.cmp + `DF_LAT_CROSS + `DF_LAT_DOT + 7 * LAT.mul + 9 * LAT.add + LAT.sqrt + LAT.div)
`define LATENCY_FREE `DF_MAX2(`LATENCY_POLE, `LATENCY_NEWTON)
`define LATENCY_STEP ((BODY == `BODY_CYLINDER) ? formats_pkg::larger(`LATENCY_CIRCLE, `LATENCY_FREE) : `LATENCY_CIRCLE)
`define LATENCY_PROJECT_CYLINDER (LAT.add + `DF_LAT_DOT + `DF_MAX2(2 * `DF_LAT_CROSS + LAT.sqrt + LAT.div, LAT.cmp) + \
  LAT.cmp + LAT.mul + 2 * LAT.add)
`define LATENCY_PROJECT_BOX (`DF_LAT_DOT + 2 * LAT.cmp + LAT.mul + 2 * LAT.add)
`define LATENCY_PROJECT_TRIANGLE (3 * LAT.add + 2 * `DF_LAT_DOT + LAT.div + LAT.mul + 5 * LAT.cmp)
`define LATENCY_PROJECT ((BODY == `BODY_CYLINDER) ? `LATENCY_PROJECT_CYLINDER : (BODY == `BODY_BOX) ? \
  `LATENCY_PROJECT_BOX : `LATENCY_PROJECT_TRIANGLE)
`define LATENCY_CYLINDER_WITNESS (LAT.mul + LAT.add + `DF_MAX2(LAT.add, LAT.cmp) + `LATENCY_PROJECT_CYLINDER + \
  `LATENCY_PROJECT + 2 * LAT.add + `DF_LAT_DOT + \
  `DF_MAX2(2 * LAT.cmp, LAT.div + `DF_MAX2(LAT.cmp, LAT.mul + LAT.add)))

// ---- Operators ----
// V of unit length; NaN if its square is lost among the subnormals. 6 mul, 2 add, 1 div, 1 sqrt, 1 compare.
`define DF_NORMALISE(R, V) `DF_DOT(R``_square, V, V) `DF_CONST(R``_least, CW'(3) << MAN) \
  `DF_CONST(R``_one, `DF_POWER_OF_TWO(0)) \
  `DF_CONST(R``_nan, (((CW'(1) << EXP) - 1) << MAN) | (CW'(1) << (MAN - 1))) `DF_LE(R``_usable, R``_least, R``_square) \
  `DF_SQRT(R``_length, R``_square) `DF_DIV(R``_inverse, R``_one, R``_length) \
    `DF_SELECT(R``_factor, R``_usable, R``_inverse, R``_nan) \
  `DF_VSCALE(R, V, R``_factor)
// A vector perpendicular to V: the longer of V x (1 0 0) and V x (0 1 0). 2 compare.
`define DF_ACROSS(R, V) `DF_VABS(R``_size, V) `DF_PICK(R``_x, R``_size, 0) `DF_PICK(R``_y, R``_size, 1) \
  `DF_PICK(R``_z, R``_size, 2) \
  `DF_LE(R``_over_y, R``_y, R``_x) `DF_LE(R``_over_z, R``_z, R``_x) `DF_AND(R``_along_x, R``_over_y, R``_over_z) \
  `DF_PICK(R``_vx, V, 0) `DF_PICK(R``_vy, V, 1) `DF_PICK(R``_vz, V, 2) `DF_NEG(R``_my, R``_vy) `DF_NEG(R``_mz, R``_vz) \
    `DF_CONST(R``_zero, 0) \
  `DF_VEC(R``_if, R``_mz, R``_zero, R``_vx) `DF_VEC(R``_else, R``_zero, R``_vz, R``_my) \
    `DF_VSELECT(R, R``_along_x, R``_if, R``_else)
// The rim of a cylinder with axis A and radius RADIUS, for the normal N. OFF: its support is the cap's centre.
`define DF_RIM(R, A, RADIUS, N, OFF) \
  localparam int T_``R``_width = T_``N + `LATENCY_RIM, T_``R``_side = T_``R``_width, T_``R``_kappa = T_``R``_width, \
    T_``R``_v = T_``R``_width; \
  `DF_SCALAR R``_width, R``_kappa; `DF_VECTOR R``_side, R``_v; \
  cylinder_rim #(`DF_SAME) rim_``R ( \
      .clk_i, .off_i(OFF), .a_i(A), .radius_i(RADIUS), .n_i(N), .width_o(R``_width), .side_o(R``_side), \
        .kappa_o(R``_kappa), .v_o(R``_v));
// The point of a cylinder nearest to X: centre C, axis A, half height HALF and the radius. The other arguments are as
// in project_cylinder.sv.
`define DF_PROJECT_CYLINDER(R, X, C, A, HALF, RADIUS, SIDE, ALONGSIDE, END, RIM) localparam int T_``R = \
  `DF_MAX2(T_``X, T_``C) + `LATENCY_PROJECT_CYLINDER; \
  `DF_VECTOR R; \
  project_cylinder #(`DF_SAME, .T_X(T_``X), .T_C(T_``C), .T_ALONGSIDE(T_``ALONGSIDE), .T_END(T_``END), \
      .T_RIM(T_``RIM)) project_``R ( \
      .clk_i, .en_i(`DF_EN), .x_i(X), .c_i(C), .a_i(A), .half_i(HALF), .radius_i(RADIUS), .side_i(SIDE), \
        .alongside_i(ALONGSIDE), .end_i(END), \
      .rim_i(RIM), .r_o(R));
`endif
