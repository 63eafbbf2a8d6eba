// SPDX-License-Identifier: Apache-2.0
// a if the lane mask is set, else b: one multiplexer of W bits per lane, for scalars (WORDS = 1) and vectors.
// Latency: 0.
// Throughput: one result per lane per cycle.
// Stall: none.
module lane_select #(
    parameter int CW = 32,
    parameter int LANES = 1,
    parameter int WORDS = 1
) (
    input logic [LANES-1:0][CW-1:0] m_i,  // all ones or all zeros
    input logic [WORDS-1:0][LANES-1:0][CW-1:0] a_i,
    input logic [WORDS-1:0][LANES-1:0][CW-1:0] b_i,
    output logic [WORDS-1:0][LANES-1:0][CW-1:0] r_o
);
  /*verilator inline_module*/
  for (genvar k = 0; k < WORDS; k++) begin : word
    logic [LANES-1:0][CW-1:0] a, b;
    assign a = a_i[k];
    assign b = b_i[k];
    assign r_o[k] = (m_i & a) | (~m_i & b);
  end
endmodule
