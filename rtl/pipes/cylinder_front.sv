// SPDX-License-Identifier: Apache-2.0
// Front of a pass between two cylinders: the unit normal that the pass evaluates (front() of
// reference/pipes/cylinder/search.hpp). Phases that need c x x or (c x x) x c share the cross products. A step on a
// circle is one of these phases.
// Operators: 13 add, 24 mul, 1 div, 1 sqrt, 4 compare.
// Latency: LATENCY_FRONT cycles; 0 with ARITH = "host".
// Throughput: one normal per lane per cycle.
// Stall: none, runs free.
`include "cylinder.svh"
module cylinder_front #(
    `DF_PARAMETERS
) (
    input logic clk_i,
    input logic [`PASS_W-1:0] pass_i,
    input logic [2:0][LANES-1:0][CW-1:0] a_i,  // axes
    input logic [2:0][LANES-1:0][CW-1:0] b_i,
    input logic [2:0][LANES-1:0][CW-1:0] d_i,  // centre of B
    input logic [2:0][LANES-1:0][CW-1:0] q_i,  // the pair's state, with the following inputs
    input logic [2:0][LANES-1:0][CW-1:0] last_n_i,
    input logic [2:0][LANES-1:0][CW-1:0] next_i,
    input logic [2:0][LANES-1:0][CW-1:0] best_n_i,
    output logic [2:0][LANES-1:0][CW-1:0] n_o
);
  /*verilator inline_module*/
  localparam int BODY = `BODY_CYLINDER;
  logic [3:0] phase;
  logic second, centre, refine;
  logic [1:0] track;
  assign phase = `PASS_PHASE(pass_i);
  assign track = `PASS_TRACK(pass_i);
  assign centre = phase == `PHASE_CENTRE;
  assign refine = phase == `PHASE_REFINE;
  assign second = centre ? `PASS_INDEX(pass_i) == 2 : track == 1;
  `DF_CONTROL(twice, (centre && `PASS_INDEX(pass_i) != 0) || phase == `PHASE_CAP || refine, 0)
  `DF_CONTROL(side, phase == `PHASE_SIDE, 0)
  `DF_CONTROL(beside, phase == `PHASE_BESIDE, 0)
  `DF_CONTROL(witness, phase == `PHASE_TOUCH || (phase == `PHASE_PROJECT && !`PASS_TRIAL(pass_i)), 0)

  `DF_VIN(c, second ? b_i : a_i, 0)
  `DF_VIN(other, centre ? d_i : refine ? next_i : second ? a_i : b_i, 0)
  `DF_VIN(plain, centre ? d_i : phase == `PHASE_POLE ? c : phase == `PHASE_START && track == 2 ? best_n_i : next_i, 0)
  `DF_VIN(q, q_i, 0)
  `DF_VIN(last_n, last_n_i, 0)
  `DF_VIN(best_n, best_n_i, 0)
  `DF_CONST(step, `DF_POWER_OF_TWO(-((MAN + 2) / 2)))  // sqrt(u), rounded down to a power of two
  `DF_CONST(tiny, `DF_POWER_OF_TWO(2 * (3 - MAN)))  // (16 u)^2

  `undef DF_EN
  `define DF_EN crossing
  logic crossing, unit_wanted;
  assign crossing = centre || refine || phase == `PHASE_CAP || phase == `PHASE_SIDE;
  assign unit_wanted = phase != `PHASE_TOUCH && (phase != `PHASE_PROJECT || `PASS_TRIAL(pass_i));
  `DF_CROSS(x, c, other)
  `DF_CROSS(xc, x, c)
  `DF_DOT(xx, x, x)
  `DF_LE(along, xx, tiny)
  `DF_ACROSS(any, c)
  `DF_VSELECT(across, along, any, x)
  `undef DF_EN
  `define DF_EN (phase == `PHASE_BESIDE)
  `DF_VSCALE(offset, last_n, step)
  `DF_VADD(aside, q, offset)
  `DF_VCHOOSE(raw_beside, beside, aside, plain)
  `DF_VCHOOSE(raw_side, side, across, raw_beside)
  `DF_VCHOOSE(raw_any, twice, xc, raw_side)
  `DF_VAT(raw, raw_any, `LATENCY_CYLINDER_RAW)
  `undef DF_EN
  `define DF_EN unit_wanted
  `DF_NORMALISE(unit, raw)
  // A direction between witness points that are too near each other is not tried.
  `DF_CONTROL(trial, phase == `PHASE_PROJECT && `PASS_TRIAL(pass_i), 0)
  `DF_VSELECT(tried, unit_usable, unit, best_n)
  `DF_VCHOOSE(unit_or_best, trial, tried, unit)
  `DF_VCHOOSE(n, witness, best_n, unit_or_best)
  `DF_VAT(n_end, n, `LATENCY_FRONT)
  assign n_o = n_end;
  `undef DF_EN
  `define DF_EN 1'b1
endmodule
