// SPDX-License-Identifier: Apache-2.0
// The counters of a pass. Units bring what is to be counted, a number of events a clock and counter; the counters are
// 64-bit registers of the card, at the offsets of one table (registers_pkg::COUNTER_REGISTERS). They start at 0 with
// every pass and stay until the next.
// Latency: a count 1 clock, a read 1 clock of the bus. Throughput: all count, and one is read, in a clock. Stall: none.
module pass_counters #(
    localparam int COUNTERS = registers_pkg::COUNTERS
) (
    input logic clk_i,
    input logic clear_i,
    input logic [COUNTERS-1:0][card_pkg::COUNT_BITS-1:0] counts_i,  // events of this clock

    input logic clk_bus_i,
    input logic read_i,   // there is a read,
    input logic there_i,  // of a register that may be read,
    input logic [11:0] offset_i,
    output logic [63:0] rdata_o  // of the last read; 0 where it was of no counter
);
  logic [COUNTERS-1:0][63:0] answers;
  for (genvar c = 0; c < COUNTERS; c++) begin : counter
    localparam logic [11:0] REGISTER = registers_pkg::counter_register(c);
    logic [63:0] count_q, answer_q;
    always_ff @(posedge clk_i) count_q <= clear_i ? '0 : count_q + 64'(counts_i[c]);
    always_ff @(posedge clk_bus_i) if (read_i) answer_q <= (there_i && offset_i == REGISTER) ? count_q : '0;
    assign answers[c] = answer_q;
  end
  always_comb begin
    rdata_o = '0;
    for (int c = 0; c < COUNTERS; c++) rdata_o = rdata_o | answers[c];
  end
endmodule
