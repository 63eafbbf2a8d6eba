// SPDX-License-Identifier: Apache-2.0
// Proposes a normal that may separate A and B, by the pair's pipe in a narrow format. All words are relative to A's
// origin, multiplied by 2^-k with k the exponent of S, and rounded. The result is the narrow pipe's n, as wide numbers.
// It need not be right, because filter_proof.sv checks it.
// Reference: `host/include/cde/reference/filter/proposal.hpp`.
// Latency: latency_o; 0 with ARITH = "host".
// Throughput: LANES pairs per cycle.
// Stall: none, runs free.
`include "filter.svh"
module filter_proposal #(
    `DF_PARAMETERS,
    parameter int PAIR = int'(pairs_pkg::PAIR_SPHERE_SPHERE),
    parameter int NARROW_EXP = 5,
    parameter int NARROW_MAN = 10,
    localparam int SHAPE_A = pairs_pkg::primary_shape(PAIR),
    localparam int SHAPE_B = pairs_pkg::secondary_shape(PAIR),
    localparam int A_WORDS = pairs_pkg::shape_words(SHAPE_A),
    localparam int B_WORDS = pairs_pkg::shape_words(SHAPE_B),
    localparam int NW = formats_pkg::container(NARROW_EXP, NARROW_MAN)
) (
    input logic clk_i,
    input logic [A_WORDS-1:0][LANES-1:0][CW-1:0] a_i,
    input logic [B_WORDS-1:0][LANES-1:0][CW-1:0] b_i,
    output logic [2:0][LANES-1:0][CW-1:0] n_o,
    output logic [15:0] latency_o
);
  /*verilator inline_module*/
  localparam int LEAST = formats_pkg::length_low(EXP, MAN);
  localparam int LW = LANES * CW;
  `PAIR_SIZE
  localparam int T_down = T_size + LAT.cmp;
  localparam int T_NARROW = T_down + LAT.add;
  `DF_SCALAR down_early;
  `DF_SCALAR down;
  fp_exponent #(.EXP(EXP), .MAN(MAN), .LANES(LANES), .OP(formats_pkg::EXPONENT_DOWN), .LEAST(LEAST), .ARITH(ARITH))
      shift_down (
      .en_i(1'b1), .a_i(size), .b_i('0), .r_o(down_early));
  pipe_delay #(.W(LW), .FROM(T_size), .TO(T_down), .ARITH(ARITH)) delay_down (.clk_i, .d_i(down_early), .q_o(down));
  logic unused_rest;
  assign unused_rest = &{1'b0, rest_a, rest_b};

  logic [A_WORDS-1:0][LANES-1:0][NW-1:0] a;
  logic [B_WORDS-1:0][LANES-1:0][NW-1:0] b;
  for (genvar k = 0; k < A_WORDS + B_WORDS; k++) begin : word
    localparam bit OF_A = k < A_WORDS;
    localparam int WORD = OF_A ? k : k - A_WORDS;
    localparam int KIND = pairs_pkg::word_kind(OF_A ? SHAPE_A : SHAPE_B, WORD);
    logic [LANES-1:0][CW-1:0] given, moved, scaled;
    logic [LANES-1:0][NW-1:0] narrow;
    if (OF_A) begin : g_a
      assign given = a_i[WORD];
    end else begin : g_b
      assign given = b_i[WORD];
    end
    localparam int T_moved = T_down;
    if (OF_A && WORD < 3) begin : g_origin
      logic unused;
      assign unused = &{1'b0, given};
      assign moved = '0;
    end else if (KIND == pairs_pkg::WORD_COORDINATE) begin : g_coordinate
      `DF_IN(x, given, 0)
      `DF_PICK(o, origin_a, WORD % 3)
      `DF_SUB(relative, x, o)
      `DF_AT(late, relative, T_moved)
      assign moved = late;
    end else begin : g_other
      `DF_IN(x, given, 0)
      `DF_AT(late, x, T_moved)
      assign moved = late;
    end
    if (pairs_pkg::is_length(OF_A ? SHAPE_A : SHAPE_B, WORD)) begin : g_length
      fp_exponent #(.EXP(EXP), .MAN(MAN), .LANES(LANES), .OP(formats_pkg::EXPONENT_MOVE), .ARITH(ARITH)) move (
          .en_i(1'b1), .a_i(moved), .b_i(down), .r_o(scaled));
    end else begin : g_pure
      assign scaled = moved;
    end
    df_format #(.EXP(EXP), .MAN(MAN), .TO_EXP(NARROW_EXP), .TO_MAN(NARROW_MAN), .LANES(LANES), .LAT(LAT.add),
        .ARITH(ARITH)) round (.clk_i, .a_i(scaled), .r_o(narrow));
    if (OF_A) begin : g_to_a
      assign a[WORD] = narrow;
    end else begin : g_to_b
      assign b[WORD] = narrow;
    end
  end

  logic [LANES-1:0][NW-1:0] f, t;
  logic [2:0][LANES-1:0][NW-1:0] cp, n;
  logic [15:0] latency;
  scaled_pipe #(
      .EXP(NARROW_EXP), .MAN(NARROW_MAN), .LANES(LANES), .LAT(LAT), .ARITH(ARITH), .PAIR(PAIR)
  ) pipe (.clk_i, .enter_i(1'b1), .a_i(a), .b_i(b), .f_o(f), .t_o(t), .cp_o(cp), .n_o(n), .latency_o(latency));
  logic unused_pipe;
  assign unused_pipe = &{1'b0, f, t, cp};
  for (genvar k = 0; k < 3; k++) begin : axis
    df_format #(.EXP(NARROW_EXP), .MAN(NARROW_MAN), .TO_EXP(EXP), .TO_MAN(MAN), .LANES(LANES), .LAT(LAT.add),
        .ARITH(ARITH)) widen (.clk_i, .a_i(n[k]), .r_o(n_o[k]));
  end
  assign latency_o = 16'(T_NARROW + LAT.add) + latency;
endmodule
