// SPDX-License-Identifier: Apache-2.0
// Sphere against sphere: s = |cB - cA| - (rA + rB), n from A to B, CP = cA + (rA + s/2) n. Centres so close that their
// squared distance is subnormal take n = (0, 0, 1). F = (s <= 0), T = |s|. 11 add, 10 mul, 1 div, 1 sqrt, 2 compare.
// Latency: LATENCY cycles; 0 with ARITH = "host". Throughput: LANES pairs per cycle. Stall: none, runs free.
`include "pipe.svh"
module sphere_sphere #(
    `DF_PARAMETERS
) (
    input logic clk_i,
    input logic [3:0][LANES-1:0][CW-1:0] a_i,  // sphere: c x y z, r
    input logic [3:0][LANES-1:0][CW-1:0] b_i,
    `DISTANCE_OUTPUTS
);
  /*verilator inline_module*/
  localparam logic [CW-1:0] ONE = ((CW'(1) << (EXP - 1)) - 1) << MAN;
  localparam logic [CW-1:0] HALF = ONE - (CW'(1) << MAN);
  localparam logic [CW-1:0] LEAST_NORMAL = CW'(1) << MAN;

  `DF_VIN(a_c, a_i[2:0], 0)
  `DF_IN(a_r, a_i[3], 0)
  `DF_VIN(b_c, b_i[2:0], 0)
  `DF_IN(b_r, b_i[3], 0)
  `DF_CONST(one, ONE)
  `DF_CONST(half, HALF)
  `DF_CONST(least_normal, LEAST_NORMAL)
  `DF_VCONST(up, 0, 0, ONE)

  `DF_VSUB(w, b_c, a_c)
  `DF_DOT(dd, w, w)
  `DF_LE(apart, least_normal, dd)
  `DF_SQRT(d, dd)
  `DF_DIV(inverse, one, d)
  `DF_VSCALE(direction, w, inverse)
  `DF_VSELECT(n, apart, direction, up)
  `DF_ADD(reach, a_r, b_r)
  `DF_SUB(s, d, reach)
  `DF_MUL(s_half, s, half)
  `DF_ADD(along, a_r, s_half)
  `DF_VSCALE(offset, n, along)
  `DF_VADD(cp, a_c, offset)

  `DISTANCE_RESULT(s, cp, n)
endmodule
