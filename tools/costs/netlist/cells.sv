// SPDX-License-Identifier: Apache-2.0
// The cells of an ECP5 netlist as Yosys writes it, for Verilator: what each cell computes, without timing. A parameter
// value that the card's netlist does not use stops the build.

// A planted fault: it inverts a cell's output while fault.cpp names its number (netlist.py).
module fault #(parameter NUMBER = 1) (input sound, output net);
  import "DPI-C" function int cde_netlist_fault();
  bit on;
  initial on = cde_netlist_fault() == NUMBER;
  assign net = sound ^ on;
endmodule

module LUT4 #(parameter [15:0] INIT = 0) (input A, B, C, D, output Z);
  assign Z = INIT[{D, C, B, A}];
endmodule

module PFUMX (input ALUT, BLUT, C0, output Z);
  assign Z = C0 ? ALUT : BLUT;
endmodule

module L6MUX21 (input D0, D1, SD, output Z);
  assign Z = SD ? D1 : D0;
endmodule

// Two bits of a carry chain. INJECT "YES" cuts the carry in.
module CCU2C #(parameter [15:0] INIT0 = 0, INIT1 = 0, parameter INJECT1_0 = "YES", INJECT1_1 = "YES")
    (input CIN, A0, B0, C0, D0, A1, B1, C1, D1, output S0, S1, COUT);
  wire propagate_0 = INIT0[{D0, C0, B0, A0}], propagate_1 = INIT1[{D1, C1, B1, A1}];
  wire generate_0 = INIT0[{2'b00, B0, A0}], generate_1 = INIT1[{2'b00, B1, A1}];
  wire between = propagate_0 ? CIN : (INJECT1_0 != "YES" && generate_0);
  assign S0 = propagate_0 ^ (INJECT1_0 != "YES" && CIN);
  assign S1 = propagate_1 ^ (INJECT1_1 != "YES" && between);
  assign COUT = propagate_1 ? between : (INJECT1_1 != "YES" && generate_1);
endmodule

module TRELLIS_FF #(parameter GSR = "DISABLED", CEMUX = "1", CLKMUX = "CLK", LSRMUX = "LSR", SRMODE = "LSR_OVER_CE",
    REGSET = "RESET") (input CLK, LSR, CE, DI, output reg Q);
  if (CLKMUX != "CLK" || (SRMODE != "LSR_OVER_CE" && SRMODE != "CE_OVER_LSR") || (CEMUX != "1" && CEMUX != "CE" &&
      CEMUX != "INV") || (LSRMUX != "LSR" && LSRMUX != "INV")) $error("TRELLIS_FF: unknown parameter");
  wire enabled = CEMUX == "1" || CE == (CEMUX == "CE");
  wire reset = LSR == (LSRMUX == "LSR");
  always @(posedge CLK)
    if (reset && (SRMODE == "LSR_OVER_CE" || enabled)) Q <= REGSET == "SET";
    else if (enabled) Q <= DI;
endmodule

module TRELLIS_DPR16X4 #(parameter WCKMUX = "WCK", WREMUX = "WRE", parameter [63:0] INITVAL = 0)
    (input [3:0] DI, WAD, RAD, input WRE, WCK, output [3:0] DO);
  if (WCKMUX != "WCK" || (WREMUX != "WRE" && WREMUX != "INV")) $error("TRELLIS_DPR16X4: unknown parameter");
  reg [3:0] words[16];
  always @(posedge WCK) if (WRE == (WREMUX == "WRE")) words[WAD] <= DI;
  assign DO = words[RAD];
endmodule

