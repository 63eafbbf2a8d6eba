// SPDX-License-Identifier: Apache-2.0
// Candidate axis (SAT): edge I of a box, half extents a about 0, and edge f from vertex J of a triangle. With TURNS = 3
// three edges f share the unit. The normal e_I x f is turned so that the triangle lies behind its edge: there the
// difference of the two bodies has this facet. The term (e_I x f_J).(third vertex - edge) has the sign of component I
// of f_J x f_J+1, which is side_i.
// Operators: 17 add, 25 mul, 1 div, 1 sqrt, 3 compare, 8 min/max.
// Latency: LATENCY_TRIANGLE_BOX_EDGE cycles; 0 with ARITH = "host".
// Throughput: one axis per lane per cycle.
// Stall: none.
`include "triangle.svh"
module triangle_box_edge #(
    `DF_PARAMETERS,
    parameter int I = 0,  // axis, 0..2
    parameter int TURNS = 1,  // 1 or 3
    parameter int J = 0  // vertex, 0..2; with TURNS = 1
) (
    input logic clk_i,
    input logic [1:0] phase_i,
    input logic [2:0][LANES-1:0][CW-1:0] a_i,
    input logic [2:0][2:0][LANES-1:0][CW-1:0] p_i,  // vertices
    input logic [2:0][LANES-1:0][CW-1:0] f_i,
    input logic [LANES-1:0][CW-1:0] inverse_ff_i,
    input logic [2:0][LANES-1:0][CW-1:0] turned_i,  // the edge turned
    input logic [LANES-1:0][CW-1:0] side_i,
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
  `DF_VIN(a, a_i, 0)
  `DF_MATRIX_IN(p, p_i[0], p_i[1], p_i[2], 0)
  `DF_VIN(f, f_i, 0)
  `DF_IN(inverse_ff, inverse_ff_i, 0)
  `DF_IN(turned_k, turned_i[K], 0)
  `DF_IN(turned_l, turned_i[L], 0)
  `DF_IN(side, side_i, 0)

  // ---- The edge normal ----
  logic [LANES-1:0][CW-1:0] normal_k, normal_l, normal_inverse2, normal_valid;
  edge_normal #(`DF_SAME) normal (
      .clk_i, .f_k_i(f[K]), .f_l_i(f[L]), .n_k_o(normal_k), .n_l_o(normal_l), .inverse2_o(normal_inverse2),
      .valid_o(normal_valid));
  localparam int T_N = `LATENCY_EDGE_NORMAL;
  `DF_IN(n_k, normal_k, T_N)
  `DF_IN(n_l, normal_l, T_N)
  `DF_IN(inverse2, normal_inverse2, T_N)
  `DF_IN(valid, normal_valid, T_N)
  `DF_VAT(a_n, a, T_N)
  `DF_MAT_AT(p_n, p, T_N)
  `DF_VAT(f_n, f, T_N)
  `DF_AT(inverse_ff_n, inverse_ff, T_N)
  `DF_AT(side_n, side, T_N)
  `DF_PHASE_IN(phase, phase_i, 0)
  `DF_PHASE_AT(phase_n, phase, T_N)
  `DF_ROW(p_n0, p_n, 0)
  `DF_ROW(p_n1, p_n, 1)
  `DF_ROW(p_n2, p_n, 2)
  `DF_VTURN(vertex, J, phase_n, p_n0, p_n1, p_n2)

  // ---- The separation ----
  `DF_PICK(a_k, a_n, K)
  `DF_PICK(a_l, a_n, L)
  `DF_ABS(abs_k, n_k)
  `DF_ABS(abs_l, n_l)
  `DF_DOT2(on_box, abs_k, a_k, abs_l, a_l)
  `DF_TRANSPOSE(columns, p_n)
  `DF_ROW(p_k, columns, K)
  `DF_ROW(p_l, columns, L)
  `DF_VSCALE(along_k, p_k, n_k)
  `DF_VSCALE(along_l, p_l, n_l)
  `DF_VADD(along, along_k, along_l)
  `DF_VFLIP(on_triangle, side_n, along)
  `DF_PICK(on_triangle0, on_triangle, 0)
  `DF_PICK(on_triangle1, on_triangle, 1)
  `DF_PICK(on_triangle2, on_triangle, 2)
  `DF_MIN(lower, on_triangle1, on_triangle2)
  `DF_MIN(low, on_triangle0, lower)
  `DF_SUB(separation, low, on_box)

  // ---- The candidate axis ----
  `DF_NEG(minus_l, turned_l)
  `DF_MOVE_SIGN(sign_k, side, minus_l)
  `DF_MOVE_SIGN(sign_l, side, turned_k)
  `DF_AT(sign_k_n, sign_k, T_N)
  `DF_AT(sign_l_n, sign_l, T_N)
  edge_axis #(`DF_SAME, .I(I), .CENTRED(0), .T_SEPARATION(T_separation - T_N)) axis (
      .clk_i, .a_i(a_n), .sign_k_i(sign_k_n), .sign_l_i(sign_l_n), .q_i(vertex), .f_i(f_n), .inverse_ff_i(inverse_ff_n),
      .n_k_i(n_k),
      .n_l_i(n_l), .inverse2_i(inverse2), .valid_i(valid), .side_i(side_n), .separation_i(separation), .separation_o,
      .n_o, .v_o, .p_o, .d2_o, .f_o,
      .inverse_ff_o);
endmodule
