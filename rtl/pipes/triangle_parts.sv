// SPDX-License-Identifier: Apache-2.0
// Prepares a triangle. Edges f_j = p_(j+1) - p_j and 1 / f.f, 0 for an edge without length. The longest edge: 0, else
// 1, else 2. The unit normal m has the orientation of f_0 x f_1. It comes from i = e / e.e of the longest edge e, and
// the next edge less its part along e. That part is perpendicular to e at any angle, and as long as the height over e
// at any size.
// A triangle without area (flat_o clear) takes the coordinate axis nearest to perpendicular to e instead.
// A triangle without length has m = (0, 0, 1).
// Operators: 27 add, 33 mul, 4 div, 1 sqrt, 10 compare, 2 min/max.
// Latency: TRIANGLE_T_* of triangle.svh, one per output, flat_o with m_o; 0 with ARITH = "host".
// Throughput: one triangle per lane per cycle.
// Stall: none.
`include "triangle.svh"
module triangle_parts #(
    `DF_PARAMETERS
) (
    input logic clk_i,
    input logic [2:0][2:0][LANES-1:0][CW-1:0] p_i,  // vertices, one per row
    output logic [2:0][2:0][LANES-1:0][CW-1:0] f_o,
    output logic [2:0][LANES-1:0][CW-1:0] inverse_ff_o,  // one per edge
    output logic [LANES-1:0][CW-1:0] longest0_o,
    output logic [LANES-1:0][CW-1:0] longest1_o,
    output logic [2:0][LANES-1:0][CW-1:0] m_o,
    output logic [LANES-1:0][CW-1:0] flat_o
);
  /*verilator inline_module*/
  localparam logic [CW-1:0] ONE = ((CW'(1) << (EXP - 1)) - 1) << MAN;
  `DF_MATRIX_IN(p, p_i[0], p_i[1], p_i[2], 0)
  `DF_MATRIX_IN(p_next, p_i[1], p_i[2], p_i[0], 0)
  `DF_CONST(zero, 0)
  `DF_CONST(one, ONE)
  `DF_VCONST(up, 0, 0, ONE)

  // ---- Edges ----
  `DF_MSUB(f, p_next, p)
  `DF_ROW(f_0, f, 0)
  `DF_ROW(f_1, f, 1)
  `DF_ROW(f_2, f, 2)
  `DF_MDOT(ff, f, f)
  `DF_PICK(ff_0, ff, 0)
  `DF_PICK(ff_1, ff, 1)
  `DF_PICK(ff_2, ff, 2)
  `DF_USABLE(usable_0, ff_0)
  `DF_USABLE(usable_1, ff_1)
  `DF_USABLE(usable_2, ff_2)
  `DF_RECIPROCAL_OR_ZERO(inverse_0, usable_0, ff_0)
  `DF_RECIPROCAL_OR_ZERO(inverse_1, usable_1, ff_1)
  `DF_RECIPROCAL_OR_ZERO(inverse_2, usable_2, ff_2)
  `DF_VEC(inverse_ff, inverse_0, inverse_1, inverse_2)

  // ---- The longest edge e and the next one, g ----
  `DF_MAX(larger, ff_1, ff_2)
  `DF_MAX(largest, ff_0, larger)
  `DF_LE(longest0, largest, ff_0)
  `DF_LE(longest1, largest, ff_1)
  `DF_VSELECT3(e, longest0, longest1, f_0, f_1, f_2)
  `DF_VSELECT3(g, longest0, longest1, f_1, f_2, f_0)
  `DF_SELECT3(inverse_ee, longest0, longest1, inverse_0, inverse_1, inverse_2)

  // ---- Normal of a face ----
  `DF_VSCALE(i, e, inverse_ee)
  `DF_DOT(ge, g, e)
  `DF_VSCALE(g_part, i, ge)
  `DF_VSUB(g_across, g, g_part)
  `DF_CROSS(m_face, i, g_across)
  `DF_DOT(mm_face, m_face, m_face)
  `DF_USABLE(flat, mm_face)

  // ---- Normal of a line: i x the axis of e's least component ----
  `DF_PICK(e_x, e, 0)
  `DF_PICK(e_y, e, 1)
  `DF_PICK(e_z, e, 2)
  `DF_ABS(size_x, e_x)
  `DF_ABS(size_y, e_y)
  `DF_ABS(size_z, e_z)
  `DF_WHICH3(axis, size_x, size_y, size_z)
  `DF_PICK(i_x, i, 0)
  `DF_PICK(i_y, i, 1)
  `DF_PICK(i_z, i, 2)
  `DF_NEG(minus_x, i_x)
  `DF_NEG(minus_y, i_y)
  `DF_NEG(minus_z, i_z)
  `DF_VEC(m_x, zero, i_z, minus_y)
  `DF_VEC(m_y, minus_z, zero, i_x)
  `DF_VEC(m_z, i_y, minus_x, zero)
  `DF_VSELECT3(m_line, axis_first, axis_second, m_x, m_y, m_z)
  `DF_DOT(mm_line, m_line, m_line)
  `DF_USABLE(line, mm_line)

  // ---- Of unit length ----
  `DF_VSELECT3(m_long, flat, line, m_face, m_line, up)
  `DF_SELECT3(mm, flat, line, mm_face, mm_line, one)
  `DF_SQRT(length, mm)
  `DF_DIV(inverse, one, length)
  `DF_VSCALE(m, m_long, inverse)
  `DF_AT(flat_late, flat, T_m)

  if (T_f != `TRIANGLE_T_F || T_inverse_ff != `TRIANGLE_T_INVERSE) $error("triangle_parts: stage time of the edges");
  if (T_longest0 != `TRIANGLE_T_LONGEST || T_m != `TRIANGLE_T_M) $error("triangle_parts: stage time of the normal");
  assign f_o = f;
  assign inverse_ff_o = inverse_ff;
  assign longest0_o = longest0;
  assign longest1_o = longest1;
  assign m_o = m;
  assign flat_o = flat_late;
endmodule
