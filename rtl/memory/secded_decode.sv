// SPDX-License-Identifier: Apache-2.0
// Decodes a word with check bits (secded.svh). One wrong bit, of data or check, is corrected, and two are detected.
// Latency: 0.
// Throughput: one word per cycle.
// Stall: none.
`include "secded.svh"
module secded_decode #(
    parameter int W = 32,
    localparam int R = `SECDED_BITS(W)
) (
    input logic [W-1:0] data_i,
    input logic [R-1:0] check_i,
    output logic [W-1:0] data_o,
    output logic corrected_o,
    output logic failed_o  // data_o is wrong
);
  `SECDED_FUNCTIONS(W)
  logic [R-2:0] syndrome;  // position of a single wrong bit; a power of two for a check bit
  logic odd;
  for (genvar j = 0; j < R - 1; j++) begin : bit_j
    localparam logic [W-1:0] MASK = secded_mask(j);
    assign syndrome[j] = check_i[j] ^ (^(data_i & MASK));
  end
  assign odd = ^{data_i, check_i};
  logic [W-1:0] flip;
  for (genvar i = 0; i < W; i++) begin : data
    localparam logic [R-2:0] POSITION = (R - 1)'(secded_position(i));
    assign flip[i] = odd && syndrome == POSITION;
  end
  logic check_wrong;
  assign check_wrong = (syndrome & (syndrome - 1)) == '0;  // or the parity bit is wrong
  assign data_o = data_i ^ flip;
  assign corrected_o = odd && (|flip || check_wrong);
  assign failed_o = odd ? !(|flip || check_wrong) : syndrome != '0;
endmodule
