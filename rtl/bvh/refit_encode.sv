// SPDX-License-Identifier: Apache-2.0
// A node's words from new boxes (refit_axis.sv): first the box of all children, then each child's. The children's kinds
// and places stay. Bytes of places without a child are 0.
// Latency: 6 cycles from the last box to the node.
// Throughput: one box per cycle.
// Stall: none.
module refit_encode (
    input logic clk_i,
    input logic rst_i,
    input logic valid_i,
    input logic first_i,            // the box of all children; one box per child follows
    input logic last_i,
    input logic [2:0] child_i,
    input logic [5:0][31:0] box_i,  // ordered words: lower x y z, upper x y z
    input logic [71:0] header_i,    // from refit_traversal.sv, with the first box
    output logic valid_o,
    output logic [bvh_pkg::NODE_WORDS-1:0][31:0] node_o
);
  import bvh_pkg::*;
  localparam int T_AXIS = 4;

  logic valid_0, first_0, last_0;
  logic [2:0] child_0;
  logic [5:0][31:0] box_0;
  logic [71:0] header_0;
  always_ff @(posedge clk_i) begin
    valid_0 <= valid_i && !rst_i;
    {first_0, last_0, child_0, box_0, header_0} <= {valid_i && first_i, last_i, child_i, box_i, header_i};
  end
  logic [2:0][31:0] origin;
  logic [2:0][7:0] exponent, lower, upper;
  for (genvar k = 0; k < 3; k++) begin : axis
    refit_axis bytes (
        .clk_i, .first_i(first_0), .lower_i(box_0[k]), .upper_i(box_0[3+k]), .origin_o(origin[k]),
        .exponent_o(exponent[k]), .lower_o(lower[k]), .upper_o(upper[k]));
  end
  logic valid, first, last;
  logic [2:0] child;
  logic [PLACE-1:0] slot, node;
  logic [15:0] kinds;
  pipe_delay_valid #(.TO(T_AXIS)) delay_box (.clk_i, .rst_i, .valid_i(valid_0), .valid_o(valid));
  pipe_delay #(.W(5), .TO(T_AXIS)) delay_which (.clk_i, .d_i({first_0, last_0, child_0}), .q_o({first, last, child}));
  pipe_delay #(.W(72), .TO(T_AXIS)) delay_header (.clk_i, .d_i(header_0), .q_o({slot, node, kinds}));

  // ---- Words ----
  logic [2:0][CHILDREN-1:0][7:0] lower_q, upper_q;
  logic [2:0][31:0] origin_q, head_q;
  always_ff @(posedge clk_i) begin
    if (valid && first) {head_q, origin_q} <= {kinds[15:12], slot, kinds[11:8], node, kinds[7:0], exponent, origin};
    valid_o <= valid && last && !rst_i;
  end
  for (genvar k = 0; k < 3; k++) begin : put
    for (genvar i = 0; i < CHILDREN; i++) begin : place
      always_ff @(posedge clk_i)
        if (valid && (first || child == 3'(i))) begin
          lower_q[k][i] <= first ? '0 : lower[k];
          upper_q[k][i] <= first ? '0 : upper[k];
        end
    end
  end
  // A half has the corners of four children.
  logic [2:0][1:0][31:0] lower_words, upper_words;
  assign {lower_words, upper_words} = {lower_q, upper_q};
  always_comb begin
    {node_o[HALF+:3], node_o[2:0]} = {head_q, origin_q};
    for (int k = 0; k < 3; k++)
      for (int h = 0; h < 2; h++) begin
        node_o[HALF*h+3+k] = lower_words[k][h];
        node_o[HALF*h+6+k] = upper_words[k][h];
      end
  end
endmodule
