// SPDX-License-Identifier: Apache-2.0
// Round-robin arbiter.
// Latency: 0 cycles.
// Throughput: one grant per cycle.
// Stall: taken_i.
module turns #(
    parameter int N = 2  // >= 1
) (
    input logic clk_i,
    input logic rst_i,
    input logic [N-1:0] some_i,
    input logic taken_i,
    output logic [N-1:0] from_o  // one-hot: one of some_i
);
  logic [N-1:0] behind_q, behind;  // requests after the last one granted
  assign behind = some_i & behind_q;
  always_comb begin
    from_o = (behind != '0) ? behind : some_i;
    from_o = from_o & (~from_o + 1);  // the lowest
  end
  always_ff @(posedge clk_i) begin
    if (from_o != '0 && taken_i) behind_q <= ~(from_o | (from_o - 1));
    if (rst_i) behind_q <= '1;
  end
endmodule
