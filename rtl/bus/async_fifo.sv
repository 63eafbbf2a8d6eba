// SPDX-License-Identifier: Apache-2.0
// FIFO between two clock domains, with Gray-coded pointers and two-stage synchronisers (C. E. Cummings, "Simulation and
// Synthesis Techniques for Asynchronous FIFO Design", SNUG 2002, style 1). Each side sees the other side's pointer
// late, never early. So the writer may see less room, and the reader fewer entries, than there are. Both resets are
// held together for at least three cycles of each side. A side's clock may be gated. The reader's synchroniser runs on
// `rclk_free_i`, so that `valid_o` can open the gate.
// Latency: 3 cycles of the reader's clock from a write to valid_o.
// Throughput: one entry per cycle.
// Stall: free_o, valid_o.
module async_fifo #(
    parameter int W = 64,
    parameter int DEPTH = 16,  // power of two, at least 4
    localparam int AW = $clog2(DEPTH)
) (
    input logic wclk_i,
    input logic wrst_i,
    input logic write_i,
    input logic [W-1:0] wdata_i,
    output logic [AW:0] free_o,

    input logic rclk_i,
    input logic rclk_free_i,
    input logic rrst_i,
    output logic valid_o,
    output logic [W-1:0] rdata_o,
    input logic read_i,
    output logic settled_o  // for a simulator: the next edge of the reader's synchroniser changes nothing
);
  if (DEPTH < 4 || (1 << AW) != DEPTH) begin : g_illegal
    $error("async_fifo: DEPTH must be a power of two, at least 4");
  end
  logic [W-1:0] memory[DEPTH];
  logic [AW:0] wbin_q, wgray_q, rbin_q, rgray_q, wnext, rnext, rbin_seen;
  // Synchronisers. card.sdc names them.
  (* ASYNC_REG = "TRUE" *) logic [AW:0] rgray_w1_q, rgray_w2_q;
  (* ASYNC_REG = "TRUE" *) logic [AW:0] wgray_r1_q, wgray_r2_q;

  assign wnext = wbin_q + 1;
  always_comb begin
    rbin_seen[AW] = rgray_w2_q[AW];
    for (int b = AW - 1; b >= 0; b--) rbin_seen[b] = ^(rgray_w2_q >> b);
  end
  assign free_o = (AW + 1)'(DEPTH) - (wbin_q - rbin_seen);
  always_ff @(posedge wclk_i) begin
    rgray_w1_q <= rgray_q;
    rgray_w2_q <= rgray_w1_q;
    if (write_i) begin
      memory[wbin_q[AW-1:0]] <= wdata_i;
      wbin_q <= wnext;
      wgray_q <= wnext ^ (wnext >> 1);
    end
    if (wrst_i) {wbin_q, wgray_q, rgray_w1_q, rgray_w2_q} <= '0;
  end

  assign rnext = rbin_q + 1;
  assign valid_o = rgray_q != wgray_r2_q;
  assign rdata_o = memory[rbin_q[AW-1:0]];
  assign settled_o = wgray_r2_q == wgray_q && wgray_r1_q == wgray_q;
  always_ff @(posedge rclk_free_i) begin
    wgray_r1_q <= wgray_q;
    wgray_r2_q <= wgray_r1_q;
    if (rrst_i) {wgray_r1_q, wgray_r2_q} <= '0;
  end
  always_ff @(posedge rclk_i) begin
    if (read_i) begin
      rbin_q <= rnext;
      rgray_q <= rnext ^ (rnext >> 1);
    end
    if (rrst_i) {rbin_q, rgray_q} <= '0;
  end

`ifndef SYNTHESIS
  // By the true pointers, not by a side's synchronised copy.
  always_ff @(posedge wclk_i)
    if (!wrst_i) assert (!(write_i &&
        wbin_q - rbin_q == (AW + 1)'(DEPTH))) else $error("async_fifo: written while full");
  always_ff @(posedge rclk_i)
    if (!rrst_i) assert (!(read_i && wbin_q == rbin_q)) else $error("async_fifo: read while empty");
`endif
endmodule
