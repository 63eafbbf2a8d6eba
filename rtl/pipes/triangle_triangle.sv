// SPDX-License-Identifier: Apache-2.0
// Triangle against triangle, both flat and two-sided, relative to the first vertex of A. Their difference has 11 pairs
// of facets, whose normals are the candidate axes (SAT): each face and 9 pairs of edges. The depth is the least overlap
// on them, the distance the least distance to them. The nearest point is polished twice. For triangles in one plane the
// difference is flat, and no axis shows whether the origin is in it or beside it. So a positive distance along the
// nearest vector proves that they are apart. The signed distance is s, n points from A to B, and CP is the midpoint of
// the witness points. F = (s <= 0), T = |s|.
// Operators: 824 add, 983 mul, 20 div, 15 sqrt, 176 compare, 172 min/max.
// Latency: LATENCY cycles; 0 with ARITH = "host".
// Throughput: LANES pairs per cycle.
// Stall: none, runs free.
`include "triangle_pair.svh"
module triangle_triangle #(
    `DF_PARAMETERS
) (
    input logic clk_i,
    input logic [8:0][LANES-1:0][CW-1:0] a_i,  // triangle A: v0 x y z, v1, v2
    input logic [8:0][LANES-1:0][CW-1:0] b_i,  // triangle B
    `DISTANCE_OUTPUTS
);
  /*verilator inline_module*/
  localparam int AXES = 11;
  `DF_VIN(a0, a_i[2:0], 0)
  `DF_VIN(a1, a_i[5:3], 0)
  `DF_VIN(a2, a_i[8:6], 0)
  `DF_MATRIX_IN(b_vertices, b_i[2:0], b_i[5:3], b_i[8:6], 0)
  `DF_MAT(a_corners, a0, a0, a0)
  `DF_CONST(half, CW'(`DF_POWER_OF_TWO(-1)))
  `DF_CONST(two_u, CW'(`DF_POWER_OF_TWO(-MAN)))
  `DF_CONST(two, CW'(`DF_POWER_OF_TWO(1)))
  `DF_VCONST(p0, 0, 0, 0)
  `DF_VSUB(p1, a1, a0)
  `DF_VSUB(p2, a2, a0)
  `DF_MATRIX_IN(p, p0, p1, p2, T_p1)
  `DF_MSUB(q, b_vertices, a_corners)

  // ---- Values that the candidate axes share ----
  `DF_TRIANGLE(a, p)
  `DF_TRIANGLE(b, q)
  `DF_PICK(inverse_aa0, a_inverse_ff, 0)
  `DF_PICK(inverse_aa1, a_inverse_ff, 1)
  `DF_PICK(inverse_aa2, a_inverse_ff, 2)
  `DF_SQRT(inverse_a0, inverse_aa0)
  `DF_SQRT(inverse_a1, inverse_aa1)
  `DF_SQRT(inverse_a2, inverse_aa2)
  `DF_VEC(inverse_a, inverse_a0, inverse_a1, inverse_a2)
  `DF_MSCALE(along_a, a_f, inverse_a)
  `DF_NORM1(reach_1, p1)
  `DF_NORM1(reach_2, p2)
  `DF_MAX(reach_a, reach_1, reach_2)
  `DF_REACH(reach_b, q)
  `DF_MAX(size, reach_a, reach_b)
  `DF_MUL(tie, two_u, size)
  `DF_MUL(wide_tie, two, tie)

  // ---- The candidate axes, each as late as possible, so that inputs are delayed, not axes ----
  localparam int T_AXES = T_p + `TRIANGLE_PAIR_T_AXES;
  localparam int T_EDGES = T_AXES - `LATENCY_TRIANGLE_PAIR_EDGE;
  logic [AXES-1:0][LANES-1:0][CW-1:0] separation, d2, inverse_ff;
  logic [AXES-1:0][2:0][LANES-1:0][CW-1:0] n, v, p_of_a, ends_on;
  `DF_MAT_AT(p_edges, p, T_EDGES)
  `DF_MAT_AT(q_edges, q, T_EDGES)
  `DF_MAT_AT(e_edges, a_f, T_EDGES)
  `DF_MAT_AT(along_edges, along_a, T_EDGES)
  `DF_VAT(inverse_e_edges, inverse_a, T_EDGES)
  `DF_VAT(inverse_ee_edges, a_inverse_ff, T_EDGES)
  `DF_MAT_AT(f_edges, b_f, T_EDGES)
  `DF_VAT(inverse_ff_edges, b_inverse_ff, T_EDGES)
  `DF_AT(tie_edges, tie, T_EDGES)
  for (genvar i = 0; i < 3; i++) begin : g_edge_of_a
    for (genvar j = 0; j < 3; j++) begin : g_edge_of_b
      localparam int AXIS = 2 + 3 * i + j;
      triangle_pair_edge #(`DF_SAME, .I(i), .J(j)) edges (
          .clk_i, .p_i(p_edges[2:1]), .q_i(q_edges), .e_i(e_edges[i]), .unit_e_i(along_edges[i]),
          .inverse_e_i(inverse_e_edges[i]), .inverse_ee_i(inverse_ee_edges[i]), .f_i(f_edges[j]),
          .inverse_ff_i(inverse_ff_edges[j]), .tie_i(tie_edges), .separation_o(separation[AXIS]), .n_o(n[AXIS]),
          .v_o(v[AXIS]),
          .p_o(p_of_a[AXIS]), .d2_o(d2[AXIS]), .f_o(ends_on[AXIS]), .inverse_ff_o(inverse_ff[AXIS]));
    end
  end
  localparam int T_FACE = T_p + `TRIANGLE_PAIR_FACE_T;
  `DF_AT(tie_a, tie, T_a_m)
  logic [1:0][LANES-1:0][CW-1:0] face_separation, face_d2;
  logic [1:0][2:0][LANES-1:0][CW-1:0] face_n, face_v, face_p;
  triangle_pair_face #(`DF_SAME, .OF_B(0)) face_of_a (
      .clk_i, .p_i(p), .q_i(q), .f_i(a_f), .inverse_ff_i(a_inverse_ff), .longest0_i(a_longest0),
      .longest1_i(a_longest1), .m_i(a_m), .flat_i(a_flat), .tie_i(tie_a), .separation_o(face_separation[0]),
      .n_o(face_n[0]), .v_o(face_v[0]), .p_o(face_p[0]), .d2_o(face_d2[0]));
  triangle_pair_face #(`DF_SAME, .OF_B(1)) face_of_b (
      .clk_i, .p_i(p), .q_i(q), .f_i(b_f), .inverse_ff_i(b_inverse_ff), .longest0_i(b_longest0),
      .longest1_i(b_longest1), .m_i(b_m), .flat_i(b_flat), .tie_i(tie_a), .separation_o(face_separation[1]),
      .n_o(face_n[1]), .v_o(face_v[1]), .p_o(face_p[1]), .d2_o(face_d2[1]));
  for (genvar i = 0; i < 2; i++) begin : g_face
    `DF_IN(separation_face, face_separation[i], T_FACE)
    `DF_IN(d2_face, face_d2[i], T_FACE)
    `DF_VIN(n_face, face_n[i], T_FACE)
    `DF_VIN(v_face, face_v[i], T_FACE)
    `DF_VIN(p_face, face_p[i], T_FACE)
    `DF_AT(separation_late, separation_face, T_AXES)
    `DF_AT(d2_late, d2_face, T_AXES)
    `DF_VAT(n_late, n_face, T_AXES)
    `DF_VAT(v_late, v_face, T_AXES)
    `DF_VAT(p_late, p_face, T_AXES)
    assign separation[i] = separation_late;
    assign d2[i] = d2_late;
    assign n[i] = n_late;
    assign v[i] = v_late;
    assign p_of_a[i] = p_late;
    assign ends_on[i] = '0;
    assign inverse_ff[i] = '0;
  end

  // ---- Result of the candidate axes ----
  localparam int T_START = T_AXES + `LATENCY_NEAREST(AXES);
  localparam int SAT_II = 1;
  localparam int T_WITNESS = T_AXES + `LATENCY_WITNESS(AXES);
  `DF_AT(tie_axes, tie_edges, T_AXES)
  `DF_AT(wide_tie_axes, wide_tie, T_AXES)
  logic [LANES-1:0][CW-1:0] choice_s;
  logic [2:0][LANES-1:0][CW-1:0] choice_n, choice_v, choice_p, choice_start_v, choice_start_p;
  axis_choice #(`DF_SAME, .COUNT(AXES), .SAT_II(SAT_II)) choice (
      .clk_i, .phase_i(2'd0), .separation_i(separation), .n_i(n), .v_i(v), .p_i(p_of_a), .d2_i(d2), .f_i(ends_on),
      .inverse_ff_i(inverse_ff), .tie_i(tie_axes), .wide_tie_i(wide_tie_axes), .s_o(choice_s),
      .witness_n_o(choice_n), .witness_v_o(choice_v), .witness_p_o(choice_p), .start_v_o(choice_start_v),
      .start_p_o(choice_start_p));
  `DF_IN(s_axes, choice_s, T_WITNESS)
  `DF_VIN(n_axes, choice_n, T_WITNESS)
  `DF_VIN(v_axes, choice_v, T_WITNESS)
  `DF_VIN(p_axes, choice_p, T_WITNESS)
  `DF_VIN(v_start, choice_start_v, T_START)
  `DF_VIN(p_start, choice_start_p, T_START)

  // ---- The nearest point, polished twice, each time towards the points of both farthest against its direction ----
  `DF_MAT_AT(p_at_start, p_edges, T_START)
  `DF_MAT_AT(q_at_start, q_edges, T_START)
  `DF_LOWEST(vertex1, q_at_start, v_start)
  `DF_HIGHEST_ZERO(p_far1, p_at_start, v_start)
  `DF_VSUB(v_far1, vertex1, p_far1)
  `DF_POLISH(v_once, p_once, slack_start, v_start, p_start, v_far1, p_far1, tie_axes)
  `DF_MAT_AT(p_at_once, p_at_start, T_v_once)
  `DF_MAT_AT(q_at_once, q_at_start, T_v_once)
  `DF_LOWEST(vertex2, q_at_once, v_once)
  `DF_HIGHEST_ZERO(p_far2, p_at_once, v_once)
  `DF_VSUB(v_far2, vertex2, p_far2)
  `DF_POLISH(v_twice, p_twice, slack_once, v_once, p_once, v_far2, p_far2, tie_axes)
  `DF_MAT_AT(p_at_twice, p_at_once, T_v_twice)
  `DF_MAT_AT(q_at_twice, q_at_once, T_v_twice)
  `DF_LOWEST(vertex3, q_at_twice, v_twice)
  `DF_HIGHEST_ZERO(p_far3, p_at_twice, v_twice)
  `DF_VSUB(v_far3, vertex3, p_far3)
  `DF_NEARER(v_point, p_point, slack, v_once, p_once, slack_once, v_twice, p_twice, v_far3)
  logic unused_slack;
  assign unused_slack = &{1'b0, slack_start};

  // ---- The distance along its direction, and the choice ----
  `DF_DIRECTION(n_point, d_point, usable, v_point)
  `DF_POINT_DISTANCE(distance_along, s_between, n_point, d_point, slack, s_axes)
  `DF_SUB(tied, s_axes, tie_axes)
  `DF_MAX(least, tied, tie_axes)
  `DF_LE(confirmed, least, distance_along)
  `DF_AND(point, usable, confirmed)
  `DF_SELECT(s, point, s_between, s_axes)
  `DF_VSELECT(n_out, point, n_point, n_axes)
  `DF_VSELECT(v_out, point, v_point, v_axes)
  `DF_VSELECT(p_out, point, p_point, p_axes)
  `DF_VSCALE(half_v, v_out, half)
  `DF_VADD(middle, p_out, half_v)
  `DF_VADD(cp, a0, middle)

  `DISTANCE_RESULT(s, cp, n_out)
endmodule
