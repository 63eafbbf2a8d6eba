// SPDX-License-Identifier: Apache-2.0
// Product with a 6-bit factor, made of adders alone: sums of two rows each | two of the three sums | all three.
// Latency: 3 cycles.
// Throughput: one result per cycle.
// Stall: none.
module fp_rows #(
    parameter int W = 18
) (
    input  logic         clk_i,
    input  logic [W-1:0] a_i,
    input  logic [5:0]   b_i,
    output logic [W+5:0] r_o
);
  logic [2:0][W+1:0] pair_p, pair;
  logic [W+3:0] two_p, two;
  logic [W+1:0] last;
  logic [W+5:0] all_p;
  for (genvar i = 0; i < 3; i++) begin : g_pair
    assign pair_p[i] = {2'b0, a_i & {W{b_i[2*i]}}} + {1'b0, a_i & {W{b_i[2*i+1]}}, 1'b0};
  end
  pipe_reg #(3 * (W + 2), 1) reg_pair (.clk_i, .d_i(pair_p), .q_o(pair));
  assign two_p = (W + 4)'(pair[0]) + ((W + 4)'(pair[1]) << 2);
  pipe_reg #(W + 4, 1) reg_two (.clk_i, .d_i(two_p), .q_o(two));
  pipe_reg #(W + 2, 1) reg_last (.clk_i, .d_i(pair[2]), .q_o(last));
  assign all_p = (W + 6)'(two) + ((W + 6)'(last) << 4);
  pipe_reg #(W + 6, 1) reg_all (.clk_i, .d_i(all_p), .q_o(r_o));
endmodule
