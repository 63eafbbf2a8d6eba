// SPDX-License-Identifier: Apache-2.0
// Delay line of tags: holds the entries of the last DEPTH cycles, so a result finds its tag again.
// It is the only delay line beside the pipes, for any latency.
// Latency: latency_i cycles (1..DEPTH-1). Throughput: one entry per cycle. Stall: none.
module issue_history #(
    parameter int W = 1,
    parameter int DEPTH = 256  // power of two
) (
    input logic clk_i,
    input logic rst_i,
    input logic [15:0] latency_i,
    input logic valid_i,
    input logic [W-1:0] d_i,
    output logic valid_o,
    output logic [W-1:0] q_o
);
  localparam int AW = $clog2(DEPTH);
  logic [AW-1:0] write_q, read_q;  // a registered address: a subtraction before the memory would be the critical path
  logic [DEPTH-1:0] valid_mem;
  logic [W-1:0] mem[DEPTH];
  assign valid_o = valid_mem[read_q];
  assign q_o = mem[read_q];
  always_ff @(posedge clk_i) begin
    valid_mem[read_q] <= 0;  // cleared when read, also if the latency grows between two passes
    valid_mem[write_q] <= valid_i;
    if (valid_i) mem[write_q] <= d_i;
    write_q <= write_q + 1;
    read_q <= write_q + 1 - AW'(latency_i);
    if (rst_i) begin
      valid_mem <= '0;
      write_q <= '0;
      read_q <= -AW'(latency_i);
    end
  end
`ifndef SYNTHESIS
  always_ff @(posedge clk_i)
    if (!rst_i && valid_i) assert (latency_i != 0 &&
        latency_i < 16'(DEPTH)) else $error("issue_history: latency must be 1..%0d", DEPTH - 1);
`endif
endmodule
