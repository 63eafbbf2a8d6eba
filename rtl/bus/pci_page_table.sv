// SPDX-License-Identifier: Apache-2.0
// Page table of the mapped address space. The driver writes it through BAR0, and every address of a descriptor is
// looked up in it. After reset all entries are cleared, one per cycle, before any access is served.
// Latency: 1 cycle from the number of an entry to its content.
// Throughput: one write and two reads per cycle.
// Stall: clearing_o.
module pci_page_table (
    input logic clk_i,
    input logic rst_i,
    output logic clearing_o,
    input logic write_i,
    input logic [11:0] entry_i,  // entry of the driver's access
    input logic [63:0] wdata_i,
    output logic [63:0] rdata_o,
    input logic [11:0] lookup_i,
    output logic valid_o,
    output logic writable_o,
    output logic [31:pci_pkg::PCI_PAGE_BITS] frame_o
);
  import pci_pkg::*;
  localparam int W = 2 + 32 - PCI_PAGE_FRAME;
  logic [W-1:0] memory[PCI_PAGES];
  logic [W-1:0] entry_q, lookup_q;
  logic [$clog2(PCI_PAGES):0] cleared_q;
  logic [11:0] entry;
  assign clearing_o = !cleared_q[$clog2(PCI_PAGES)];
  assign entry = clearing_o ? cleared_q[11:0] : entry_i;
  assign rdata_o = {32'b0, entry_q[W-1:2], 10'b0, entry_q[1:0]};
  assign {frame_o, writable_o, valid_o} = lookup_q;
  always_ff @(posedge clk_i) begin
    if (write_i || clearing_o)
      memory[entry] <= clearing_o ? '0 : {wdata_i[31:PCI_PAGE_FRAME], wdata_i[PCI_PAGE_WRITABLE],
          wdata_i[PCI_PAGE_VALID]};
    entry_q <= memory[entry_i];
    lookup_q <= memory[lookup_i];
    if (clearing_o) cleared_q <= cleared_q + 1;
    if (rst_i) cleared_q <= '0;
  end
  logic unused;
  assign unused = ^{wdata_i[63:32], wdata_i[PCI_PAGE_FRAME-1:2]};
endmodule
