// SPDX-License-Identifier: Apache-2.0
// Candidate axis (SAT): face I of a box, half extents a about 0, and the nearest vertex of a triangle. It is on the
// side with the larger distance; ties go to the upper side (low + high within tie of 0). The vertex is the lowest one
// along the normal, by component I of the turned edges.
// Operators: 8 add, 3 mul, 4 compare, 9 min/max.
// Latency: LATENCY_TRIANGLE_BOX_FACE cycles; 0 with ARITH = "host".
// Throughput: one axis per lane per cycle.
// Stall: none.
`include "triangle.svh"
module triangle_box_face #(
    `DF_PARAMETERS,
    parameter int I = 0  // axis, 0..2
) (
    input logic clk_i,
    input logic [2:0][LANES-1:0][CW-1:0] a_i,
    input logic [2:0][2:0][LANES-1:0][CW-1:0] p_i,  // vertices
    input logic [2:0][LANES-1:0][CW-1:0] turned_i,  // component I of the turned edges
    input logic [LANES-1:0][CW-1:0] tie_i,
    output logic [LANES-1:0][CW-1:0] separation_o,
    output logic [2:0][LANES-1:0][CW-1:0] n_o,
    output logic [2:0][LANES-1:0][CW-1:0] v_o,
    output logic [2:0][LANES-1:0][CW-1:0] p_o,
    output logic [LANES-1:0][CW-1:0] d2_o
);
  /*verilator inline_module*/
  `DF_VIN(a, a_i, 0)
  `DF_PICK(a_axis, a, I)
  `DF_MATRIX_IN(p, p_i[0], p_i[1], p_i[2], 0)
  `DF_IN(turned0, turned_i[0], 0)
  `DF_IN(turned1, turned_i[1], 0)
  `DF_IN(turned2, turned_i[2], 0)
  `DF_IN(tie, tie_i, 0)
  `DF_CONST(zero, 0)
  `DF_CONST(up, ((CW'(1) << (EXP - 1)) - 1) << MAN)

  `DF_TRANSPOSE(columns, p)
  `DF_ROW(heights, columns, I)
  `DF_SPAN(low, high, heights)
  `DF_SIDE(side, separation, low, high, a_axis, tie, up)
  `DF_MOVE_SIGN(rise0, side, turned0)
  `DF_MOVE_SIGN(rise1, side, turned1)
  `DF_MOVE_SIGN(rise2, side, turned2)
  `DF_LE(below1, zero, rise0)
  `DF_LE(below2, rise2, zero)
  `DF_AND(lowest_first, below1, below2)
  `DF_LE(lowest_second, zero, rise1)
  `DF_LEAST_ROW(q, lowest, p)

  `DF_VAT(a_q, a, T_q)
  `DF_AT(side_q, side, T_q)
  face_axis #(`DF_SAME, .I(I)) axis (
      .clk_i, .a_i(a_q), .side_i(side_q), .q_i(q), .n_o, .v_o, .p_o, .d2_o);
  if (T_q + `LATENCY_FACE_AXIS != `LATENCY_TRIANGLE_BOX_FACE) $error("triangle_box_face: latency");
  `DF_AT(separation_out, separation, `LATENCY_TRIANGLE_BOX_FACE)
  assign separation_o = separation_out;
endmodule
