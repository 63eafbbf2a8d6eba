// SPDX-License-Identifier: Apache-2.0
// Carries a valid bit from stage time FROM to stage time TO; reset clears every stage.
// Latency: TO - FROM cycles.
// Throughput: one bit per cycle.
// Stall: none.
module pipe_delay_valid #(
    parameter int FROM = 0,
    parameter int TO = 1
) (
    input logic clk_i,
    input logic rst_i,
    input logic valid_i,
    output logic valid_o
);
  localparam int DEPTH = TO - FROM;
  if (DEPTH < 1) begin : g_illegal
    $error("pipe_delay_valid: TO must be after FROM");
  end
  logic [DEPTH-1:0] q;
  always_ff @(posedge clk_i) q <= rst_i ? '0 : DEPTH'({q, valid_i});
  assign valid_o = q[DEPTH-1];
endmodule
