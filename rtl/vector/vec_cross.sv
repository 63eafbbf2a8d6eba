// SPDX-License-Identifier: Apache-2.0
// Cross product a x b, each component the difference of two rounded products (6 multipliers, 3 subtractors).
// Latency: LAT.mul + LAT.add cycles; 0 with ARITH = "host".
// Throughput: one vector per lane per cycle.
// Stall: none.
module vec_cross #(
    parameter int EXP = 8,
    parameter int MAN = 23,
    parameter int LANES = 1,
    parameter int B_LANES = LANES,  // 1: b is one vector for all lanes
    parameter latency_pkg::latency_t LAT = latency_pkg::ONES,
    parameter ARITH = "rtl",
    parameter bit CANON = 1,  // as in fp_lanes, for the result
    localparam int CW = (1 + EXP + MAN <= 32) ? 32 : 64
) (
    input logic clk_i,
    input logic en_i,
    input logic [2:0][LANES-1:0][CW-1:0] a_i,
    input logic [2:0][B_LANES-1:0][CW-1:0] b_i,
    output logic [2:0][LANES-1:0][CW-1:0] r_o
);
  /*verilator inline_module*/
  for (genvar k = 0; k < 3; k++) begin : axis
    localparam int Y = (k + 1) % 3, Z = (k + 2) % 3;
    logic [LANES-1:0][CW-1:0] yz, zy;
    fp_lanes #(.OP(formats_pkg::FP_MUL), .EXP(EXP), .MAN(MAN), .LANES(LANES), .B_LANES(B_LANES), .LAT(LAT.mul),
        .ARITH(ARITH), .CANON(0)) mul_yz (
        .clk_i, .en_i, .a_i(a_i[Y]), .b_i(b_i[Z]), .r_o(yz), .flags_o());
    fp_lanes #(.OP(formats_pkg::FP_MUL), .EXP(EXP), .MAN(MAN), .LANES(LANES), .B_LANES(B_LANES), .LAT(LAT.mul),
        .ARITH(ARITH), .CANON(0)) mul_zy (
        .clk_i, .en_i, .a_i(a_i[Z]), .b_i(b_i[Y]), .r_o(zy), .flags_o());
    fp_lanes #(.OP(formats_pkg::FP_SUB), .EXP(EXP), .MAN(MAN), .LANES(LANES), .LAT(LAT.add), .ARITH(ARITH),
        .CANON(CANON)) sub (
        .clk_i, .en_i, .a_i(yz), .b_i(zy), .r_o(r_o[k]), .flags_o());
  end
endmodule
