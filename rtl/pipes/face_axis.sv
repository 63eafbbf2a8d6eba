// SPDX-License-Identifier: Apache-2.0
// Candidate axis (SAT): face I of a box (frame as in obb_obb.sv) on the side of `side`'s sign, and the vertex q of the
// other body. The vector n is the face's normal. The face's point nearest to q is p, v = q - p, d2 = v.v.
// Operators: 5 add, 3 mul, 4 min/max.
// Latency: LATENCY_FACE_AXIS cycles; 0 with ARITH = "host".
// Throughput: one axis per lane per cycle.
// Stall: none.
`include "convex.svh"
module face_axis #(
    `DF_PARAMETERS,
    parameter int I = 0  // axis, 0..2
) (
    input logic clk_i,
    input logic [2:0][LANES-1:0][CW-1:0] a_i,  // half extents
    input logic [LANES-1:0][CW-1:0] side_i,
    input logic [2:0][LANES-1:0][CW-1:0] q_i,
    output logic [2:0][LANES-1:0][CW-1:0] n_o,
    output logic [2:0][LANES-1:0][CW-1:0] v_o,
    output logic [2:0][LANES-1:0][CW-1:0] p_o,
    output logic [LANES-1:0][CW-1:0] d2_o
);
  /*verilator inline_module*/
  localparam int K = (I + 1) % 3, L = (I + 2) % 3;
  localparam logic [CW-1:0] ONE = ((CW'(1) << (EXP - 1)) - 1) << MAN;
  `DF_IN(side, side_i, 0)
  `DF_VIN(q, q_i, 0)
  `DF_IN(a_i_axis, a_i[I], 0)
  `DF_IN(a_k, a_i[K], 0)
  `DF_IN(a_l, a_i[L], 0)
  `DF_IN(q_k, q_i[K], 0)
  `DF_IN(q_l, q_i[L], 0)
  `DF_CONST(zero, 0)
  `DF_CONST(one, ONE)

  `DF_MOVE_SIGN(n_axis, side, one)
  `DF_VAXES(n, I, n_axis, zero, zero)
  `DF_MOVE_SIGN(p_i_axis, side, a_i_axis)
  `DF_NEG(low_k, a_k)
  `DF_CLAMP(p_k, q_k, low_k, a_k)
  `DF_NEG(low_l, a_l)
  `DF_CLAMP(p_l, q_l, low_l, a_l)
  `DF_VAXES(p, I, p_i_axis, p_k, p_l)
  `DF_VSUB(v, q, p)
  `DF_DOT(d2, v, v)

  if (T_d2 != `LATENCY_FACE_AXIS) $error("face_axis: latency");
  `DF_VAT(n_out, n, T_d2)
  `DF_VAT(v_out, v, T_d2)
  `DF_VAT(p_out, p, T_d2)
  assign n_o = n_out;
  assign v_o = v_out;
  assign p_o = p_out;
  assign d2_o = d2;
endmodule
