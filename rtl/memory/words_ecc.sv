// SPDX-License-Identifier: Apache-2.0
// Corrects words of 32 bits read from a memory with check bits: one wrong bit per word.
// Latency: 0.
// Throughput: WORDS words per cycle.
// Stall: none.
`include "secded.svh"
module words_ecc #(
    parameter int WORDS = 2,
    localparam int R = `SECDED_BITS(32)
) (
    input logic [WORDS-1:0][31:0] data_i,
    input logic [WORDS-1:0][R-1:0] check_i,
    output logic [WORDS-1:0][31:0] data_o,
    output logic [4:0] corrected_o,  // words
    output logic failed_o  // some word has more wrong bits
);
  logic [WORDS-1:0] corrected, failed;
  for (genvar w = 0; w < WORDS; w++) begin : word
    secded_decode #(.W(32)) decode (.data_i(data_i[w]), .check_i(check_i[w]), .data_o(data_o[w]),
        .corrected_o(corrected[w]), .failed_o(failed[w]));
  end
  assign corrected_o = 5'($countones(corrected));
  assign failed_o = failed != '0;
endmodule
