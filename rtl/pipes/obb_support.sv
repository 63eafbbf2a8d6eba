// SPDX-License-Identifier: Apache-2.0
// The corner of box B minus the corner of box A that is farthest against v, and that corner of A, in A's frame
// (obb_face.sv).
// Operators: 18 add, 9 mul.
// Latency: LATENCY_OBB_SUPPORT cycles; 0 with ARITH = "host".
// Throughput: one point per lane per cycle.
// Stall: none.
`include "convex.svh"
module obb_support #(
    `DF_PARAMETERS
) (
    input logic clk_i,
    input logic [2:0][LANES-1:0][CW-1:0] v_i,
    input logic [2:0][LANES-1:0][CW-1:0] a_i,
    input logic [2:0][LANES-1:0][CW-1:0] t_i,
    input logic [2:0][2:0][LANES-1:0][CW-1:0] f_i,
    output logic [2:0][LANES-1:0][CW-1:0] v_o,
    output logic [2:0][LANES-1:0][CW-1:0] p_o
);
  /*verilator inline_module*/
  `DF_VIN(v, v_i, 0)
  `DF_VIN(a, a_i, 0)
  `DF_VIN(t, t_i, 0)
  `DF_MATRIX_IN(f, f_i[0], f_i[1], f_i[2], 0)
  `DF_APPLY(on_b, f, v)
  `DF_PICK(towards0, on_b, 0)
  `DF_PICK(towards1, on_b, 1)
  `DF_PICK(towards2, on_b, 2)
  `DF_ROW(f0, f, 0)
  `DF_ROW(f1, f, 1)
  `DF_ROW(f2, f, 2)
  `DF_AGAINST(q0, t, towards0, f0)
  `DF_AGAINST(q01, q0, towards1, f1)
  `DF_AGAINST(q, q01, towards2, f2)
  `DF_VMOVE_SIGN(p, v, a)
  `DF_VSUB(x, q, p)
  if (T_x != `LATENCY_OBB_SUPPORT) $error("obb_support: latency");
  `DF_VAT(p_out, p, T_x)
  assign v_o = x;
  assign p_o = p_out;
endmodule
