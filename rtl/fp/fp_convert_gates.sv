// Gate back end of the conversions: lanes behind their input registers. Parameters as in fp_convert.
// Latency: 1 + CUTS clocks. Throughput: one result a lane a clock. Stall: none.
// Not inlined: all that the lanes touch must lie in one C++ object for the compiler to see that they do not alias.
module fp_convert_gates #(
    parameter  int KIND  = 0,
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
  for (genvar l = 0; l < LANES; l++) begin : g_lane
    if (KIND == 0) begin : g_cvt
      fp_cvt_lane #(.EXP(EXP), .MAN(MAN), .EXP_O(P), .MAN_O(Q), .CUTS(CUTS), .FLAGS(FLAGS)) lane (
          .clk_i, .a_i(a_q[l]), .r_o(r_o[l]), .flags_o(flags_o[l]));
    end else if (KIND == 1) begin : g_from_int
      fp_from_int_lane #(.EXP(EXP), .MAN(MAN), .CW(P), .UNSIGNED((Q & 1) != 0), .CUTS(CUTS), .FLAGS(FLAGS)) lane (
          .clk_i, .a_i(a_q[l]), .r_o(r_o[l]), .flags_o(flags_o[l]));
    end else begin : g_to_int
      fp_to_int_lane #(.EXP(EXP), .MAN(MAN), .INT(P), .UNSIGNED((Q & 1) != 0), .TRUNCATE((Q & 2) != 0), .CUTS(CUTS),
          .FLAGS(FLAGS)) lane (.clk_i, .a_i(a_q[l]), .r_o(r_o[l]), .flags_o(flags_o[l]));
    end
  end
endmodule
