// SPDX-License-Identifier: Apache-2.0
// Candidate axis (SAT): the face of one triangle, A or B (OF_B), and the nearest vertex of the other. It is on the side
// with the larger distance, ties the side of the normal. A's first vertex is 0.
// Operators: 70 add, 86 mul, 13 compare, 15 min/max; 67 add for B.
// Latency: inputs at the stage times of triangle.svh, the axis at TRIANGLE_PAIR_FACE_T; 0 with ARITH = "host".
// Throughput: one axis per lane per cycle.
// Stall: none.
`include "triangle_pair.svh"
module triangle_pair_face #(
    `DF_PARAMETERS,
    parameter bit OF_B = 0
) (
    input logic clk_i,
    input logic [2:0][2:0][LANES-1:0][CW-1:0] p_i,  // vertices of A, stage time 0
    input logic [2:0][2:0][LANES-1:0][CW-1:0] q_i,  // vertices of B
    // the face's parts as from triangle_parts.sv, with the following inputs
    input logic [2:0][2:0][LANES-1:0][CW-1:0] f_i,
    input logic [2:0][LANES-1:0][CW-1:0] inverse_ff_i,
    input logic [LANES-1:0][CW-1:0] longest0_i,
    input logic [LANES-1:0][CW-1:0] longest1_i,
    input logic [2:0][LANES-1:0][CW-1:0] m_i,
    input logic [LANES-1:0][CW-1:0] flat_i,
    input logic [LANES-1:0][CW-1:0] tie_i,  // TRIANGLE_T_M
    output logic [LANES-1:0][CW-1:0] separation_o,
    output logic [2:0][LANES-1:0][CW-1:0] n_o,
    output logic [2:0][LANES-1:0][CW-1:0] v_o,
    output logic [2:0][LANES-1:0][CW-1:0] p_o,
    output logic [LANES-1:0][CW-1:0] d2_o
);
  /*verilator inline_module*/
  `DF_MATRIX_IN(p_early, p_i[0], p_i[1], p_i[2], 0)
  `DF_MATRIX_IN(q_early, q_i[0], q_i[1], q_i[2], 0)
  `DF_MATRIX_IN(t_f, f_i[0], f_i[1], f_i[2], `TRIANGLE_T_F)
  `DF_VIN(t_inverse_ff, inverse_ff_i, `TRIANGLE_T_INVERSE)
  `DF_IN(t_longest0, longest0_i, `TRIANGLE_T_LONGEST)
  `DF_IN(t_longest1, longest1_i, `TRIANGLE_T_LONGEST)
  `DF_VIN(t_m, m_i, `TRIANGLE_T_M)
  `DF_IN(t_flat, flat_i, `TRIANGLE_T_M)
  `DF_IN(tie, tie_i, `TRIANGLE_T_M)
  `DF_CONST(up, ((CW'(1) << (EXP - 1)) - 1) << MAN)

  // ---- The distance; n from the face to the other triangle ----
  `DF_MAT_AT(p, p_early, T_t_m)
  `DF_MAT_AT(q, q_early, T_t_m)
  `DF_ALONG_ZERO(on_a, p, t_m)
  `DF_APPLY(on_b, q, t_m)
  `DF_VIN(on_face, OF_B ? on_b : on_a, T_on_b)
  `DF_VIN(on_other, OF_B ? on_a : on_b, T_on_b)
  `DF_SPAN(face_low, face_high, on_face)
  `DF_SPAN(other_low, other_high, on_other)
  `DF_SEPARATIONS(separations, face, other, up, tie)
  `DF_MAX(separation, separations_above, separations_below)
  `DF_VFLIP(n, separations_side, t_m)

  // ---- The vertex, and the point of the face nearest to it ----
  `DF_VFLIP(rise, separations_side, on_other)
  `DF_PICK(rise0, rise, 0)
  `DF_PICK(rise1, rise, 1)
  `DF_PICK(rise2, rise, 2)
  `DF_WHICH3(lowest, rise0, rise1, rise2)
  `DF_MATRIX_IN(corners, OF_B ? p[0] : q[0], OF_B ? p[1] : q[1], OF_B ? p[2] : q[2], T_p)
  `DF_LEAST_ROW(vertex, lowest, corners)
  `DF_MAT(vertices, vertex, vertex, vertex)
  `DF_MATRIX_IN(own, OF_B ? q[0] : p[0], OF_B ? q[1] : p[1], OF_B ? q[2] : p[2], T_p)
  `DF_MSUB(w, vertices, own)
  `DF_POINT_TRIANGLE(closest, w, t)
  logic unused_h;
  assign unused_h = &{1'b0, closest_h};

  localparam int T_OUT = `TRIANGLE_PAIR_FACE_T;
  if (T_w != `TRIANGLE_PAIR_FACE_T_W || T_closest_v + LAT.add != T_OUT) $error("triangle_pair_face: latency");
  if (OF_B) begin : g_of_b
    `DF_VNEG(n_turned, n)
    `DF_VNEG(v_turned, closest_v)
    `DF_VAT(n_out, n_turned, T_OUT)
    `DF_VAT(v_out, v_turned, T_OUT)
    `DF_VAT(p_out, vertex, T_OUT)
    assign n_o = n_out;
    assign v_o = v_out;
    assign p_o = p_out;
  end else begin : g_of_a
    `DF_VSUB(p_out, vertex, closest_v)
    `DF_VAT(n_out, n, T_OUT)
    `DF_VAT(v_out, closest_v, T_OUT)
    assign n_o = n_out;
    assign v_o = v_out;
    assign p_o = p_out;
  end
  `DF_AT(separation_out, separation, T_OUT)
  `DF_AT(d2_out, closest_d2, T_OUT)
  assign separation_o = separation_out;
  assign d2_o = d2_out;
endmodule
