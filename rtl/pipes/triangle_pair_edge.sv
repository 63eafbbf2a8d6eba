// SPDX-License-Identifier: Apache-2.0
// Candidate axis (SAT): edge I of triangle A, from p along e, and edge J of triangle B, from q along f. A's first
// vertex is 0. The normal is e x f, with f less its part along e: perpendicular to both edges at any angle. The third
// vertices choose its side: A is behind its edge and B before its own. If both are in one plane, it is the side with
// the larger distance, ties the side of e x f. If there is no normal, separation = -inf. Nearest points: solve t across
// e, then s on A's edge, then t again for that s. If neither is at an end, v is along the normal. Else v ends on the
// edge f_o, and inverse_ff_o is 1 / f.f of that edge, or 0 if v ends on no edge.
// Operators: 53 add, 64 mul, 1 div, 1 sqrt, 7 compare, 14 min/max; 47 add with I = 0.
// Latency: LATENCY_TRIANGLE_PAIR_EDGE cycles; 0 with ARITH = "host".
// Throughput: one axis per lane per cycle.
// Stall: none.
`include "triangle_pair.svh"
module triangle_pair_edge #(
    `DF_PARAMETERS,
    parameter int I = 0,  // edge of A, 0..2
    parameter int J = 0  // edge of B, 0..2
) (
    input logic clk_i,
    input logic [2:1][2:0][LANES-1:0][CW-1:0] p_i,  // vertices of A except the first
    input logic [2:0][2:0][LANES-1:0][CW-1:0] q_i,  // vertices of B
    input logic [2:0][LANES-1:0][CW-1:0] e_i,
    input logic [2:0][LANES-1:0][CW-1:0] unit_e_i,  // e of unit length
    input logic [LANES-1:0][CW-1:0] inverse_e_i,  // 1 / |e|
    input logic [LANES-1:0][CW-1:0] inverse_ee_i,  // 1 / e.e
    input logic [2:0][LANES-1:0][CW-1:0] f_i,
    input logic [LANES-1:0][CW-1:0] inverse_ff_i,
    input logic [LANES-1:0][CW-1:0] tie_i,
    output logic [LANES-1:0][CW-1:0] separation_o,
    output logic [2:0][LANES-1:0][CW-1:0] n_o,
    output logic [2:0][LANES-1:0][CW-1:0] v_o,
    output logic [2:0][LANES-1:0][CW-1:0] p_o,
    output logic [LANES-1:0][CW-1:0] d2_o,
    output logic [2:0][LANES-1:0][CW-1:0] f_o,
    output logic [LANES-1:0][CW-1:0] inverse_ff_o
);
  /*verilator inline_module*/
  localparam int K = (I + 2) % 3, L = (J + 2) % 3;  // the third vertices
  localparam logic [CW-1:0] ONE = ((CW'(1) << (EXP - 1)) - 1) << MAN;
  localparam logic [CW-1:0] MINUS_INF = (CW'(1) << (EXP + MAN)) | (((CW'(1) << EXP) - 1) << MAN);
  localparam int T_p = 0;
  logic [2:1][2:0][LANES-1:0][CW-1:0] p;
  assign p = p_i;
  `DF_MATRIX_IN(q, q_i[0], q_i[1], q_i[2], 0)
  `DF_VIN(e, e_i, 0)
  `DF_VIN(unit_e, unit_e_i, 0)
  `DF_IN(inverse_e, inverse_e_i, 0)
  `DF_IN(inverse_ee, inverse_ee_i, 0)
  `DF_VIN(f, f_i, 0)
  `DF_IN(inverse_ff, inverse_ff_i, 0)
  `DF_IN(tie, tie_i, 0)
  `DF_CONST(zero, 0)
  `DF_CONST(one, ONE)
  `DF_CONST(minus_inf, MINUS_INF)

  // ---- The normal ----
  `DF_DOT(ef, unit_e, f)
  `DF_VSCALE(f_part, unit_e, ef)
  `DF_VSUB(f_across, f, f_part)
  `DF_CROSS(m, unit_e, f_across)
  `DF_DOT(mm, m, m)
  `DF_USABLE(valid, mm)
  `DF_SQRT(length, mm)
  `DF_RECIPROCAL_OR_ZERO(inverse, valid, length)
  `DF_VSCALE(n, m, inverse)
  if (T_n != `LATENCY_TRIANGLE_PAIR_NORMAL) $error("triangle_pair_edge: stage time of the normal");

  // ---- Its side and separation ----
  `DF_ALONG_ZERO(on_a, p, n)
  `DF_APPLY(on_b, q, n)
  `DF_SPAN(a_low, a_high, on_a)
  `DF_SPAN(b_low, b_high, on_b)
  `DF_SEPARATIONS(separations, a, b, one, tie)
  `DF_PICK(on_a_edge, on_a, I)
  `DF_PICK(on_a_third, on_a, K)
  `DF_PICK(on_b_edge, on_b, J)
  `DF_PICK(on_b_third, on_b, L)
  `DF_SUB(before_b, on_b_third, on_b_edge)
  `DF_SUB(behind_a, on_a_third, on_a_edge)
  `DF_SUB(apart, before_b, behind_a)
  `DF_SIDE_OF(side, apart, tie, separations_side)
  `DF_NEGATIVE(turned, side)
  `DF_SELECT(side_separation, turned, separations_below, separations_above)
  `DF_SELECT(separation, valid, side_separation, minus_inf)
  `DF_VFLIP(n_side, side, n)

  // ---- t across e ----
  `DF_ROW(q_edge, q, J)
  logic [2:0][LANES-1:0][CW-1:0] between;
  localparam int T_BETWEEN = (I == 0) ? 0 : LAT.add;
  if (I == 0) begin : g_from_zero
    assign between = q_edge;
  end else begin : g_from_p
    `DF_ROW(p_edge, p, I)
    `DF_VSUB(from_p, q_edge, p_edge)
    assign between = from_p;
  end
  `DF_VIN(w, between, T_BETWEEN)
  `DF_CROSS(across, n, unit_e)
  `DF_DOT(w_across, w, across)
  `DF_MUL(minus_t1, w_across, inverse)
  `DF_NEG(t1_free, minus_t1)
  `DF_CLAMP(t1, t1_free, zero, one)

  // ---- s, then t again ----
  `DF_DOT(w_along, w, unit_e)
  `DF_MUL(t1_along, t1, ef)
  `DF_ADD(s_length, w_along, t1_along)
  `DF_MUL(s_free, s_length, inverse_e)
  `DF_CLAMP(s, s_free, zero, one)
  `DF_VSCALE(along, e, s)
  `DF_VSUB(r, w, along)
  `DF_DOT(rf, r, f)
  `DF_MUL(minus_t, rf, inverse_ff)
  `DF_NEG(t_free, minus_t)
  `DF_CLAMP(t, t_free, zero, one)

  // ---- Results for the nearest points ----
  `DF_VSCALE(f_t, f, t)
  `DF_VADD(v_ends, r, f_t)
  `DF_EQ(s_kept, s, s_free)
  `DF_LT(has_length, zero, inverse_e)
  `DF_AND(s_inside, s_kept, has_length)
  `DF_EQ(t1_inside, t1, t1_free)
  `DF_AND(both_inside, s_inside, t1_inside)
  `DF_AND(along_n, valid, both_inside)
  `DF_SUB(h, on_b_edge, on_a_edge)
  `DF_VSCALE(v_normal, n, h)
  `DF_VSELECT(v, along_n, v_normal, v_ends)
  `DF_DOT(d2, v, v)
  `DF_VSELECT(ends_on, s_inside, e, f)
  `DF_EQ(t_inside, t, t_free)
  `DF_SELECT(inverse_f, t_inside, inverse_ff, zero)
  `DF_SELECT(inverse_edge, s_inside, inverse_ee, inverse_f)
  `DF_SELECT(inverse_here, along_n, zero, inverse_edge)

  localparam int T_OUT = `LATENCY_TRIANGLE_PAIR_EDGE;
  if (`DF_MAX2(T_d2, T_inverse_here) != T_OUT) $error("triangle_pair_edge: latency");
  if (I == 0) begin : g_at_zero
    `DF_VAT(p_out, along, T_OUT)
    assign p_o = p_out;
  end else begin : g_at_p
    `DF_ROW(p_edge, p, I)
    `DF_VADD(at_s, p_edge, along)
    `DF_VAT(p_out, at_s, T_OUT)
    assign p_o = p_out;
  end
  `DF_AT(separation_out, separation, T_OUT)
  `DF_VAT(n_out, n_side, T_OUT)
  `DF_VAT(v_out, v, T_OUT)
  `DF_AT(d2_out, d2, T_OUT)
  `DF_VAT(ends_on_out, ends_on, T_OUT)
  `DF_AT(inverse_out, inverse_here, T_OUT)
  assign separation_o = separation_out;
  assign n_o = n_out;
  assign v_o = v_out;
  assign d2_o = d2_out;
  assign f_o = ends_on_out;
  assign inverse_ff_o = inverse_out;
endmodule
