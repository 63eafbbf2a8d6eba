// SPDX-License-Identifier: Apache-2.0
// Every operation of one format on LANES lanes, for tests, measurements and the `cde fp` command.
// Each operation has its own clock, as behind a clock gate, so that idle operations cost no simulation time.
// Latency: the operation's LAT_*.
// Throughput: one result per lane per cycle.
// Stall: none.
module fp_unit #(
    parameter  int EXP      = 8,      // 3..11
    parameter  int MAN      = 23,     // 2..52
    parameter  int LANES    = 16,     // >= 1
    parameter  int B_LANES  = LANES,  // LANES, or 1: b is one value for all lanes
    parameter      ARITH    = "rtl",  // "rtl" or "host"
    parameter  int CANON    = 1,      // 0 or 1, for arithmetic as in fp_lanes
    parameter  int FLAGS    = 1,      // 0 or 1
    parameter  int LEAST    = 0,      // 0 or 1, for arithmetic as in fp_lanes
    parameter  int OPS      = -1,     // bit k: operation k is present
    parameter  int LAT_ADD  = 1,      // add, sub
    parameter  int LAT_MUL  = 1,
    parameter  int LAT_DIV  = 1,
    parameter  int LAT_SQRT = 1,
    parameter  int LAT_CMP  = 1,      // comparisons, min, max
    parameter  int LAT_CVT  = 1,      // conversions
    localparam int CW       = (1 + EXP + MAN <= 32) ? 32 : 64,
    localparam int CONVERSIONS = formats_pkg::FP_OPS - formats_pkg::FP_TO_FORMAT
) (
    input  logic [formats_pkg::FP_OPS-1:0]  clk_i,  // bit k: clock of operation k, formats_pkg::FP_*
    input  logic [LANES-1:0][CW-1:0]       a_i,
    input  logic [B_LANES-1:0][CW-1:0]     b_i,
    input  logic [LANES-1:0][63:0]         n_i,   // integer operands
    output logic [formats_pkg::FP_ARITHMETIC-1:0][LANES-1:0][CW-1:0]  r_o,
    output logic [formats_pkg::FP_ARITHMETIC-1:0][LANES-1:0][CW-1:0]  f_o,   // their flags
    // Conversions, starting at FP_TO_FORMAT.
    output logic [CONVERSIONS-1:0][LANES-1:0][63:0]  x_o,
    output logic [CONVERSIONS-1:0][LANES-1:0][31:0]  g_o    // their flags
);
  if (formats_pkg::FP_FROM_I32 != formats_pkg::FP_TO_FORMAT + formats_pkg::FORMATS) begin : g_codes
    $error("fp_unit: conversions from integers must follow those to formats");
  end
  logic unused_inputs;  // inputs of operations that OPS omits
  assign unused_inputs = &{1'b0, clk_i, a_i, b_i, n_i};
  for (genvar k = 0; k < formats_pkg::FP_ARITHMETIC; k++) begin : g_op
    localparam int LAT = (k <= formats_pkg::FP_SUB) ? LAT_ADD : (k == formats_pkg::FP_MUL) ? LAT_MUL :
        (k == formats_pkg::FP_DIV) ? LAT_DIV : (k == formats_pkg::FP_SQRT) ? LAT_SQRT : LAT_CMP;
    if (OPS[k]) begin : g_en
      logic [LANES-1:0][CW-1:0] r, f;
      fp_lanes #(.OP(k), .EXP(EXP), .MAN(MAN), .LANES(LANES), .B_LANES(B_LANES), .LAT(LAT), .ARITH(ARITH),
          .CANON(CANON != 0),
          .FLAGS(FLAGS != 0), .LEAST(LEAST != 0)) lanes (
          .clk_i(clk_i[k]), .en_i(1'b1), .a_i, .b_i, .r_o(r), .flags_o(f));
      // The host back end is combinational. Here it gets the timing of the gates.
      fp_delay #(.LANES(LANES), .W(CW), .DEPTH(ARITH != "rtl" ? LAT : 0))
          delay_r (.clk_i(clk_i[k]), .d_i(r), .q_o(r_o[k]));
      fp_delay #(.LANES(LANES), .W(CW), .DEPTH(ARITH != "rtl" ? LAT : 0))
          delay_f (.clk_i(clk_i[k]), .d_i(f), .q_o(f_o[k]));
    end else begin : g_off
      assign r_o[k] = '0;
      assign f_o[k] = '0;
    end
  end

  for (genvar k = 0; k < CONVERSIONS; k++) begin : g_convert
    localparam int OP = formats_pkg::FP_TO_FORMAT + k;
    localparam int EXP_O = formats_pkg::format_exp(k % formats_pkg::FORMATS), MAN_O =
        formats_pkg::format_man(k % formats_pkg::FORMATS);
    // Conversions from and to integers are in groups of four: i32, ui32, i64, ui64.
    localparam int GROUP = k - formats_pkg::FORMATS;
    localparam int INT = ((GROUP / 2) % 2 == 1) ? 64 : 32;
    localparam bit UNSIGNED = GROUP % 2 == 1;
    localparam int CO = (k < formats_pkg::FORMATS) ? formats_pkg::container(EXP_O, MAN_O) :
        (OP < formats_pkg::FP_TO_I32) ? CW : INT;
    if (OPS[OP]) begin : g_en
      logic [LANES-1:0][CO-1:0] r, f;
      if (k < formats_pkg::FORMATS) begin : g_cvt
        fp_cvt #(.EXP_I(EXP), .MAN_I(MAN), .EXP_O(EXP_O), .MAN_O(MAN_O), .LANES(LANES), .LAT(LAT_CVT), .ARITH(ARITH),
            .FLAGS(FLAGS != 0)) cvt (.clk_i(clk_i[OP]), .a_i, .r_o(r), .flags_o(f));
      end else if (OP < formats_pkg::FP_TO_I32) begin : g_from_int
        logic [LANES-1:0][INT-1:0] n;
        for (genvar l = 0; l < LANES; l++) begin : g_operand
          assign n[l] = n_i[l][INT-1:0];
        end
        fp_from_int #(.EXP(EXP), .MAN(MAN), .INT(INT), .UNSIGNED(UNSIGNED), .LANES(LANES), .LAT(LAT_CVT),
            .ARITH(ARITH),
            .FLAGS(FLAGS != 0)) from_int (.clk_i(clk_i[OP]), .a_i(n), .r_o(r), .flags_o(f));
      end else begin : g_to_int
        fp_to_int #(.EXP(EXP), .MAN(MAN), .INT(INT), .UNSIGNED(UNSIGNED),
            .TRUNCATE(OP >= formats_pkg::FP_TO_I32_TRUNC), .LANES(LANES), .LAT(LAT_CVT),
            .ARITH(ARITH), .FLAGS(FLAGS != 0)) to_int (.clk_i(clk_i[OP]), .a_i, .r_o(r), .flags_o(f));
      end
      for (genvar l = 0; l < LANES; l++) begin : g_result
        if (CO == 64) begin : g_64
          assign x_o[k][l] = r[l];
        end else begin : g_32
          assign x_o[k][l] = {32'd0, r[l]};
        end
        assign g_o[k][l] = f[l][31:0];
      end
      if (CO == 64) begin : g_high
        logic unused_flags;
        assign unused_flags = &{1'b0, f};
      end
    end else begin : g_off
      assign x_o[k] = '0;
      assign g_o[k] = '0;
    end
  end
endmodule
