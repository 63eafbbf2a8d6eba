// SPDX-License-Identifier: Apache-2.0
// The pipe of a pair (scaled_pipe.sv). With BOUND, a signed distance below the box distance is raised to it
// (distance_bound.sv). The bound comes from the unscaled pair. With BOUND, also its operators, 1 compare and 1 max.
// Latency: latency_o: the pipe's latency, and with BOUND LAT.cmp; 0 with ARITH = "host".
// Throughput: LANES pairs per SAT_II cycles.
// Stall: none, runs free.
`include "distance_bound.svh"
module bounded_pipe #(
    `DF_PARAMETERS,
    parameter int PAIR = 0,
    parameter int ALGORITHM = 0,  // as in pair_pipe.sv, with the following parameters
    parameter int BOX = 0,
    parameter int HALF_SPACE = 0,
    parameter int SAT_II = 1,
    parameter int B_LANES = LANES,
    parameter int BOUND = 0,  // 1: apply the bound; for config_pkg::BOUND_PAIRS
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
  localparam int LW = LANES * CW;
  logic [LANES-1:0][CW-1:0] f, t;
  logic [2:0][LANES-1:0][CW-1:0] cp, n;
  logic [15:0] latency;
  scaled_pipe #(`DF_SAME, .PAIR(PAIR), .ALGORITHM(ALGORITHM), .BOX(BOX), .HALF_SPACE(HALF_SPACE), .SAT_II(SAT_II),
      .B_LANES(B_LANES)) pipe (
      .clk_i, .enter_i, .a_i, .b_i, .f_o(f), .t_o(t), .cp_o(cp), .n_o(n), .latency_o(latency));
  if (BOUND != 0) begin : g_bound
    if (!pairs_pkg::has(config_pkg::BOUND_PAIRS, PAIR)) $error("bounded_pipe: BOUND needs a pair of BOUND_PAIRS");
    localparam int A_SHAPE = pairs_pkg::primary_shape(PAIR);
    localparam int B_SHAPE = pairs_pkg::secondary_shape(PAIR);
    logic [B_WORDS-1:0][LANES-1:0][CW-1:0] b_own;  // one secondary per lane
    for (genvar k = 0; k < B_WORDS; k++) begin : word
      if (B_LANES == LANES) begin : g_own
        assign b_own[k] = b_i[k];
      end else begin : g_broadcast
        assign b_own[k] = {LANES{b_i[k][0]}};
      end
    end
    logic [LANES-1:0][CW-1:0] bound_now, bound_late;
    distance_bound #(`DF_SAME, .A_SHAPE(A_SHAPE), .B_SHAPE(B_SHAPE)) of_boxes (
        .clk_i, .a_i, .b_i(b_own), .bound_o(bound_now));
    if (ARITH == "rtl") begin : g_late  // the pipe's latency is a port value, not a parameter
      localparam int SLOWEST = latency_pkg::mean(LAT);
      logic unused_valid;
      issue_history #(.W(LW), .DEPTH(256 << $clog2(SLOWEST))) history (
          .clk_i, .rst_i(1'b0), .latency_i(latency - 16'(`DISTANCE_T_BOUND(A_SHAPE, B_SHAPE))), .valid_i(1'b1),
          .d_i(bound_now), .valid_o(unused_valid), .q_o(bound_late));
    end else begin : g_now
      assign bound_late = bound_now;
    end
    distance_at_least #(`DF_SAME) at_least (
        .clk_i, .bound_i(bound_late), .f_i(f), .t_i(t), .cp_i(cp), .n_i(n), .f_o, .t_o, .cp_o, .n_o);
    assign latency_o = latency + 16'(LAT.cmp);
  end else begin : g_pipe_alone
    assign {n_o, cp_o, t_o, f_o} = {n, cp, t, f};
    assign latency_o = latency;
  end
endmodule
