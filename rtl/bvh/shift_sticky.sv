// SPDX-License-Identifier: Apache-2.0
// Shifts a word to the right, one stage per bit of the distance, and tells whether a one is shifted out.
// Latency: 0 cycles.
// Throughput: one word per cycle.
// Stall: none.
module shift_sticky #(
    parameter int W = 24,
    parameter int BY = 5,    // bits of the distance
    parameter int FIRST = 0  // the distance is by_i * 2^FIRST
) (
    input logic [W-1:0] d_i,
    input logic fill_i,  // the bits shifted in
    input logic [BY-1:0] by_i,
    output logic [W-1:0] q_o,
    output logic lost_o
);
  /*verilator inline_module*/
  localparam logic [W-1:0] ONES = '1;
  always_comb begin
    q_o = d_i;
    lost_o = 1'b0;
    for (int k = 0; k < BY; k++)
      if (by_i[k]) begin
        lost_o = lost_o || (q_o & ~(ONES << (1 << (k + FIRST)))) != '0;
        q_o = (q_o >> (1 << (k + FIRST))) | ({W{fill_i}} & ~(ONES >> (1 << (k + FIRST))));
      end
  end
endmodule
