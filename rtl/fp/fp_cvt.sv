// SPDX-License-Identifier: Apache-2.0
// Conversion from one format to another, rounded to nearest even.
// Latency: LAT cycles.
// Throughput: one result per lane per cycle.
// Stall: none, runs free.
// Flags: {NV,DZ,OF,UF,NX} when FLAGS = 1.
module fp_cvt #(
    parameter  int EXP_I = 8,      // 3..11, format of the operand
    parameter  int MAN_I = 23,     // 2..52
    parameter  int EXP_O = 5,      // 3..11, format of the result
    parameter  int MAN_O = 10,     // 2..52
    parameter  int LANES = 1,      // >= 1
    parameter  int LAT   = 1,      // >= 1
    parameter      ARITH = "rtl",  // "rtl": gates; "host": the host's FPU, simulation only
    parameter  bit FLAGS = 0,
    localparam int CI = (1 + EXP_I + MAN_I <= 32) ? 32 : 64,
    localparam int CO = (1 + EXP_O + MAN_O <= 32) ? 32 : 64
) (
    input  logic                     clk_i,
    input  logic [LANES-1:0][CI-1:0] a_i,
    output logic [LANES-1:0][CO-1:0] r_o,
    output logic [LANES-1:0][CO-1:0] flags_o
);
  /*verilator inline_module*/
  fp_convert #(.KIND(formats_pkg::CONVERT_FORMAT), .EXP(EXP_I), .MAN(MAN_I), .P(EXP_O), .Q(MAN_O), .CI(CI), .CO(CO),
      .LANES(LANES), .LAT(LAT), .ARITH(ARITH), .FLAGS(FLAGS)) convert (
      .clk_i, .a_i, .r_o, .flags_o);
endmodule
