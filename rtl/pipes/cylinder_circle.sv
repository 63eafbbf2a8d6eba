// A step on a circle of normals perpendicular to e (reference/cylinder/search.hpp): the bracket lo, hi that the pass leaves behind, and
// the next normal, Newton's where that stays in the bracket, else the tie of the support points of both ends. The normal the pass has
// evaluated is (n, y, g); best is the better of its orientations, back the y of the other.
//   beside   (cylinders) last and best make the bracket, in whichever order
//   sample   (polyhedra) last and this one make it if both slopes point inward and no bracket so far has a better end
//   refine   this one replaces the end whose slope has its sign
// 40 add, 58 mul, 1 div, 6 compare (cylinder); 39 add, 56 mul, 1 div, 9 compare, 1 min/max (box, triangle).
// Latency: LATENCY_STEP clocks; 0 with ARITH = "host". Throughput: one step a lane a clock. Stall: none, runs free.
`include "cylinder.svh"
module cylinder_circle #(
    parameter int BODY = `BODY_CYLINDER,
    parameter int EXP = 8,
    parameter int MAN = 23,
    parameter int LANES = 1,
    parameter int LAT_ADD = 1,
    parameter int LAT_MUL = 1,
    parameter int LAT_DIV = 1,
    parameter int LAT_SQRT = 1,
    parameter int LAT_CMP = 1,
    parameter ARITH = "rtl",
    localparam int CW = (1 + EXP + MAN <= 32) ? 32 : 64
) (
    input logic clk_i,
    input logic [`PASS_W-1:0] pass_i,
    input logic [2:0][LANES-1:0][CW-1:0] e_i,
    input logic [LANES-1:0][CW-1:0] g_i,
    input logic [2:0][LANES-1:0][CW-1:0] n_i,
    input logic [2:0][LANES-1:0][CW-1:0] y_i,
    input logic [LANES-1:0][CW-1:0] a_kappa_i,
    input logic [2:0][LANES-1:0][CW-1:0] a_v_i,
    input logic [LANES-1:0][CW-1:0] b_kappa_i,
    input logic [2:0][LANES-1:0][CW-1:0] b_v_i,
    input logic [LANES-1:0][CW-1:0] best_g_i,
    input logic [2:0][LANES-1:0][CW-1:0] best_n_i,
    input logic [2:0][LANES-1:0][CW-1:0] best_y_i,
    input logic [2:0][LANES-1:0][CW-1:0] back_y_i,
    input logic [2:0][LANES-1:0][CW-1:0] lo_n_i,  // state
    input logic [2:0][LANES-1:0][CW-1:0] lo_y_i,
    input logic [2:0][LANES-1:0][CW-1:0] hi_n_i,
    input logic [2:0][LANES-1:0][CW-1:0] hi_y_i,
    input logic [LANES-1:0][CW-1:0] score_i,
    input logic [LANES-1:0][CW-1:0] last_g_i,
    input logic [2:0][LANES-1:0][CW-1:0] last_n_i,
    input logic [2:0][LANES-1:0][CW-1:0] last_y_i,
    output logic [2:0][LANES-1:0][CW-1:0] lo_n_o,
    output logic [2:0][LANES-1:0][CW-1:0] lo_y_o,
    output logic [2:0][LANES-1:0][CW-1:0] hi_n_o,
    output logic [2:0][LANES-1:0][CW-1:0] hi_y_o,
    output logic [LANES-1:0][CW-1:0] score_o,
    output logic [2:0][LANES-1:0][CW-1:0] next_o
);
  /*verilator inline_module*/
  localparam logic [CW-1:0] MINUS_INFINITY = ((CW'(2) << EXP) - 1) << MAN;
  `DF_CONTROL(refine, `PASS_PHASE(pass_i) == `PHASE_REFINE, 0)
  `DF_CONTROL(first, `PASS_INDEX(pass_i) == 0, 0)
  `DF_VIN(e, e_i, 0)
  `DF_IN(g, g_i, 0)
  `DF_VIN(n, n_i, 0)
  `DF_IN(b_kappa, b_kappa_i, 0)
  `DF_VIN(b_v, b_v_i, 0)
  `DF_CONST(zero, 0)

  // ---- The new end: n, or what beside and sample make of it; which ends the pass replaces. ----
  localparam int T_end_n = (BODY == `BODY_CYLINDER) ? 0 : `DF_LAT_DOT + LAT_CMP, T_end_y = T_end_n;
  localparam int T_take_lo = T_end_n + `DF_LAT_CROSS + `DF_LAT_DOT + LAT_CMP, T_take_hi = T_take_lo;
  `DF_VECTOR end_n, end_y;
  `DF_SCALAR take_lo, take_hi;
  `DF_CROSS(t, e, end_n)
  `DF_DOT(slope, end_y, t)
  `DF_LT(up, zero, slope)
  `DF_NOT(down, up)
  `DF_VIN(last_n, last_n_i, 0)
  `DF_CROSS(last_t, e, last_n)
  // With the mask set an end becomes take_x, else it stays or becomes keep_x.
  localparam int T_keep_hi_n = 0, T_keep_hi_y = 0, T_keep_lo_n = 0, T_keep_lo_y = 0;
  `DF_VECTOR keep_lo_n, keep_lo_y, keep_hi_n, keep_hi_y;
  `DF_VIN(take_lo_n, refine ? n_i : last_n_i, 0)
  `DF_VIN(take_lo_y, refine ? y_i : last_y_i, 0)
  if (BODY == `BODY_CYLINDER) begin : g_beside
    logic unused;
    assign unused = &{1'b0, first, `PASS_TRACK(pass_i), score_i, last_g_i, best_g_i, back_y_i};
    `DF_VIN(best_n, best_n_i, 0)
    `DF_DOT(turn, last_t, best_n)
    `DF_LT(ahead, zero, turn)
    `DF_CHOOSE(lo, refine, up, ahead)
    `DF_CHOOSE(hi, refine, down, ahead)
    assign {take_lo, take_hi} = {lo, hi};
    assign end_n = refine ? n_i : best_n_i;
    assign end_y = refine ? y_i : best_y_i;
    assign keep_lo_n = refine ? lo_n_i : best_n_i;
    assign keep_lo_y = refine ? lo_y_i : best_y_i;
    assign keep_hi_n = refine ? hi_n_i : last_n_i;
    assign keep_hi_y = refine ? hi_y_i : last_y_i;
    assign score_o = '0;
  end else begin : g_sample
    logic unused;
    assign unused = &{1'b0, `PASS_TRACK(pass_i)};
    `DF_CONTROL(start, first && !refine, 0)
    `DF_VIN(y, y_i, 0)
    `DF_IN(best_g, best_g_i, 0)
    `DF_VIN(best_n, best_n_i, 0)
    `DF_VIN(best_y, best_y_i, 0)
    `DF_VIN(back_y, back_y_i, 0)
    `DF_VIN(last_y, last_y_i, 0)
    `DF_IN(last_g, last_g_i, 0)
    `DF_IN(score, score_i, 0)
    `DF_VNEG(back_n, best_n)
    `DF_DOT(fold, best_n, last_n)
    `DF_LT(turned, fold, zero)
    `DF_VSELECT(near_n, turned, back_n, best_n)
    `DF_VSELECT(near_y, turned, back_y, best_y)
    `DF_VCHOOSE(any_n, refine, n, near_n)
    `DF_VCHOOSE(any_y, refine, y, near_y)
    assign {end_n, end_y} = {any_n, any_y};
    `DF_MAX(score_now, last_g, best_g)
    `DF_LT(better, score, score_now)
    `DF_DOT(last_slope, last_y, last_t)
    `DF_LT(last_up, zero, last_slope)
    `DF_LT(end_down, slope, zero)
    `DF_AND(inward, last_up, end_down)
    `DF_AND(take_any, inward, better)
    `DF_CHOOSE(take, start, zero, take_any)
    `DF_CHOOSE(lo, refine, up, take)
    `DF_CHOOSE(hi, refine, down, take)
    assign {take_lo, take_hi} = {lo, hi};
    assign keep_lo_n = start ? '0 : lo_n_i;
    assign keep_lo_y = start ? '0 : lo_y_i;
    assign keep_hi_n = start ? '0 : hi_n_i;
    assign keep_hi_y = start ? '0 : hi_y_i;
    `DF_CONST(least, MINUS_INFINITY)
    `DF_SELECT(score_kept, take, score_now, score)
    `DF_CHOOSE(score_new, start, least, score_kept)
    `DF_AT(score_end, score_new, `LATENCY_STEP)
    assign score_o = score_end;
  end
  `DF_VSELECT(lo_n, take_lo, take_lo_n, keep_lo_n)
  `DF_VSELECT(lo_y, take_lo, take_lo_y, keep_lo_y)
  `DF_VSELECT(hi_n, take_hi, end_n, keep_hi_n)
  `DF_VSELECT(hi_y, take_hi, end_y, keep_hi_y)

  // ---- Newton; e x n and its slope are those of n in a refinement ----
  `DF_DOT(vb, b_v, t)
  `DF_MUL(vbvb, vb, vb)
  `DF_MUL(curve_b, b_kappa, vbvb)
  localparam int T_curve_ab = T_curve_b + LAT_ADD;
  `DF_SCALAR curve_ab;
  if (BODY == `BODY_CYLINDER) begin : g_curve
    `DF_IN(a_kappa, a_kappa_i, 0)
    `DF_VIN(a_v, a_v_i, 0)
    `DF_DOT(va, a_v, t)
    `DF_MUL(vava, va, va)
    `DF_MUL(curve_a, a_kappa, vava)
    `DF_ADD(sum, curve_a, curve_b)
    assign curve_ab = sum;
  end else begin : g_flat  // + 0 of a body without curvature changes nothing
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

  // ---- The tie ----
  `DF_VSUB(apart, lo_y, hi_y)
  `DF_CROSS(knot, e, apart)
  `DF_VADD(middle, lo_n, hi_n)
  `DF_DOT(side, knot, middle)
  `DF_LT(reverse, side, zero)
  `DF_VNEG(minus_knot, knot)
  `DF_VSELECT(tie, reverse, minus_knot, knot)
  `DF_VSELECT(refined, holds, newton, tie)
  `DF_VCHOOSE(next, refine, refined, tie)

  `DF_VAT(lo_n_end, lo_n, `LATENCY_STEP)
  `DF_VAT(lo_y_end, lo_y, `LATENCY_STEP)
  `DF_VAT(hi_n_end, hi_n, `LATENCY_STEP)
  `DF_VAT(hi_y_end, hi_y, `LATENCY_STEP)
  `DF_VAT(next_end, next, `LATENCY_STEP)
  assign {lo_n_o, lo_y_o, hi_n_o, hi_y_o, next_o} = {lo_n_end, lo_y_end, hi_n_end, hi_y_end, next_end};
endmodule
