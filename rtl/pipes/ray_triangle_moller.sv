// SPDX-License-Identifier: Apache-2.0
// Ray against triangle, Möller and Trumbore 1997, the paper's equation (3): E1 = V1-V0, E2 = V2-V0, T = O-V0, P = D x
// E2, Q = T x E1, det = P.E1, u = P.T, v = Q.D, t = (Q.E2)/det, CP = O + t D. u, v and u+v are compared with det
// unscaled, so the one division is off the hit decision. Two-sided; det = 0 (parallel or degenerate) is a miss: T =
// +inf, CP = 0.
// 27 multipliers, 1 divider, 12 adders, 15 subtractors, 8 comparators.
//
// Latency: LATENCY clocks (10 when every operator takes one); 0 with ARITH = "host". Throughput: LANES pairs a clock.
// Stall: none, runs free.
`include "ray_box.svh"
module ray_triangle_moller #(
    `DF_PARAMETERS,
    parameter int B_LANES = LANES,  // secondaries a clock: 1 (broadcast to all lanes) or LANES
    parameter int BOX = 0          // 1: a hit must lie in the triangle's box (ray_box.sv)
) (
    input logic clk_i,
    input logic [7:0][LANES-1:0][CW-1:0] a_i,    // ray: o x y z, d x y z, tmin, tmax
    input logic [8:0][B_LANES-1:0][CW-1:0] b_i,  // triangle: v0 x y z, v1, v2
    output logic [LANES-1:0][CW-1:0] f_o,        // lane mask
    output logic [LANES-1:0][CW-1:0] t_o,
    output logic [2:0][LANES-1:0][CW-1:0] cp_o,
    output logic [15:0] latency_o  // constant: LATENCY, also with ARITH = "host"
);
  localparam logic [CW-1:0] INF = ((CW'(1) << EXP) - 1) << MAN;

  localparam int T_EDGE = LAT_ADD;
  localparam int T_CROSS = T_EDGE + LAT_MUL + LAT_ADD;
  localparam int T_DOT = T_CROSS + LAT_MUL + 2 * LAT_ADD;
  localparam int T_UV = T_DOT + LAT_ADD;
  localparam int T_UV_IN = T_UV + LAT_CMP;
  localparam int T_T = T_DOT + LAT_DIV;
  localparam int T_RANGE = T_T + LAT_CMP;
  localparam int T_TD = T_T + LAT_MUL;
  localparam int T_CP = T_TD + LAT_ADD;
  localparam int T_IN = (T_UV_IN > T_RANGE) ? T_UV_IN : T_RANGE;
  localparam int T_MET = (T_CP > T_IN) ? T_CP : T_IN;  // before the box

  `define CDE_ALIGN(NAME, WIDTH, AT, UNTIL, D, Q) \
    align #(.W(WIDTH), .FROM(AT), .TO(UNTIL), .ARITH(ARITH)) NAME (.clk_i, .d_i(D), .q_o(Q));
  `define CDE_CMP(NAME, OPERATION, A, B, M) \
    fp_cmp #(.EXP(EXP), .MAN(MAN), .LANES(LANES), .LAT(LAT_CMP), .OP(OPERATION), .ARITH(ARITH)) NAME ( \
        .clk_i, .a_i(A), .b_i(B), .m_o(M), .flags_o());

  // ---- The ray at the stages that need it ----
  logic [2:0][LANES-1:0][CW-1:0] d_cross, d_dot, d_t, o_cp;
  logic [LANES-1:0][CW-1:0] tmin_t, tmax_t;
  `CDE_ALIGN(align_d_cross, 3 * LANES * CW, 0, T_EDGE, a_i[5:3], d_cross)
  `CDE_ALIGN(align_d_dot, 3 * LANES * CW, T_EDGE, T_CROSS, d_cross, d_dot)
  `CDE_ALIGN(align_d_t, 3 * LANES * CW, T_CROSS, T_T, d_dot, d_t)
  `CDE_ALIGN(align_o_cp, 3 * LANES * CW, 0, T_TD, a_i[2:0], o_cp)
  `CDE_ALIGN(align_tmin, LANES * CW, 0, T_T, a_i[6], tmin_t)
  `CDE_ALIGN(align_tmax, LANES * CW, 0, T_T, a_i[7], tmax_t)

  // ---- Edges; the two of the triangle are computed once for all lanes when it is broadcast ----
  logic [2:0][B_LANES-1:0][CW-1:0] e1, e2, e1_dot, e2_dot;
  vec_add #(.EXP(EXP), .MAN(MAN), .LANES(B_LANES), .LAT_ADD(LAT_ADD), .SUB(1), .ARITH(ARITH), .CANON(0)) sub_e1 (
      .clk_i, .a_i(b_i[5:3]), .b_i(b_i[2:0]), .r_o(e1));
  vec_add #(.EXP(EXP), .MAN(MAN), .LANES(B_LANES), .LAT_ADD(LAT_ADD), .SUB(1), .ARITH(ARITH), .CANON(0)) sub_e2 (
      .clk_i, .a_i(b_i[8:6]), .b_i(b_i[2:0]), .r_o(e2));
  `CDE_ALIGN(align_e1, 3 * B_LANES * CW, T_EDGE, T_CROSS, e1, e1_dot)
  `CDE_ALIGN(align_e2, 3 * B_LANES * CW, T_EDGE, T_CROSS, e2, e2_dot)

  logic [2:0][LANES-1:0][CW-1:0] tv, tv_dot, p, q;
  vec_add #(.EXP(EXP), .MAN(MAN), .LANES(LANES), .B_LANES(B_LANES), .LAT_ADD(LAT_ADD), .SUB(1), .ARITH(ARITH),
      .CANON(0)) sub_t (
      .clk_i, .a_i(a_i[2:0]), .b_i(b_i[2:0]), .r_o(tv));
  vec_cross #(.EXP(EXP), .MAN(MAN), .LANES(LANES), .B_LANES(B_LANES), .LAT_ADD(LAT_ADD), .LAT_MUL(LAT_MUL),
      .ARITH(ARITH), .CANON(0)) cross_p (
      .clk_i, .on_i(1'b1), .a_i(d_cross), .b_i(e2), .r_o(p));
  vec_cross #(.EXP(EXP), .MAN(MAN), .LANES(LANES), .B_LANES(B_LANES), .LAT_ADD(LAT_ADD), .LAT_MUL(LAT_MUL),
      .ARITH(ARITH), .CANON(0)) cross_q (
      .clk_i, .on_i(1'b1), .a_i(tv), .b_i(e1), .r_o(q));
  `CDE_ALIGN(align_tv, 3 * LANES * CW, T_EDGE, T_CROSS, tv, tv_dot)

  logic [LANES-1:0][CW-1:0] det, u, v, tn;
  vec_dot #(.EXP(EXP), .MAN(MAN), .LANES(LANES), .B_LANES(B_LANES), .LAT_ADD(LAT_ADD), .LAT_MUL(LAT_MUL), .ARITH(ARITH),
      .CANON(0)) dot_det (
      .clk_i, .on_i(1'b1), .a_i(p), .b_i(e1_dot), .r_o(det));
  vec_dot #(.EXP(EXP), .MAN(MAN), .LANES(LANES), .LAT_ADD(LAT_ADD), .LAT_MUL(LAT_MUL), .ARITH(ARITH), .CANON(0)) dot_u (
      .clk_i, .on_i(1'b1), .a_i(p), .b_i(tv_dot), .r_o(u));
  vec_dot #(.EXP(EXP), .MAN(MAN), .LANES(LANES), .LAT_ADD(LAT_ADD), .LAT_MUL(LAT_MUL), .ARITH(ARITH), .CANON(0)) dot_v (
      .clk_i, .on_i(1'b1), .a_i(q), .b_i(d_dot), .r_o(v));
  vec_dot #(.EXP(EXP), .MAN(MAN), .LANES(LANES), .B_LANES(B_LANES), .LAT_ADD(LAT_ADD), .LAT_MUL(LAT_MUL), .ARITH(ARITH),
      .CANON(0)) dot_t (
      .clk_i, .on_i(1'b1), .a_i(q), .b_i(e2_dot), .r_o(tn));

  // ---- Inside test against |det|: the sign of det is moved to u, v and u+v ----
  logic [LANES-1:0][CW-1:0] uv, det_uv, det_abs, u_flip, v_flip, zero, det_abs_uv, uv_flip;
  fp_add #(.EXP(EXP), .MAN(MAN), .LANES(LANES), .LAT(LAT_ADD), .ARITH(ARITH), .CANON(0)) add_uv (
      .clk_i, .a_i(u), .b_i(v), .r_o(uv), .flags_o());
  assign zero = '0;
  `define CDE_SIGN(NAME, OPERATION, A, B, R) \
    fp_sign #(.EXP(EXP), .MAN(MAN), .LANES(LANES), .OP(OPERATION), .ARITH(ARITH)) NAME (.a_i(A), .b_i(B), .r_o(R));
  `CDE_SIGN(abs_det, formats_pkg::SIGN_ABS, det, zero, det_abs)
  `CDE_SIGN(flip_u, formats_pkg::SIGN_XOR, u, det, u_flip)
  `CDE_SIGN(flip_v, formats_pkg::SIGN_XOR, v, det, v_flip)
  `CDE_ALIGN(align_det, LANES * CW, T_DOT, T_UV, det, det_uv)
  `CDE_SIGN(abs_det_uv, formats_pkg::SIGN_ABS, det_uv, zero, det_abs_uv)
  `CDE_SIGN(flip_uv, formats_pkg::SIGN_XOR, uv, det_uv, uv_flip)
  logic [LANES-1:0][CW-1:0] u_lo, u_hi, v_lo, v_hi, det_nz, uv_hi, t_lo, t_hi;
  `CDE_CMP(cmp_u_lo, formats_pkg::FP_LE, zero, u_flip, u_lo)
  `CDE_CMP(cmp_u_hi, formats_pkg::FP_LE, u_flip, det_abs, u_hi)
  `CDE_CMP(cmp_v_lo, formats_pkg::FP_LE, zero, v_flip, v_lo)
  `CDE_CMP(cmp_v_hi, formats_pkg::FP_LE, v_flip, det_abs, v_hi)
  `CDE_CMP(cmp_det, formats_pkg::FP_LT, zero, det_abs, det_nz)
  `CDE_CMP(cmp_uv, formats_pkg::FP_LE, uv_flip, det_abs_uv, uv_hi)

  // ---- Distance and point ----
  logic [LANES-1:0][CW-1:0] t, t_select, t_finite, t_not_zero, cp_finite;
  logic [2:0][LANES-1:0][CW-1:0] td, cp, cp_select;
  fp_div #(.EXP(EXP), .MAN(MAN), .LANES(LANES), .LAT(LAT_DIV), .ARITH(ARITH), .CANON(0)) div_t (
      .clk_i, .a_i(tn), .b_i(det), .r_o(t), .flags_o());
  `CDE_CMP(cmp_t_lo, formats_pkg::FP_LE, tmin_t, t, t_lo)
  `CDE_CMP(cmp_t_hi, formats_pkg::FP_LE, t, tmax_t, t_hi)
  vec_scale #(.EXP(EXP), .MAN(MAN), .LANES(LANES), .LAT_MUL(LAT_MUL), .ARITH(ARITH), .CANON(0)) scale_d (
      .clk_i, .a_i(d_t), .s_i(t), .r_o(td));
  vec_add #(.EXP(EXP), .MAN(MAN), .LANES(LANES), .LAT_ADD(LAT_ADD), .ARITH(ARITH), .CANON(0)) add_cp (
      .clk_i, .a_i(o_cp), .b_i(td), .r_o(cp));

  // ---- Decision: a hit has a finite CP, so that its T is finite, too, and is never -0; BOX accepts nothing else ----
  `define CDE_CLASS(NAME, OPERATION, A, M) \
    fp_class #(.EXP(EXP), .MAN(MAN), .LANES(LANES), .OP(OPERATION), .ARITH(ARITH)) NAME (.a_i(A), .m_o(M));
  if (BOX != 0) begin : g_known
    assign cp_finite = '1;
  end else begin : g_look
    fp_finite #(.EXP(EXP), .MAN(MAN), .LANES(LANES), .ARITH(ARITH)) finite (.a_i(cp), .m_o(cp_finite));
  end
  `CDE_CLASS(t_zero, formats_pkg::CLASS_NONZERO, t, t_not_zero)
  logic [LANES-1:0][CW-1:0] in_edges, in_edges_uv, in_uv, in_uv_all, in_range, in_range_all, in_all, finite_all,
      met_all, hit_select;
  assign in_edges = u_lo & u_hi & v_lo & v_hi & det_nz;
  `CDE_ALIGN(align_edges, LANES * CW, T_DOT + LAT_CMP, T_UV_IN, in_edges, in_edges_uv)
  assign in_uv = in_edges_uv & uv_hi;
  `CDE_ALIGN(align_uv, LANES * CW, T_UV_IN, T_IN, in_uv, in_uv_all)
  assign in_range = t_lo & t_hi;
  `CDE_ALIGN(align_range, LANES * CW, T_RANGE, T_IN, in_range, in_range_all)
  `CDE_ALIGN(align_in, LANES * CW, T_IN, T_MET, in_uv_all & in_range_all, in_all)
  `CDE_ALIGN(align_finite, LANES * CW, T_CP, T_MET, cp_finite, finite_all)
  assign met_all = in_all & finite_all;
  `DF_IN(met, met_all, T_MET)
  `DF_VIN(t_d, td, T_TD)
  `DF_VIN(point, cp, T_CP)
  `RAY_BOX(hit, met, t_d, point)
  localparam int T_SELECT = T_hit;
  localparam int LATENCY = T_SELECT + 1;
  assign latency_o = 16'(LATENCY);
  assign t_finite = t & t_not_zero;
  assign hit_select = hit;
  `CDE_ALIGN(align_t, LANES * CW, T_T, T_SELECT, t_finite, t_select)
  `CDE_ALIGN(align_cp, 3 * LANES * CW, T_CP, T_SELECT, cp, cp_select)

  // ---- Result: a miss is T = +inf, CP = 0 ----
  logic [LANES-1:0][CW-1:0] t_result;
  logic [2:0][LANES-1:0][CW-1:0] cp_result;
  lane_select #(.CW(CW), .LANES(LANES)) select_t (.m_i(hit_select), .a_i(t_select), .b_i({LANES{INF}}), .r_o(t_result));
  lane_select #(.CW(CW), .LANES(LANES), .WORDS(3)) select_cp (.m_i(hit_select), .a_i(cp_select), .b_i('0),
      .r_o(cp_result));
  `CDE_ALIGN(result_f, LANES * CW, T_SELECT, LATENCY, hit_select, f_o)
  `CDE_ALIGN(result_t, LANES * CW, T_SELECT, LATENCY, t_result, t_o)
  `CDE_ALIGN(result_cp, 3 * LANES * CW, T_SELECT, LATENCY, cp_result, cp_o)
  `undef CDE_ALIGN
  `undef CDE_CMP
  `undef CDE_SIGN
  `undef CDE_CLASS
endmodule
