// SPDX-License-Identifier: Apache-2.0
// Oriented box against oriented box, in A's frame: A's centre is 0, and its axes are e_i. B has centre t, axes r_j and
// half edges f_j = b_j r_j.
// The difference B - A has 15 pairs of facets. Their normals are the 15 candidate axes (SAT): 3 faces of A, 3 faces
// of B, 9 pairs of edges. The depth is the least overlap on them. The distance is the least distance to the 15 facets
// that face the origin. The nearest point is polished twice. Axes turned by 16 u choose the support features, as if no
// face or edge of one box were parallel to one of the other. F = (s <= 0), T = |s|.
// Operators: 638 add, 568 mul, 15 div, 10 sqrt, 123 compare, 91 min/max.
// With SAT_II = 3, the edges of B share one unit per edge of A. A face of A and one of B share a unit. Three axes
// share the unit of the witness key. Operators then: 372 add, 335 mul, 7 div, 4 sqrt, 81 compare, 43 min/max.
// Latency: LATENCY cycles; 0 with ARITH = "host".
// Throughput: LANES pairs per SAT_II cycles.
// Stall: none, runs free.
`include "convex.svh"
module obb_obb #(
    `DF_PARAMETERS,
    parameter int SAT_II = 1  // 1 or 3
) (
    input logic clk_i,
    input logic enter_i,  // a pair enters; used with SAT_II = 3
    input logic [14:0][LANES-1:0][CW-1:0] a_i,  // OBB: c x y z, half extents, rotation by rows
    input logic [14:0][LANES-1:0][CW-1:0] b_i,
    `DISTANCE_OUTPUTS
);
  /*verilator inline_module*/
  localparam int AXES = 15;
  localparam logic [CW-1:0] HALF = CW'(`DF_POWER_OF_TWO(-1));
  localparam logic [CW-1:0] TIE = CW'(`DF_POWER_OF_TWO(1 - MAN));  // 4 u

  localparam int TURNS = `SAT_TURNS;
  localparam int T_IN = `SAT_T_IN;
  logic [14:0][LANES-1:0][CW-1:0] box_a, box_b;
  logic [1:0] phase_in;
  pair_hold #(.SAT_II(SAT_II), .A_BITS(15 * LANES * CW), .B_BITS(15 * LANES * CW), .ARITH(ARITH)) hold (
      .clk_i, .enter_i, .a_i, .b_i, .a_o(box_a), .b_o(box_b), .phase_o(phase_in));
  `DF_PHASE_IN(phase, phase_in, T_IN)
  `DF_VIN(a_c, box_a[2:0], T_IN)
  `DF_VIN(a, box_a[5:3], T_IN)
  `DF_MATRIX_IN(a_rotation, box_a[8:6], box_a[11:9], box_a[14:12], T_IN)
  `DF_VIN(b_c, box_b[2:0], T_IN)
  `DF_VIN(b, box_b[5:3], T_IN)
  `DF_MATRIX_IN(b_rotation, box_b[8:6], box_b[11:9], box_b[14:12], T_IN)
  `DF_CONST(half, HALF)
  `DF_CONST(four_u, TIE)
  `DF_CONST(four, CW'(`DF_POWER_OF_TWO(2)))

  // ---- The pair in A's frame ----
  `DF_VSUB(centres, b_c, a_c)
  `DF_TRANSPOSE(a_frame, a_rotation)
  `DF_TRANSPOSE(b_frame, b_rotation)
  `DF_APPLY(t, a_frame, centres)
  `DF_ROW(b_axis0, b_frame, 0)
  `DF_ROW(b_axis1, b_frame, 1)
  `DF_ROW(b_axis2, b_frame, 2)
  `DF_APPLY(r0, a_frame, b_axis0)
  `DF_APPLY(r1, a_frame, b_axis1)
  `DF_APPLY(r2_given, a_frame, b_axis2)
  // A box may be given by a reflection. The turned axes need a rotation, and the box is the same.
  `DF_CROSS(r01, r0, r1)
  `DF_DOT(handedness, r01, r2_given)
  `DF_VFLIP(r2, handedness, r2_given)
  `DF_PICK(b0, b, 0)
  `DF_PICK(b1, b, 1)
  `DF_PICK(b2, b, 2)
  `DF_VSCALE(f0, r0, b0)
  `DF_VSCALE(f1, r1, b1)
  `DF_VSCALE(f2, r2, b2)
  `DF_TURNED(turned0, r0)
  `DF_TURNED(turned1, r1)
  `DF_TURNED(turned2, r2)
  `DF_MAT(r, r0, r1, r2)
  `DF_MAT(f, f0, f1, f2)
  `DF_MAT(turned_r, turned0, turned1, turned2)

  // Distances closer than `tie` are equal.
  `DF_PICK(a0, a, 0)
  `DF_PICK(a1, a, 1)
  `DF_PICK(a2, a, 2)
  `DF_ADD(a01, a0, a1)
  `DF_ADD(a_sum, a01, a2)
  `DF_ADD(b01, b0, b1)
  `DF_ADD(b_sum, b01, b2)
  `DF_ADD(extents, a_sum, b_sum)
  `DF_NORM1(t_sum, t)
  `DF_ADD(size, t_sum, extents)
  `DF_MUL(tie, four_u, size)
  `DF_MUL(wide_tie, four, tie)

  // ---- Stage times of the candidate axes ----
  // Slow adders can make the edges' other inputs later than their normals.
  localparam int T_LATEST = `DF_MAX2(T_t, `DF_MAX2(T_turned_r, T_tie));
  localparam int T_EARLY = `DF_MAX2(T_f, T_LATEST - `LATENCY_EDGE_NORMAL);
  localparam int T_EDGES = T_EARLY + `LATENCY_EDGE_NORMAL;
  localparam int T_AXES = T_EDGES + `LATENCY_OBB_EDGE + `SAT_WAIT;
  // As late as possible, so that inputs are delayed, not axes.
  localparam int T_FACES_B = T_AXES - `DF_LAT_DOT - `LATENCY_OBB_FACE;
  localparam int T_FACES_A = T_AXES - `LATENCY_OBB_FACE;
  `DF_VAT(a_edges, a, T_EDGES)
  `DF_VAT(t_edges, t, T_EDGES)
  `DF_AT(tie_edges, tie, T_EDGES)
  `DF_MAT_AT(f_edges, f, T_EDGES)
  `DF_MAT_AT(turned_edges, turned_r, T_EDGES)
  `DF_VAT(a_faces_b, a_edges, T_FACES_B)
  `DF_VAT(t_faces_b, t_edges, T_FACES_B)
  `DF_MAT_AT(f_faces_b, f_edges, T_FACES_B)
  `DF_MAT_AT(turned_faces_b, turned_edges, T_FACES_B)
  `DF_TRANSPOSE(turned_columns_b, turned_faces_b)
  `DF_VAT(a_faces_a, a_faces_b, T_FACES_A)
  `DF_VAT(t_faces_a, t_faces_b, T_FACES_A)
  `DF_MAT_AT(f_faces_a, f_faces_b, T_FACES_A)

  logic [AXES-1:0][LANES-1:0][CW-1:0] separation, d2, inverse_ff;
  logic [AXES-1:0][2:0][LANES-1:0][CW-1:0] n, v, p, along;

  // ---- Faces. For B: the pair in B's frame, roles exchanged; the axis' vector and normal return to A's frame ----
  `DF_APPLY(t_from_b, r, t)
  `DF_VNEG(t_back, t_from_b)
  `DF_TRANSPOSE(columns, r)
  `DF_ROW(column0, columns, 0)
  `DF_ROW(column1, columns, 1)
  `DF_ROW(column2, columns, 2)
  `DF_VSCALE(f_back0, column0, a0)
  `DF_VSCALE(f_back1, column1, a1)
  `DF_VSCALE(f_back2, column2, a2)
  `DF_MAT(f_back, f_back0, f_back1, f_back2)
  `DF_VAT(b_back_faces_b, b, T_FACES_B)
  `DF_VAT(t_back_faces_b, t_back, T_FACES_B)
  `DF_MAT_AT(f_back_faces_b, f_back, T_FACES_B)
  `DF_MAT_AT(r_faces_b, r, T_FACES_B)
  localparam int T_V_B = T_FACES_B + `LATENCY_OBB_FACE;
  `DF_TRANSPOSE(columns_faces_b, r_faces_b)
  `DF_MAT_AT(columns_v, columns_faces_b, T_V_B)
  `DF_MAT_AT(r_axes, r_faces_b, T_AXES)
  `DF_MAT_AT(turned_axes, turned_faces_b, T_AXES)
  `DF_VAT(a_axes, a_faces_a, T_AXES)
  // Face units: first B's face, whose vector takes longer, then A's.
  `DF_PHASE_AT(phase_faces, phase, T_FACES_B)
  `DF_VTURN(half_extents, 0, phase_faces, b_back_faces_b, a_faces_b, a_faces_b)
  `DF_VTURN(centre, 0, phase_faces, t_back_faces_b, t_faces_b, t_faces_b)
  `DF_MTURN(half_edges, 0, phase_faces, f_back_faces_b, f_faces_b, f_faces_b)
  `DF_MTURN(signs, 0, phase_faces, turned_faces_b, turned_columns_b, turned_columns_b)
  for (genvar j = 0; j < 3; j++) begin : g_face
    logic [LANES-1:0][CW-1:0] separation_b, d2_b;
    logic [2:0][LANES-1:0][CW-1:0] n_b, v_b, p_b;
    // A's position in B's frame: the normal is reversed.
    `DF_ROW(axis_b, r, j)
    `DF_LEADING(leading, axis_b)
    `DF_LEAD(axis_lead, leading, axis_b)
    `DF_LEAD(t_lead, leading, t)
    `DF_MOVE_SIGN(along_axis, t_lead, axis_lead)
    `DF_NEG(against_axis, along_axis)
    `DF_PICK(height, t_back, j)
    `DF_SIDE_OF(side_b, height, tie, against_axis)
    `DF_AT(side_faces, side_b, T_FACES_B)
    `DF_AT(side, side_faces, T_AXES)
    `DF_PICK(height_a, t_faces_b, j)
    `DF_TURN(side_turn, 0, phase_faces, side_faces, height_a, height_a)
    obb_face #(`DF_SAME, .I(j)) face (
        .clk_i, .a_i(half_extents), .t_i(centre), .f_i(half_edges), .signs_i(signs[j]), .side_i(side_turn),
        .separation_o(separation_b), .n_o(n_b),
        .v_o(v_b), .p_o(p_b), .d2_o(d2_b));
    if (TURNS == 1) begin : g_a
      `DF_ROW(signs_b, turned_columns_b, j)
      `DF_VAT(signs_a, signs_b, T_FACES_A)
      obb_face #(`DF_SAME, .I(j)) face_a (
          .clk_i, .a_i(a_faces_a), .t_i(t_faces_a), .f_i(f_faces_a), .signs_i(signs_a), .side_i(t_faces_a[j]),
          .separation_o(separation[j]),
          .n_o(n[j]), .v_o(v[j]), .p_o(p[j]), .d2_o(d2[j]));
      logic unused;
      assign unused = &{1'b0, n_b, p_b};
    end else begin : g_a_in_turn
      localparam int T_V_A = T_V_B + 1;
      `DF_IN(separation_turn, separation_b, T_V_A)
      `DF_IN(d2_turn, d2_b, T_V_A)
      `DF_VIN(n_turn, n_b, T_V_A)
      `DF_VIN(v_turn, v_b, T_V_A)
      `DF_VIN(p_turn, p_b, T_V_A)
      `DF_AT(separation_late, separation_turn, T_AXES)
      `DF_AT(d2_late, d2_turn, T_AXES)
      `DF_VAT(n_late, n_turn, T_AXES)
      `DF_VAT(v_late, v_turn, T_AXES)
      `DF_VAT(p_late, p_turn, T_AXES)
      assign separation[j] = separation_late;
      assign d2[j] = d2_late;
      assign n[j] = n_late;
      assign v[j] = v_late;
      assign p[j] = p_late;
    end
    assign along[j] = '0;
    assign inverse_ff[j] = '0;
    `DF_VIN(v_from_b, v_b, T_V_B)
    `DF_APPLY(minus_v, columns_v, v_from_b)
    `DF_VNEG(v_a, minus_v)
    `DF_ROW(turned_axis, turned_axes, j)
    `DF_VMOVE_SIGN(corner, turned_axis, a_axes)
    `DF_VFLIP(minus_p, side, corner)
    `DF_VNEG(p_a, minus_p)
    `DF_ROW(axis, r_axes, j)
    `DF_VFLIP(minus_n, side, axis)
    `DF_VNEG(n_a, minus_n)
    `DF_IN(separation_early, separation_b, T_V_B)
    `DF_IN(d2_early, d2_b, T_V_B)
    `DF_AT(separation_a, separation_early, T_AXES)
    `DF_AT(d2_a, d2_early, T_AXES)
    assign separation[3+j] = separation_a;
    assign d2[3+j] = d2_a;
    assign n[3+j] = n_a;
    assign v[3+j] = v_a;
    assign p[3+j] = p_a;
    assign along[3+j] = '0;
    assign inverse_ff[3+j] = '0;
  end

  // ---- Edges of A and edges of B; for each edge of B, the inputs of its axes ----
  `DF_PHASE_AT(phase_f, phase, T_EARLY)
  `DF_MAT_AT(f_normals, f, T_EARLY)
  `DF_PHASE_AT(phase_edges, phase_f, T_EDGES)
  `DF_ROW(f_row0, f_normals, 0)
  `DF_ROW(f_row1, f_normals, 1)
  `DF_ROW(f_row2, f_normals, 2)
  `DF_ROW(f_edges0, f_edges, 0)
  `DF_ROW(f_edges1, f_edges, 1)
  `DF_ROW(f_edges2, f_edges, 2)
  `DF_ROW(turned_edges0, turned_edges, 0)
  `DF_ROW(turned_edges1, turned_edges, 1)
  `DF_ROW(turned_edges2, turned_edges, 2)
  `DF_MNEG(minus_turned, turned_edges)
  `DF_ROW(minus_turned0, minus_turned, 0)
  `DF_ROW(minus_turned1, minus_turned, 1)
  `DF_ROW(minus_turned2, minus_turned, 2)
  for (genvar j = 0; j < 3 / TURNS; j++) begin : g_edge_b
    `DF_TURN(b_j, j, phase, b0, b1, b2)
    `DF_MUL(ff, b_j, b_j)
    `DF_USABLE(long, ff)
    `DF_RECIPROCAL_OR_ZERO(inverse, long, ff)
    `DF_AT(inverse_edges, inverse, T_EDGES)
    `DF_VTURN(f_early, j, phase_f, f_row0, f_row1, f_row2)
    `DF_VTURN(f_j, j, phase_edges, f_edges0, f_edges1, f_edges2)
    `DF_VTURN(f_first, j, phase_edges, f_edges1, f_edges0, f_edges0)
    `DF_VTURN(f_second, j, phase_edges, f_edges2, f_edges2, f_edges1)
    `DF_VTURN(turned_j, j, phase_edges, turned_edges0, turned_edges1, turned_edges2)
    `DF_VTURN(sign_first, j, phase_edges, turned_edges2, minus_turned2, turned_edges1)
    `DF_VTURN(sign_second, j, phase_edges, minus_turned1, turned_edges0, minus_turned0)
    for (genvar i = 0; i < 3; i++) begin : g_edge_a
      localparam int K = (i + 1) % 3, L = (i + 2) % 3, AXIS = 6 + 3 * i + j;
      logic [LANES-1:0][CW-1:0] n_k, n_l, inverse2, valid, separation_e, d2_e, inverse_ff_e;
      logic [2:0][LANES-1:0][CW-1:0] n_e, v_e, p_e, f_e;
      edge_normal #(`DF_SAME) normal (
          .clk_i, .f_k_i(f_early[K]), .f_l_i(f_early[L]), .n_k_o(n_k), .n_l_o(n_l), .inverse2_o(inverse2),
          .valid_o(valid));
      obb_edge #(`DF_SAME, .I(i)) edges (
          .clk_i, .a_i(a_edges), .t_i(t_edges), .f_i(f_edges), .edge_i(f_j), .first_i(f_first), .second_i(f_second),
          .sign_k_i(turned_j[K]),
          .sign_l_i(turned_j[L]), .sign_first_i(sign_first[i]), .sign_second_i(sign_second[i]),
          .inverse_ff_i(inverse_edges), .n_k_i(n_k),
          .n_l_i(n_l), .inverse2_i(inverse2), .tie_i(tie_edges), .valid_i(valid), .separation_o(separation_e),
          .n_o(n_e), .v_o(v_e), .p_o(p_e), .d2_o(d2_e), .f_o(f_e),
          .inverse_ff_o(inverse_ff_e));
      axis_results #(`DF_FORMAT, .TURNS(TURNS)) axes (
          .clk_i, .separation_i(separation_e), .n_i(n_e), .v_i(v_e), .p_i(p_e), .d2_i(d2_e), .f_i(f_e),
          .inverse_ff_i(inverse_ff_e),
          .separation_o(separation[AXIS+:TURNS]), .n_o(n[AXIS+:TURNS]), .v_o(v[AXIS+:TURNS]), .p_o(p[AXIS+:TURNS]),
          .d2_o(d2[AXIS+:TURNS]),
          .f_o(along[AXIS+:TURNS]), .inverse_ff_o(inverse_ff[AXIS+:TURNS]));
    end
  end

  // ---- Result of the candidate axes ----
  localparam int T_START = T_AXES + `LATENCY_NEAREST(AXES);
  localparam int T_WITNESS = T_AXES + `LATENCY_WITNESS(AXES);
  `DF_AT(tie_axes, tie_edges, T_AXES)
  `DF_AT(wide_tie_axes, wide_tie, T_AXES)
  logic [LANES-1:0][CW-1:0] choice_s;
  logic [2:0][LANES-1:0][CW-1:0] choice_n, choice_v, choice_p, choice_start_v, choice_start_p;
  `DF_PHASE_AT(phase_axes, phase_edges, T_AXES)
  axis_choice #(`DF_SAME, .COUNT(AXES), .SAT_II(SAT_II)) choice (
      .clk_i, .phase_i(phase_axes), .separation_i(separation), .n_i(n), .v_i(v), .p_i(p), .d2_i(d2), .f_i(along),
      .inverse_ff_i(inverse_ff), .tie_i(tie_axes),
      .wide_tie_i(wide_tie_axes), .s_o(choice_s),
      .witness_n_o(choice_n), .witness_v_o(choice_v), .witness_p_o(choice_p), .start_v_o(choice_start_v),
      .start_p_o(choice_start_p));
  `DF_IN(s_axes, choice_s, T_WITNESS)
  `DF_VIN(n_axes, choice_n, T_WITNESS)
  `DF_VIN(v_witness, choice_v, T_WITNESS)
  `DF_VIN(p_witness, choice_p, T_WITNESS)
  `DF_VAT(a_witness, a_axes, T_WITNESS)
  `DF_SETTLE(v_axes, p_axes, v_witness, p_witness, s_axes, n_axes, a_witness)
  `DF_VIN(v_start, choice_start_v, T_START)
  `DF_VIN(p_start, choice_start_p, T_START)

  // ---- The nearest point, polished twice, and the difference between its length and its distance ----
  `DF_VAT(a_start, a_axes, T_START)
  `DF_VAT(t_start, t_faces_a, T_START)
  `DF_MAT_AT(f_start, f_faces_a, T_START)
  logic [2:0][LANES-1:0][CW-1:0] support1_v, support1_p, support2_v, support2_p, support3_v, support3_p;
  obb_support #(`DF_SAME) support1 (
      .clk_i, .v_i(v_start), .a_i(a_start), .t_i(t_start), .f_i(f_start), .v_o(support1_v), .p_o(support1_p));
  `DF_VIN(v_far1, support1_v, T_START + `LATENCY_OBB_SUPPORT)
  `DF_VIN(p_far1, support1_p, T_START + `LATENCY_OBB_SUPPORT)
  `DF_POLISH(v_once, p_once, slack_start, v_start, p_start, v_far1, p_far1, tie_axes)
  `DF_VAT(a_once, a_start, T_v_once)
  `DF_VAT(t_once, t_start, T_v_once)
  `DF_MAT_AT(f_once, f_start, T_v_once)
  obb_support #(`DF_SAME) support2 (
      .clk_i, .v_i(v_once), .a_i(a_once), .t_i(t_once), .f_i(f_once), .v_o(support2_v), .p_o(support2_p));
  `DF_VIN(v_far2, support2_v, T_v_once + `LATENCY_OBB_SUPPORT)
  `DF_VIN(p_far2, support2_p, T_v_once + `LATENCY_OBB_SUPPORT)
  `DF_POLISH(v_twice, p_twice, slack_once, v_once, p_once, v_far2, p_far2, tie_axes)
  `DF_VAT(a_twice, a_once, T_v_twice)
  `DF_VAT(t_twice, t_once, T_v_twice)
  `DF_MAT_AT(f_twice, f_once, T_v_twice)
  obb_support #(`DF_SAME) support3 (
      .clk_i, .v_i(v_twice), .a_i(a_twice), .t_i(t_twice), .f_i(f_twice), .v_o(support3_v), .p_o(support3_p));
  `DF_VIN(v_far3, support3_v, T_v_twice + `LATENCY_OBB_SUPPORT)
  `DF_NEARER(v_point, p_point, slack, v_once, p_once, slack_once, v_twice, p_twice, v_far3)
  logic unused_polished;
  assign unused_polished = &{1'b0, slack_start, support3_p};

  // ---- The distance along its direction, and the choice ----
  `DF_DIRECTION(n_point, d_point, usable, v_point)
  `DF_POINT_DISTANCE(distance_along, s_between, n_point, d_point, slack, s_axes)
  `DF_DECIDE(s, n_local, v_local, p_local, s_axes, n_axes, v_axes, p_axes, s_between, n_point, v_point, p_point,
      usable, distance_along, tie_axes)

  // ---- Back to the world ----
  `DF_VSCALE(half_v, v_local, half)
  `DF_VADD(middle, p_local, half_v)
  `DF_APPLY(middle_world, a_rotation, middle)
  `DF_VADD(cp, a_c, middle_world)
  `DF_APPLY(n_world, a_rotation, n_local)

  `DISTANCE_RESULT(s, cp, n_world)
endmodule
