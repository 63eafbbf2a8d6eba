// SPDX-License-Identifier: Apache-2.0
// Candidate axis (SAT): edge I of box A and edge J of box B, in A's frame (see obb_face.sv). The edge normal is
// n = e_I x f_J / |e_I x f_J|. `sign_k` is component K of B's turned axis r_J, and so on. K, L are the axes after I,
// and M, O those after J. The support edges follow from n.e_K = -r_JL, n.e_L = r_JK, n.r_M = r_OI, n.r_O = -r_MI.
// The inputs `sign_first` and `sign_second` belong to the last two, in the order of B's axes.
// The side has the sign of n.t. If |n.t| <= tie, t has the sign of n's leading component on that side.
// The separation is |n.t| - (sum of a_k |n_k|) - (sum of |n.f_j|). Every term is projected, also n.f_J, which should
// be 0.
// Operators: 26 add, 22 mul, 4 compare, 6 min/max.
// Latency: LATENCY_OBB_EDGE cycles; 0 with ARITH = "host".
// Throughput: one axis per lane per cycle.
// Stall: none.
`include "convex.svh"
module obb_edge #(
    `DF_PARAMETERS,
    parameter int I = 0  // 0..2
) (
    input logic clk_i,
    input logic [2:0][LANES-1:0][CW-1:0] a_i,
    input logic [2:0][LANES-1:0][CW-1:0] t_i,
    input logic [2:0][2:0][LANES-1:0][CW-1:0] f_i,
    input logic [2:0][LANES-1:0][CW-1:0] edge_i,    // f_J
    input logic [2:0][LANES-1:0][CW-1:0] first_i,   // the other two edges, in order
    input logic [2:0][LANES-1:0][CW-1:0] second_i,
    input logic [LANES-1:0][CW-1:0] sign_k_i,
    input logic [LANES-1:0][CW-1:0] sign_l_i,
    input logic [LANES-1:0][CW-1:0] sign_first_i,
    input logic [LANES-1:0][CW-1:0] sign_second_i,
    input logic [LANES-1:0][CW-1:0] inverse_ff_i,
    input logic [LANES-1:0][CW-1:0] n_k_i,
    input logic [LANES-1:0][CW-1:0] n_l_i,
    input logic [LANES-1:0][CW-1:0] inverse2_i,
    input logic [LANES-1:0][CW-1:0] tie_i,
    input logic [LANES-1:0][CW-1:0] valid_i,
    output logic [LANES-1:0][CW-1:0] separation_o,
    output logic [2:0][LANES-1:0][CW-1:0] n_o,
    output logic [2:0][LANES-1:0][CW-1:0] v_o,
    output logic [2:0][LANES-1:0][CW-1:0] p_o,
    output logic [LANES-1:0][CW-1:0] d2_o,
    output logic [2:0][LANES-1:0][CW-1:0] f_o,
    output logic [LANES-1:0][CW-1:0] inverse_ff_o
);
  /*verilator inline_module*/
  localparam int K = (I + 1) % 3, L = (I + 2) % 3;
  localparam int FIRST = (I == 0) ? 1 : 0, SECOND = (I == 2) ? 1 : 2;  // K and L in order
  `DF_VIN(a, a_i, 0)
  `DF_PICK(a_k, a, K)
  `DF_PICK(a_l, a, L)
  `DF_VIN(t, t_i, 0)
  `DF_PICK(t_k, t, K)
  `DF_PICK(t_l, t, L)
  `DF_IN(f0_k, f_i[0][K], 0)
  `DF_IN(f0_l, f_i[0][L], 0)
  `DF_IN(f1_k, f_i[1][K], 0)
  `DF_IN(f1_l, f_i[1][L], 0)
  `DF_IN(f2_k, f_i[2][K], 0)
  `DF_IN(f2_l, f_i[2][L], 0)
  `DF_VIN(f, edge_i, 0)
  `DF_VIN(f_first, first_i, 0)
  `DF_VIN(f_second, second_i, 0)
  `DF_IN(turned_k, sign_k_i, 0)
  `DF_IN(turned_l, sign_l_i, 0)
  `DF_IN(sign_first, sign_first_i, 0)
  `DF_IN(sign_second, sign_second_i, 0)
  `DF_IN(inverse_ff, inverse_ff_i, 0)
  `DF_IN(n_k, n_k_i, 0)
  `DF_IN(n_l, n_l_i, 0)
  `DF_IN(inverse2, inverse2_i, 0)
  `DF_IN(valid, valid_i, 0)
  `DF_IN(tie, tie_i, 0)
  `DF_CONST(zero, 0)

  // ---- The separation ----
  `DF_DOT2(height, n_k, t_k, n_l, t_l)
  `DF_ABS(abs_k, n_k)
  `DF_ABS(abs_l, n_l)
  `DF_DOT2(on_a, abs_k, a_k, abs_l, a_l)
  `DF_DOT2(on_b0, n_k, f0_k, n_l, f0_l)
  `DF_DOT2(on_b1, n_k, f1_k, n_l, f1_l)
  `DF_DOT2(on_b2, n_k, f2_k, n_l, f2_l)
  `DF_VEC(on_b, on_b0, on_b1, on_b2)
  `DF_NORM1(radius, on_b)
  `DF_ABS(distance, height)
  `DF_SUB(beyond, distance, on_a)
  `DF_SUB(separation, beyond, radius)

  // ---- The side: component I of n is 0 ----
  `DF_VAXES(n, I, zero, n_k, n_l)
  `DF_PICK(t_first, t, FIRST)
  `DF_PICK(t_second, t, SECOND)
  `DF_PICK(n_first, n, FIRST)
  `DF_PICK(n_second, n, SECOND)
  `DF_CONST(least, CW'(`DF_POWER_OF_TWO(-2)) | (CW'(1) << (MAN - 2)))
  `DF_ABS(size_first, n_first)
  `DF_LT(leads, least, size_first)
  `DF_MOVE_SIGN(along_first, t_first, n_first)
  `DF_MOVE_SIGN(along_second, t_second, n_second)
  `DF_SELECT(along, leads, along_first, along_second)
  `DF_SIDE_OF(side, height, tie, along)

  // ---- The support edges ----
  `DF_NEG(minus_l, turned_l)
  `DF_MOVE_SIGN(sign_k, side, minus_l)
  `DF_MOVE_SIGN(sign_l, side, turned_k)
  `DF_MOVE_SIGN(towards_first, side, sign_first)
  `DF_MOVE_SIGN(towards_second, side, sign_second)
  `DF_AGAINST(q_first, t, towards_first, f_first)
  `DF_AGAINST(q, q_first, towards_second, f_second)

  // ---- The candidate axis ----
  `DF_VAT(a_q, a, T_q)
  `DF_AT(sign_k_q, sign_k, T_q)
  `DF_AT(sign_l_q, sign_l, T_q)
  `DF_VAT(f_q, f, T_q)
  `DF_AT(inverse_ff_q, inverse_ff, T_q)
  `DF_AT(n_k_q, n_k, T_q)
  `DF_AT(n_l_q, n_l, T_q)
  `DF_AT(inverse2_q, inverse2, T_q)
  `DF_AT(valid_q, valid, T_q)
  `DF_AT(side_q, side, T_q)
  localparam int T_LATE = (T_separation > T_q) ? T_separation : T_q;
  `DF_AT(separation_late, separation, T_LATE)
  if (T_q + `LATENCY_EDGE_AXIS != `LATENCY_OBB_EDGE) $error("obb_edge: latency");
  edge_axis #(`DF_SAME, .I(I), .CENTRED(1), .T_SEPARATION(T_LATE - T_q)) axis (
      .clk_i, .a_i(a_q), .sign_k_i(sign_k_q), .sign_l_i(sign_l_q), .q_i(q), .f_i(f_q), .inverse_ff_i(inverse_ff_q),
      .n_k_i(n_k_q),
      .n_l_i(n_l_q), .inverse2_i(inverse2_q), .valid_i(valid_q), .side_i(side_q), .separation_i(separation_late),
      .separation_o, .n_o, .v_o, .p_o, .d2_o, .f_o,
      .inverse_ff_o);
endmodule
