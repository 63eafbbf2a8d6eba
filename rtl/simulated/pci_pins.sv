// SPDX-License-Identifier: Apache-2.0
// Simulation only: re-times the bus wires at the card's input. Verilator evaluates all logic behind a top-level input
// at every step, even without a change. The harness changes the wires only with the falling PCI clock. Taking them over
// there gives the same bits at every rising edge, and costs nothing while that clock rests.
// Latency: none.
// Throughput: all wires every cycle.
// Stall: none.
module pci_pins #(
    parameter int W = 1
) (
    input logic clk_i,
    input logic [W-1:0] wires_i,
    output logic [W-1:0] wires_o
);
  always_ff @(negedge clk_i) wires_o <= wires_i;
endmodule
