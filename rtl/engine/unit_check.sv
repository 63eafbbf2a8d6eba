// SPDX-License-Identifier: Apache-2.0
// Test of unit vectors (ONE = 1) and of perpendicular vectors: |a.b - ONE| <= tolerance, false for NaN. Operators: 3
// mul, 2 add, 1 sub, 1 compare.
// Latency: LAT.mul + 3*LAT.add + LAT.cmp cycles; 0 with ARITH = "host".
// Throughput: one result per lane per cycle.
// Stall: none.
`include "dataflow.svh"
module unit_check #(
    parameter bit ONE = 1,
    parameter int EXP = 8,
    parameter int MAN = 23,
    parameter int LANES = 1,
    parameter latency_pkg::latency_t LAT = latency_pkg::ONES,
    parameter ARITH = "rtl",
    localparam int CW = (1 + EXP + MAN <= 32) ? 32 : 64
) (
    input logic clk_i,
    input logic en_i,  // 0: no reader uses the result
    input logic [2:0][LANES-1:0][CW-1:0] a_i,
    input logic [2:0][LANES-1:0][CW-1:0] b_i,
    output logic [LANES-1:0][CW-1:0] good_o
);
  /*verilator inline_module*/
  `undef DF_EN
  `define DF_EN en_i
  localparam int BIAS = (1 << (EXP - 1)) - 1;
  localparam int SHIFT = (MAN - 3 < 20) ? MAN - 3 : 20;  // 16 u = 2^-(MAN-3)
  localparam logic [CW-1:0] TOLERANCE = (CW'(BIAS) - CW'(SHIFT)) << MAN;
  `DF_VIN(a, a_i, 0)
  `DF_VIN(b, b_i, 0)
  `DF_CONST(expected, ONE ? CW'(BIAS) << MAN : CW'(0))
  `DF_CONST(tolerance, TOLERANCE)
  `DF_DOT(product, a, b)
  `DF_SUB(difference, product, expected)
  `DF_ABS(error, difference)
  `DF_LE(good, error, tolerance)
  assign good_o = good;
  `undef DF_EN
  `define DF_EN 1'b1
endmodule
