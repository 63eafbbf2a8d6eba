// SPDX-License-Identifier: Apache-2.0
// Simulation model of AMD's clock buffer with enable (UG572: CE is taken while I is low), for clock_gate with GATE =
// "bufgce". Synthesis does not read this folder and uses the vendor's cell.
module BUFGCE (
    input logic I,
    input logic CE,
    output logic O
);
  logic enable_l;
  always_latch if (!I) enable_l = CE;
  assign O = I & enable_l;
endmodule
