// SPDX-License-Identifier: Apache-2.0
// Delay line of tags, like issue_history.sv, for many entries: all of it is memory, also the valid bits.
// With REGISTERS = 2, the memory is read earlier, and flip-flops hold its outputs: block memories are slow.
// Latency: latency_i cycles (1 + REGISTERS..DEPTH-1). An entry of the cycle in which latency_i changes is lost.
// Throughput: one entry per cycle. Stall: none.
module row_history #(
    parameter int W = 1,
    parameter int DEPTH = 256,  // power of two
    parameter int REGISTERS = 0  // 0 or 2: one for the block memory, one behind it
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
  (* no_rw_check *) logic valid_mem[DEPTH];  // written in every cycle, and read in a later one
  (* no_rw_check *) logic [W-1:0] mem[DEPTH];
  logic [AW-1:0] left_q, latency_q;  // cycles until the latency has passed since reset or its change
  logic valid, restart, open_q;
  if (REGISTERS == 0) begin : g_direct
    assign valid = valid_mem[read_q];
    assign q_o = mem[read_q];
  end else begin : g_registers
    logic valid_q;
    logic [W-1:0] d_q;
    always_ff @(posedge clk_i) begin
      {valid_q, d_q} <= {valid_mem[read_q], mem[read_q]};
      {valid, q_o} <= {valid_q, d_q};
    end
  end
  // The memory holds random bits after power-on. Until a pass begins, the pair may be one that the card lacks, whose
  // latency is too short.
  assign restart = rst_i || latency_q != AW'(latency_i);
  assign valid_o = valid && open_q;
  always_ff @(posedge clk_i) begin
    valid_mem[write_q] <= valid_i;
    if (valid_i) mem[write_q] <= d_i;
    write_q <= write_q + 1;
    read_q <= write_q + 1 + AW'(REGISTERS) - AW'(latency_i);
    latency_q <= AW'(latency_i);
    if (left_q != 0) left_q <= left_q - 1;
    if (restart) left_q <= AW'(latency_i);
    open_q <= !restart && left_q <= 1 && latency_i > 16'(REGISTERS);
    if (rst_i) begin
      write_q <= '0;
      read_q <= AW'(REGISTERS) - AW'(latency_i);
    end
  end
`ifndef SYNTHESIS
  always_ff @(posedge clk_i)
    if (!rst_i && valid_i) assert (latency_i > 16'(REGISTERS) &&
        latency_i < 16'(DEPTH)) else $error("row_history: latency must be %0d..%0d", 1 + REGISTERS, DEPTH - 1);
`endif
endmodule
