// SPDX-License-Identifier: Apache-2.0
// minimumNumber or maximumNumber of IEEE 754-2019. A NaN loses against a number, and -0 is below +0.
// Two NaNs give the canonical NaN. A signalling NaN raises NV.
// Latency: LAT cycles; 0 with ARITH = "host".
// Throughput: one result per lane per cycle.
// Stall: none, runs free.
// Flags: {NV,DZ,OF,UF,NX} when FLAGS = 1.
module fp_minmax #(
    parameter  int EXP   = 8,    // 3..11
    parameter  int MAN   = 23,   // 2..52
    parameter  int LANES = 1,    // >= 1
    parameter  int B_LANES = LANES,  // 1: b is one value for all lanes
    parameter  int LAT   = 1,    // >= 1
    parameter  bit MAX   = 0,    // 1: maximum
    parameter      ARITH = "rtl",  // "rtl": gates; "host": the host's FPU, simulation only, combinational
    parameter  bit FLAGS = 0,
    localparam int CW    = (1 + EXP + MAN <= 32) ? 32 : 64
) (
    input  logic                     clk_i,
    input  logic [LANES-1:0][CW-1:0] a_i,
    input  logic [B_LANES-1:0][CW-1:0] b_i,
    output logic [LANES-1:0][CW-1:0] r_o,
    output logic [LANES-1:0][CW-1:0] flags_o
);
  /*verilator inline_module*/
  fp_lanes #(.OP(MAX ? formats_pkg::FP_MAX : formats_pkg::FP_MIN), .EXP(EXP), .MAN(MAN), .LANES(LANES),
      .B_LANES(B_LANES), .LAT(LAT), .ARITH(ARITH), .FLAGS(FLAGS)) lanes (
      .clk_i, .en_i(1'b1), .a_i, .b_i, .r_o(r_o), .flags_o);
endmodule
