// SPDX-License-Identifier: Apache-2.0
// A vector x turned by 16 u: x + w cross x. The turn puts the shapes of a pair in general position. Only the signs of
// the result may be used, to choose support features. 6 add, 6 mul.
// Latency: LATENCY_TURNED cycles; 0 with ARITH = "host".
// Throughput: one vector per lane per cycle.
// Stall: none.
`include "convex.svh"
module turned #(
    `DF_PARAMETERS
) (
    input logic clk_i,
    input logic [2:0][LANES-1:0][CW-1:0] x_i,
    output logic [2:0][LANES-1:0][CW-1:0] r_o
);
  /*verilator inline_module*/
  // exponent shift: 16 u, and the change of bias from binary64
  localparam int SHIFT = 3 - MAN + (2 ** (EXP - 1) - 1) - 1023;
  // A binary64 word times 16 u = 2^(3-MAN), rounded to nearest even. The result must be a normal number of the format.
  function automatic logic [CW-1:0] times_angle(input logic [63:0] x);
    logic [63:0] fraction, half, rest, magnitude;
    fraction = {12'd0, x[51:0]} >> (52 - MAN);
    rest = {12'd0, x[51:0]} & ((64'd1 << (52 - MAN)) - 64'd1);
    half = (64'd1 << (52 - MAN)) >> 1;
    magnitude = ((64'(x[62:52]) + 64'(SHIFT)) << MAN) + fraction;
    if (MAN < 52 && (rest > half || (rest == half && fraction[0]))) magnitude = magnitude + 64'd1;
    times_angle = CW'(magnitude) | (CW'(x[63]) << (EXP + MAN));
  endfunction
  // 1, 0.618, -0.755
  localparam logic [CW-1:0] TURN_X = times_angle(64'h3FF0_0000_0000_0000);
  localparam logic [CW-1:0] TURN_Y = times_angle(64'h3FE3_C6A7_EF9D_B22D);
  localparam logic [CW-1:0] TURN_Z = times_angle(64'hBFE8_28F5_C28F_5C29);

  `DF_VIN(x, x_i, 0)
  `DF_VCONST(turn, TURN_X, TURN_Y, TURN_Z)
  `DF_CROSS(moved, turn, x)
  `DF_VADD(r, x, moved)
  if (T_r != `LATENCY_TURNED) $error("turned: latency");
  assign r_o = r;
endmodule
