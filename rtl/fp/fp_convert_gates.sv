// SPDX-License-Identifier: Apache-2.0
// Gate back end of the conversions: lanes with input registers. Parameters as in fp_convert.
// Latency: 1 + CUTS cycles.
// Throughput: one result per lane per cycle.
// Stall: none.
// Not inlined: the lanes must access one C++ object, so that the compiler sees that their data do not alias.
module fp_convert_gates #(
    parameter  int KIND  = formats_pkg::CONVERT_FORMAT,
    parameter  int EXP   = 8,
    parameter  int MAN   = 23,
    parameter  int P     = 5,
    parameter  int Q     = 10,
    parameter  int CI    = 32,
    parameter  int CO    = 32,
    parameter  int LANES = 1,
    parameter  int CUTS  = 0,
    parameter  bit FLAGS = 0
) (
    input  logic                     clk_i,
    input  logic [LANES-1:0][CI-1:0] a_i,
    output logic [LANES-1:0][CO-1:0] r_o,
    output logic [LANES-1:0][CO-1:0] flags_o
);
  /*verilator no_inline_module*/
  logic [LANES-1:0][CI-1:0] a_q;
  always_ff @(posedge clk_i) a_q <= a_i;
  // Words of a lane (fp_mask.svh). An integer is as wide as its container.
  localparam int LI = (KIND == formats_pkg::CONVERT_FROM_INT) ? P : formats_pkg::lane_word(EXP, MAN, 0);
  localparam int LO = (KIND == formats_pkg::CONVERT_TO_INT) ? P : (KIND == formats_pkg::CONVERT_FROM_INT) ?
      formats_pkg::lane_word(EXP, MAN, 0) : formats_pkg::lane_word(P, Q, 0);
  for (genvar l = 0; l < LANES; l++) begin : g_lane
    logic [LI-1:0] a;
    logic [LO-1:0] r, flags;
    if (LI == CI) begin : g_same_i
      assign a = a_q[l];
    end else begin : g_wider_i
      assign a = {{LI - CI{1'b0}}, a_q[l]};
    end
    assign r_o[l] = r[CO-1:0];
    assign flags_o[l] = flags[CO-1:0];
    if (LO != CO) begin : g_wider_o
      logic unused_high;
      assign unused_high = &{1'b0, r, flags};
    end
    if (KIND == formats_pkg::CONVERT_FORMAT) begin : g_cvt
      fp_cvt_lane #(.EXP(EXP), .MAN(MAN), .EXP_O(P), .MAN_O(Q), .CUTS(CUTS), .FLAGS(FLAGS)) lane (
          .clk_i, .a_i(a), .r_o(r), .flags_o(flags));
    end else if (KIND == formats_pkg::CONVERT_FROM_INT) begin : g_from_int
      fp_from_int_lane #(.EXP(EXP), .MAN(MAN), .CW(P), .UNSIGNED((Q & 1) != 0), .CUTS(CUTS), .FLAGS(FLAGS)) lane (
          .clk_i, .a_i(a), .r_o(r), .flags_o(flags));
    end else begin : g_to_int
      fp_to_int_lane #(.EXP(EXP), .MAN(MAN), .INT(P), .UNSIGNED((Q & 1) != 0), .TRUNCATE((Q & 2) != 0), .CUTS(CUTS),
          .FLAGS(FLAGS)) lane (.clk_i, .a_i(a), .r_o(r), .flags_o(flags));
    end
  end
endmodule
