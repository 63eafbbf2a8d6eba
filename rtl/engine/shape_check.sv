// SPDX-License-Identifier: Apache-2.0
// Input contract of a shape (pairs_pkg::SHAPE_*). Every word must be finite; tmin and tmax may be infinite but not NaN.
// Coordinates are at most 2^length_high. Sizes and a direction's largest component are from 2^length_low to
// 2^length_high, and max is above min. Unit vectors and rotations hold |a.b - (0 or 1)| <= 2^-20, or 16 u in formats
// too coarse for that.
// Latency: LAT.mul + 3*LAT.add + LAT.cmp cycles for any shape; 0 with ARITH = "host".
// Throughput: LANES shapes per cycle.
// Stall: none.
`include "dataflow.svh"
module shape_check #(
    parameter int SHAPE = 0,
    parameter int EXP = 8,
    parameter int MAN = 23,
    parameter int LANES = 1,
    parameter latency_pkg::latency_t LAT = latency_pkg::ONES,
    parameter ARITH = "rtl",
    localparam int CW = (1 + EXP + MAN <= 32) ? 32 : 64,
    localparam int WORDS = pairs_pkg::shape_words(SHAPE)
) (
    input logic clk_i,
    input logic en_i,  // 0: no reader uses the result
    input logic [WORDS-1:0][LANES-1:0][CW-1:0] words_i,
    output logic [LANES-1:0][CW-1:0] bad_o  // lane mask
);
  /*verilator inline_module*/
  localparam int LATENCY = LAT.mul + 3 * LAT.add + LAT.cmp;
  localparam int LOW = formats_pkg::length_low(EXP, MAN);
  localparam int HIGH = formats_pkg::length_high(EXP);
  // First word of a unit vector, before or after a point; -1 if there is none.
  localparam int UNIT = (pairs_pkg::word_kind(SHAPE, 0) == pairs_pkg::WORD_PURE) ? 0 :
      (pairs_pkg::word_kind(SHAPE, 3) == pairs_pkg::WORD_PURE) ? 3 : -1;

  // ---- Each word alone ----
  for (genvar k = 0; k < WORDS; k++) begin : word
    localparam int KIND = pairs_pkg::word_kind(SHAPE, k);
    logic [LANES-1:0][CW-1:0] legal, good;  // good: this word and those below
    if (KIND == pairs_pkg::WORD_INTERVAL) begin : g_interval
      logic [LANES-1:0][CW-1:0] nan;
      fp_class #(.EXP(EXP), .MAN(MAN), .LANES(LANES), .OP(formats_pkg::CLASS_NAN),
          .ARITH(ARITH)) is_nan (.a_i(words_i[k]), .m_o(nan));
      assign legal = ~nan;
    end else if (KIND == pairs_pkg::WORD_PURE) begin : g_pure
      fp_class #(.EXP(EXP), .MAN(MAN), .LANES(LANES), .OP(formats_pkg::CLASS_FINITE),
          .ARITH(ARITH)) is_finite (.a_i(words_i[k]), .m_o(legal));
    end else begin : g_length
      fp_range #(
          .EXP(EXP), .MAN(MAN), .LANES(LANES), .SIGNED(KIND == pairs_pkg::WORD_SIZE),
          .ZERO(KIND != pairs_pkg::WORD_SIZE), .LOW(LOW), .HIGH(HIGH), .ARITH(ARITH)
      ) in_range (.en_i, .a_i(words_i[k]), .m_o(legal));
    end
    if (k == 0) begin : g_first
      assign good = legal;
    end else begin : g_next
      assign good = word[k-1].good & legal;
    end
  end

  // ---- Checks that need arithmetic. Results for each word alone wait, in a register first: a delay line may be a
  // memory far away ----
  logic [LANES-1:0][CW-1:0] shape_good, words_good;
  `DF_IN(all_words, word[WORDS-1].good, 0)
  `DF_AT(early_words, all_words, 1)
  `DF_AT(late_words, early_words, LATENCY)
  assign words_good = late_words;
  if (pairs_pkg::word_kind(SHAPE, 3) == pairs_pkg::WORD_DIRECTION) begin : g_direction
    logic [2:0][LANES-1:0][CW-1:0] m;
    for (genvar k = 0; k < 3; k++) begin : axis
      fp_range #(.EXP(EXP), .MAN(MAN), .LANES(LANES), .LOW(LOW), .HIGH(HIGH), .ARITH(ARITH)) is_size (.en_i,
          .a_i(words_i[3+k]), .m_o(m[k]));
    end
    `DF_IN(moves, m[0] | m[1] | m[2], 0)
    `DF_AT(early, moves, 1)
    `DF_AT(late, early, LATENCY)
    assign shape_good = late;
  end else if (SHAPE == pairs_pkg::SHAPE_AABB) begin : g_box
    `DF_VIN(low, words_i[2:0], 0)
    `DF_VIN(high, words_i[5:3], 0)
    `DF_BINARY3(ordered, low, high, formats_pkg::FP_LT, LAT.cmp)
    `DF_VAT(late, ordered, LATENCY)
    assign shape_good = late[0] & late[1] & late[2];
  end else if (UNIT >= 0) begin : g_unit
    unit_check #(.ONE(1), .EXP(EXP), .MAN(MAN), .LANES(LANES), .LAT(LAT),
        .ARITH(ARITH)) unit (
        .clk_i, .en_i, .a_i(words_i[UNIT+:3]), .b_i(words_i[UNIT+:3]), .good_o(shape_good));
  end else if (SHAPE == pairs_pkg::SHAPE_OBB) begin : g_rotation
    logic [5:0][LANES-1:0][CW-1:0] dot_good;  // dot products of the upper triangle, row by row
    for (genvar i = 0; i < 3; i++) begin : row
      for (genvar j = i; j < 3; j++) begin : column
        unit_check #(.ONE(i == j), .EXP(EXP), .MAN(MAN), .LANES(LANES), .LAT(LAT), .ARITH(ARITH)) unit (
            .clk_i, .en_i, .a_i({words_i[12+i], words_i[9+i], words_i[6+i]}), .b_i({words_i[12+j], words_i[9+j],
            words_i[6+j]}),
            .good_o(dot_good[i*(5-i)/2+j]));
      end
    end
    assign shape_good = dot_good[0] & dot_good[1] & dot_good[2] & dot_good[3] & dot_good[4] & dot_good[5];
  end else begin : g_words
    assign shape_good = '1;
  end
  assign bad_o = ~(words_good & shape_good);
endmodule
