// SPDX-License-Identifier: Apache-2.0
// Scales a pair to size one by an exact power of two. So products of four lengths neither overflow nor
// underflow, for operands of any size. Every length is multiplied by 2^-k, where k is the largest exponent of both
// shapes' lengths.
// A ray's direction has its own exponent kd, and its interval is multiplied by 2^(kd - k).
// length_unscale.sv scales the result back. Reference: host/include/cde/reference/pipes/scale.hpp.
// Latency: LAT.cmp for the largest exponent plus LAT.cmp for the shift; with a ray, the larger of that and LAT.mul; 0
// with ARITH = "host".
// Throughput: LANES pairs per cycle.
// Stall: none.
`include "dataflow.svh"
module length_scale #(
    `DF_PARAMETERS,
    parameter int SHAPE_A = 0,  // pairs_pkg::SHAPE_*
    parameter int SHAPE_B = 0,
    localparam int A_WORDS = pairs_pkg::shape_words(SHAPE_A),
    localparam int B_WORDS = pairs_pkg::shape_words(SHAPE_B)
) (
    input logic clk_i,
    input logic en_i,  // 0: no reader uses the result
    input logic [A_WORDS-1:0][LANES-1:0][CW-1:0] a_i,
    input logic [B_WORDS-1:0][LANES-1:0][CW-1:0] b_i,
    output logic [A_WORDS-1:0][LANES-1:0][CW-1:0] a_o,
    output logic [B_WORDS-1:0][LANES-1:0][CW-1:0] b_o,
    output logic [LANES-1:0][CW-1:0] back_o,  // shift by 2^k (fp_exponent.sv)
    output logic [LANES-1:0][CW-1:0] t_back_o  // rays: the number 2^(k - kd)
);
  /*verilator inline_module*/
  localparam bit RAY = SHAPE_A == pairs_pkg::SHAPE_RAY;
  localparam int LATENCY = pairs_pkg::scale_latency(RAY, LAT.mul, LAT.cmp);
  localparam int LW = LANES * CW;
  localparam int LEAST = formats_pkg::length_low(EXP, MAN);

  // ---- The largest exponent, by a tree in LAT.cmp cycles: node i takes 2i and 2i + 1; words start at N_LENGTHS ----
  localparam int N_A = pairs_pkg::lengths(SHAPE_A);
  localparam int N_LENGTHS = N_A + pairs_pkg::lengths(SHAPE_B);
  localparam int LEVELS = $clog2(N_LENGTHS);
  for (genvar i = 2 * N_LENGTHS - 1; i > 0; i--) begin : node
    localparam int LEVEL = $clog2(i + 1) - 1;  // 0: the root
    localparam int FROM = (i < N_LENGTHS) ? LAT.cmp * (LEVELS - LEVEL - 1) / LEVELS : 0;
    logic [LANES-1:0][CW-1:0] size, late;
    pipe_delay #(.W(LW), .FROM(FROM), .TO(LAT.cmp * (LEVELS - LEVEL) / LEVELS), .ARITH(ARITH)) delay_size (
        .clk_i, .d_i(size), .q_o(late));
    if (i >= N_LENGTHS + N_A) begin : g_b
      localparam int WORD = pairs_pkg::length_word(SHAPE_B, i - N_LENGTHS - N_A);  // avoids a call in every cycle
      assign size = b_i[WORD];
    end else if (i >= N_LENGTHS) begin : g_a
      localparam int WORD = pairs_pkg::length_word(SHAPE_A, i - N_LENGTHS);
      assign size = a_i[WORD];
    end else begin : g_larger
      fp_exponent #(.EXP(EXP), .MAN(MAN), .LANES(LANES), .OP(formats_pkg::EXPONENT_MAX), .ARITH(ARITH)) larger (
          .en_i, .a_i(node[2*i].late), .b_i(node[2*i+1].late), .r_o(size));
    end
  end
  logic [LANES-1:0][CW-1:0] largest, down, back;
  assign largest = node[1].late;
  fp_exponent #(.EXP(EXP), .MAN(MAN), .LANES(LANES), .OP(formats_pkg::EXPONENT_DOWN), .LEAST(LEAST), .ARITH(ARITH))
      shift_down (
      .en_i, .a_i(largest), .b_i('0), .r_o(down));
  fp_exponent #(.EXP(EXP), .MAN(MAN), .LANES(LANES), .OP(formats_pkg::EXPONENT_UP), .LEAST(LEAST), .ARITH(ARITH))
      shift_back (
      .en_i, .a_i(largest), .b_i('0), .r_o(back));
  pipe_delay #(.W(LW), .FROM(LAT.cmp), .TO(LATENCY), .ARITH(ARITH)) delay_back (.clk_i, .d_i(back), .q_o(back_o));

  // ---- A ray's direction ----
  logic [LANES-1:0][CW-1:0] ray_down, t_scale;  // the shift by 2^-kd, and the number 2^(kd - k)
  if (RAY) begin : g_ray
    localparam logic [CW-1:0] ONE = CW'((1 << (EXP - 1)) - 1) << MAN;
    logic [LANES-1:0][CW-1:0] xy, xy_late, z_late, xyz, steepest, t_back;
    fp_exponent #(.EXP(EXP), .MAN(MAN), .LANES(LANES), .OP(formats_pkg::EXPONENT_MAX), .ARITH(ARITH))
        larger_xy (.en_i, .a_i(a_i[3]), .b_i(a_i[4]), .r_o(xy));
    fp_exponent #(.EXP(EXP), .MAN(MAN), .LANES(LANES), .OP(formats_pkg::EXPONENT_MAX), .ARITH(ARITH))
        larger_xyz (.en_i, .a_i(xy_late), .b_i(z_late), .r_o(xyz));
    pipe_delay #(.W(2 * LW), .FROM(0), .TO(LAT.cmp / 2), .ARITH(ARITH)) delay_xy (
        .clk_i, .d_i({a_i[5], xy}), .q_o({z_late, xy_late}));
    pipe_delay #(.W(LW), .FROM(LAT.cmp / 2), .TO(LAT.cmp), .ARITH(ARITH)) delay_steepest (
        .clk_i, .d_i(xyz), .q_o(steepest));
    fp_exponent #(.EXP(EXP), .MAN(MAN), .LANES(LANES), .OP(formats_pkg::EXPONENT_DOWN), .LEAST(LEAST), .ARITH(ARITH))
        shift_ray (
        .en_i, .a_i(steepest), .b_i('0), .r_o(ray_down));
    always_comb begin
      t_scale = '0;
      t_back = '0;
      for (int l = 0; l < LANES; l++) begin
        t_scale[l] = ONE + down[l] - ray_down[l];
        t_back[l] = ONE + ray_down[l] - down[l];
      end
    end
    pipe_delay #(.W(LW), .FROM(LAT.cmp), .TO(LATENCY), .ARITH(ARITH)) delay_t_back (
        .clk_i, .d_i(t_back), .q_o(t_back_o));
  end else begin : g_solid
    assign {ray_down, t_scale, t_back_o} = '0;
    logic unused;
    assign unused = &{1'b0, ray_down, t_scale};
  end

  // ---- The words: moved one cycle after the shift is known, if there are two cycles ----
  localparam int MOVE = (LATENCY - LAT.cmp > 1) ? LAT.cmp + 1 : LAT.cmp;
  logic [LANES-1:0][CW-1:0] down_late, ray_down_late;
  pipe_delay #(.W(2 * LW), .FROM(LAT.cmp), .TO(MOVE), .ARITH(ARITH)) delay_down (
      .clk_i, .d_i({ray_down, down}), .q_o({ray_down_late, down_late}));
  for (genvar k = 0; k < A_WORDS; k++) begin : word_a
    localparam int KIND = pairs_pkg::word_kind(SHAPE_A, k);
    logic [LANES-1:0][CW-1:0] late, scaled;
    if (KIND == pairs_pkg::WORD_PURE) begin : g_pure
      assign late = '0;
      assign scaled = '0;
      logic unused_word;
      assign unused_word = &{1'b0, late, scaled};
      pipe_delay #(.W(LW), .FROM(0), .TO(LATENCY), .ARITH(ARITH)) delay_word (.clk_i, .d_i(a_i[k]), .q_o(a_o[k]));
    end else begin : g_scaled
      localparam int TIME = (KIND == pairs_pkg::WORD_INTERVAL) ? LAT.cmp : MOVE;
      pipe_delay #(.W(LW), .FROM(0), .TO(TIME), .ARITH(ARITH)) delay_word (.clk_i, .d_i(a_i[k]), .q_o(late));
      if (KIND == pairs_pkg::WORD_INTERVAL) begin : g_interval
        fp_mul #(.EXP(EXP), .MAN(MAN), .LANES(LANES), .LAT(LAT.mul), .ARITH(ARITH)) multiply (
            .clk_i, .a_i(late), .b_i(t_scale), .r_o(scaled), .flags_o());
        pipe_delay #(.W(LW), .FROM(LAT.cmp + LAT.mul), .TO(LATENCY), .ARITH(ARITH))
            delay_scaled (.clk_i, .d_i(scaled), .q_o(a_o[k]));
      end else begin : g_length
        fp_exponent #(.EXP(EXP), .MAN(MAN), .LANES(LANES), .OP(formats_pkg::EXPONENT_MOVE), .ARITH(ARITH)) move (
            .en_i, .a_i(late), .b_i((KIND == pairs_pkg::WORD_DIRECTION) ? ray_down_late : down_late), .r_o(scaled));
        pipe_delay #(.W(LW), .FROM(MOVE), .TO(LATENCY), .ARITH(ARITH)) delay_scaled (
            .clk_i, .d_i(scaled), .q_o(a_o[k]));
      end
    end
  end
  for (genvar k = 0; k < B_WORDS; k++) begin : word_b
    if (pairs_pkg::is_length(SHAPE_B, k)) begin : g_length
      logic [LANES-1:0][CW-1:0] late, scaled;
      pipe_delay #(.W(LW), .FROM(0), .TO(MOVE), .ARITH(ARITH)) delay_word (.clk_i, .d_i(b_i[k]), .q_o(late));
      fp_exponent #(.EXP(EXP), .MAN(MAN), .LANES(LANES), .OP(formats_pkg::EXPONENT_MOVE), .ARITH(ARITH))
          move (.en_i, .a_i(late), .b_i(down_late), .r_o(scaled));
      pipe_delay #(.W(LW), .FROM(MOVE), .TO(LATENCY), .ARITH(ARITH)) delay_scaled (.clk_i, .d_i(scaled), .q_o(b_o[k]));
    end else begin : g_pure
      pipe_delay #(.W(LW), .FROM(0), .TO(LATENCY), .ARITH(ARITH)) delay_word (.clk_i, .d_i(b_i[k]), .q_o(b_o[k]));
    end
  end
endmodule
