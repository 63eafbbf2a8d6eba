// SPDX-License-Identifier: Apache-2.0
// Signed distance s from a box, half extents a about 0, to a triangle in the box's frame. Also the unit normal n from
// box to triangle and the midpoint of the witness points. The difference of the two has 13 pairs of facets: 3 faces of
// the box, the triangle's face, 9 pairs of edges. Their normals are the candidate axes (SAT). The depth is the least
// overlap on them, the distance the least distance to the facets that face the origin. The nearest point is polished
// twice. Edges turned by 16 u choose the support features (turned.sv).
// Operators: 443 add, 527 mul, 16 div, 11 sqrt, 126 compare, 126 min/max.
// With SAT_II = 3, the triangle's edges share one unit per edge of the box, and three axes share the unit of the
// witness key. Operators then: 301 add, 329 mul, 10 div, 5 sqrt, 100 compare, 78 min/max.
// Latency: LATENCY_TRIANGLE_BOX cycles; 0 with ARITH = "host".
// Throughput: one pair per lane per SAT_II cycles; its operands must stay stable for them.
// Stall: none.
`include "triangle.svh"
module triangle_box #(
    `DF_PARAMETERS,
    parameter int SAT_II = 1  // 1 or 3
) (
    input logic clk_i,
    input logic [1:0] phase_i,  // phase of the pair, used with SAT_II = 3
    input logic [2:0][LANES-1:0][CW-1:0] a_i,
    input logic [2:0][2:0][LANES-1:0][CW-1:0] p_i,  // vertices
    output logic [LANES-1:0][CW-1:0] s_o,
    output logic [2:0][LANES-1:0][CW-1:0] n_o,
    output logic [2:0][LANES-1:0][CW-1:0] middle_o
);
  /*verilator inline_module*/
  localparam int AXES = 13;
  localparam int TURNS = `SAT_TURNS;
  `DF_PHASE_IN(phase, phase_i, 0)
  `DF_VIN(a, a_i, 0)
  `DF_MATRIX_IN(p, p_i[0], p_i[1], p_i[2], 0)
  `DF_CONST(half, CW'(`DF_POWER_OF_TWO(-1)))
  `DF_CONST(four_u, CW'(`DF_POWER_OF_TWO(1 - MAN)))
  `DF_CONST(four, CW'(`DF_POWER_OF_TWO(2)))

  // ---- Values that the candidate axes share ----
  `DF_TRIANGLE(t, p)
  `DF_ROW(f0, t_f, 0)
  `DF_ROW(f1, t_f, 1)
  `DF_ROW(f2, t_f, 2)
  `DF_TURNED(turned0, f0)
  `DF_TURNED(turned1, f1)
  `DF_TURNED(turned2, f2)
  `DF_CROSS(m1, turned0, turned1)
  `DF_MAT(turned_edges, turned0, turned1, turned2)
  `DF_REACH(reach, p)
  `DF_PICK(a_x, a, 0)
  `DF_PICK(a_y, a, 1)
  `DF_PICK(a_z, a, 2)
  `DF_ADD(a_xy, a_x, a_y)
  `DF_ADD(a_sum, a_xy, a_z)
  `DF_ADD(size, reach, a_sum)
  `DF_MUL(tie, four_u, size)
  `DF_MUL(wide_tie, four, tie)

  // ---- The candidate axes, each as late as possible, so that inputs are delayed, not axes ----
  localparam int T_AXES = `TRIANGLE_BOX_T_AXES;
  localparam int T_EDGES = T_AXES - `SAT_WAIT - `LATENCY_TRIANGLE_BOX_EDGE;
  localparam int T_FACES = T_AXES - `LATENCY_TRIANGLE_BOX_FACE;
  logic [AXES-1:0][LANES-1:0][CW-1:0] separation, d2, inverse_ff;
  logic [AXES-1:0][2:0][LANES-1:0][CW-1:0] n, v, p_box, along;
  `DF_VAT(a_edges, a, T_EDGES)
  `DF_MAT_AT(p_edges, p, T_EDGES)
  `DF_MAT_AT(f_edges, t_f, T_EDGES)
  `DF_VAT(inverse_edges, t_inverse_ff, T_EDGES)
  `DF_MAT_AT(turned_at_edges, turned_edges, T_EDGES)
  `DF_VAT(m1_edges, m1, T_EDGES)
  `DF_VAT(a_faces, a_edges, T_FACES)
  `DF_AT(tie_faces, tie, T_FACES)
  `DF_MAT_AT(p_faces, p_edges, T_FACES)
  `DF_MAT_AT(turned_faces, turned_at_edges, T_FACES)
  `DF_PHASE_AT(phase_edges, phase, T_EDGES)
  `DF_ROW(f_edges0, f_edges, 0)
  `DF_ROW(f_edges1, f_edges, 1)
  `DF_ROW(f_edges2, f_edges, 2)
  `DF_PICK(inverse_edges0, inverse_edges, 0)
  `DF_PICK(inverse_edges1, inverse_edges, 1)
  `DF_PICK(inverse_edges2, inverse_edges, 2)
  `DF_ROW(turned_at_edges0, turned_at_edges, 0)
  `DF_ROW(turned_at_edges1, turned_at_edges, 1)
  `DF_ROW(turned_at_edges2, turned_at_edges, 2)
  for (genvar j = 0; j < 3 / TURNS; j++) begin : g_edge
    `DF_VTURN(f_j, j, phase_edges, f_edges0, f_edges1, f_edges2)
    `DF_TURN(inverse_j, j, phase_edges, inverse_edges0, inverse_edges1, inverse_edges2)
    `DF_VTURN(turned_j, j, phase_edges, turned_at_edges0, turned_at_edges1, turned_at_edges2)
    for (genvar i = 0; i < 3; i++) begin : g_axis
      localparam int AXIS = 4 + 3 * i + j;
      logic [LANES-1:0][CW-1:0] separation_e, d2_e, inverse_ff_e;
      logic [2:0][LANES-1:0][CW-1:0] n_e, v_e, p_e, along_e;
      triangle_box_edge #(`DF_SAME, .I(i), .TURNS(TURNS), .J(j)) edges (
          .clk_i, .phase_i(phase_edges), .a_i(a_edges), .p_i(p_edges), .f_i(f_j), .inverse_ff_i(inverse_j),
          .turned_i(turned_j),
          .side_i(m1_edges[i]), .separation_o(separation_e), .n_o(n_e), .v_o(v_e), .p_o(p_e), .d2_o(d2_e),
          .f_o(along_e), .inverse_ff_o(inverse_ff_e));
      axis_results #(`DF_FORMAT, .TURNS(TURNS)) axes (
          .clk_i, .separation_i(separation_e), .n_i(n_e), .v_i(v_e), .p_i(p_e), .d2_i(d2_e), .f_i(along_e),
          .inverse_ff_i(inverse_ff_e),
          .separation_o(separation[AXIS+:TURNS]), .n_o(n[AXIS+:TURNS]), .v_o(v[AXIS+:TURNS]),
          .p_o(p_box[AXIS+:TURNS]), .d2_o(d2[AXIS+:TURNS]),
          .f_o(along[AXIS+:TURNS]), .inverse_ff_o(inverse_ff[AXIS+:TURNS]));
    end
  end
  for (genvar i = 0; i < 3; i++) begin : g_face
    triangle_box_face #(`DF_SAME, .I(i)) face (
        .clk_i, .a_i(a_faces), .p_i(p_faces), .turned_i({turned_faces[2][i], turned_faces[1][i], turned_faces[0][i]}),
        .tie_i(tie_faces),
        .separation_o(separation[i]), .n_o(n[i]), .v_o(v[i]), .p_o(p_box[i]), .d2_o(d2[i]));
    assign along[i] = '0;
    assign inverse_ff[i] = '0;
  end
  logic [2:0][LANES-1:0][CW-1:0] face_n, face_v, face_p;
  logic [LANES-1:0][CW-1:0] face_separation, face_d2;
  `DF_AT(tie_m, tie, `TRIANGLE_T_M)
  triangle_face #(`DF_SAME) face (
      .clk_i, .a_i(a), .p_i(p), .m1_i(m1), .f_i(t_f), .inverse_ff_i(t_inverse_ff), .longest0_i(t_longest0),
      .longest1_i(t_longest1),
      .m_i(t_m), .flat_i(t_flat), .tie_i(tie_m), .separation_o(face_separation), .n_o(face_n), .v_o(face_v),
      .p_o(face_p), .d2_o(face_d2));
  `DF_IN(separation_face, face_separation, `TRIANGLE_FACE_T)
  `DF_IN(d2_face, face_d2, `TRIANGLE_FACE_T)
  `DF_VIN(n_face, face_n, `TRIANGLE_FACE_T)
  `DF_VIN(v_face, face_v, `TRIANGLE_FACE_T)
  `DF_VIN(p_face, face_p, `TRIANGLE_FACE_T)
  `DF_AT(separation_late, separation_face, T_AXES)
  `DF_AT(d2_late, d2_face, T_AXES)
  `DF_VAT(n_late, n_face, T_AXES)
  `DF_VAT(v_late, v_face, T_AXES)
  `DF_VAT(p_late, p_face, T_AXES)
  assign separation[3] = separation_late;
  assign d2[3] = d2_late;
  assign n[3] = n_late;
  assign v[3] = v_late;
  assign p_box[3] = p_late;
  assign along[3] = '0;
  assign inverse_ff[3] = '0;

  // ---- Result of the candidate axes ----
  localparam int T_START = T_AXES + `LATENCY_NEAREST(AXES);
  localparam int T_WITNESS = T_AXES + `LATENCY_WITNESS(AXES);
  `DF_AT(tie_axes, tie_faces, T_AXES)
  `DF_AT(wide_tie_axes, wide_tie, T_AXES)
  logic [LANES-1:0][CW-1:0] choice_s;
  logic [2:0][LANES-1:0][CW-1:0] choice_n, choice_v, choice_p, choice_start_v, choice_start_p;
  `DF_PHASE_AT(phase_axes, phase_edges, T_AXES)
  axis_choice #(`DF_SAME, .COUNT(AXES), .SAT_II(SAT_II)) choice (
      .clk_i, .phase_i(phase_axes), .separation_i(separation), .n_i(n), .v_i(v), .p_i(p_box), .d2_i(d2), .f_i(along),
      .inverse_ff_i(inverse_ff), .tie_i(tie_axes),
      .wide_tie_i(wide_tie_axes), .s_o(choice_s),
      .witness_n_o(choice_n), .witness_v_o(choice_v), .witness_p_o(choice_p), .start_v_o(choice_start_v),
      .start_p_o(choice_start_p));
  `DF_IN(s_axes, choice_s, T_WITNESS)
  `DF_VIN(n_axes, choice_n, T_WITNESS)
  `DF_VIN(v_witness, choice_v, T_WITNESS)
  `DF_VIN(p_witness, choice_p, T_WITNESS)
  `DF_VAT(a_witness, a_faces, T_WITNESS)
  `DF_SETTLE(v_axes, p_axes, v_witness, p_witness, s_axes, n_axes, a_witness)
  `DF_VIN(v_start, choice_start_v, T_START)
  `DF_VIN(p_start, choice_start_p, T_START)

  // ---- The nearest point, polished twice, each time towards the points farthest against its direction ----
  `DF_VAT(a_start, a_faces, T_START)
  `DF_MAT_AT(q_start, p_faces, T_START)
  `DF_LOWEST(vertex1, q_start, v_start)
  `DF_VMOVE_SIGN(p_far1, v_start, a_start)
  `DF_VSUB(v_far1, vertex1, p_far1)
  `DF_POLISH(v_once, p_once, slack_start, v_start, p_start, v_far1, p_far1, tie_axes)
  `DF_VAT(a_once, a_start, T_v_once)
  `DF_MAT_AT(q_once, q_start, T_v_once)
  `DF_LOWEST(vertex2, q_once, v_once)
  `DF_VMOVE_SIGN(p_far2, v_once, a_once)
  `DF_VSUB(v_far2, vertex2, p_far2)
  `DF_POLISH(v_twice, p_twice, slack_once, v_once, p_once, v_far2, p_far2, tie_axes)
  `DF_VAT(a_twice, a_once, T_v_twice)
  `DF_MAT_AT(q_twice, q_once, T_v_twice)
  `DF_LOWEST(vertex3, q_twice, v_twice)
  `DF_VMOVE_SIGN(p_far3, v_twice, a_twice)
  `DF_VSUB(v_far3, vertex3, p_far3)
  `DF_NEARER(v_point, p_point, slack, v_once, p_once, slack_once, v_twice, p_twice, v_far3)
  logic unused_slack;
  assign unused_slack = &{1'b0, slack_start};

  // ---- The distance along its direction, and the choice ----
  `DF_DIRECTION(n_point, d_point, usable, v_point)
  `DF_POINT_DISTANCE(distance_along, s_between, n_point, d_point, slack, s_axes)
  if (T_distance_along != `TRIANGLE_BOX_T_ALONG) $error("triangle_box: stage time");
  `DF_DECIDE(s, n_box, v_box, p_box_point, s_axes, n_axes, v_axes, p_axes, s_between, n_point, v_point, p_point,
      usable, distance_along, tie_axes)
  `DF_VSCALE(half_v, v_box, half)
  `DF_VADD(middle, p_box_point, half_v)

  if (T_middle != `LATENCY_TRIANGLE_BOX) $error("triangle_box: latency");
  `DF_AT(s_out, s, T_middle)
  `DF_VAT(n_out, n_box, T_middle)
  assign s_o = s_out;
  assign n_o = n_out;
  assign middle_o = middle;
endmodule
