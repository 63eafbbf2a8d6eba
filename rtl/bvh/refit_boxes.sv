// SPDX-License-Identifier: Apache-2.0
// Boxes of the children of nodes under way, and for each node the box of its children so far. Corners are ordered words
// (bvh_pkg): lower x y z, upper x y z.
// Latency: 1 cycle from write to read.
// Throughput: per cycle, one box written, and one box and one node's box read.
// Stall: none.
module refit_boxes #(
    parameter int CONTEXTS = 8,  // a power of two, 2 or more
    parameter int FLAGS = 2,     // flags with a box, >= 1; a node has the OR of its children's
    localparam int CX = $clog2(CONTEXTS)
) (
    input logic clk_i,
    input logic open_i,  // opens a node, without boxes so far
    input logic [CX-1:0] open_context_i,
    input logic write_i,
    input logic [CX+2:0] write_at_i,  // context and child
    input logic [5:0][31:0] box_i,
    input logic [FLAGS-1:0] flags_i,
    input logic [CX+2:0] read_at_i,
    output logic [5:0][31:0] box_o,
    output logic [FLAGS-1:0] flags_o,
    output logic some_o,  // the node has a box
    output logic [5:0][31:0] all_o,
    output logic [FLAGS-1:0] any_o
);
  logic [FLAGS+6*32-1:0] boxes[CONTEXTS*8], alls[CONTEXTS];
  logic [CONTEXTS-1:0] some_q;
  assign {flags_o, box_o} = boxes[read_at_i];
  assign {any_o, all_o} = alls[read_at_i[CX+2:3]];
  assign some_o = some_q[read_at_i[CX+2:3]];

  // ---- A node's box joined with one more ----
  logic [CX-1:0] context_;
  logic [5:0][31:0] all, sum;
  logic [FLAGS-1:0] any;
  assign context_ = write_at_i[CX+2:3];
  assign {any, all} = alls[context_];
  always_comb begin
    sum = box_i;
    for (int k = 0; k < 3; k++)
      if (some_q[context_]) begin
        if (all[k] < box_i[k]) sum[k] = all[k];
        if (all[3+k] > box_i[3+k]) sum[3+k] = all[3+k];
      end
  end
  always_ff @(posedge clk_i) begin
    if (write_i) begin
      boxes[write_at_i] <= {flags_i, box_i};
      alls[context_] <= {flags_i | (some_q[context_] ? any : '0), sum};
      some_q[context_] <= 1'b1;
    end
    if (open_i) some_q[open_context_i] <= 1'b0;
  end
endmodule
