// SPDX-License-Identifier: Apache-2.0
// Sum a + b or difference a - b of two 3-vectors, one rounding per component (3 adders or subtractors).
// Latency: LAT.add cycles; 0 with ARITH = "host".
// Throughput: one vector per lane per cycle.
// Stall: none.
module vec_add #(
    parameter int EXP = 8,
    parameter int MAN = 23,
    parameter int LANES = 1,
    parameter int B_LANES = LANES,  // 1: b is one vector for all lanes
    parameter latency_pkg::latency_t LAT = latency_pkg::ONES,
    parameter bit SUB = 0,  // 1: a - b
    parameter ARITH = "rtl",
    parameter bit CANON = 1,  // as in fp_lanes, for the result
    localparam int CW = (1 + EXP + MAN <= 32) ? 32 : 64
) (
    input logic clk_i,
    input logic [2:0][LANES-1:0][CW-1:0] a_i,
    input logic [2:0][B_LANES-1:0][CW-1:0] b_i,
    output logic [2:0][LANES-1:0][CW-1:0] r_o
);
  /*verilator inline_module*/
  for (genvar k = 0; k < 3; k++) begin : axis
    fp_add #(.EXP(EXP), .MAN(MAN), .LANES(LANES), .B_LANES(B_LANES), .LAT(LAT.add), .SUB(SUB), .ARITH(ARITH),
        .CANON(CANON)) add (
        .clk_i, .a_i(a_i[k]), .b_i(b_i[k]), .r_o(r_o[k]), .flags_o());
  end
endmodule
