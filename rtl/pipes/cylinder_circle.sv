// SPDX-License-Identifier: Apache-2.0
// One step on a circle of normals perpendicular to e (reference/pipes/cylinder/search.hpp).
// It gives the new bracket lo, hi and the next normal. That is Newton's normal if it stays in the bracket, else the tie
// of both ends' support points. The pass has evaluated (n, y, g) and the opposite normal (-n, minus_y, minus_g).
//   Beside (cylinders): last and best make the bracket, in either order.
//   Sample (polyhedra): the previous and this sample, or their opposites, make the bracket.
//   Condition: both slopes point inward, and no earlier bracket has a better end.
//   Refine: n replaces the end whose slope has the same sign.
// Operators (cylinder): 40 add, 62 mul, 1 div, 5 compare, 3 min/max.
// Operators (box, triangle): 34 add, 51 mul, 1 div, 10 compare, 5 min/max.
// Latency: LATENCY_STEP cycles, the slopes LATENCY_SLOPE; 0 with ARITH = "host".
// Throughput: one step per lane per cycle.
// Stall: none.
`include "cylinder.svh"
module cylinder_circle #(
    `DF_PARAMETERS,
    parameter int BODY = `BODY_CYLINDER
) (
    input logic clk_i,
    input logic [`PASS_W-1:0] pass_i,
    input logic refine_next_i,  // with ARITH = "host": next_o is the normal of the next pass
    input logic [2:0][LANES-1:0][CW-1:0] e_i,
    input logic [LANES-1:0][CW-1:0] g_i,
    input logic [2:0][LANES-1:0][CW-1:0] n_i,
    input logic [2:0][LANES-1:0][CW-1:0] y_i,
    input logic [LANES-1:0][CW-1:0] a_kappa_i,
    input logic [2:0][LANES-1:0][CW-1:0] a_v_i,
    input logic [LANES-1:0][CW-1:0] b_kappa_i,
    input logic [2:0][LANES-1:0][CW-1:0] b_v_i,
    input logic [LANES-1:0][CW-1:0] minus_g_i,
    input logic [2:0][LANES-1:0][CW-1:0] minus_y_i,
    input logic [2:0][LANES-1:0][CW-1:0] best_n_i,  // cylinders: from the better orientation
    input logic [2:0][LANES-1:0][CW-1:0] best_y_i,
    input logic [2:0][LANES-1:0][CW-1:0] lo_n_i,  // the pair's state, with the following inputs
    input logic [2:0][LANES-1:0][CW-1:0] lo_y_i,
    input logic [2:0][LANES-1:0][CW-1:0] hi_n_i,
    input logic [2:0][LANES-1:0][CW-1:0] hi_y_i,
    input logic [LANES-1:0][CW-1:0] score_i,
    input logic [LANES-1:0][CW-1:0] last_g_i,
    input logic [2:0][LANES-1:0][CW-1:0] last_n_i,
    input logic [2:0][LANES-1:0][CW-1:0] last_y_i,
    input logic [LANES-1:0][CW-1:0] last_slope_i,
    input logic [LANES-1:0][CW-1:0] back_g_i,
    input logic [2:0][LANES-1:0][CW-1:0] back_y_i,
    input logic [LANES-1:0][CW-1:0] back_slope_i,
    output logic [LANES-1:0][CW-1:0] slope_o,  // slope of n
    output logic [LANES-1:0][CW-1:0] minus_slope_o,  // slope of -n
    output logic [2:0][LANES-1:0][CW-1:0] lo_n_o,
    output logic [2:0][LANES-1:0][CW-1:0] lo_y_o,
    output logic [2:0][LANES-1:0][CW-1:0] hi_n_o,
    output logic [2:0][LANES-1:0][CW-1:0] hi_y_o,
    output logic [LANES-1:0][CW-1:0] score_o,
    output logic [2:0][LANES-1:0][CW-1:0] next_o
);
  /*verilator inline_module*/
  logic en;
  assign en = `PASS_PHASE(pass_i) == `PHASE_BESIDE || `PASS_PHASE(pass_i) == `PHASE_SAMPLE || `PASS_PHASE(pass_i) ==
      `PHASE_REFINE;
  `undef DF_EN
  `define DF_EN en
  localparam logic [CW-1:0] MINUS_INFINITY = ((CW'(2) << EXP) - 1) << MAN;
  // sqrt(16 times the smallest normal number), rounded down to a power of two. The square of a smaller weight would
  // underflow.
  localparam int LEAST_WEIGHT = (EXP > 3) ? -(((1 << (EXP - 1)) - 5) / 2) : 0;
  `DF_CONTROL(refine, `PASS_PHASE(pass_i) == `PHASE_REFINE, 0)
  `DF_CONTROL(first, `PASS_INDEX(pass_i) == 0, 0)
  `DF_VIN(e, e_i, 0)
  `DF_IN(g, g_i, 0)
  `DF_VIN(n, n_i, 0)
  `DF_IN(b_kappa, b_kappa_i, 0)
  `DF_VIN(b_v, b_v_i, 0)
  `DF_CONST(zero, 0)

  `DF_VIN(y, y_i, 0)
  `DF_VIN(minus_y, minus_y_i, 0)
  `DF_VIN(last_n, last_n_i, 0)
  `DF_VIN(last_y, last_y_i, 0)
  `DF_VIN(kept_lo_n, lo_n_i, 0)
  `DF_VIN(kept_lo_y, lo_y_i, 0)
  `DF_VIN(kept_hi_n, hi_n_i, 0)
  `DF_VIN(kept_hi_y, hi_y_i, 0)
  `DF_CROSS(t, e, n)
  `DF_DOT(slope, y, t)
  `DF_LT(up, zero, slope)
  assign slope_o = slope;

  // ---- The ends of the bracket ----
  localparam int T_lo_n = `LATENCY_ENDS, T_lo_y = T_lo_n, T_hi_n = T_lo_n, T_hi_y = T_lo_n;
  `DF_VECTOR lo_n, lo_y, hi_n, hi_y;
  `DF_VSELECT(refined_lo_n, up, n, kept_lo_n)
  `DF_VSELECT(refined_lo_y, up, y, kept_lo_y)
  `DF_VSELECT(refined_hi_n, up, kept_hi_n, n)
  `DF_VSELECT(refined_hi_y, up, kept_hi_y, y)
  if (BODY == `BODY_CYLINDER) begin : g_beside
    logic unused;
    assign unused = &{1'b0, first, `PASS_TRACK(pass_i), score_i, last_g_i, last_slope_i, back_g_i, back_y_i,
        back_slope_i, minus_g_i, minus_y};
    `DF_VIN(best_n, best_n_i, 0)
    `DF_VIN(best_y, best_y_i, 0)
    `DF_CROSS(last_t, e, last_n)
    `DF_DOT(turn, last_t, best_n)
    `DF_LT(ahead, zero, turn)
    `DF_VSELECT(beside_lo_n, ahead, last_n, best_n)
    `DF_VSELECT(beside_lo_y, ahead, last_y, best_y)
    `DF_VSELECT(beside_hi_n, ahead, best_n, last_n)
    `DF_VSELECT(beside_hi_y, ahead, best_y, last_y)
    `DF_VCHOOSE(new_lo_n, refine, refined_lo_n, beside_lo_n)
    `DF_VCHOOSE(new_lo_y, refine, refined_lo_y, beside_lo_y)
    `DF_VCHOOSE(new_hi_n, refine, refined_hi_n, beside_hi_n)
    `DF_VCHOOSE(new_hi_y, refine, refined_hi_y, beside_hi_y)
    assign {lo_n, lo_y, hi_n, hi_y} = {new_lo_n, new_lo_y, new_hi_n, new_hi_y};
    assign {score_o, minus_slope_o} = '0;
  end else begin : g_sample
    logic unused;
    assign unused = &{1'b0, `PASS_TRACK(pass_i), best_n_i, best_y_i};
    `DF_IN(minus_g, minus_g_i, 0)
    `DF_IN(last_g, last_g_i, 0)
    `DF_IN(last_slope, last_slope_i, 0)
    `DF_IN(back_g, back_g_i, 0)
    `DF_VIN(back_y, back_y_i, 0)
    `DF_IN(back_slope, back_slope_i, 0)
    `DF_IN(score, score_i, 0)
    `DF_VNEG(back_n, last_n)
    `DF_VNEG(minus_n, n)
    `DF_DOT(minus_along, minus_y, t)
    `DF_NEG(minus_slope, minus_along)
    assign minus_slope_o = minus_slope;
    // The arc from the previous sample to this one, and the opposite arc.
    `DF_MAX(arc_score, last_g, g)
    `DF_LT(arc_up, zero, last_slope)
    `DF_LT(arc_down, slope, zero)
    `DF_LT(arc_better, score, arc_score)
    `DF_AND(arc_inward, arc_up, arc_down)
    `DF_AND(arc, arc_inward, arc_better)
    `DF_SELECT(score_arc, arc, arc_score, score)
    `DF_MAX(opposite_score, back_g, minus_g)
    `DF_LT(opposite_up, zero, back_slope)
    `DF_LT(opposite_down, minus_slope, zero)
    `DF_LT(opposite_better, score_arc, opposite_score)
    `DF_AND(opposite_inward, opposite_up, opposite_down)
    `DF_AND(opposite, opposite_inward, opposite_better)
    `DF_SELECT(score_both, opposite, opposite_score, score_arc)
    `DF_CONST(least, MINUS_INFINITY)
    `DF_CHOOSE(score_new, first, least, score_both)
    `DF_AT(score_end, score_new, `LATENCY_STEP)
    assign score_o = score_end;
    `DF_VSELECT3(sampled_lo_n, opposite, arc, back_n, last_n, kept_lo_n)
    `DF_VSELECT3(sampled_lo_y, opposite, arc, back_y, last_y, kept_lo_y)
    `DF_VSELECT3(sampled_hi_n, opposite, arc, minus_n, n, kept_hi_n)
    `DF_VSELECT3(sampled_hi_y, opposite, arc, minus_y, y, kept_hi_y)
    `DF_VCONST(none, 0, 0, 0)
    `DF_VCHOOSE(any_lo_n, first, none, sampled_lo_n)
    `DF_VCHOOSE(any_lo_y, first, none, sampled_lo_y)
    `DF_VCHOOSE(any_hi_n, first, none, sampled_hi_n)
    `DF_VCHOOSE(any_hi_y, first, none, sampled_hi_y)
    `DF_VCHOOSE(new_lo_n, refine, refined_lo_n, any_lo_n)
    `DF_VCHOOSE(new_lo_y, refine, refined_lo_y, any_lo_y)
    `DF_VCHOOSE(new_hi_n, refine, refined_hi_n, any_hi_n)
    `DF_VCHOOSE(new_hi_y, refine, refined_hi_y, any_hi_y)
    `DF_VAT(late_lo_n, new_lo_n, T_lo_n)
    `DF_VAT(late_lo_y, new_lo_y, T_lo_y)
    `DF_VAT(late_hi_n, new_hi_n, T_hi_n)
    `DF_VAT(late_hi_y, new_hi_y, T_hi_y)
    assign {lo_n, lo_y, hi_n, hi_y} = {late_lo_n, late_lo_y, late_hi_n, late_hi_y};
  end

  `undef DF_EN
  `define DF_EN refine_next_i
  // ---- Newton. In a refinement, e x n and its slope belong to n ----
  `DF_DOT(vb, b_v, t)
  `DF_MUL(vbvb, vb, vb)
  `DF_MUL(curve_b, b_kappa, vbvb)
  localparam int T_curve_ab = T_curve_b + LAT.add;
  `DF_SCALAR curve_ab;
  if (BODY == `BODY_CYLINDER) begin : g_curve
    `DF_IN(a_kappa, a_kappa_i, 0)
    `DF_VIN(a_v, a_v_i, 0)
    `DF_DOT(va, a_v, t)
    `DF_MUL(vava, va, va)
    `DF_MUL(curve_a, a_kappa, vava)
    `DF_ADD(sum, curve_a, curve_b)
    assign curve_ab = sum;
  end else begin : g_flat  // adding 0 for a body without curvature changes nothing
    logic unused;
    assign unused = &{1'b0, a_kappa_i, a_v_i};
    `DF_AT(late, curve_b, T_curve_ab)
    assign curve_ab = late;
  end
  `DF_ADD(curve, curve_ab, g)
  `DF_DIV(step, slope, curve)
  `DF_VSCALE(move, t, step)
  `DF_VADD(newton, n, move)
  `DF_LT(convex, zero, curve)
  `DF_CROSS(lo_t, e, lo_n)
  `DF_CROSS(hi_t, e, hi_n)
  `DF_DOT(past_lo, lo_t, newton)
  `DF_DOT(past_hi, hi_t, newton)
  `DF_LT(beyond_lo, zero, past_lo)
  `DF_LT(before_hi, past_hi, zero)
  `DF_AND(between, beyond_lo, before_hi)
  `DF_AND(holds, convex, between)

  // ---- The tie. If an end is already a tie, or both support points are one, each side keeps 1/16 of the weight ----
  `DF_CONST(sixteenth, `DF_POWER_OF_TWO(-4))
  `DF_CONST(least_weight, `DF_POWER_OF_TWO(LEAST_WEIGHT))
  `DF_VSUB(apart, lo_y, hi_y)
  `DF_DOT(along_hi, apart, hi_n)
  `DF_DOT(along_lo, apart, lo_n)
  `DF_ABS(weight_lo, along_hi)
  `DF_ABS(weight_hi, along_lo)
  `DF_ADD(weights, weight_lo, weight_hi)
  `DF_MUL(share, weights, sixteenth)
  `DF_MAX(least_share, share, least_weight)
  `DF_MAX(by_lo, weight_lo, least_share)
  `DF_MAX(by_hi, weight_hi, least_share)
  `DF_VSCALE(part_lo, lo_n, by_lo)
  `DF_VSCALE(part_hi, hi_n, by_hi)
  `DF_VADD(tie, part_lo, part_hi)
  `DF_VSELECT(refined, holds, newton, tie)
  `DF_VCHOOSE(next, refine, refined, tie)

  `DF_VAT(lo_n_end, lo_n, `LATENCY_STEP)
  `DF_VAT(lo_y_end, lo_y, `LATENCY_STEP)
  `DF_VAT(hi_n_end, hi_n, `LATENCY_STEP)
  `DF_VAT(hi_y_end, hi_y, `LATENCY_STEP)
  `DF_VAT(next_end, next, `LATENCY_STEP)
  assign {lo_n_o, lo_y_o, hi_n_o, hi_y_o, next_o} = {lo_n_end, lo_y_end, hi_n_end, hi_y_end, next_end};
  `undef DF_EN
  `define DF_EN 1'b1
endmodule
