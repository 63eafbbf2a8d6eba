// SPDX-License-Identifier: Apache-2.0
// The wires of the bus on their way into the card, of which hardware has nothing. Verilator evaluates all logic behind
// a top-level input at every step, whatever has changed. The harness changes the wires with the falling PCI clock and
// at no other time, so taking them over there gives the same bits at every rising edge, and costs nothing while that
// clock rests.
// Latency: none.
// Throughput: all of them every cycle.
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
