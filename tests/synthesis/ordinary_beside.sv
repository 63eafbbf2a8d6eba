// SPDX-License-Identifier: Apache-2.0
// Adder and multiplier of rtl/fp next to those in the ordinary style.
// Latency: 1 cycle. Throughput: one result per cycle. Stall: none.
module ordinary_beside #(
    parameter  int EXP = 8,
    parameter  int MAN = 23,
    localparam int W   = 1 + EXP + MAN
) (
    input  logic         clk_i,
    input  logic [W-1:0] a_i,
    input  logic [W-1:0] b_i,
    output logic [31:0]  add_o,
    output logic [31:0]  mul_o,
    output logic [W-1:0] ordinary_add_o,
    output logic [W-1:0] ordinary_mul_o
);
  logic [31:0] unused_add, unused_mul;
  fp_add #(.EXP(EXP), .MAN(MAN)) add (.clk_i, .a_i(32'(a_i)), .b_i(32'(b_i)), .r_o(add_o), .flags_o(unused_add));
  fp_mul #(.EXP(EXP), .MAN(MAN)) mul (.clk_i, .a_i(32'(a_i)), .b_i(32'(b_i)), .r_o(mul_o), .flags_o(unused_mul));
  ordinary_add #(.EXP(EXP), .MAN(MAN)) other_add (.clk_i, .a_i, .b_i, .r_o(ordinary_add_o));
  ordinary_mul #(.EXP(EXP), .MAN(MAN)) other_mul (.clk_i, .a_i, .b_i, .r_o(ordinary_mul_o));
endmodule
