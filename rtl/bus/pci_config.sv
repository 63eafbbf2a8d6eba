// SPDX-License-Identifier: Apache-2.0
// Type 0 configuration space of PCI Local Bus 2.3, chapter 6: identity, command and status, class, latency timer, BAR0,
// interrupt.
// Latency: 0 cycles for reads, 1 cycle for writes.
// Throughput: one access per cycle.
// Stall: none.
module pci_config (
    input logic clk_i,
    input logic rst_i,
    input logic write_i,
    input logic [5:0] index_i,  // number of the 32-bit register
    input logic [3:0] enable_i, // byte enables
    input logic [31:0] wdata_i,
    output logic [31:0] rdata_o,

    output logic memory_o,  // command register: the card answers memory accesses,
    output logic master_o,  // may become bus master,
    output logic parity_o,  // drives PERR# on parity errors,
    output logic serr_o,    // and SERR#,
    output logic intx_o,    // and may drive INTA#
    output logic [7:0] latency_o,
    output logic [15:0] status_o,
    output logic [31:pci_pkg::PCI_BAR_BITS] bar_o,

    input logic interrupt_i,
    input logic detected_parity_i,
    input logic signaled_serr_i,
    input logic master_abort_i,
    input logic target_abort_i,           // received
    input logic signaled_target_abort_i,
    input logic master_parity_i           // in a transfer by this card
);
  import pci_pkg::*;
  logic [15:0] command_q;
  logic [7:0] cache_line_q, latency_q, line_q;
  logic [31:PCI_BAR_BITS] bar_q;
  logic [5:0] error_q;  // status [15:11] and [8]
  logic [31:0] strobe;
  assign strobe = {{8{enable_i[3]}}, {8{enable_i[2]}}, {8{enable_i[1]}}, {8{enable_i[0]}}} & {32{write_i}};

  assign memory_o = command_q[1];
  assign master_o = command_q[2];
  assign parity_o = command_q[6];
  assign serr_o = command_q[8];
  assign intx_o = !command_q[10];
  assign latency_o = latency_q;
  assign bar_o = bar_q;
  // Medium DEVSEL# timing, 66 MHz capable.
  assign status_o = {error_q[5:1], 2'b01, error_q[0], 4'b0010, interrupt_i, 3'b000};

  always_comb begin
    case (index_i)
      6'd0: rdata_o = {PCI_DEVICE_ID, PCI_VENDOR_ID};
      6'd1: rdata_o = {status_o, command_q};
      6'd2: rdata_o = PCI_CLASS;
      6'd3: rdata_o = {16'b0, latency_q, cache_line_q};
      6'd4: rdata_o = {bar_q, {PCI_BAR_BITS{1'b0}}};
      6'd11: rdata_o = PCI_SUBSYSTEM;
      6'd15: rdata_o = {16'b0, 8'd1, line_q};
      default: rdata_o = '0;
    endcase
  end

  localparam logic [15:0] COMMAND_BITS = 16'b0000_0101_0100_0110;
  always_ff @(posedge clk_i) begin
    if (index_i == 6'd1) command_q <= ((command_q & ~strobe[15:0]) | (wdata_i[15:0] & strobe[15:0])) & COMMAND_BITS;
    if (index_i == 6'd3) {latency_q, cache_line_q} <= ({latency_q,
        cache_line_q} & ~strobe[15:0]) | (wdata_i[15:0] & strobe[15:0]);
    if (index_i == 6'd4)
      bar_q <= (bar_q & ~strobe[31:PCI_BAR_BITS]) | (wdata_i[31:PCI_BAR_BITS] & strobe[31:PCI_BAR_BITS]);
    if (index_i == 6'd15) line_q <= (line_q & ~strobe[7:0]) | (wdata_i[7:0] & strobe[7:0]);
    error_q <= (error_q & ~(index_i == 6'd1 ? {wdata_i[31:27] & strobe[31:27], wdata_i[24] & strobe[24]} : 6'b0)) |
        {detected_parity_i, signaled_serr_i, master_abort_i, target_abort_i, signaled_target_abort_i, master_parity_i};
    if (rst_i) begin
      command_q <= '0;
      {latency_q, cache_line_q, line_q} <= '0;
      bar_q <= '0;
      error_q <= '0;
    end
  end
endmodule
