// SPDX-License-Identifier: Apache-2.0
// Index of the set bit of a one-hot vector; 0 if no bit is set. Combinational.
module one_hot_index #(
    parameter int N = 16,  // power of two
    localparam int W = (N > 1) ? $clog2(N) : 1
) (
    input logic [N-1:0] bit_i,
    output logic [W-1:0] index_o
);
  if (N == 1) begin : g_single
    assign index_o = 1'b0;
    logic unused_bit;
    assign unused_bit = bit_i;
  end else begin : g_encode
    for (genvar b = 0; b < W; b++) begin : index_bit
      logic [N-1:0] pattern;
      for (genvar i = 0; i < N; i++) begin : position
        assign pattern[i] = ((i >> b) & 1) == 1;
      end
      assign index_o[b] = |(bit_i & pattern);
    end
  end
endmodule
