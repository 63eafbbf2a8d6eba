// SPDX-License-Identifier: Apache-2.0
// Event counters of a unit. Each counter sums a number of events per cycle from the beginning of a pass. It is read at
// its register in registers_pkg::COUNTER_REGISTERS, where the unit's counters begin at FIRST. Counters start at 0 with
// every pass and keep their value until the next. A read selects one counter of the card, and all other modules return
// 0: the card ORs them. The engine does not use this module, because an array of its events slows down simulation.
// Latency: 1 cycle per count, 1 cycle of the bus clock per read.
// Throughput: every counter counts, and one is read, per cycle.
// Stall: none.
module pass_counters #(
    parameter int FIRST = 0,
    parameter int COUNTERS = registers_pkg::COUNTERS - FIRST
) (
    input logic clk_i,
    input logic rst_i,
    input logic clear_i,
    input logic [COUNTERS-1:0][card_pkg::COUNT_BITS-1:0] counts_i,  // events of this cycle

    input logic clk_bus_i,
    input logic read_i,   // a read,
    input logic hit_i,    // of an allowed register,
    input logic [11:0] offset_i,
    output logic [63:0] rdata_o  // data of the last read; 0 if it was of another register
);
  if (FIRST < 0 || COUNTERS < 1 || FIRST + COUNTERS > registers_pkg::COUNTERS) begin : g_counters
    $error("pass_counters: FIRST and COUNTERS exceed the table of %0d counters", registers_pkg::COUNTERS);
  end
  logic [COUNTERS-1:0][63:0] answers;
  for (genvar c = 0; c < COUNTERS; c++) begin : counter
    localparam logic [11:0] REGISTER = registers_pkg::counter_register(FIRST + c);
    logic [63:0] count_q, answer_q;
    always_ff @(posedge clk_i) count_q <= (clear_i | rst_i) ? '0 : count_q + 64'(counts_i[c]);
    always_ff @(posedge clk_bus_i) if (read_i) answer_q <= (hit_i && offset_i == REGISTER) ? count_q : '0;
    assign answers[c] = answer_q;
  end
  always_comb begin
    rdata_o = '0;
    for (int c = 0; c < COUNTERS; c++) rdata_o = rdata_o | answers[c];
  end
endmodule