// A multiplier block without registers.
module MULT18X18D #(parameter REG_INPUTA_CLK = "NONE", REG_INPUTB_CLK = "NONE", REG_PIPELINE_CLK = "NONE",
    REG_OUTPUT_CLK = "NONE", SOURCEB_MODE = "B_SHIFT", MULT_BYPASS = "DISABLED", RESETMODE = "ASYNC", GSR = "ENABLED")
    (input A0, A1, A2, A3, A4, A5, A6, A7, A8, A9, A10, A11, A12, A13, A14, A15, A16, A17,
     B0, B1, B2, B3, B4, B5, B6, B7, B8, B9, B10, B11, B12, B13, B14, B15, B16, B17,
     C0, C1, C2, C3, C4, C5, C6, C7, C8, C9, C10, C11, C12, C13, C14, C15, C16, C17, SOURCEA, SOURCEB,
     SIGNEDA, SIGNEDB, output P0, P1, P2, P3, P4, P5, P6, P7, P8, P9, P10, P11, P12, P13, P14, P15, P16, P17,
     P18, P19, P20, P21, P22, P23, P24, P25, P26, P27, P28, P29, P30, P31, P32, P33, P34, P35);
  if (REG_INPUTA_CLK != "NONE" || REG_INPUTB_CLK != "NONE" || REG_PIPELINE_CLK != "NONE" || REG_OUTPUT_CLK != "NONE")
    $error("MULT18X18D: unknown parameter");
  wire [17:0] a = {A17, A16, A15, A14, A13, A12, A11, A10, A9, A8, A7, A6, A5, A4, A3, A2, A1, A0};
  wire [17:0] b = {B17, B16, B15, B14, B13, B12, B11, B10, B9, B8, B7, B6, B5, B4, B3, B2, B1, B0};
  wire signed [35:0] wide_a = {{18{SIGNEDA & a[17]}}, a}, wide_b = {{18{SIGNEDB & b[17]}}, b};
  assign {P35, P34, P33, P32, P31, P30, P29, P28, P27, P26, P25, P24, P23, P22, P21, P20, P19, P18, P17, P16, P15,
      P14, P13, P12, P11, P10, P9, P8, P7, P6, P5, P4, P3, P2, P1, P0} = wide_a * wide_b;
endmodule

