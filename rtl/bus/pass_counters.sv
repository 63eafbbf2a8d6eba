// SPDX-License-Identifier: Apache-2.0
// Counters that a unit brings: a number of events a clock and counter is summed from the beginning of a pass on, and is
// read at the counter's register in the table (registers_pkg::COUNTER_REGISTERS), where the unit's begin at FIRST.
// They start at 0 with every pass and stay until the next.
// What is read here and in other such modules and card_registers is one of them, the others show 0: the card ORs them.
// The engine has no such module: the order of its events in an array took 5 to 9 % of the simulated speed (16 lanes).
// Latency: a count 1 cycle, a read 1 clock of the bus.
// Throughput: every counter counts, and one is read, per cycle.
// Stall: none.
module pass_counters #(
    parameter int FIRST = 0,
    parameter int COUNTERS = registers_pkg::COUNTERS - FIRST
) (
    input logic clk_i,
    input logic rst_i,
    input logic clear_i,
    input logic [COUNTERS-1:0][card_pkg::COUNT_BITS-1:0] counts_i,  // events of this clock

    input logic clk_bus_i,
    input logic read_i,   // there is a read,
    input logic there_i,  // of a register that may be read,
    input logic [11:0] offset_i,
    output logic [63:0] rdata_o  // of the last read; 0 where it was of no counter
);
  if (FIRST < 0 || COUNTERS < 1 || FIRST + COUNTERS > registers_pkg::COUNTERS) begin : g_counters
    $error("pass_counters: FIRST and COUNTERS must be some of the %0d of the table", registers_pkg::COUNTERS);
  end
  logic [COUNTERS-1:0][63:0] answers;
  for (genvar c = 0; c < COUNTERS; c++) begin : counter
    localparam logic [11:0] REGISTER = registers_pkg::counter_register(FIRST + c);
    logic [63:0] count_q, answer_q;
    always_ff @(posedge clk_i) count_q <= (clear_i | rst_i) ? '0 : count_q + 64'(counts_i[c]);
    always_ff @(posedge clk_bus_i) if (read_i) answer_q <= (there_i && offset_i == REGISTER) ? count_q : '0;
    assign answers[c] = answer_q;
  end
  always_comb begin
    rdata_o = '0;
    for (int c = 0; c < COUNTERS; c++) rdata_o = rdata_o | answers[c];
  end
endmodule
