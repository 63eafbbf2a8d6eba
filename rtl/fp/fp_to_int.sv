// SPDX-License-Identifier: Apache-2.0
// Floating point to integer. A value out of range saturates with NV. A NaN gives the largest integer with NV.
// Latency: LAT cycles.
// Throughput: one result per lane per cycle.
// Stall: none, runs free.
// Flags: {NV,DZ,OF,UF,NX} when FLAGS = 1.
module fp_to_int #(
    parameter  int EXP   = 8,      // 3..11
    parameter  int MAN   = 23,     // 2..52
    parameter  int INT   = 32,     // bits of the integer: 32 or 64
    parameter  bit UNSIGNED = 0,
    parameter  bit TRUNCATE = 0,   // 0: to nearest even; 1: toward zero
    parameter  int LANES = 1,      // >= 1
    parameter  int LAT   = 1,      // >= 1
    parameter      ARITH = "rtl",  // "rtl": gates; "host": the host's FPU, simulation only
    parameter  bit FLAGS = 0,
    localparam int CI = (1 + EXP + MAN <= 32) ? 32 : 64,
    localparam int CO = INT
) (
    input  logic                     clk_i,
    input  logic [LANES-1:0][CI-1:0] a_i,
    output logic [LANES-1:0][CO-1:0] r_o,
    output logic [LANES-1:0][CO-1:0] flags_o
);
  /*verilator inline_module*/
  fp_convert #(.KIND(formats_pkg::CONVERT_TO_INT), .EXP(EXP), .MAN(MAN), .P(INT),
      .Q((UNSIGNED ? 1 : 0) + (TRUNCATE ? 2 : 0)), .CI(CI), .CO(CO), .LANES(LANES), .LAT(LAT), .ARITH(ARITH),
      .FLAGS(FLAGS)) convert (
      .clk_i, .a_i, .r_o, .flags_o);
endmodule
