// SPDX-License-Identifier: Apache-2.0
// One step of a free track between two cylinders (reference/pipes/cylinder/search.hpp), from the evaluated normal
// (n, y, g). Pole, beside a cap axis: along the steepest ascent t = y - g n, by the Newton step of the one-sided
// derivative. There t comes from the other cylinder's nearer end, or from between parallel axes.
// Otherwise: a damped Newton step on the sphere, (kappa_a va va^T + kappa_b vb vb^T + g) step = y - g n.
// A step that does not raise g is undone, and a quarter of it tried. The base is lo_n, the step from it lo_y, and its g
// is score.
// Operators: 63 add, 91 mul, 2 div, 3 sqrt, 6 compare, 7 min/max.
// Latency: LATENCY_STEP cycles; 0 with ARITH = "host".
// Throughput: one step per lane per cycle.
// Stall: none, runs free.
`include "cylinder.svh"
module cylinder_free #(
    `DF_PARAMETERS
) (
    input logic clk_i,
    input logic [`PASS_W-1:0] pass_i,
    input logic [2:0][LANES-1:0][CW-1:0] d_i,  // centre of B
    input logic [2:0][LANES-1:0][CW-1:0] a_i,  // A and B: axes, half heights times axes, radii
    input logic [2:0][LANES-1:0][CW-1:0] b_i,
    input logic [2:0][LANES-1:0][CW-1:0] a_reach_i,
    input logic [2:0][LANES-1:0][CW-1:0] b_reach_i,
    input logic [LANES-1:0][CW-1:0] a_radius_i,
    input logic [LANES-1:0][CW-1:0] b_radius_i,
    input logic [LANES-1:0][CW-1:0] g_i,
    input logic [2:0][LANES-1:0][CW-1:0] n_i,
    input logic [2:0][LANES-1:0][CW-1:0] y_i,
    input logic [LANES-1:0][CW-1:0] a_kappa_i,
    input logic [2:0][LANES-1:0][CW-1:0] a_v_i,
    input logic [LANES-1:0][CW-1:0] b_kappa_i,
    input logic [2:0][LANES-1:0][CW-1:0] b_v_i,
    input logic [2:0][LANES-1:0][CW-1:0] lo_n_i,  // the pair's state, with the following inputs
    input logic [2:0][LANES-1:0][CW-1:0] lo_y_i,
    input logic [LANES-1:0][CW-1:0] score_i,
    output logic [2:0][LANES-1:0][CW-1:0] lo_n_o,
    output logic [2:0][LANES-1:0][CW-1:0] lo_y_o,
    output logic [LANES-1:0][CW-1:0] score_o,
    output logic [2:0][LANES-1:0][CW-1:0] next_o
);
  /*verilator inline_module*/
  logic on_pole, on_newton;
  assign on_pole = `PASS_PHASE(pass_i) == `PHASE_POLE;
  assign on_newton = `PASS_PHASE(pass_i) == `PHASE_START || `PASS_PHASE(pass_i) == `PHASE_NEWTON;
  `undef DF_EN
  `define DF_EN on_pole
  localparam int BODY = `BODY_CYLINDER;
  logic on_a, unused;
  assign unused = &{1'b0, `PASS_INDEX(pass_i)};
  assign on_a = `PASS_TRACK(pass_i) == 0;
  `DF_CONTROL(pole, `PASS_PHASE(pass_i) == `PHASE_POLE, 0)
  `DF_CONTROL(start, `PASS_PHASE(pass_i) == `PHASE_START, 0)
  `DF_IN(g, g_i, 0)
  `DF_VIN(n, n_i, 0)
  `DF_VIN(y, y_i, 0)
  `DF_IN(a_kappa, a_kappa_i, 0)
  `DF_VIN(a_v, a_v_i, 0)
  `DF_IN(b_kappa, b_kappa_i, 0)
  `DF_VIN(b_v, b_v_i, 0)
  `DF_CONST(zero, 0)
  `DF_CONST(one, `DF_POWER_OF_TWO(0))

  // ---- Beside a cap axis: axis, reach, kappa and v of the other cylinder ----
  `DF_IN(radius_own, on_a ? a_radius_i : b_radius_i, 0)
  `DF_IN(radius_other, on_a ? b_radius_i : a_radius_i, 0)
  `DF_IN(kappa, on_a ? b_kappa_i : a_kappa_i, 0)
  `DF_VIN(v, on_a ? b_v_i : a_v_i, 0)
  `DF_VIN(axis, on_a ? b_i : a_i, 0)
  `DF_VIN(reach, on_a ? b_reach_i : a_reach_i, 0)
  `DF_VIN(d, d_i, 0)
  `DF_CONST(far, `DF_POWER_OF_TWO(-3))
  `DF_CONST(near, `DF_POWER_OF_TWO(-13))
  `DF_CONST(aslant, `DF_POWER_OF_TWO(-10))
  `DF_CONST(straight, `DF_POWER_OF_TWO(-15))
  // The other cylinder's end on the side of d, and its part across n.
  `DF_DOT(tilt, axis, n)
  `DF_DOT(d_axis, d, axis)
  `DF_DOT(d_n, d, n)
  `DF_MUL(d_tilt, tilt, d_n)
  `DF_SUB(toward, d_axis, d_tilt)
  `DF_VFLIP(end_reach, toward, reach)
  `DF_VSUB(to_end, d, end_reach)
  `DF_DOT(end_along, to_end, n)
  `DF_VSCALE(end_axial, n, end_along)
  `DF_VSUB(across, to_end, end_axial)
  `DF_DOT(ahead, across, axis)
  `DF_DOT(across2, across, across)
  `DF_MUL(tilt2, tilt, tilt)
  `DF_MUL(tilted, tilt2, across2)
  `DF_MUL(ahead2, ahead, ahead)
  `DF_MUL(reached, ahead2, aslant)
  `DF_LE(crosses, tilted, reached)
  `DF_MUL(kappa_straight, kappa, straight)
  `DF_EQ(coaxial, kappa, zero)
  `DF_LE(near_axis, radius_other, kappa_straight)
  `DF_OR(parallel, coaxial, near_axis)
  `DF_OR(from_end, crosses, parallel)
  `DF_VSCALE(along_n, n, g)
  `DF_VSUB(touched, y, along_n)
  `DF_VSELECT(t, from_end, across, touched)
  `DF_DOT(tt, t, t)
  `DF_SQRT(length, tt)
  `DF_DOT(vt, v, t)
  `DF_MUL(vtvt, vt, vt)
  `DF_MUL(curve_rim, kappa, vtvt)
  `DF_SELECT(curve_v, parallel, zero, curve_rim)
  `DF_MUL(curve_g, g, tt)
  `DF_ADD(curve, curve_v, curve_g)
  `DF_ADD(radius_both, radius_own, radius_other)
  `DF_SELECT(radius, parallel, radius_both, radius_own)
  `DF_SUB(slope, length, radius)
  `DF_MUL(rise, slope, tt)
  `DF_DIV(angle, rise, curve)
  `DF_CLAMP(angle_near, angle, near, far)
  `DF_LT(convex, zero, curve)
  `DF_SELECT(pole_step, convex, angle_near, far)
  `DF_VSCALE(pole_n, n, length)
  `DF_VSCALE(pole_t, t, pole_step)
  `DF_VADD(pole_next, pole_n, pole_t)

  `undef DF_EN
  `define DF_EN on_newton
  // ---- Newton on the sphere. `more` of the identity makes the matrix' smaller eigenvalue the slope ----
  `DF_CONST(half, `DF_POWER_OF_TWO(-1))
  `DF_NEG(minus_half, half)
  `DF_EQ(swap, a_kappa, zero)
  `DF_SELECT(k1, swap, b_kappa, a_kappa)
  `DF_SELECT(k2, swap, a_kappa, b_kappa)
  `DF_VSELECT(v1, swap, b_v, a_v)
  `DF_VSELECT(v2, swap, a_v, b_v)
  `DF_CROSS(v1_t, v1, n)
  `DF_DOT(c, v2, v1)
  `DF_DOT(s, v2, v1_t)
  `DF_MUL(kc, k2, c)
  `DF_MUL(ks, k2, s)
  `DF_MUL(kcc, kc, c)
  `DF_ADD(h11, k1, kcc)
  `DF_MUL(h12, kc, s)
  `DF_MUL(h22, ks, s)
  `DF_MUL(hh, h12, h12)
  `DF_ADD(d11, h11, g)
  `DF_ADD(d22, h22, g)
  `DF_ADD(trace, d11, d22)
  `DF_MUL(mean, trace, half)
  `DF_SUB(differ, d11, d22)
  `DF_MUL(apart, differ, half)
  `DF_MUL(apart2, apart, apart)
  `DF_ADD(spread2, apart2, hh)
  `DF_SQRT(spread, spread2)
  `DF_SUB(lesser, mean, spread)
  `DF_DOT(y1, y, v1)
  `DF_DOT(y2, y, v1_t)
  `DF_MUL(y1y1, y1, y1)
  `DF_MUL(y2y2, y2, y2)
  `DF_ADD(yy, y1y1, y2y2)
  `DF_SQRT(steep, yy)
  `DF_SUB(lacks, steep, lesser)
  `DF_MAX(more, zero, lacks)
  `DF_ADD(e11, d11, more)
  `DF_ADD(e22, d22, more)
  `DF_MUL(e11e22, e11, e22)
  `DF_SUB(e_det, e11e22, hh)
  `DF_DIV(inverse, one, e_det)
  `DF_MUL(e22y1, e22, y1)
  `DF_MUL(h12y2, h12, y2)
  `DF_SUB(along1, e22y1, h12y2)
  `DF_MUL(free1, along1, inverse)
  `DF_MUL(e11y2, e11, y2)
  `DF_MUL(h12y1, h12, y1)
  `DF_SUB(along2, e11y2, h12y1)
  `DF_MUL(free2, along2, inverse)
  `DF_CLAMP(s1, free1, minus_half, half)
  `DF_CLAMP(s2, free2, minus_half, half)
  `DF_VSCALE(step1, v1, s1)
  `DF_VSCALE(step2, v1_t, s2)
  `DF_VADD(newton, step1, step2)

  // ---- Step kept or undone ----
  `DF_VIN(old_n, lo_n_i, 0)
  `DF_VIN(old_step, lo_y_i, 0)
  `DF_IN(old_score, score_i, 0)
  `DF_CONST(quarter, `DF_POWER_OF_TWO(-2))
  `DF_LT(raised, old_score, g)
  `DF_FILL(start_all, start)
  `DF_OR(up, start_all, raised)
  `DF_VSCALE(shorter, old_step, quarter)
  `DF_VSELECT(lo_y, up, newton, shorter)
  `DF_VSELECT(lo_n, up, n, old_n)
  `DF_SELECT(score, up, g, old_score)
  `DF_VADD(moved, lo_n, lo_y)
  `DF_VCHOOSE(next, pole, pole_next, moved)

  `DF_VAT(lo_n_end, lo_n, `LATENCY_STEP)
  `DF_VAT(lo_y_end, lo_y, `LATENCY_STEP)
  `DF_AT(score_end, score, `LATENCY_STEP)
  `DF_VAT(next_end, next, `LATENCY_STEP)
  assign {lo_n_o, lo_y_o, score_o, next_o} = {lo_n_end, lo_y_end, score_end, next_end};
  `undef DF_EN
  `define DF_EN 1'b1
endmodule
