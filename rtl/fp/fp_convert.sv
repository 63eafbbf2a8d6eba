// SPDX-License-Identifier: Apache-2.0
// A conversion on LANES lanes, with the back end that ARITH names. fp_cvt, fp_from_int and fp_to_int are built on it.
// Latency: LAT cycles.
// Throughput: one result per lane per cycle.
// Stall: none, runs free.
module fp_convert #(
    parameter  int KIND  = formats_pkg::CONVERT_FORMAT,  // CONVERT_*
    parameter  int EXP   = 8,      // 3..11; the floating-point format, with CONVERT_FORMAT the operand's
    parameter  int MAN   = 23,     // 2..52
    parameter  int P     = 5,      // CONVERT_FORMAT: EXP of the result; else bits of the integer, 32 or 64
    parameter  int Q     = 10,     // CONVERT_FORMAT: MAN of the result; else bit 0: unsigned, bit 1: truncate
    parameter  int CI    = 32,     // container bits of operand and result
    parameter  int CO    = 32,
    parameter  int LANES = 1,      // >= 1
    parameter  int LAT   = 1,      // >= 1; up to 3 register cuts (to integer: 2), the rest is delay at the output
    parameter      ARITH = "rtl",  // "rtl" or "host"
    parameter  bit FLAGS = 0
) (
    input  logic                     clk_i,
    input  logic [LANES-1:0][CI-1:0] a_i,
    output logic [LANES-1:0][CO-1:0] r_o,
    output logic [LANES-1:0][CO-1:0] flags_o
);
  /*verilator inline_module*/
  if (EXP < 3 || EXP > 11 || MAN < 2 || MAN > 52) $error("fp: EXP must be 3..11 and MAN 2..52");
  if (KIND == formats_pkg::CONVERT_FORMAT ? (P < 3 || P > 11 || Q < 2 || Q > 52) : (P != 32 && P != 64))
      $error("fp: bad format or integer width");
  if (LANES < 1 || LAT < 1) $error("fp: LANES and LAT must be at least 1");
  localparam int MOST = (ARITH == "rtl") ? (KIND == formats_pkg::CONVERT_TO_INT ? 1 : 2) : 0;
  localparam int CUTS = (LAT - 1 > MOST) ? MOST : LAT - 1;
  logic [LANES-1:0][CO-1:0] r, flags;
  if (ARITH == "rtl") begin : g_rtl
    fp_convert_gates #(.KIND(KIND), .EXP(EXP), .MAN(MAN), .P(P), .Q(Q), .CI(CI), .CO(CO), .LANES(LANES), .CUTS(CUTS),
        .FLAGS(FLAGS)) gates (
        .clk_i, .a_i, .r_o(r), .flags_o(flags));
  end else begin : g_host
`ifdef VERILATOR
    for (genvar l = 0; l < LANES; l++) begin : g_lane
      if (CO == 32) begin : g_32
        always_ff @(posedge clk_i) r[l] <= $c32("host_fp::convert<", KIND, ",", EXP, ",", MAN, ",", P, ",", Q, ">(",
            a_i[l], ")");
      end else begin : g_64
        always_ff @(posedge clk_i) r[l] <= $c64("host_fp::convert<", KIND, ",", EXP, ",", MAN, ",", P, ",", Q, ">(",
            a_i[l], ")");
      end
      if (!FLAGS) begin : g_no_flags
        assign flags[l] = '0;
      end else if (CO == 32) begin : g_f32
        always_ff @(posedge clk_i) flags[l] <= $c32("host_fp::convert_flags<", KIND, ",", EXP, ",", MAN, ",", P, ",", Q,
            ">(", a_i[l], ")");
      end else begin : g_f64
        always_ff @(posedge clk_i) flags[l] <= $c64("host_fp::convert_flags<", KIND, ",", EXP, ",", MAN, ",", P, ",", Q,
            ">(", a_i[l], ")");
      end
    end
`else
    $error("fp: ARITH = \"host\" exists only under Verilator");
`endif
  end
  fp_delay #(.LANES(LANES), .W(CO), .DEPTH(LAT - 1 - CUTS)) delay_r (.clk_i, .d_i(r), .q_o(r_o));
  if (FLAGS) begin : g_flags
    fp_delay #(.LANES(LANES), .W(CO), .DEPTH(LAT - 1 - CUTS)) delay_f (.clk_i, .d_i(flags), .q_o(flags_o));
  end else begin : g_no_flags
    logic unused_flags;
    assign unused_flags = &{1'b0, flags};
    assign flags_o = '0;
  end
endmodule
