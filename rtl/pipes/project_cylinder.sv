// SPDX-License-Identifier: Apache-2.0
// Nearest point of a solid cylinder or, by masks, of a cap's rim or a line of its side. The masks matter because a
// round side and a plane that touches it separate slowly: every projection merely halves the error.
// Operators: 19 add, 24 mul, 1 div, 1 sqrt, 1 compare, 3 min/max.
// Latency: LATENCY_PROJECT_CYLINDER cycles from the later of x and c; other inputs are early; 0 with ARITH = "host".
// Throughput: one point per lane per cycle.
// Stall: none, runs free.
`include "cylinder.svh"
module project_cylinder #(
    `DF_PARAMETERS,
    parameter int T_X = 0,  // stage times of the inputs
    parameter int T_C = 0,
    parameter int T_ALONGSIDE = 0,
    parameter int T_END = 0,
    parameter int T_RIM = 0
) (
    input logic clk_i,
    input logic en_i,  // 0: no reader uses the result
    input logic [2:0][LANES-1:0][CW-1:0] x_i,
    input logic [2:0][LANES-1:0][CW-1:0] c_i,  // centre
    input logic [2:0][LANES-1:0][CW-1:0] a_i,  // axis, half height, radius
    input logic [LANES-1:0][CW-1:0] half_i,
    input logic [LANES-1:0][CW-1:0] radius_i,
    // from the axis to the line of the side, or to where n touches the rim
    input logic [2:0][LANES-1:0][CW-1:0] side_i,
    input logic [LANES-1:0][CW-1:0] alongside_i,  // use that line instead of the round side
    input logic [LANES-1:0][CW-1:0] end_i,  // height of a cap; the cylinder is reduced to its rim
    input logic [LANES-1:0][CW-1:0] rim_i,
    output logic [2:0][LANES-1:0][CW-1:0] r_o
);
  /*verilator inline_module*/
  `undef DF_EN
  `define DF_EN en_i
  `DF_VIN(x, x_i, T_X)
  `DF_VIN(centre, c_i, T_C)
  `DF_VIN(a, a_i, 0)
  `DF_IN(half, half_i, 0)
  `DF_IN(radius, radius_i, 0)
  `DF_VIN(side, side_i, 0)
  `DF_IN(alongside, alongside_i, T_ALONGSIDE)
  `DF_IN(cap, end_i, T_END)
  `DF_IN(rim, rim_i, T_RIM)
  `DF_CONST(one, `DF_POWER_OF_TWO(0))
  `DF_VSUB(w, x, centre)
  `DF_CROSS(aw, a, w)
  `DF_CROSS(l, aw, a)
  `DF_DOT(height, a, w)
  `DF_NEG(minus_half, half)
  `DF_CLAMP(between, height, minus_half, half)
  `DF_SELECT(z, rim, cap, between)
  `DF_DOT(ll, l, l)
  `DF_SQRT(length, ll)
  `DF_DIV(ratio, radius, length)
  `DF_MIN(inward, one, ratio)
  `DF_SELECT(f, rim, ratio, inward)
  `DF_VSCALE(round, l, f)
  // On the axis, all points of the rim are equally near and l has no direction. Then it is the point that n touches.
  `DF_CONST(least, CW'(3) << MAN)
  `DF_LT(central, ll, least)
  `DF_AND(rim_from_axis, rim, central)
  `DF_OR(named, alongside, rim_from_axis)
  `DF_VSELECT(across, named, side, round)
  `DF_VSCALE(axial, a, z)
  `DF_VADD(offset, axial, across)
  `DF_VADD(r, centre, offset)
  `DF_VAT(r_end, r, `DF_MAX2(T_X, T_C) + `LATENCY_PROJECT_CYLINDER)
  assign r_o = r_end;
  `undef DF_EN
  `define DF_EN 1'b1
endmodule
