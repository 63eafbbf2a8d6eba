// SPDX-License-Identifier: Apache-2.0
// Candidate axis (SAT): a box's edge along axis I and an edge q + t f of the other body, low <= t <= 1.
// The vector n is the edge normal (edge_normal.sv), turned by the sign of `side`. `sign_k` and `sign_l` choose the
// box's edge on the side that n points to. Nearest points: solve t in the plane perpendicular to the axis, then s on
// the box's edge, then t again for that s. The output `separation_o` is -inf if there is no normal. If s is not at an
// end, v_I is 0. The output inverse_ff_o is 0 where t is at an end.
// Operators: 11 add, 12 mul, 2 compare, 6 min/max.
// Latency: LATENCY_EDGE_AXIS cycles; 0 with ARITH = "host".
// Throughput: one axis per lane per cycle.
// Stall: none.
`include "convex.svh"
module edge_axis #(
    `DF_PARAMETERS,
    parameter int I = 0,         // axis, 0..2
    parameter bit CENTRED = 0,   // 1: low is -1; else 0
    parameter int T_SEPARATION = 0  // stage time of separation_i, at most LATENCY_EDGE_AXIS
) (
    input logic clk_i,
    input logic [2:0][LANES-1:0][CW-1:0] a_i,  // half extents
    input logic [LANES-1:0][CW-1:0] sign_k_i,
    input logic [LANES-1:0][CW-1:0] sign_l_i,
    input logic [2:0][LANES-1:0][CW-1:0] q_i,
    input logic [2:0][LANES-1:0][CW-1:0] f_i,
    input logic [LANES-1:0][CW-1:0] inverse_ff_i,
    input logic [LANES-1:0][CW-1:0] n_k_i,
    input logic [LANES-1:0][CW-1:0] n_l_i,
    input logic [LANES-1:0][CW-1:0] inverse2_i,
    input logic [LANES-1:0][CW-1:0] valid_i,
    input logic [LANES-1:0][CW-1:0] side_i,
    input logic [LANES-1:0][CW-1:0] separation_i,
    output logic [LANES-1:0][CW-1:0] separation_o,
    output logic [2:0][LANES-1:0][CW-1:0] n_o,
    output logic [2:0][LANES-1:0][CW-1:0] v_o,
    output logic [2:0][LANES-1:0][CW-1:0] p_o,
    output logic [LANES-1:0][CW-1:0] d2_o,
    output logic [2:0][LANES-1:0][CW-1:0] f_o,  // f of the other body's edge
    output logic [LANES-1:0][CW-1:0] inverse_ff_o
);
  /*verilator inline_module*/
  localparam int K = (I + 1) % 3, L = (I + 2) % 3;
  localparam logic [CW-1:0] ONE = ((CW'(1) << (EXP - 1)) - 1) << MAN;
  localparam logic [CW-1:0] SIGN = CW'(1) << (EXP + MAN);
  localparam logic [CW-1:0] LOW = CENTRED ? (ONE | SIGN) : 0;
  localparam logic [CW-1:0] MINUS_INF = SIGN | (((CW'(1) << EXP) - 1) << MAN);
  `DF_IN(half, a_i[I], 0)
  `DF_IN(a_k, a_i[K], 0)
  `DF_IN(a_l, a_i[L], 0)
  `DF_IN(sign_k, sign_k_i, 0)
  `DF_IN(sign_l, sign_l_i, 0)
  `DF_IN(q_i_axis, q_i[I], 0)
  `DF_IN(q_k, q_i[K], 0)
  `DF_IN(q_l, q_i[L], 0)
  `DF_VIN(f, f_i, 0)
  `DF_IN(f_i_axis, f_i[I], 0)
  `DF_IN(f_k, f_i[K], 0)
  `DF_IN(f_l, f_i[L], 0)
  `DF_IN(inverse_ff, inverse_ff_i, 0)
  `DF_IN(n_k, n_k_i, 0)
  `DF_IN(n_l, n_l_i, 0)
  `DF_IN(inverse2, inverse2_i, 0)
  `DF_IN(valid, valid_i, 0)
  `DF_IN(side, side_i, 0)
  `DF_IN(separation, separation_i, T_SEPARATION)
  `DF_CONST(zero, 0)
  `DF_CONST(one, ONE)
  `DF_CONST(low, LOW)
  `DF_CONST(minus_inf, MINUS_INF)

  // ---- t in the plane perpendicular to the axis ----
  `DF_MOVE_SIGN(at_k, sign_k, a_k)
  `DF_MOVE_SIGN(at_l, sign_l, a_l)
  `DF_SUB(w_k, q_k, at_k)
  `DF_SUB(w_l, q_l, at_l)
  `DF_DOT2(across, w_k, f_k, w_l, f_l)
  `DF_MUL(minus_t1, across, inverse2)
  `DF_NEG(t1_free, minus_t1)
  `DF_CLAMP(t1, t1_free, low, one)

  // ---- s, then t again ----
  `DF_MUL(t1_f, t1, f_i_axis)
  `DF_ADD(s_free, q_i_axis, t1_f)
  `DF_NEG(minus_half, half)
  `DF_CLAMP(s, s_free, minus_half, half)
  `DF_SUB(rest, q_i_axis, s)
  `DF_MUL(rest_f, rest, f_i_axis)
  `DF_ADD(slope, across, rest_f)
  `DF_MUL(minus_t2, slope, inverse_ff)
  `DF_NEG(t2, minus_t2)
  `DF_CLAMP(t, t2, low, one)

  // ---- Results for the nearest points ----
  `DF_MUL(t_f_i, t, f_i_axis)
  `DF_ADD(v_along, rest, t_f_i)
  `DF_EQ(s_inside, s_free, s)
  `DF_SELECT(v_i_axis, s_inside, zero, v_along)
  `DF_MUL(t_f_k, t, f_k)
  `DF_ADD(v_k, w_k, t_f_k)
  `DF_MUL(t_f_l, t, f_l)
  `DF_ADD(v_l, w_l, t_f_l)
  `DF_VAXES(v, I, v_i_axis, v_k, v_l)
  `DF_DOT(d2, v, v)
  `DF_VAXES(p, I, s, at_k, at_l)
  `DF_EQ(t_inside, t2, t)
  `DF_SELECT(inverse_here, t_inside, inverse_ff, zero)
  `DF_MOVE_SIGN(n_k_out, side, n_k)
  `DF_MOVE_SIGN(n_l_out, side, n_l)
  `DF_VAXES(n, I, zero, n_k_out, n_l_out)
  `DF_SELECT(separation_valid, valid, separation, minus_inf)

  localparam int T_OUT = `LATENCY_EDGE_AXIS;
  if (`DF_MAX2(T_d2, T_inverse_here) != T_OUT) $error("edge_axis: latency");
  `DF_AT(separation_out, separation_valid, T_OUT)
  `DF_VAT(n_out, n, T_OUT)
  `DF_VAT(v_out, v, T_OUT)
  `DF_VAT(p_out, p, T_OUT)
  `DF_AT(d2_out, d2, T_OUT)
  `DF_VAT(f_out, f, T_OUT)
  `DF_AT(inverse_out, inverse_here, T_OUT)
  assign separation_o = separation_out;
  assign n_o = n_out;
  assign v_o = v_out;
  assign p_o = p_out;
  assign d2_o = d2_out;
  assign f_o = f_out;
  assign inverse_ff_o = inverse_out;
endmodule
