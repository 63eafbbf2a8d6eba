// SPDX-License-Identifier: Apache-2.0
// What a simulator needs of AMD's clock buffer with enable (UG572: CE is taken while I is low), for clock_gate with
// GATE = "bufgce".
// Synthesis has its own: this folder is not part of it.
module BUFGCE (
    input logic I,
    input logic CE,
    output logic O
);
  logic enable_l;
  always_latch if (!I) enable_l = CE;
  assign O = I & enable_l;
endmodule
