// SPDX-License-Identifier: Apache-2.0
// Makes the check bits of a word (secded.svh).
// Latency: 0.
// Throughput: one word per cycle.
// Stall: none.
`include "secded.svh"
module secded_encode #(
    parameter int W = 32,
    localparam int R = `SECDED_BITS(W)
) (
    input logic [W-1:0] data_i,
    output logic [R-1:0] check_o
);
  `SECDED_FUNCTIONS(W)
  logic [R-2:0] hamming;
  for (genvar j = 0; j < R - 1; j++) begin : bit_j
    localparam logic [W-1:0] MASK = secded_mask(j);
    assign hamming[j] = ^(data_i & MASK);
  end
  assign check_o = {^{data_i, hamming}, hamming};
endmodule
