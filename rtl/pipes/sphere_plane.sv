// SPDX-License-Identifier: Apache-2.0
// Sphere against plane. The plane has two sides: H = n.c - d, s = |H| - r, n from the sphere to the plane. With
// HALF_SPACE the plane is the solid n.x <= d: s = H - r, n points into it. CP = c + (r + s/2) n. F = (s <= 0), T = |s|.
// Operators: 8 add, 7 mul, 1 compare.
// Latency: LATENCY cycles; 0 with ARITH = "host".
// Throughput: LANES pairs per cycle.
// Stall: none, runs free.
`include "pipe.svh"
module sphere_plane #(
    `DF_PARAMETERS,
    parameter bit HALF_SPACE = 0
) (
    input logic clk_i,
    input logic [3:0][LANES-1:0][CW-1:0] a_i,  // sphere: c x y z, r
    input logic [3:0][LANES-1:0][CW-1:0] b_i,  // plane: n x y z, d
    `DISTANCE_OUTPUTS
);
  /*verilator inline_module*/
  localparam logic [CW-1:0] ONE = ((CW'(1) << (EXP - 1)) - 1) << MAN;
  localparam logic [CW-1:0] HALF = ONE - (CW'(1) << MAN);

  `DF_VIN(c, a_i[2:0], 0)
  `DF_IN(r, a_i[3], 0)
  `DF_VIN(plane_n, b_i[2:0], 0)
  `DF_IN(plane_d, b_i[3], 0)
  `DF_CONST(half, HALF)

  `DF_DOT(on_n, plane_n, c)
  `DF_SUB(height, on_n, plane_d)
  // The sphere's side of the plane, as a sign. A half-space is always below.
  localparam int T_up = HALF_SPACE ? `DF_CONSTANT : T_height;
  `DF_SCALAR up;
  assign up = HALF_SPACE ? {LANES{ONE}} : height;
  `DF_MOVE_SIGN(distance, up, height)
  `DF_SUB(s, distance, r)

  // Away from the sphere's side of the plane.
  `DF_VFLIP(n_up, up, plane_n)
  `DF_VNEG(n, n_up)
  `DF_MUL(s_half, s, half)
  `DF_ADD(along, r, s_half)
  `DF_VSCALE(offset, n, along)
  `DF_VADD(cp, c, offset)

  `DISTANCE_RESULT(s, cp, n)
endmodule
