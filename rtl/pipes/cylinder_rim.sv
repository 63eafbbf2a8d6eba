// SPDX-License-Identifier: Apache-2.0
// A cylinder's rim for a unit normal: x = a cross n, m = |x|. Its width is r m. The vector side, (r x/m) cross a, goes
// from the axis to the support point. The radius of curvature of the support function is kappa = r/m, across n in the
// direction v = x/m.
// The product is a x n and never n - (a.n) a, which loses all its digits beside the axis.
// Where m <= u, or the rim is off, kappa, side and v are 0. If the rim is off, the width is also 0.
// Operators: 8 add, 23 mul, 1 div, 1 sqrt, 1 compare.
// Latency: LATENCY_RIM cycles; 0 with ARITH = "host".
// Throughput: one rim per lane per cycle.
// Stall: none, runs free.
`include "cylinder.svh"
module cylinder_rim #(
    `DF_PARAMETERS
) (
    input logic clk_i,
    input logic off_i,
    input logic [2:0][LANES-1:0][CW-1:0] a_i,  // axis
    input logic [LANES-1:0][CW-1:0] radius_i,
    input logic [2:0][LANES-1:0][CW-1:0] n_i,
    output logic [LANES-1:0][CW-1:0] width_o,
    output logic [2:0][LANES-1:0][CW-1:0] side_o,
    output logic [LANES-1:0][CW-1:0] kappa_o,
    output logic [2:0][LANES-1:0][CW-1:0] v_o
);
  /*verilator inline_module*/
  `DF_CONTROL(off, off_i, 0)
  `DF_VIN(a, a_i, 0)
  `DF_IN(radius, radius_i, 0)
  `DF_VIN(n, n_i, 0)
  `DF_CONST(zero, 0)
  `DF_CONST(one, `DF_POWER_OF_TWO(0))
  `DF_CONST(u, `DF_POWER_OF_TWO(-MAN - 1))

  `DF_CROSS(x, a, n)
  `DF_DOT(xx, x, x)
  `DF_SQRT(m, xx)
  `DF_LE(on_axis, m, u)
  `DF_FILL(off_all, off)
  `DF_OR(none, off_all, on_axis)
  `DF_DIV(inverse, one, m)
  `DF_SELECT(i, none, zero, inverse)
  `DF_MUL(kappa, radius, i)
  `DF_MUL(width, radius, m)
  `DF_CHOOSE(width_on, off, zero, width)
  `DF_CROSS(across, x, a)
  `DF_VSCALE(side, across, kappa)
  `DF_VSCALE(v, x, i)

  `DF_AT(width_late, width_on, `LATENCY_RIM)
  `DF_VAT(side_late, side, `LATENCY_RIM)
  `DF_AT(kappa_late, kappa, `LATENCY_RIM)
  `DF_VAT(v_late, v, `LATENCY_RIM)
  assign width_o = width_late;
  assign side_o = side_late;
  assign kappa_o = kappa_late;
  assign v_o = v_late;
endmodule
