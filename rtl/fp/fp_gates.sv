// SPDX-License-Identifier: Apache-2.0
// Gate back end of the binary units: lanes of one operation with input registers.
// CW is the word of a lane (fp_mask.svh).
// Latency: 1 + CUTS cycles.
// Throughput: one result per lane per cycle.
// Stall: none.
// Not inlined: the lanes must access one C++ object, so that the compiler sees that their data do not alias.
// The inputs are public so that they stay variables of this object. Then all instances run one function.
module fp_gates #(
    parameter  int OP    = formats_pkg::FP_ADD,
    parameter  int EXP   = 8,
    parameter  int MAN   = 23,
    parameter  int LANES = 1,
    parameter  int B_LANES = LANES,  // LANES, or 1: b is one value for all lanes
    parameter  bit LEAST = 0,        // 1: words no wider than the format needs
    parameter  int CUTS  = 0,
    parameter  bit FLAGS = 0,
    localparam int CW    = formats_pkg::lane_word(EXP, MAN, LEAST)
) (
    input  logic                     clk_i,
    input  logic [LANES-1:0][CW-1:0] a_i /*verilator public_flat_rd*/,
    input  logic [B_LANES-1:0][CW-1:0] b_i /*verilator public_flat_rd*/,
    output logic [LANES-1:0][CW-1:0] r_o,
    output logic [LANES-1:0][CW-1:0] flags_o
);
  /*verilator no_inline_module*/
  logic [LANES-1:0][CW-1:0] a_q;
  logic [B_LANES-1:0][CW-1:0] b_q;
  always_ff @(posedge clk_i) begin
    a_q <= a_i;
    b_q <= b_i;
  end
  for (genvar l = 0; l < LANES; l++) begin : g_lane
    if (OP <= formats_pkg::FP_SUB) begin : g_add
      fp_add_lane #(.EXP(EXP), .MAN(MAN), .LEAST(LEAST), .SUB(OP == formats_pkg::FP_SUB), .CUTS(CUTS),
          .FLAGS(FLAGS)) lane (
          .clk_i, .a_i(a_q[l]), .b_i(b_q[l%B_LANES]), .r_o(r_o[l]), .flags_o(flags_o[l]));
    end else if (OP == formats_pkg::FP_MUL) begin : g_mul
      fp_mul_lane #(.EXP(EXP), .MAN(MAN), .LEAST(LEAST), .CUTS(CUTS), .FLAGS(FLAGS)) lane (
          .clk_i, .a_i(a_q[l]), .b_i(b_q[l%B_LANES]), .r_o(r_o[l]), .flags_o(flags_o[l]));
    end else if (OP == formats_pkg::FP_DIV) begin : g_div
      fp_div_lane #(.EXP(EXP), .MAN(MAN), .LEAST(LEAST), .CUTS(CUTS), .FLAGS(FLAGS)) lane (
          .clk_i, .a_i(a_q[l]), .b_i(b_q[l%B_LANES]), .r_o(r_o[l]), .flags_o(flags_o[l]));
    end else if (OP == formats_pkg::FP_SQRT) begin : g_sqrt
      fp_sqrt_lane #(.EXP(EXP), .MAN(MAN), .LEAST(LEAST), .CUTS(CUTS), .FLAGS(FLAGS)) lane (
          .clk_i, .a_i(a_q[l]), .r_o(r_o[l]), .flags_o(flags_o[l]));
    end else begin : g_compare
      fp_cmp_lane #(.OP(OP), .EXP(EXP), .MAN(MAN), .LEAST(LEAST), .FLAGS(FLAGS)) lane (
          .a_i(a_q[l]), .b_i(b_q[l%B_LANES]), .r_o(r_o[l]), .flags_o(flags_o[l]));
    end
  end
  if (OP == formats_pkg::FP_SQRT) begin : g_one_operand
    logic unused_b;
    assign unused_b = &{1'b0, b_q};
  end
endmodule
