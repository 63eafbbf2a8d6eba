// SPDX-License-Identifier: Apache-2.0
// Integer to floating point, rounded to nearest even.
// Latency: LAT cycles.
// Throughput: one result per lane per cycle.
// Stall: none, runs free.
// Flags: {NV,DZ,OF,UF,NX} when FLAGS = 1.
module fp_from_int #(
    parameter  int EXP   = 8,      // 3..11
    parameter  int MAN   = 23,     // 2..52
    parameter  int INT   = 32,     // bits of the integer: 32 or 64
    parameter  bit UNSIGNED = 0,
    parameter  int LANES = 1,      // >= 1
    parameter  int LAT   = 1,      // >= 1
    parameter      ARITH = "rtl",  // "rtl": gates; "host": the host's FPU, simulation only
    parameter  bit FLAGS = 0,
    localparam int CI = INT,
    localparam int CO = (1 + EXP + MAN <= 32) ? 32 : 64
) (
    input  logic                     clk_i,
    input  logic [LANES-1:0][CI-1:0] a_i,
    output logic [LANES-1:0][CO-1:0] r_o,
    output logic [LANES-1:0][CO-1:0] flags_o
);
  /*verilator inline_module*/
  fp_convert #(.KIND(formats_pkg::CONVERT_FROM_INT), .EXP(EXP), .MAN(MAN), .P(INT), .Q(UNSIGNED ? 1 : 0), .CI(CI),
      .CO(CO), .LANES(LANES), .LAT(LAT), .ARITH(ARITH), .FLAGS(FLAGS)) convert (
      .clk_i, .a_i, .r_o, .flags_o);
endmodule
