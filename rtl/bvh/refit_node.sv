// SPDX-License-Identifier: Apache-2.0
// The box of a node from its words: the union of its children's boxes. The lower corner is the origin, exactly, and the
// upper one is rounded up. Without children, the box is the origin. Corners are ordered words (bvh_pkg):
// lower x y z, upper x y z.
// Latency: 5 cycles.
// Throughput: one node per cycle.
// Stall: none, runs free.
module refit_node (
    input logic clk_i,
    input logic [bvh_pkg::NODE_WORDS-1:0][31:0] node_i,
    output logic [5:0][31:0] box_o
);
  import bvh_pkg::*;
  logic [CHILDREN-1:0][1:0] kinds;
  assign kinds = kinds_of(node_i);
  logic [2:0][7:0] exponents;
  assign exponents = exponents_of(node_i);

  for (genvar k = 0; k < 3; k++) begin : axis
    logic [CHILDREN-1:0][7:0] upper;
    logic [7:0] most, most_1, exponent_1;
    logic [31:0] origin_1;
    assign upper = upper_of(node_i, k);
    always_comb begin
      most = '0;
      for (int i = 0; i < CHILDREN; i++) if (kinds[i] != KIND_NONE && upper[i] > most) most = upper[i];
    end
    always_ff @(posedge clk_i) {most_1, exponent_1, origin_1} <= {most, exponents[k], node_i[k]};
    refit_upper corner (.clk_i, .origin_i(origin_1), .exponent_i(exponent_1), .byte_i(most_1), .upper_o(box_o[3+k]));
    pipe_delay #(.W(32), .TO(4)) delay_lower (.clk_i, .d_i(ordered(origin_1)), .q_o(box_o[k]));
  end
endmodule
