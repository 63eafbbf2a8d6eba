// SPDX-License-Identifier: Apache-2.0
// Registers of the bridge in BAR0 (pci_pkg::PCI_REG_*): settings and state of the descriptor ring, interrupt causes,
// counters. Ring settings are refused while the ring runs. Such a write, or a start with settings out of range, halts
// the ring with an interrupt.
// Latency: 1 cycle for writes, 0 for reads.
// Throughput: one access per cycle.
// Stall: none.
module pci_registers (
    input logic clk_i,
    input logic rst_i,
    input logic write_i,
    input logic [11:0] offset_i,
    input logic [63:0] wdata_i,
    output logic [63:0] rdata_o,
    output logic interrupt_o,
    output logic active_o,

    output logic run_o,
    output logic clear_o,  // pulse: the ring restarts
    output logic [23:0] ring_base_o,
    output logic [15:0] ring_size_o,
    output logic [15:0] ring_tail_o,
    output logic [23:0] completion_base_o,
    output logic [12:0] burst_o,
    output logic [15:0] retry_limit_o,
    input logic [15:0] head_i,
    input logic busy_i,
    input logic clearing_i,
    input logic completion_i,   // a descriptor with an interrupt is done
    input logic fault_i,        // the ring halts with a fault
    input logic [7:0] code_i,
    input logic [7:0] where_i,
    input logic [31:0] fault_addr_i,
    input logic card_irq_i,
    input logic [6:0] count_i,  // events: abort, parity error, disconnect, retry, wait, beat, burst
    input logic bus_busy_i
);
  import pci_pkg::*;
  localparam logic [15:0] RING_MAX = 16'd32768;
  logic run_q, halted_q, stop_q, clear, settings_ok, run_requested, refused, ring_register, fault;
  logic [1:0] irq_q;  // completion and halted
  logic [2:0] mask_q, irq;
  logic [23:0] ring_base_q, completion_base_q;
  logic [15:0] size_q, tail_q, retry_limit_q;
  logic [12:0] burst_q;
  logic [7:0] code_q, where_q, code, where;
  logic [31:0] fault_addr_q;
  logic [7:0][47:0] count_q;

  function automatic access(input logic [15:0] at);  // the access is to this register
    access = {4'b0001, offset_i} == at;
  endfunction
  assign ring_register = access(PCI_REG_RING_BASE) || access(PCI_REG_RING_SIZE) || access(PCI_REG_COMPLETION_BASE) ||
      access(PCI_REG_BURST);
  assign clear = write_i && access(PCI_REG_CONTROL) && wdata_i[PCI_CONTROL_CLEAR] && !busy_i;
  assign run_requested = write_i && access(PCI_REG_CONTROL) && wdata_i[PCI_CONTROL_RUN] && !(halted_q && !clear);
  assign settings_ok = ring_base_q[4:0] == 0 && completion_base_q[3:0] == 0 && size_q >= 2 && size_q <= RING_MAX &&
      tail_q < size_q;
  assign refused = (run_requested && !settings_ok && !clear) || (write_i && ring_register && run_q) ||
      (write_i && access(PCI_REG_RING_TAIL) && run_q && wdata_i >= 64'(size_q)) || (stop_q && run_q && !busy_i);
  assign fault = fault_i || refused;
  assign code = fault_i ? code_i : (stop_q && run_q) ? PCI_CODE_STOPPED : PCI_CODE_SETTINGS;
  assign where = fault_i ? where_i : PCI_WHERE_SETTINGS;
  assign irq = {card_irq_i, irq_q};
  assign interrupt_o = (irq & mask_q) != 0;
  assign active_o = stop_q;

  assign run_o = run_q && !stop_q;
  assign clear_o = clear;
  assign ring_base_o = ring_base_q;
  assign ring_size_o = size_q;
  assign ring_tail_o = tail_q;
  assign completion_base_o = completion_base_q;
  assign burst_o = burst_q;
  assign retry_limit_o = retry_limit_q;

  logic [63:0] status;
  always_comb begin
    status = '0;
    status[PCI_STATUS_RUN] = run_q;
    status[PCI_STATUS_HALTED] = halted_q;
    status[PCI_STATUS_BUSY] = busy_i;
    status[PCI_STATUS_CLEARING] = clearing_i;
    status[PCI_STATUS_CODE+:8] = code_q;
    status[PCI_STATUS_WHERE+:8] = where_q;
    case ({4'b0001, offset_i})
      PCI_REG_STATUS: rdata_o = status;
      PCI_REG_IRQ_STATUS: rdata_o = 64'(irq);
      PCI_REG_IRQ_MASK: rdata_o = 64'(mask_q);
      PCI_REG_RING_BASE: rdata_o = 64'(ring_base_q);
      PCI_REG_RING_SIZE: rdata_o = 64'(size_q);
      PCI_REG_RING_HEAD: rdata_o = 64'(head_i);
      PCI_REG_RING_TAIL: rdata_o = 64'(tail_q);
      PCI_REG_COMPLETION_BASE: rdata_o = 64'(completion_base_q);
      PCI_REG_BURST: rdata_o = 64'(burst_q);
      PCI_REG_RETRY_LIMIT: rdata_o = 64'(retry_limit_q);
      PCI_REG_FAULT_ADDR: rdata_o = 64'(fault_addr_q);
      default: rdata_o = (offset_i >= PCI_REG_BURSTS[11:0] &&
          offset_i <= PCI_REG_BUSY[11:0]) ? 64'(count_q[offset_i[5:3]]) : '0;
    endcase
  end

  // A value out of range reads back as the stored value, and is refused when the ring is started.
  function automatic [23:0] address(input logic [63:0] value);
    address = |value[63:24] ? '1 : value[23:0];
  endfunction
  function automatic [15:0] number(input logic [63:0] value);
    number = |value[63:16] ? '1 : value[15:0];
  endfunction
  always_ff @(posedge clk_i) begin
    if (write_i) begin
      case ({4'b0001, offset_i})
        PCI_REG_IRQ_MASK: mask_q <= wdata_i[2:0];
        PCI_REG_RETRY_LIMIT: retry_limit_q <= number(wdata_i);
        PCI_REG_RING_TAIL: if (!refused) tail_q <= number(wdata_i);
        PCI_REG_RING_BASE: if (!run_q) ring_base_q <= address(wdata_i);
        PCI_REG_RING_SIZE: if (!run_q) size_q <= number(wdata_i);
        PCI_REG_COMPLETION_BASE: if (!run_q) completion_base_q <= address(wdata_i);
        PCI_REG_BURST: if (!run_q) burst_q <= (wdata_i < 64) ? 13'd64 : (wdata_i > 4096) ? 13'd4096 : {wdata_i[12:3],
            3'b0};
        default: ;
      endcase
    end
    if (write_i && access(PCI_REG_CONTROL) && wdata_i[PCI_CONTROL_STOP]) stop_q <= run_q;
    if (clear) begin
      {halted_q, run_q, stop_q} <= '0;
      {code_q, where_q} <= '0;
      fault_addr_q <= '0;
      tail_q <= '0;
    end else if (run_requested && settings_ok) run_q <= 1;
    if (fault) begin
      {halted_q, run_q, stop_q} <= 3'b100;
      if (!halted_q) begin
        code_q <= code;
        where_q <= where;
        fault_addr_q <= fault_i ? fault_addr_i : '0;
      end
    end
    irq_q <= (irq_q & ~((write_i && access(PCI_REG_IRQ_STATUS)) ? wdata_i[1:0] : 2'b0)) | {fault, completion_i};
    for (int c = 0; c < 7; c++) if (count_i[c]) count_q[c] <= count_q[c] + 1;
    if (bus_busy_i) count_q[7] <= count_q[7] + 1;
    if (write_i && access(PCI_REG_CONTROL) && wdata_i[PCI_CONTROL_COUNT]) count_q <= '0;
    if (rst_i) begin
      {run_q, halted_q, stop_q} <= '0;
      irq_q <= '0;
      mask_q <= '0;
      {ring_base_q, completion_base_q} <= '0;
      {size_q, tail_q} <= '0;
      retry_limit_q <= '0;
      burst_q <= 13'd4096;
      {code_q, where_q} <= '0;
      fault_addr_q <= '0;
      count_q <= '0;
    end
  end
endmodule
