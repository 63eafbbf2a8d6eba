// SPDX-License-Identifier: Apache-2.0
// Tag FIFO of a pipe that keeps the order but not the time: tags leave in the order they entered.
// Latency: 1 cycle.
// Throughput: one tag in and one out per cycle.
// Stall: none; the user keeps at most DEPTH - 1 tags inside.
module tag_fifo #(
    parameter int W = 1,
    parameter int DEPTH = 1024  // power of two
) (
    input logic clk_i,
    input logic rst_i,
    input logic push_i,
    input logic [W-1:0] d_i,
    input logic pop_i,
    output logic [W-1:0] q_o  // the oldest tag
);
  localparam int AW = $clog2(DEPTH);
  logic [AW-1:0] write_q, read_q;
  logic [W-1:0] mem[DEPTH];
  assign q_o = mem[read_q];
  always_ff @(posedge clk_i) begin
    if (push_i) begin
      mem[write_q] <= d_i;
      write_q <= write_q + 1;
    end
    if (pop_i) read_q <= read_q + 1;
    if (rst_i) begin
      write_q <= '0;
      read_q <= '0;
    end
  end
`ifndef SYNTHESIS
  always_ff @(posedge clk_i)
    if (!rst_i) begin
      assert (!pop_i || read_q != write_q) else $error("tag_fifo: a result without a tag");
      assert (!push_i || write_q + 1'b1 != read_q) else $error("tag_fifo: more than %0d rows in flight", DEPTH - 1);
    end
`endif
endmodule
