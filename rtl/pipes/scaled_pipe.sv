// SPDX-License-Identifier: Apache-2.0
// The pipe of a pair (pair_pipe.sv). Where pairs_pkg::scaled says so, the pair is first scaled to the size of one and
// the result is scaled back.
// Latency: latency_o: the pipe's latency plus length_scale.sv's and length_unscale.sv's; 0 with ARITH = "host".
// Throughput: LANES pairs per SAT_II cycles.
// Stall: none, runs free.
`include "pipe.svh"
module scaled_pipe #(
    `DF_PARAMETERS,
    parameter int PAIR = 0,
    parameter int ALGORITHM = 0,  // as in pair_pipe.sv, with the following parameters
    parameter int BOX = 0,
    parameter int HALF_SPACE = 0,
    parameter int SAT_II = 1,
    parameter int B_LANES = LANES,
    localparam int A_WORDS = pairs_pkg::shape_words(pairs_pkg::primary_shape(PAIR)),
    localparam int B_WORDS = pairs_pkg::shape_words(pairs_pkg::secondary_shape(PAIR))
) (
    input logic clk_i,
    input logic enter_i,
    input logic [A_WORDS-1:0][LANES-1:0][CW-1:0] a_i,
    input logic [B_WORDS-1:0][B_LANES-1:0][CW-1:0] b_i,
    `DISTANCE_OUTPUTS
);
  /*verilator inline_module*/
  localparam bit SCALED = pairs_pkg::scaled(PAIR, EXP);
  localparam int INNER_B = SCALED ? LANES : B_LANES;
  localparam int LW = LANES * CW;
  logic enter;
  logic [A_WORDS-1:0][LANES-1:0][CW-1:0] a;
  logic [B_WORDS-1:0][INNER_B-1:0][CW-1:0] b;
  logic [LANES-1:0][CW-1:0] f, t;
  logic [2:0][LANES-1:0][CW-1:0] cp, n;
  logic [15:0] latency;
  pair_pipe #(`DF_SAME, .PAIR(PAIR), .ALGORITHM(ALGORITHM), .BOX(BOX), .HALF_SPACE(HALF_SPACE), .SAT_II(SAT_II),
      .B_LANES(INNER_B)) pipe (
      .clk_i, .enter_i(enter), .a_i(a), .b_i(b), .f_o(f), .t_o(t), .cp_o(cp), .n_o(n), .latency_o(latency));
  if (SCALED) begin : g_scaled
    localparam int SHAPE_A = pairs_pkg::primary_shape(PAIR);
    localparam bit RAY = SHAPE_A == pairs_pkg::SHAPE_RAY;
    logic [B_WORDS-1:0][LANES-1:0][CW-1:0] b_own;  // one secondary per lane
    for (genvar k = 0; k < B_WORDS; k++) begin : word
      if (B_LANES == LANES) begin : g_own
        assign b_own[k] = b_i[k];
      end else begin : g_broadcast
        assign b_own[k] = {LANES{b_i[k][0]}};
      end
    end
    logic [LANES-1:0][CW-1:0] back, t_back, back_late, t_back_late;
    length_scale #(`DF_SAME, .SHAPE_A(SHAPE_A), .SHAPE_B(pairs_pkg::secondary_shape(PAIR))) scale (
        .clk_i, .en_i(1'b1), .a_i, .b_i(b_own), .a_o(a), .b_o(b), .back_o(back), .t_back_o(t_back));
    length_unscale #(`DF_SAME, .RAY(RAY)) unscale (
        .clk_i, .en_i(1'b1), .back_i(back_late), .t_back_i(t_back_late), .f_i(f), .t_i(t), .cp_i(cp), .n_i(n), .f_o,
        .t_o, .cp_o, .n_o);
    localparam int FRONT = pairs_pkg::scale_latency(RAY, LAT.mul, LAT.cmp);
    assign latency_o = latency + 16'(FRONT + pairs_pkg::unscale_latency(RAY, LAT.mul, LAT.cmp));
    if (ARITH == "rtl") begin : g_late  // the pipe's latency is a port value, not a parameter
      localparam int SLOWEST = latency_pkg::mean(LAT);
      logic unused_valid;
      pipe_delay #(.W(1), .FROM(0), .TO(FRONT), .ARITH(ARITH)) delay_enter (.clk_i, .d_i(enter_i), .q_o(enter));
      issue_history #(.W(2 * LW), .DEPTH(128 << $clog2(SLOWEST))) history (
          .clk_i, .rst_i(1'b0), .latency_i(latency), .valid_i(1'b1), .d_i({t_back, back}), .valid_o(unused_valid),
          .q_o({t_back_late, back_late}));
    end else begin : g_now
      assign enter = enter_i;
      assign back_late = back;
      assign t_back_late = t_back;
    end
  end else begin : g_plain
    assign enter = enter_i;
    assign a = a_i;
    assign b = b_i;
    assign {n_o, cp_o, t_o, f_o} = {n, cp, t, f};
    assign latency_o = latency;
  end
endmodule
