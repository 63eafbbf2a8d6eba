// SPDX-License-Identifier: Apache-2.0
// Priority encoder: the lowest set bit of a vector, one-hot and as an index. Combinational.
module priority_encoder #(
    parameter int N = 16,  // power of two
    localparam int W = (N > 1) ? $clog2(N) : 1
) (
    input logic [N-1:0] set_i,
    output logic [N-1:0] first_o,
    output logic [W-1:0] index_o
);
  assign first_o = set_i & (~set_i + 1'b1);
  one_hot_index #(.N(N)) encode (.bit_i(first_o), .index_o);
endmodule
