// SPDX-License-Identifier: Apache-2.0
// A witness pass of a cylinder pair (reference/pipes/cylinder/witness.hpp): finds the point q of A with q + s n in B.
// It projects alternately between the features that n touches (track 0), then those that n nearly touches, then the
// solids. Touch starts at the support point that is nearer to the other body, or at the middle of a cap.
// Project goes to B moved by -s n and back to A, then on to where flat faces would cross.
// If the solids are clearly apart, the last projections are on the unmoved solids. The direction between their nearest
// points becomes n if g does not fall. The best point so far is w, and off is its squared distance from B.
// Operators (cylinder): 86 add, 78 mul, 3 div, 2 sqrt, 14 compare, 8 min/max.
// Operators (box): 83 add, 77 mul, 2 div, 1 sqrt, 13 compare, 11 min/max.
// Operators (triangle): 145 add, 137 mul, 5 div, 1 sqrt, 21 compare, 12 min/max.
// Latency: LATENCY_CYLINDER_WITNESS cycles; 0 with ARITH = "host".
// Throughput: one pass per lane per cycle.
// Stall: none, runs free.
`include "cylinder.svh"
module cylinder_witness #(
    `DF_PARAMETERS,
    parameter int BODY = `BODY_CYLINDER
) (
    input logic clk_i,
    input logic [`PASS_W-1:0] pass_i,
    input logic [2:0][2:0][LANES-1:0][CW-1:0] axis_i,  // A: axes, half height or half extents, radius, edges, face
    input logic [2:0][LANES-1:0][CW-1:0] half_i,
    input logic [LANES-1:0][CW-1:0] radius_i,
    input logic [2:0][2:0][LANES-1:0][CW-1:0] edge_i,
    input logic [2:0][LANES-1:0][CW-1:0] face_i,
    input logic [2:0][LANES-1:0][CW-1:0] d_i,  // B: centre, axis, half height, radius
    input logic [2:0][LANES-1:0][CW-1:0] b_i,
    input logic [LANES-1:0][CW-1:0] b_half_i,
    input logic [LANES-1:0][CW-1:0] b_radius_i,
    input logic [2:0][LANES-1:0][CW-1:0] a_reach_i,  // half heights times axes
    input logic [2:0][LANES-1:0][CW-1:0] b_reach_i,
    input logic [2:0][LANES-1:0][CW-1:0] tried_n_i,  // the normal of this pass (n unless a trial) and its evaluation
    input logic [LANES-1:0][CW-1:0] tried_g_i,
    input logic [LANES-1:0][CW-1:0] minus_g_i,
    input logic [2:0][LANES-1:0][CW-1:0] y_i,
    input logic [LANES-1:0][CW-1:0] a_kappa_i,
    input logic [2:0][LANES-1:0][CW-1:0] a_side_i,
    input logic [LANES-1:0][CW-1:0] b_kappa_i,
    input logic [2:0][LANES-1:0][CW-1:0] b_side_i,
    input logic [LANES-1:0][CW-1:0] b_along_i,
    input logic [2:0][LANES-1:0][CW-1:0] pa_i,
    input logic [LANES-1:0][CW-1:0] g_i,  // the pair's state: s and n
    input logic [2:0][LANES-1:0][CW-1:0] n_i,
    input logic [2:0][LANES-1:0][CW-1:0] q_i,
    input logic [2:0][LANES-1:0][CW-1:0] w_i,
    input logic [LANES-1:0][CW-1:0] off_i,
    input logic [2:0][LANES-1:0][CW-1:0] from_i,  // where the previous pass began, and how far it went
    input logic [2:0][LANES-1:0][CW-1:0] move_i,
    output logic [LANES-1:0][CW-1:0] g_o,
    output logic [2:0][LANES-1:0][CW-1:0] n_o,
    output logic [2:0][LANES-1:0][CW-1:0] q_o,
    output logic [2:0][LANES-1:0][CW-1:0] w_o,
    output logic [LANES-1:0][CW-1:0] off_o,
    output logic [2:0][LANES-1:0][CW-1:0] from_o,
    output logic [2:0][LANES-1:0][CW-1:0] move_o,
    output logic [2:0][LANES-1:0][CW-1:0] next_o  // normal to try in the next pass
);
  /*verilator inline_module*/
  logic en;
  assign en = `PASS_PHASE(pass_i) == `PHASE_TOUCH || `PASS_PHASE(pass_i) == `PHASE_PROJECT;
  `undef DF_EN
  `define DF_EN en
  // A normal within this angle touches all of an edge, face, cap or line of a side: 64 u. Where n may be off, it is
  // 2^14 u radian.
  localparam int TOUCHING = 5 - MAN, WIDE = 13 - MAN;
  logic [7:0] index;
  logic [1:0] track;
  logic touching;
  assign track = `PASS_TRACK(pass_i);
  assign index = `PASS_INDEX(pass_i);
  assign touching = `PASS_PHASE(pass_i) == `PHASE_TOUCH;
  `DF_CONTROL(touch, touching, 0)
  `DF_CONTROL(first, track == 0, 0)
  `DF_CONTROL(start, touching && track == 0, 0)
  `DF_CONTROL(on_features, touching || track == 0 || index < `WIDE_PROJECTIONS - 2, 0)
  `DF_CONTROL(with_lines, track == 0 || !touching, 0)
  `DF_CONTROL(with_rims, track == 0 || BODY != `BODY_CYLINDER, 0)
  `DF_CONTROL(unshifted, !touching && track == 1 && index >= `UNSHIFTED, 0)
  `DF_CONTROL(fresh, !touching && track == 1 && index == `UNSHIFTED, 0)
  `DF_CONTROL(trial, !touching && `PASS_TRIAL(pass_i), 0)
  `DF_CONTROL(onward, track == 0 || index[0], 0)
  `DF_VIN(n, n_i, 0)
  `DF_IN(g, g_i, 0)
  `DF_VIN(tried_n, tried_n_i, 0)
  `DF_IN(tried_g, tried_g_i, 0)
  `DF_IN(minus_g, minus_g_i, 0)
  `DF_VIN(y, y_i, 0)
  `DF_VIN(d, d_i, 0)
  `DF_VIN(pa, pa_i, 0)
  `DF_VIN(b_side, b_side_i, 0)
  `DF_IN(b_along, b_along_i, 0)
  `DF_IN(b_kappa, b_kappa_i, 0)
  `DF_IN(b_radius, b_radius_i, 0)
  `DF_IN(b_half, b_half_i, 0)
  `DF_VIN(b_reach, b_reach_i, 0)
  `DF_VIN(q, q_i, 0)
  `DF_VIN(old_w, w_i, 0)
  `DF_IN(old_off, off_i, 0)
  `DF_VIN(old_from, from_i, 0)
  `DF_VIN(old_move, move_i, 0)
  `DF_CONST(zero, 0)
  `DF_VCONST(nowhere, 0, 0, 0)
  `DF_CONST(one, `DF_POWER_OF_TWO(0))
  `DF_CONST(most, `DF_POWER_OF_TWO(-TOUCHING))
  `DF_CONST(narrow, `DF_POWER_OF_TWO(TOUCHING))
  `DF_CONST(wide, `DF_POWER_OF_TWO(WIDE))
  `DF_CONST(part, `DF_POWER_OF_TWO(-6))
  `DF_CONST(two_u, `DF_POWER_OF_TWO(-MAN))
  `DF_CONST(four_u, `DF_POWER_OF_TWO(1 - MAN))
  `DF_CHOOSE(near, first, narrow, wide)
  `DF_FILL(first_all, first)
  `DF_FILL(unshifted_all, unshifted)
  `DF_FILL(features_all, on_features)
  `DF_FILL(lines_all, with_lines)
  `DF_FILL(rims_all, with_rims)

  // ---- Clearly apart: the solids are not moved. Else: features, and B moved by -s n ----
  `DF_ABS(plus_size, tried_g)
  `DF_ABS(minus_size, minus_g)
  `DF_ADD(sum, plus_size, minus_size)
  `DF_MUL(least, sum, part)
  `DF_LT(apart_enough, least, g)
  `DF_AND(clear, apart_enough, unshifted_all)
  `DF_NOT(shifted, clear)
  `DF_AND(features, shifted, features_all)
  `DF_AND(lines, features, lines_all)
  `DF_AND(rims, features, rims_all)
  `DF_VSCALE(shift, n, g)
  `DF_VSUB(b_moved, d, shift)
  `DF_VSELECT(b_centre, clear, d, b_moved)

  // ---- Contact of n with a cylinder: a line of its side, all of a cap, or the cap's rim ----
  `define TOUCHED(C, KAPPA, RADIUS) `DF_ABS(C``_tilt, C``_along) `DF_LE(C``_level, C``_tilt, near) \
    `DF_AND(C``_alongside, C``_level, lines) \
    `DF_EQ(C``_centred, KAPPA, zero) `DF_MUL(C``_width, KAPPA, near) `DF_LE(C``_inside, RADIUS, C``_width) \
      `DF_OR(C``_flat, C``_centred, C``_inside) \
    `DF_OR(C``_whole, C``_level, C``_flat) `DF_NOT(C``_round, C``_whole) `DF_AND(C``_rim, C``_round, rims)
  `TOUCHED(b, b_kappa, b_radius)
  `DF_NEG(b_facing, b_along)
  `DF_MOVE_SIGN(b_end, b_facing, b_half)
  `DF_VFLIP(b_cap, b_facing, b_reach)
  `DF_VADD(b_middle, b_centre, b_cap)
  `DF_VNEG(b_line, b_side)
  `DF_AND(b_flat_first, b_flat, first_all)

  // ---- To B from pa or q; to A from B's support point or from there ----
  localparam int T_a_cap = (BODY == `BODY_CYLINDER) ? `DF_LAT_DOT : `DF_CONSTANT;
  localparam int T_cap_a = (BODY == `BODY_CYLINDER) ? `DF_MAX2(T_b_rim, LAT.mul + LAT.cmp) : `DF_CONSTANT;
  localparam int T_cap_b = (BODY == `BODY_CYLINDER) ? `DF_MAX3(T_rims, T_b_flat_first, `DF_LAT_DOT + LAT.cmp) :
      T_b_flat_first;
  `DF_SCALAR cap_a, cap_b;
  `DF_VECTOR a_cap;
  `DF_VSELECT(pa_or_cap, cap_a, a_cap, pa)
  `DF_VSELECT(w_or_q, clear, old_w, q)
  `DF_VCHOOSE(q_now, fresh, w_or_q, q)
  `DF_VCHOOSE(from, touch, pa_or_cap, q_now)
  `DF_PROJECT_CYLINDER(on_b, from, b_centre, b_i, b_half_i, b_radius_i, b_line, b_alongside, b_end, b_rim)
  `DF_VSUB(y_moved, y, shift)
  `DF_VADD(b_support, pa, y_moved)
  `DF_VSELECT(of_b, cap_b, b_middle, b_support)
  `DF_VCHOOSE(to_a, touch, of_b, on_b)
  localparam int T_on_a = T_to_a + `LATENCY_PROJECT;
  `DF_VECTOR on_a;
  if (BODY == `BODY_CYLINDER) begin : g_cylinder
    logic unused;
    assign unused = &{1'b0, axis_i[2:1], half_i[2:1], edge_i, face_i};
    `DF_VIN(a, axis_i[0], 0)
    `DF_VIN(a_line, a_side_i, 0)
    `DF_VIN(a_reach, a_reach_i, 0)
    `DF_IN(a_half, half_i[0], 0)
    `DF_IN(a_kappa, a_kappa_i, 0)
    `DF_IN(a_radius, radius_i, 0)
    `DF_DOT(a_along, a, n)
    `TOUCHED(a, a_kappa, a_radius)
    `DF_MOVE_SIGN(a_end, a_along, a_half)
    `DF_VFLIP(a_face, a_along, a_reach)
    `DF_NOT(b_more, b_rim)
    `DF_NOT(a_more, a_rim)
    `DF_AND(a_flat_first, a_flat, first_all)
    `DF_AND(a_flat_to_b, a_flat_first, b_more)
    `DF_AND(b_flat_to_a, b_flat_first, a_more)
    assign a_cap = a_face;
    assign cap_a = a_flat_to_b;
    assign cap_b = b_flat_to_a;
    `DF_PROJECT_CYLINDER(point, to_a, nowhere, a, half_i[0], radius_i, a_line, a_alongside, a_end, a_rim)
    assign on_a = point;
  end else begin : g_polyhedron
    logic unused;
    assign unused = &{1'b0, radius_i, a_side_i, a_kappa_i, a_reach_i};
    assign a_cap = '0;
    assign cap_a = '0;
    assign cap_b = b_flat_first;
    project_polyhedron #(`DF_SAME, .BODY(BODY), .T_X(T_to_a), .T_FEATURE(T_features)) project (
        .clk_i, .en_i(`DF_EN), .x_i(to_a), .axis_i, .half_i, .edge_i, .face_i, .feature_i(features), .near_i(near),
        .n_i, .r_o(on_a));
  end
  `undef TOUCHED

  // ---- Distance of each point from its origin: the best point, and with it n if the solids are clearly apart ----
  `DF_VSUB(step, on_b, from)
  `DF_DOT(away, step, step)
  `DF_VSUB(apart, to_a, on_a)
  `DF_VSCALE(tried_shift, tried_n, g)
  `DF_VSELECT(wanted, clear, tried_shift, nowhere)
  `DF_VSUB(missing, apart, wanted)
  `DF_DOT(miss, missing, missing)
  `DF_LT(a_is_nearer, miss, away)
  `DF_NOT(no_cap_a, cap_a)
  `DF_AND(a_nearer, a_is_nearer, no_cap_a)
  `DF_OR(b_first, a_nearer, cap_b)
  `DF_VSELECT(cap_or_from, cap_a, on_b, from)
  `DF_VSELECT(begun, b_first, on_a, cap_or_from)
  `DF_SELECT(begun_off, b_first, miss, away)
  `DF_VCHOOSE(found, touch, begun, on_a)
  `DF_CHOOSE(found_off, touch, begun_off, miss)
  `DF_MUL(noise, sum, four_u)
  `DF_MUL(noise2, noise, noise)
  `DF_MAX(off_or_noise, old_off, noise2)
  `DF_SELECT(bound, clear, off_or_noise, old_off)
  `DF_LT(nearer, found_off, bound)
  `DF_SUB(fall, g, tried_g)
  `DF_MUL(rounding, sum, two_u)
  `DF_LE(no_lower, fall, rounding)
  `DF_OR(as_good, no_lower, shifted)
  `DF_AND(better, nearer, as_good)
  `DF_FILL(start_all, start)
  `DF_OR(take, better, start_all)
  `DF_AND(turn, take, clear)
  `DF_MAX(higher, g, tried_g)
  `DF_VSELECT(best, take, found, old_w)
  `DF_SELECT(best_off, take, found_off, old_off)
  `DF_VSELECT(best_n, turn, tried_n, n)
  `DF_SELECT(best_g, turn, higher, g)
  `DF_VSELECT(next, clear, apart, best_n)

  // ---- Next start: the crossing, or if clearly apart, from the last two steps ----
  `DF_VSUB(move, on_a, from)
  `DF_VSUB(bend, move, old_move)
  `DF_VSELECT(against, clear, bend, step)
  `DF_VSELECT(bend_or_move, clear, bend, move)
  `DF_DOT(bent, move, bend)
  `DF_DOT(below, against, bend_or_move)
  `DF_SELECT(above, clear, bent, away)
  `DF_DIV(gain, above, below)
  `DF_ABS(gain_size, gain)
  `DF_LT(bounded, gain_size, most)
  `DF_LT(more, one, gain)
  `DF_FILL(trial_all, trial)
  `DF_FILL(onward_all, onward)
  `DF_AND(crossing, more, onward_all)
  `DF_SELECT(wished, clear, trial_all, crossing)
  `DF_AND(further, bounded, wished)
  `DF_VSUB(backward, old_from, from)
  `DF_VSUB(aside, backward, bend)
  `DF_VSELECT(along, clear, aside, move)
  `DF_VSCALE(stride, along, gain)
  `DF_VSELECT(base, clear, on_a, from)
  `DF_VADD(beyond, base, stride)
  `DF_VSELECT(projected, further, beyond, on_a)
  `DF_VCHOOSE(point, touch, begun, projected)
  localparam int T_END = `LATENCY_CYLINDER_WITNESS;
  `DF_VAT(point_end, point, T_END)
  `DF_VAT(best_end, best, T_END)
  `DF_AT(best_off_end, best_off, T_END)
  `DF_VAT(best_n_end, best_n, T_END)
  `DF_AT(best_g_end, best_g, T_END)
  `DF_VAT(from_end, from, T_END)
  `DF_VAT(move_end, move, T_END)
  `DF_VAT(next_end, next, T_END)
  assign {q_o, w_o, off_o} = {point_end, best_end, best_off_end};
  assign {n_o, g_o} = {best_n_end, best_g_end};
  assign {from_o, move_o, next_o} = {from_end, move_end, next_end};
  `undef DF_EN
  `define DF_EN 1'b1
endmodule
