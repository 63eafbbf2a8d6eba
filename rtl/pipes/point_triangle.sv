// SPDX-License-Identifier: Apache-2.0
// The vector v from the closest point of a triangle (triangle_parts.sv) to a point, |v|^2, and the point's signed
// distance h from the plane.
// It takes the three segments, and the face if the point lies over its inside. The region is selected at the end, ties
// to the lowest edge. Over a needle, the signs that say "inside" are noise when the point is in line with it. So the
// point must also lie between the ends of the longest edge. 43 add, 71 mul, 9 compare, 6 min/max.
// Latency: to POINT_TRIANGLE_T_V of triangle.svh. h_o comes LAT.mul + 2*LAT.add after the later of w and m. 0 with
// ARITH = "host".
// Throughput: one point per lane per cycle.
// Stall: none.
`include "triangle.svh"
module point_triangle #(
    `DF_PARAMETERS,
    parameter int T_W = 0,  // stage times of the inputs
    parameter int T_F = 0,
    parameter int T_INVERSE = 0,
    parameter int T_LONGEST = 0,
    parameter int T_M = 0
) (
    input logic clk_i,
    input logic [2:0][2:0][LANES-1:0][CW-1:0] w_i,  // point - vertex, one row per vertex
    input logic [2:0][2:0][LANES-1:0][CW-1:0] f_i,
    input logic [2:0][LANES-1:0][CW-1:0] inverse_ff_i,
    input logic [LANES-1:0][CW-1:0] longest0_i,
    input logic [LANES-1:0][CW-1:0] longest1_i,
    input logic [2:0][LANES-1:0][CW-1:0] m_i,
    input logic [LANES-1:0][CW-1:0] flat_i,  // at the time of m_i
    output logic [2:0][LANES-1:0][CW-1:0] v_o,
    output logic [LANES-1:0][CW-1:0] d2_o,
    output logic [LANES-1:0][CW-1:0] h_o
);
  /*verilator inline_module*/
  localparam logic [CW-1:0] ONE = ((CW'(1) << (EXP - 1)) - 1) << MAN;
  `DF_MATRIX_IN(w, w_i[0], w_i[1], w_i[2], T_W)
  `DF_MATRIX_IN(f, f_i[0], f_i[1], f_i[2], T_F)
  `DF_VIN(inverse_ff, inverse_ff_i, T_INVERSE)
  `DF_IN(longest0, longest0_i, T_LONGEST)
  `DF_IN(longest1, longest1_i, T_LONGEST)
  `DF_VIN(m, m_i, T_M)
  `DF_IN(flat, flat_i, T_M)
  `DF_VCONST(zeros, 0, 0, 0)
  `DF_VCONST(ones, ONE, ONE, ONE)

  // ---- The three segments ----
  `DF_MDOT(wf, w, f)
  `DF_VMUL(along, wf, inverse_ff)
  `DF_VCLAMP(on_edge, along, zeros, ones)
  `DF_VEQ(between, along, on_edge)
  `DF_VSELECT_EACH(inverse, between, inverse_ff, zeros)
  `DF_MSCALE(part, f, on_edge)
  `DF_MSUB(r, w, part)
  `DF_MDOT(rr, r, r)
  `DF_PICK(rr_0, rr, 0)
  `DF_PICK(rr_1, rr, 1)
  `DF_PICK(rr_2, rr, 2)
  `DF_LEAST3(edge_rr, rr_0, rr_1, rr_2)
  `DF_LEAST_ROW(edge_r, edge_rr, r)
  `DF_LEAST_ROW(edge_f, edge_rr, f)
  `DF_PICK(inverse_0, inverse, 0)
  `DF_PICK(inverse_1, inverse, 1)
  `DF_PICK(inverse_2, inverse, 2)
  `DF_SELECT3(edge_inverse, edge_rr_first, edge_rr_second, inverse_0, inverse_1, inverse_2)
  `DF_PERPENDICULAR(v_edge, edge_r, edge_f, edge_inverse)

  // ---- The face ----
  `DF_MCROSS(fw, f, w)
  `DF_APPLY(side, fw, m)
  `DF_VLT(left_of, zeros, side)
  `DF_PICK(left_of_0, left_of, 0)
  `DF_PICK(left_of_1, left_of, 1)
  `DF_PICK(left_of_2, left_of, 2)
  `DF_PICK(between_0, between, 0)
  `DF_PICK(between_1, between, 1)
  `DF_PICK(between_2, between, 2)
  `DF_SELECT3(beside, longest0, longest1, between_0, between_1, between_2)
  `DF_AND(left_of_01, left_of_0, left_of_1)
  `DF_AND(left_of_all, left_of_01, left_of_2)
  `DF_AND(over, flat, left_of_all)
  `DF_AND(over_face, over, beside)
  `DF_ROW(w_0, w, 0)
  `DF_DOT(h, w_0, m)
  `DF_VSCALE(v_face, m, h)
  `DF_MUL(hh, h, h)

  // ---- Choice ----
  `DF_VSELECT(v, over_face, v_face, v_edge)
  `DF_SELECT(d2, over_face, hh, edge_rr)
  localparam int T_OUT = `POINT_TRIANGLE_T_V(T_W, T_F, T_INVERSE, T_M);
  `DF_VAT(v_late, v, T_OUT)
  `DF_AT(d2_late, d2, T_OUT)
  assign v_o = v_late;
  assign d2_o = d2_late;
  assign h_o = h;
endmodule
