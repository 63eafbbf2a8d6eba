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
  if (N == 1) begin : g_single
    assign index_o = 1'b0;
  end else begin : g_encode
    for (genvar b = 0; b < W; b++) begin : index_bit
      logic [N-1:0] pattern;
      for (genvar i = 0; i < N; i++) begin : position
        assign pattern[i] = ((i >> b) & 1) == 1;
      end
      assign index_o[b] = |(first_o & pattern);
    end
  end
endmodule
