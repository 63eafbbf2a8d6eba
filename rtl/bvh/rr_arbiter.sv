// SPDX-License-Identifier: Apache-2.0
// Round-robin arbiter.
// Latency: 0 cycles.
// Throughput: one grant per cycle.
// Stall: taken_i.
module rr_arbiter #(
    parameter int N = 2  // >= 1
) (
    input logic clk_i,
    input logic rst_i,
    input logic [N-1:0] request_i,
    input logic taken_i,
    output logic [N-1:0] grant_o  // one-hot: one of request_i
);
  logic [N-1:0] mask_q, masked;  // requests after the last one granted
  assign masked = request_i & mask_q;
  always_comb begin
    grant_o = (masked != '0) ? masked : request_i;
    grant_o = grant_o & (~grant_o + 1);  // the lowest
  end
  always_ff @(posedge clk_i) begin
    if (grant_o != '0 && taken_i) mask_q <= ~(grant_o | (grant_o - 1));
    if (rst_i) mask_q <= '1;
  end
endmodule
