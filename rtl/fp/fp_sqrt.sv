// SPDX-License-Identifier: Apache-2.0
// Square root. A negative number gives NaN, and -0 gives -0.
// Latency: LAT cycles; 0 with ARITH = "host".
// Throughput: one result per lane per cycle.
// Stall: none, runs free.
// Flags: {NV,DZ,OF,UF,NX} when FLAGS = 1.
module fp_sqrt #(
    parameter  int EXP   = 8,    // 3..11
    parameter  int MAN   = 23,   // 2..52
    parameter  int LANES = 1,    // >= 1
    parameter  int LAT   = 1,    // >= 1
    parameter      ARITH = "rtl",  // "rtl": gates; "host": the host's FPU, simulation only, combinational
    parameter  bit FLAGS = 0,
    localparam int CW    = (1 + EXP + MAN <= 32) ? 32 : 64
) (
    input  logic                     clk_i,
    input  logic [LANES-1:0][CW-1:0] a_i,
    output logic [LANES-1:0][CW-1:0] r_o,
    output logic [LANES-1:0][CW-1:0] flags_o
);
  /*verilator inline_module*/
  fp_lanes #(.OP(formats_pkg::FP_SQRT), .EXP(EXP), .MAN(MAN), .LANES(LANES), .LAT(LAT), .ARITH(ARITH), .FLAGS(FLAGS))
      lanes (
      .clk_i, .en_i(1'b1), .a_i, .b_i(a_i), .r_o(r_o), .flags_o);
endmodule
