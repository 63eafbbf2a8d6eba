// SPDX-License-Identifier: Apache-2.0
// Clock and timing of a check that runs for a while after a commit and is idle otherwise. The result of an entry is
// present T_CHECK cycles after its commit.
// Latency: T_CHECK cycles from the commit to checked_o.
// Throughput: one entry per cycle.
// Stall: none.
module check_clock #(
    parameter int NUMBER_W = 1,
    parameter int T_CHECK = 1  // 1 to 255
) (
    input logic clk_i,  // not gated
    input logic rst_i,
    input logic commit_i,
    input logic [NUMBER_W-1:0] number_i,
    output logic clk_o,
    output logic busy_o,  // results are outstanding
    output logic checked_o,
    output logic [NUMBER_W-1:0] number_o  // entry of the result
);
  logic [7:0] running_q;
  logic any_q;  // running_q != 0
  assign busy_o = commit_i || any_q;
  clock_gate gate (.clk_i, .enable_i(busy_o || rst_i), .clk_o);
  always_ff @(posedge clk_o) begin
    running_q <= rst_i ? '0 : commit_i ? 8'(T_CHECK) : running_q - 8'(any_q);
    any_q <= !rst_i && (commit_i || running_q > 1);
  end
  pipe_delay #(.W(NUMBER_W + 1), .FROM(0), .TO(T_CHECK)) delay_number (.clk_i(clk_o), .d_i({commit_i, number_i}),
      .q_o({checked_o, number_o}));
endmodule
