// SPDX-License-Identifier: Apache-2.0
// FIFO in one clock domain. The head is visible without a read.
// Latency: 1 cycle; 2 with LATE.
// Throughput: one entry in and one out per cycle.
// Stall: free_o, count_o.
module sync_fifo #(
    parameter int W = 64,
    parameter int DEPTH = 16,  // power of two
    parameter bit LATE = 0,    // a block memory has no registers around it
    localparam int AW = $clog2(DEPTH)
) (
    input logic clk_i,
    input logic rst_i,  // also empties it
    input logic write_i,
    input logic [W-1:0] wdata_i,
    output logic [AW:0] free_o,
    output logic [AW:0] count_o,
    output logic some_o,  // a register: count_o is not 0
    output logic [W-1:0] rdata_o,
    input logic read_i
);
  logic [AW:0] write_q, read_q;
  assign count_o = write_q - read_q;
  assign free_o = (AW + 1)'(DEPTH) - count_o;
  logic [AW:0] read;  // read_q of the next cycle
  assign read = read_q + (AW + 1)'(read_i);
  if (LATE) begin : g_late
    (* no_rw_check *) logic [W-1:0] memory[DEPTH];
    always_ff @(posedge clk_i) begin
      rdata_o <= memory[read[AW-1:0]];
      if (write_i) memory[write_q[AW-1:0]] <= wdata_i;
      some_o <= !rst_i && write_q != read;
    end
  end else if (DEPTH >= 32 && W >= 24) begin : g_block
    // The memory is read one cycle ahead. A word that becomes the head as it is written goes around the memory.
    (* ram_style = "block", no_rw_check *) logic [W-1:0] memory[DEPTH];
    logic around_q;
    logic [W-1:0] written_q, head_q;
    assign rdata_o = around_q ? written_q : head_q;
    always_ff @(posedge clk_i) begin
      around_q <= write_i && (read_i ? count_o == 1 : count_o == 0);
      if (read_i || around_q) head_q <= memory[read[AW-1:0]];
      if (write_i) begin
        memory[write_q[AW-1:0]] <= wdata_i;
        written_q <= wdata_i;
      end
    end
  end else begin : g_distributed
    logic [W-1:0] memory[DEPTH];
    assign rdata_o = memory[read_q[AW-1:0]];
    always_ff @(posedge clk_i) if (write_i) memory[write_q[AW-1:0]] <= wdata_i;
  end
  if (!LATE) begin : g_some
    always_ff @(posedge clk_i) some_o <= !rst_i && (write_i || (read_i ? count_o > 1 : some_o));
  end
  always_ff @(posedge clk_i) begin
    if (write_i) write_q <= write_q + 1;
    read_q <= read;
    if (rst_i) {write_q, read_q} <= '0;
  end

`ifndef SYNTHESIS
  always_ff @(posedge clk_i)
    if (!rst_i) begin
      // By the true pointers, not by the outputs to users.
      assert (!(write_i && write_q - read_q == (AW + 1)'(DEPTH))) else $error("sync_fifo: written while full");
      assert (!(read_i && (write_q == read_q || (LATE && !some_o)))) else $error("sync_fifo: read while empty");
    end
`endif
endmodule