// A block memory of 18 kbit. With DATA_WIDTH_A = 36, port A writes and port B reads, and the lowest address bits of
// port A are write enables of 9 bits. A read of a word that the other port writes in that cycle gives wrong bits, so a
// netlist that relies on them is noticed.
module DP16KD #(parameter DATA_WIDTH_A = 18, DATA_WIDTH_B = 18, REGMODE_A = "NOREG", REGMODE_B = "NOREG",
    RESETMODE = "SYNC", ASYNC_RESET_RELEASE = "SYNC", CSDECODE_A = "0b000", CSDECODE_B = "0b000", CLKAMUX = "CLKA",
    CLKBMUX = "CLKB", WRITEMODE_A = "NORMAL", WRITEMODE_B = "NORMAL", GSR = "AUTO",
    parameter [319:0]
    INITVAL_00 = 0, INITVAL_01 = 0, INITVAL_02 = 0, INITVAL_03 = 0, INITVAL_04 = 0, INITVAL_05 = 0, INITVAL_06 = 0,
    INITVAL_07 = 0,
    INITVAL_08 = 0, INITVAL_09 = 0, INITVAL_0A = 0, INITVAL_0B = 0, INITVAL_0C = 0, INITVAL_0D = 0, INITVAL_0E = 0,
    INITVAL_0F = 0,
    INITVAL_10 = 0, INITVAL_11 = 0, INITVAL_12 = 0, INITVAL_13 = 0, INITVAL_14 = 0, INITVAL_15 = 0, INITVAL_16 = 0,
    INITVAL_17 = 0,
    INITVAL_18 = 0, INITVAL_19 = 0, INITVAL_1A = 0, INITVAL_1B = 0, INITVAL_1C = 0, INITVAL_1D = 0, INITVAL_1E = 0,
    INITVAL_1F = 0,
    INITVAL_20 = 0, INITVAL_21 = 0, INITVAL_22 = 0, INITVAL_23 = 0, INITVAL_24 = 0, INITVAL_25 = 0, INITVAL_26 = 0,
    INITVAL_27 = 0,
    INITVAL_28 = 0, INITVAL_29 = 0, INITVAL_2A = 0, INITVAL_2B = 0, INITVAL_2C = 0, INITVAL_2D = 0, INITVAL_2E = 0,
    INITVAL_2F = 0,
    INITVAL_30 = 0, INITVAL_31 = 0, INITVAL_32 = 0, INITVAL_33 = 0, INITVAL_34 = 0, INITVAL_35 = 0, INITVAL_36 = 0,
    INITVAL_37 = 0,
    INITVAL_38 = 0, INITVAL_39 = 0, INITVAL_3A = 0, INITVAL_3B = 0, INITVAL_3C = 0, INITVAL_3D = 0, INITVAL_3E = 0,
    INITVAL_3F = 0)
    (input CLKA, WEA, CEA, OCEA, RSTA, CSA0, CSA1, CSA2, CLKB, WEB, CEB, OCEB, RSTB, CSB0, CSB1, CSB2,
     ADA0, ADA1, ADA2, ADA3, ADA4, ADA5, ADA6, ADA7, ADA8, ADA9, ADA10, ADA11, ADA12, ADA13,
     ADB0, ADB1, ADB2, ADB3, ADB4, ADB5, ADB6, ADB7, ADB8, ADB9, ADB10, ADB11, ADB12, ADB13,
     DIA0, DIA1, DIA2, DIA3, DIA4, DIA5, DIA6, DIA7, DIA8, DIA9, DIA10, DIA11, DIA12, DIA13, DIA14, DIA15, DIA16,
         DIA17,
     DIB0, DIB1, DIB2, DIB3, DIB4, DIB5, DIB6, DIB7, DIB8, DIB9, DIB10, DIB11, DIB12, DIB13, DIB14, DIB15, DIB16,
         DIB17,
     output DOA0, DOA1, DOA2, DOA3, DOA4, DOA5, DOA6, DOA7, DOA8, DOA9, DOA10, DOA11, DOA12, DOA13, DOA14, DOA15,
         DOA16, DOA17,
     DOB0, DOB1, DOB2, DOB3, DOB4, DOB5, DOB6, DOB7, DOB8, DOB9, DOB10, DOB11, DOB12, DOB13, DOB14, DOB15, DOB16,
         DOB17);
  localparam WIDE = DATA_WIDTH_A == 36 || DATA_WIDTH_B == 36;
  if (REGMODE_A != "NOREG" || REGMODE_B != "NOREG" || CLKAMUX != "CLKA" || CLKBMUX != "CLKB" || (WRITEMODE_A !=
      "NORMAL" && WRITEMODE_A != "READBEFOREWRITE") || WRITEMODE_B != WRITEMODE_A || DATA_WIDTH_A != DATA_WIDTH_B ||
      {INITVAL_00, INITVAL_01, INITVAL_02, INITVAL_03, INITVAL_04, INITVAL_05, INITVAL_06, INITVAL_07,
      INITVAL_08, INITVAL_09, INITVAL_0A, INITVAL_0B, INITVAL_0C, INITVAL_0D, INITVAL_0E, INITVAL_0F,
      INITVAL_10, INITVAL_11, INITVAL_12, INITVAL_13, INITVAL_14, INITVAL_15, INITVAL_16, INITVAL_17,
      INITVAL_18, INITVAL_19, INITVAL_1A, INITVAL_1B, INITVAL_1C, INITVAL_1D, INITVAL_1E, INITVAL_1F,
      INITVAL_20, INITVAL_21, INITVAL_22, INITVAL_23, INITVAL_24, INITVAL_25, INITVAL_26, INITVAL_27,
      INITVAL_28, INITVAL_29, INITVAL_2A, INITVAL_2B, INITVAL_2C, INITVAL_2D, INITVAL_2E, INITVAL_2F,
      INITVAL_30, INITVAL_31, INITVAL_32, INITVAL_33, INITVAL_34, INITVAL_35, INITVAL_36, INITVAL_37,
      INITVAL_38, INITVAL_39, INITVAL_3A, INITVAL_3B, INITVAL_3C, INITVAL_3D, INITVAL_3E, INITVAL_3F} != 20480'd0)
      $error("DP16KD: unknown parameter");
  wire [13:0] address_a = {ADA13, ADA12, ADA11, ADA10, ADA9, ADA8, ADA7, ADA6, ADA5, ADA4, ADA3, ADA2, ADA1, ADA0};
  wire [13:0] address_b = {ADB13, ADB12, ADB11, ADB10, ADB9, ADB8, ADB7, ADB6, ADB5, ADB4, ADB3, ADB2, ADB1, ADB0};
  wire [17:0] in_a = {DIA17, DIA16, DIA15, DIA14, DIA13, DIA12, DIA11, DIA10, DIA9, DIA8, DIA7, DIA6, DIA5, DIA4,
      DIA3, DIA2, DIA1, DIA0};
  wire [17:0] in_b = {DIB17, DIB16, DIB15, DIB14, DIB13, DIB12, DIB11, DIB10, DIB9, DIB8, DIB7, DIB6, DIB5, DIB4,
      DIB3, DIB2, DIB1, DIB0};
  reg [17:0] out_a, out_b;
  assign {DOA17, DOA16, DOA15, DOA14, DOA13, DOA12, DOA11, DOA10, DOA9, DOA8, DOA7, DOA6, DOA5, DOA4, DOA3, DOA2,
      DOA1, DOA0} = out_a;
  assign {DOB17, DOB16, DOB15, DOB14, DOB13, DOB12, DOB11, DOB10, DOB9, DOB8, DOB7, DOB6, DOB5, DOB4, DOB3, DOB2,
      DOB1, DOB0} = out_b;
  if (WIDE) begin : g_wide
    reg [35:0] words[512];
    wire [8:0] to = address_a[13:5], from = address_b[13:5];
    wire [3:0] enable = {4{CEA && WEA}} & address_a[3:0];
    wire [35:0] in = {in_b, in_a};
    wire [35:0] wrong = (enable != 0 && to == from) ? {{9{enable[3]}}, {9{enable[2]}}, {9{enable[1]}},
        {9{enable[0]}}} : 36'd0;
    always @(posedge CLKA)
      for (int k = 0; k < 4; k++) if (enable[k]) words[to][9*k+:9] <= in[9*k+:9];
    always @(posedge CLKB)
      if (RSTB) {out_b, out_a} <= 0;
      else if (CEB) {out_b, out_a} <= words[from] ^ wrong;
  end else begin : g_both
    localparam STEP = DATA_WIDTH_A == 18 ? 16 : DATA_WIDTH_A == 9 ? 8 : DATA_WIDTH_A;
    localparam WORDS = 16384 / STEP;
    localparam LOW = $clog2(STEP);
    reg [DATA_WIDTH_A-1:0] words[WORDS];
    wire [$clog2(WORDS)-1:0] word_a = address_a[13:LOW], word_b = address_b[13:LOW];
    wire [1:0] enable_a = {2{CEA && WEA}} & (DATA_WIDTH_A == 18 ? address_a[1:0] : 2'b11);
    wire [1:0] enable_b = {2{CEB && WEB}} & (DATA_WIDTH_A == 18 ? address_b[1:0] : 2'b11);
    wire same = word_a == word_b;
    localparam OLD = WRITEMODE_A == "READBEFOREWRITE";  // a port reads the word that it replaces
    always @(posedge CLKA) begin
      for (int k = 0; k < DATA_WIDTH_A; k++) begin
        if (enable_a[k/9]) words[word_a][k] <= in_a[k];
        if (enable_b[k/9]) words[word_b][k] <= in_b[k];
      end
      if (RSTA) out_a <= 0;
      else if (CEA && (!WEA || OLD)) out_a <= 18'(words[word_a] ^ {DATA_WIDTH_A{same && enable_b != 0}});
      if (RSTB) out_b <= 0;
      else if (CEB && (!WEB || OLD)) out_b <= 18'(words[word_b] ^ {DATA_WIDTH_A{same && enable_a != 0}});
    end
  end
endmodule
