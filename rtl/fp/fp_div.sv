// SPDX-License-Identifier: Apache-2.0
// Quotient a / b, rounded to nearest even.
// Latency: LAT cycles; 0 with ARITH = "host".
// Throughput: one result per lane per cycle.
// Stall: none, runs free.
// Flags: {NV,DZ,OF,UF,NX} when FLAGS = 1.
module fp_div #(
    parameter  int EXP   = 8,    // 3..11
    parameter  int MAN   = 23,   // 2..52
    parameter  int LANES = 1,    // >= 1
    parameter  int LAT   = 1,    // >= 1
    parameter      ARITH = "rtl",  // "rtl": gates; "host": the host's FPU, simulation only, combinational
    parameter  bit CANON = 1,    // 0: the host back end may give any NaN; for results that only arithmetic reads
    parameter  bit FLAGS = 0,
    localparam int CW    = (1 + EXP + MAN <= 32) ? 32 : 64
) (
    input  logic                     clk_i,
    input  logic [LANES-1:0][CW-1:0] a_i,
    input  logic [LANES-1:0][CW-1:0] b_i,
    output logic [LANES-1:0][CW-1:0] r_o,
    output logic [LANES-1:0][CW-1:0] flags_o
);
  /*verilator inline_module*/
  fp_lanes #(.OP(formats_pkg::FP_DIV), .EXP(EXP), .MAN(MAN), .LANES(LANES), .LAT(LAT), .ARITH(ARITH), .CANON(CANON),
      .FLAGS(FLAGS)) lanes (
      .clk_i, .en_i(1'b1), .a_i, .b_i, .r_o(r_o), .flags_o);
endmodule
