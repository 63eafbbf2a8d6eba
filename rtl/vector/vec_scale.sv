// SPDX-License-Identifier: Apache-2.0
// A 3-vector times a scalar, s * a (3 multipliers).
// Latency: LAT.mul cycles; 0 with ARITH = "host".
// Throughput: one vector per lane per cycle.
// Stall: none.
module vec_scale #(
    parameter int EXP = 8,
    parameter int MAN = 23,
    parameter int LANES = 1,
    parameter latency_pkg::latency_t LAT = latency_pkg::ONES,
    parameter ARITH = "rtl",
    parameter bit CANON = 1,  // as in fp_lanes, for the result
    localparam int CW = (1 + EXP + MAN <= 32) ? 32 : 64
) (
    input logic clk_i,
    input logic [2:0][LANES-1:0][CW-1:0] a_i,
    input logic [LANES-1:0][CW-1:0] s_i,
    output logic [2:0][LANES-1:0][CW-1:0] r_o
);
  /*verilator inline_module*/
  for (genvar k = 0; k < 3; k++) begin : axis
    fp_mul #(.EXP(EXP), .MAN(MAN), .LANES(LANES), .LAT(LAT.mul), .ARITH(ARITH), .CANON(CANON)) mul (
        .clk_i, .a_i(a_i[k]), .b_i(s_i), .r_o(r_o[k]), .flags_o());
  end
endmodule
