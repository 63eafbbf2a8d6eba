// Every operation of one format on LANES lanes, for tests, measurements and the `cde fp` command. Each operation has a
// clock of its own, as behind a clock gate, so that idle operations cost nothing.
// Latency: LAT_* clocks of the operation. Throughput: one result a lane a clock. Stall: none.
module fp_unit #(
    parameter  int EXP      = 8,      // 3..11
    parameter  int MAN      = 23,     // 2..52
    parameter  int LANES    = 16,     // >= 1
    parameter  int B_LANES  = LANES,  // LANES, or 1: b is one value for all lanes
    parameter      ARITH    = "rtl",  // "rtl" or "host"
    parameter  int CANON    = 1,      // 0 or 1, of arithmetic as in fp_lanes
    parameter  int FLAGS    = 1,      // 0 or 1
    parameter  int OPS      = -1,     // bit k: clock k's operation is there
    parameter  int LAT_ADD  = 1,      // add, sub
    parameter  int LAT_MUL  = 1,
    parameter  int LAT_DIV  = 1,
    parameter  int LAT_SQRT = 1,
    parameter  int LAT_CMP  = 1,      // comparisons, min, max
    parameter  int LAT_CVT  = 1,      // conversions
    localparam int CW       = (1 + EXP + MAN <= 32) ? 32 : 64
) (
    // 0 add, 1 sub, 2 mul, 3 div, 4 sqrt, 5 lt, 6 le, 7 eq, 8 min, 9 max, then the conversions as in x_o.
    input  logic [29:0]                    clk_i,
    input  logic [LANES-1:0][CW-1:0]       a_i,
    input  logic [B_LANES-1:0][CW-1:0]     b_i,
    input  logic [LANES-1:0][63:0]         n_i,   // integer operands
    output logic [9:0][LANES-1:0][CW-1:0]  r_o,
    output logic [9:0][LANES-1:0][CW-1:0]  f_o,   // their flags
    // 0..7 to fp16 bf16 tf32 fp24 fp32 fp64 e4m3 e3m2; 8..11 from i32 ui32 i64 ui64; 12..15 to i32 ui32 i64 ui64,
    // nearest even; 16..19 the same toward zero.
    output logic [19:0][LANES-1:0][63:0]   x_o,
    output logic [19:0][LANES-1:0][31:0]   g_o    // their flags
);
  logic unused_inputs;  // of operations that OPS leaves out
  assign unused_inputs = &{1'b0, clk_i, a_i, b_i, n_i};
  for (genvar k = 0; k < 10; k++) begin : g_op
    localparam int LAT = (k <= 1) ? LAT_ADD : (k == 2) ? LAT_MUL : (k == 3) ? LAT_DIV : (k == 4) ? LAT_SQRT : LAT_CMP;
    if (OPS[k]) begin : g_on
      logic [LANES-1:0][CW-1:0] r, f;
      fp_lanes #(.OP(k), .EXP(EXP), .MAN(MAN), .LANES(LANES), .B_LANES(B_LANES), .LAT(LAT), .ARITH(ARITH),
          .CANON(CANON != 0),
          .FLAGS(FLAGS != 0)) lanes (
          .clk_i(clk_i[k]), .on_i(1'b1), .a_i, .b_i, .r_o(r), .flags_o(f));
      // The host back end is combinational; here it gets the timing of the gates.
      fp_delay #(.LANES(LANES), .W(CW), .DEPTH(ARITH != "rtl" ? LAT : 0))
          delay_r (.clk_i(clk_i[k]), .d_i(r), .q_o(r_o[k]));
      fp_delay #(.LANES(LANES), .W(CW), .DEPTH(ARITH != "rtl" ? LAT : 0))
          delay_f (.clk_i(clk_i[k]), .d_i(f), .q_o(f_o[k]));
    end else begin : g_off
      assign r_o[k] = '0;
      assign f_o[k] = '0;
    end
  end

  localparam logic [7:0][31:0] EXPS = {32'd3, 32'd4, 32'd11, 32'd8, 32'd7, 32'd8, 32'd8, 32'd5};
  localparam logic [7:0][31:0] MANS = {32'd2, 32'd3, 32'd52, 32'd23, 32'd16, 32'd10, 32'd7, 32'd10};
  for (genvar k = 0; k < 20; k++) begin : g_convert
    localparam int INT = ((k / 2) % 2 == 1) ? 64 : 32;
    localparam int CO = (k < 8) ? ((1 + EXPS[k%8] + MANS[k%8] <= 32) ? 32 : 64) : (k < 12) ? CW : INT;
    if (OPS[10+k]) begin : g_on
      logic [LANES-1:0][CO-1:0] r, f;
      if (k < 8) begin : g_cvt
        fp_cvt #(.EXP_I(EXP), .MAN_I(MAN), .EXP_O(EXPS[k]), .MAN_O(MANS[k]), .LANES(LANES), .LAT(LAT_CVT),
            .ARITH(ARITH),
            .FLAGS(FLAGS != 0)) cvt (.clk_i(clk_i[10+k]), .a_i, .r_o(r), .flags_o(f));
      end else if (k < 12) begin : g_from_int
        logic [LANES-1:0][INT-1:0] n;
        for (genvar l = 0; l < LANES; l++) begin : g_operand
          assign n[l] = n_i[l][INT-1:0];
        end
        fp_from_int #(.EXP(EXP), .MAN(MAN), .INT(INT), .UNSIGNED(k % 2 == 1), .LANES(LANES), .LAT(LAT_CVT),
            .ARITH(ARITH),
            .FLAGS(FLAGS != 0)) from_int (.clk_i(clk_i[10+k]), .a_i(n), .r_o(r), .flags_o(f));
      end else begin : g_to_int
        fp_to_int #(.EXP(EXP), .MAN(MAN), .INT(INT), .UNSIGNED(k % 2 == 1), .TRUNCATE(k >= 16), .LANES(LANES),
            .LAT(LAT_CVT),
            .ARITH(ARITH), .FLAGS(FLAGS != 0)) to_int (.clk_i(clk_i[10+k]), .a_i, .r_o(r), .flags_o(f));
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
