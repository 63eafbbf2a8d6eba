// SPDX-License-Identifier: Apache-2.0
// Candidate axis (SAT): face I of box A, on the side of `side`'s sign, and the nearest corner of box B.
// In A's frame, A's centre is 0 and its axes are e_i; B has centre t and half edges f_j. `signs` is component I of B's
// turned axes. The separation is |t_I| - a_I - sum of |f_jI|. 18 add, 3 mul, 4 min/max.
// Latency: LATENCY_OBB_FACE cycles; 0 with ARITH = "host".
// Throughput: one axis per lane per cycle.
// Stall: none.
`include "convex.svh"
module obb_face #(
    `DF_PARAMETERS,
    parameter int I = 0  // axis, 0..2
) (
    input logic clk_i,
    input logic [2:0][LANES-1:0][CW-1:0] a_i,
    input logic [2:0][LANES-1:0][CW-1:0] t_i,
    input logic [2:0][2:0][LANES-1:0][CW-1:0] f_i,
    input logic [2:0][LANES-1:0][CW-1:0] signs_i,
    input logic [LANES-1:0][CW-1:0] side_i,
    output logic [LANES-1:0][CW-1:0] separation_o,
    output logic [2:0][LANES-1:0][CW-1:0] n_o,
    output logic [2:0][LANES-1:0][CW-1:0] v_o,
    output logic [2:0][LANES-1:0][CW-1:0] p_o,
    output logic [LANES-1:0][CW-1:0] d2_o
);
  /*verilator inline_module*/
  `DF_VIN(a, a_i, 0)
  `DF_PICK(a_axis, a, I)
  `DF_VIN(t, t_i, 0)
  `DF_PICK(height, t, I)
  `DF_IN(side, side_i, 0)
  `DF_VIN(f0, f_i[0], 0)
  `DF_VIN(f1, f_i[1], 0)
  `DF_VIN(f2, f_i[2], 0)
  `DF_IN(sign0, signs_i[0], 0)
  `DF_IN(sign1, signs_i[1], 0)
  `DF_IN(sign2, signs_i[2], 0)

  `DF_PICK(across0, f0, I)
  `DF_PICK(across1, f1, I)
  `DF_PICK(across2, f2, I)
  `DF_VEC(across, across0, across1, across2)
  `DF_NORM1(radius, across)
  `DF_ABS(distance, height)
  `DF_SUB(beyond, distance, a_axis)
  `DF_SUB(separation, beyond, radius)

  `DF_MOVE_SIGN(towards0, side, sign0)
  `DF_MOVE_SIGN(towards1, side, sign1)
  `DF_MOVE_SIGN(towards2, side, sign2)
  `DF_AGAINST(q0, t, towards0, f0)
  `DF_AGAINST(q01, q0, towards1, f1)
  `DF_AGAINST(q, q01, towards2, f2)

  `DF_VAT(a_q, a, T_q)
  `DF_AT(side_q, side, T_q)
  face_axis #(`DF_SAME, .I(I)) axis (
      .clk_i, .a_i(a_q), .side_i(side_q), .q_i(q), .n_o, .v_o, .p_o, .d2_o);
  if (T_q + `LATENCY_FACE_AXIS != `LATENCY_OBB_FACE) $error("obb_face: latency");
  `DF_AT(separation_out, separation, `LATENCY_OBB_FACE)
  assign separation_o = separation_out;
endmodule
