// SPDX-License-Identifier: Apache-2.0
// Candidate axis (SAT): a triangle's face and the nearest corner of a box, half extents a about 0. It is on the side
// with the larger distance. Ties go to the side where the normal's leading component is positive. m1 is the face's
// normal by turned edges; its signs choose the corner.
// Operators: 63 add, 83 mul, 12 compare, 11 min/max.
// Latency: inputs at the stage times of triangle.svh, the axis at TRIANGLE_FACE_T; 0 with ARITH = "host".
// Throughput: one axis per lane per cycle.
// Stall: none.
`include "triangle.svh"
module triangle_face #(
    `DF_PARAMETERS
) (
    input logic clk_i,
    input logic [2:0][LANES-1:0][CW-1:0] a_i,  // stage time 0
    input logic [2:0][2:0][LANES-1:0][CW-1:0] p_i,  // vertices, 0
    input logic [2:0][LANES-1:0][CW-1:0] m1_i,  // TRIANGLE_BOX_T_M1
    input logic [2:0][2:0][LANES-1:0][CW-1:0] f_i,  // as from triangle_parts.sv, with the following inputs
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
  `DF_VIN(a_early, a_i, 0)
  `DF_MATRIX_IN(p_early, p_i[0], p_i[1], p_i[2], 0)
  `DF_VIN(m1, m1_i, `TRIANGLE_BOX_T_M1)
  `DF_MATRIX_IN(t_f, f_i[0], f_i[1], f_i[2], `TRIANGLE_T_F)
  `DF_VIN(t_inverse_ff, inverse_ff_i, `TRIANGLE_T_INVERSE)
  `DF_IN(t_longest0, longest0_i, `TRIANGLE_T_LONGEST)
  `DF_IN(t_longest1, longest1_i, `TRIANGLE_T_LONGEST)
  `DF_VIN(t_m, m_i, `TRIANGLE_T_M)
  `DF_IN(t_flat, flat_i, `TRIANGLE_T_M)
  `DF_IN(tie, tie_i, `TRIANGLE_T_M)

  `DF_VAT(a, a_early, T_t_m)
  `DF_MAT_AT(p, p_early, T_t_m)
  `DF_APPLY(heights, p, t_m)
  `DF_SPAN(low, high, heights)
  `DF_BOX_RADIUS(radius, t_m, a)
  `DF_LEADING(leading, t_m)
  `DF_LEAD(orientation, leading, t_m)
  `DF_SIDE(side, separation, low, high, radius, tie, orientation)
  `DF_VFLIP(n, side, t_m)
  `DF_VFLIP(signs, side, m1)
  `DF_VMOVE_SIGN(corner, signs, a)
  `DF_MAT(corners, corner, corner, corner)
  `DF_MSUB(w, corners, p)
  `DF_POINT_TRIANGLE(closest, w, t)
  logic unused_h;
  assign unused_h = &{1'b0, closest_h};
  `DF_VNEG(v, closest_v)

  if (T_w != `TRIANGLE_FACE_T_W || T_v != `TRIANGLE_FACE_T) $error("triangle_face: latency");
  `DF_AT(separation_out, separation, T_v)
  `DF_VAT(n_out, n, T_v)
  `DF_VAT(p_out, corner, T_v)
  assign separation_o = separation_out;
  assign n_o = n_out;
  assign v_o = v;
  assign p_o = p_out;
  assign d2_o = closest_d2;
endmodule
