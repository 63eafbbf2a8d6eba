// SPDX-License-Identifier: Apache-2.0
// Nearest point of the box around the origin, or of the triangle with v0 at the origin. For the triangle it is a point
// of the plane if that lies inside and is no farther, else of an edge. An edge or triangle without length or area drops
// out by its NaN, and v0 remains. Where `feature` is set, it is the nearest point of the vertex, edge or face that n
// touches, up to `near` radian.
// Operators (box): 18 add, 27 mul, 3 compare, 6 min/max.
// Operators (triangle): 80 add, 88 mul, 3 div, 13 compare, 7 min/max.
// Latency: LATENCY_PROJECT cycles from x; 0 with ARITH = "host".
// Throughput: one point per lane per cycle.
// Stall: none, runs free.
`include "cylinder.svh"
module project_polyhedron #(
    `DF_PARAMETERS,
    parameter int BODY = `BODY_BOX,
    parameter int T_X = 0,  // stage time of x and feature; other inputs have stage time 0
    parameter int T_FEATURE = 0
) (
    input logic clk_i,
    input logic en_i,  // 0: no reader uses the result
    input logic [2:0][LANES-1:0][CW-1:0] x_i,
    input logic [2:0][2:0][LANES-1:0][CW-1:0] axis_i,  // box: axes, half extents; triangle: edges of unit length
    input logic [2:0][LANES-1:0][CW-1:0] half_i,
    input logic [2:0][2:0][LANES-1:0][CW-1:0] edge_i,  // triangle: v1 - v0, v2 - v0, v2 - v1, unit normal
    input logic [2:0][LANES-1:0][CW-1:0] face_i,
    input logic [LANES-1:0][CW-1:0] feature_i,  // lane mask
    input logic [LANES-1:0][CW-1:0] near_i,
    input logic [2:0][LANES-1:0][CW-1:0] n_i,
    output logic [2:0][LANES-1:0][CW-1:0] r_o
);
  /*verilator inline_module*/
  `undef DF_EN
  `define DF_EN en_i
  `define ACROSS(K, AXIS) `DF_VIN(axis``K, AXIS, 0) `DF_DOT(tilt``K, n, axis``K) `DF_ABS(size``K, tilt``K)
  `DF_VIN(x, x_i, T_X)
  `DF_VIN(n, n_i, 0)
  `DF_IN(feature, feature_i, T_FEATURE)
  `DF_IN(across, near_i, 0)
  if (BODY == `BODY_BOX) begin : g_box
    logic unused;
    assign unused = &{1'b0, edge_i, face_i};
    `DF_MATRIX_IN(axis, axis_i[0], axis_i[1], axis_i[2], 0)
    `DF_VIN(half, half_i, 0)
    `DF_VNEG(minus_half, half)
    `DF_APPLY(along, axis, x)
    `DF_VCLAMP(limited, along, minus_half, half)
    `define COORDINATE(K) `ACROSS(K, axis_i[K]) `DF_LT(off``K, across, size``K) `DF_AND(fixed``K, off``K, feature) \
      `DF_PICK(half``K, half, K) `DF_MOVE_SIGN(end``K, tilt``K, half``K) `DF_PICK(limited``K, limited, K) \
      `DF_SELECT(at``K, fixed``K, end``K, limited``K)
    `COORDINATE(0)
    `COORDINATE(1)
    `COORDINATE(2)
    `undef COORDINATE
    `DF_VEC(at, at0, at1, at2)
    `DF_MSCALE(p, axis, at)
    localparam int T_p0 = T_p, T_p1 = T_p, T_p2 = T_p;
    `DF_VECTOR p0, p1, p2;
    assign {p2, p1, p0} = p;
    `DF_VADD(p12, p1, p2)
    `DF_VADD(r, p0, p12)
    `DF_VAT(r_end, r, T_X + `LATENCY_PROJECT)
    assign r_o = r_end;
  end else begin : g_triangle
    logic unused;
    assign unused = &{1'b0, half_i};
    `DF_MATRIX_IN(edges, edge_i[0], edge_i[1], edge_i[2], 0)
    `DF_VIN(e1, edge_i[0], 0)
    `DF_VIN(e2, edge_i[1], 0)
    `DF_VIN(face, face_i, 0)
    `DF_VCONST(v0, 0, 0, 0)
    `DF_VCONST(ones, `DF_POWER_OF_TWO(0), `DF_POWER_OF_TWO(0), `DF_POWER_OF_TWO(0))
    `DF_CONST(zero, 0)
    // From the first end of each edge: v0, v0, v1.
    `DF_MATRIX_IN(from, v0, v0, e1, 0)
    localparam int T_xs = T_X;
    `DF_MATRIX xs;
    assign xs = {x, x, x};
    `DF_MSUB(w, xs, from)
    `DF_MDOT(we, w, edges)
    `DF_MDOT(ee, edges, edges)
    `DF_BINARY3(ratio, we, ee, formats_pkg::FP_DIV, LAT.div)
    `DF_VCLAMP(t, ratio, v0, ones)
    `DF_MSCALE(part, edges, t)
    localparam int T_p = T_part + LAT.add;
    `DF_MATRIX p;
    for (genvar k = 0; k < 9; k++) begin : on_edge
      df_operator #(`DF_FORMAT, .OP(formats_pkg::FP_ADD), .T_A(0), .T_B(T_part), .LAT(LAT.add)) op (
          .clk_i, .en_i(`DF_EN), .a_i(from[k/3][k%3]), .b_i(part[k/3][k%3]), .r_o(p[k/3][k%3]));
    end
    `DF_MSUB(r, xs, p)
    `DF_MDOT(rr, r, r)
    `DF_MCROSS(ew, edges, w)
    `DF_APPLY(side, ew, face)

    // ---- The vertex that n touches, the edges that end there, and which of them are flat ----
    `DF_DOT(to_v1, n, e1)
    `DF_DOT(to_v2, n, e2)
    `DF_LT(second, to_v1, to_v2)
    `DF_MAX(farthest, to_v1, to_v2)
    `DF_LT(first, zero, farthest)
    `DF_AND(is_v2, first, second)
    `DF_NOT(is_v0, first)
    `DF_NOT(solid, feature)
    `DF_NOT(ends0, is_v2)
    `DF_OR(ends1, second, is_v0)
    localparam int T_ends2 = T_first;
    `DF_SCALAR ends2;
    assign ends2 = first;
    `define EDGE(K, AXIS) `ACROSS(K, AXIS) `DF_LE(level``K, size``K, across) `DF_OR(flat``K, level``K, solid)
    `EDGE(0, axis_i[0])
    `EDGE(1, axis_i[2])
    `EDGE(2, axis_i[1])
    `undef EDGE
    `DF_AND(flat01, flat0, flat1)
    `DF_AND(level_face, flat01, flat2)
    `define ALLOWED(K) `DF_OR(ending``K, ends``K, level_face) `DF_AND(allowed``K, flat``K, ending``K)
    `ALLOWED(0)
    `ALLOWED(1)
    `ALLOWED(2)
    `undef ALLOWED
    `DF_AND(beyond_v0, first, feature)
    `DF_VSELECT(v1_or_v2, second, e2, e1)
    `DF_VSELECT(touched, beyond_v0, v1_or_v2, v0)

    // ---- The nearest of that vertex, or v0, and the edges; the first of equals ----
    localparam int T_p0 = T_p, T_p1 = T_p, T_p2 = T_p;
    `DF_VECTOR p0, p1, p2;
    assign {p2, p1, p0} = p;
    `DF_PICK(rr0, rr, 0)
    `DF_PICK(rr1, rr, 1)
    `DF_PICK(rr2, rr, 2)
    `DF_VSUB(from_vertex, x, touched)
    `DF_DOT(xx, from_vertex, from_vertex)
    `DF_LT(less0, rr0, xx)
    `DF_AND(nearer0, less0, allowed0)
    `DF_SELECT(least0, nearer0, rr0, xx)
    `DF_LT(less1, rr1, least0)
    `DF_AND(nearer1, less1, allowed1)
    `DF_SELECT(least1, nearer1, rr1, least0)
    `DF_LT(less2, rr2, least1)
    `DF_AND(nearer2, less2, allowed2)
    `DF_VSELECT(best0, nearer0, p0, touched)
    `DF_VSELECT(best1, nearer1, p1, best0)
    `DF_VSELECT(best2, nearer2, p2, best1)

    // ---- The plane, strictly inside (never without area); v0 v2 runs against the other two edges ----
    `DF_PICK(side0, side, 0)
    `DF_PICK(side1, side, 1)
    `DF_PICK(side2, side, 2)
    `DF_LT(left0, zero, side0)
    `DF_LT(right1, side1, zero)
    `DF_LT(left2, zero, side2)
    `DF_AND(left, left0, left2)
    `DF_AND(enclosed, left, right1)
    `DF_AND(above_it, enclosed, level_face)
    `DF_DOT(height, x, face)
    `DF_VSCALE(drop, face, height)
    `DF_VSUB(plane, x, drop)
    // No farther than the best of edges and vertex: a sliver's plane may be farther, because its normal is inexact.
    `DF_MUL(drop_squared, height, height)
    `DF_LE(no_farther1, drop_squared, least1)
    `DF_LE(no_farther2, drop_squared, rr2)
    `DF_SELECT(no_farther, nearer2, no_farther2, no_farther1)
    `DF_AND(of_plane, above_it, no_farther)
    `DF_VSELECT(nearest, of_plane, plane, best2)
    `DF_VAT(r_end, nearest, T_X + `LATENCY_PROJECT)
    assign r_o = r_end;
  end
  `undef ACROSS
  `undef DF_EN
  `define DF_EN 1'b1
endmodule
