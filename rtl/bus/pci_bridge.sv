// SPDX-License-Identifier: Apache-2.0
// PCI Local Bus 2.3 device, 64 bits and 66 MHz, in front of a local bus. Target (pci_target), bus master (pci_master)
// and scatter-gather DMA (pci_dma) are in the PCI clock domain. The master of the local bus (local_master) is in the
// core's. Two asynchronous FIFOs connect the domains: one for requests, one for read data and the card's interrupt
// line.
//
// Shared pins are split into _i (the wire), _o and _oe. Signals that are low when asserted have an _n. All outputs are
// registers. BAR0: registers of the card (SPACE_REG), registers of the bridge, page table (pci_pkg::PCI_*).
// While no FRAME# is asserted and no access is under way, the PCI side's clock is gated, except for the FIFO's
// synchroniser. Reset: `rst_i` is one line for both domains, held for at least four cycles of each. With RESET_STAGES =
// 0 it must be synchronous to both clocks, as in a simulation. Hardware has 2 or more, and then it may be asynchronous
// (reset_sync.sv).
// Latency, throughput and stall: as in the modules.
module pci_bridge #(
    parameter int RESET_STAGES = 0  // of the reset synchronisers, as in reset_sync
) (
    input logic clk_pci_i,
    input logic clk_i,
    input logic rst_i,
    output logic rst_o,  // reset of the core's domain
    output logic idle_o,  // for a simulator: with these inputs, the next edge of the PCI clock changes nothing

    input logic [63:0] pci_ad_i,
    output logic [63:0] pci_ad_o,
    output logic pci_ad_oe,
    output logic pci_ad64_oe,  // enable of the upper half
    input logic [7:0] pci_cbe_n_i,
    output logic [7:0] pci_cbe_n_o,
    output logic pci_cbe_oe,
    input logic pci_par_i,
    output logic pci_par_o,
    output logic pci_par_oe,
    input logic pci_par64_i,
    output logic pci_par64_o,
    output logic pci_par64_oe,
    input logic pci_frame_n_i,
    output logic pci_frame_n_o,
    output logic pci_frame_oe,
    input logic pci_req64_n_i,
    output logic pci_req64_n_o,
    output logic pci_req64_oe,
    input logic pci_irdy_n_i,
    output logic pci_irdy_n_o,
    output logic pci_irdy_oe,
    input logic pci_trdy_n_i,
    output logic pci_trdy_n_o,
    output logic pci_trdy_oe,
    input logic pci_stop_n_i,
    output logic pci_stop_n_o,
    output logic pci_stop_oe,
    input logic pci_devsel_n_i,
    output logic pci_devsel_n_o,
    output logic pci_devsel_oe,
    input logic pci_ack64_n_i,
    output logic pci_ack64_n_o,
    output logic pci_ack64_oe,
    input logic pci_perr_n_i,
    output logic pci_perr_n_o,
    output logic pci_perr_oe,
    output logic pci_serr_oe,  // open drain: low while this is high
    output logic pci_inta_oe,  // open drain
    input logic pci_idsel_i,
    output logic pci_req_n_o,
    input logic pci_gnt_n_i,

    output logic bus_valid_o,
    output logic bus_write_o,
    output logic [registers_pkg::SPACE_BITS-1:0] bus_space_o,
    output logic [31:0] bus_addr_o,
    output logic [63:0] bus_wdata_o,
    input logic bus_ready_i,
    input logic bus_rvalid_i,
    input logic [63:0] bus_rdata_i,
    input logic irq_i
);
  import pci_pkg::*;
  logic rst_pci;
  reset_sync #(.STAGES(RESET_STAGES)) reset_pci (.clk_i(clk_pci_i), .rst_i, .rst_o(rst_pci));
  reset_sync #(.STAGES(RESET_STAGES)) reset_core (.clk_i, .rst_i, .rst_o);
  localparam int REQUESTS = 16, RESPONSES = 16;

  // ---- The wires ----
  logic [63:0] ad;
  logic [7:0] cbe_n;
  logic par, par64, frame_n, req64_n, irdy_n, trdy_n, stop_n, devsel_n, ack64_n, perr_n, idsel, gnt_n;
  logic [83:0] wires, pins;
  assign wires = {pci_ad_i, pci_cbe_n_i, pci_par_i, pci_par64_i, pci_frame_n_i, pci_req64_n_i, pci_irdy_n_i,
      pci_trdy_n_i,
      pci_stop_n_i, pci_devsel_n_i, pci_ack64_n_i, pci_perr_n_i, pci_idsel_i, pci_gnt_n_i};
`ifdef VERILATOR
  pci_pins #(.W(84)) taken (.clk_i(clk_pci_i), .wires_i(wires), .wires_o(pins));
`else
  assign pins = wires;
`endif
  assign {ad, cbe_n, par, par64, frame_n, req64_n, irdy_n, trdy_n, stop_n, devsel_n, ack64_n, perr_n, idsel, gnt_n} =
      pins;

  // ---- Clock of the PCI side ----
  logic clk, active, target_active, master_active, dma_active, registers_active, response_valid, response_settled;
  logic inta, perr, perr_q, frame, irdy, clearing, request_valid;
  assign frame = !frame_n;
  assign irdy = !irdy_n;
  assign active = rst_pci | frame | irdy | target_active | master_active | dma_active | registers_active |
      response_valid | clearing | perr |
      perr_q | pci_serr_oe | (inta != pci_inta_oe) | (pci_par_oe != pci_ad_oe) | (pci_par64_oe != pci_ad64_oe);
  assign idle_o = !active && response_settled;
  clock_gate gate (.clk_i(clk_pci_i), .enable_i(active), .clk_o(clk));

  // ---- Parity over the bus in the previous cycle ----
  logic par_q, par64_q, parity_error, parity64_error;
  assign parity_error = par_q != par;
  assign parity64_error = par64_q != par64;
  assign pci_par_o = par_q;
  assign pci_par64_o = par64_q;
  always_ff @(posedge clk) begin
    par_q <= ^{ad[31:0], cbe_n[3:0]};
    par64_q <= ^{ad[63:32], cbe_n[7:4]};
    pci_par_oe <= pci_ad_oe && !rst_pci;
    pci_par64_oe <= pci_ad64_oe && !rst_pci;
  end

  // ---- Configuration space and target ----
  logic [63:0] target_ad, master_ad, target_wdata, target_rdata;
  logic target_ad_oe, target_ad64_oe, target_oe, target_perr, target_detected, address_parity, target_aborts, own;
  logic trdy, stop, devsel, ack64, memory, master, parity, serr, intx, target_write, target_pop, target_rvalid;
  logic config_write, interrupt, master_detected, master_parity, master_abort, target_abort;
  logic [5:0] config_index;
  logic [3:0] config_enable;
  logic [31:0] config_wdata, config_rdata;
  logic [31:PCI_BAR_BITS] bar;
  logic [7:0] latency;
  logic [15:0] pci_status, target_offset;
  pci_config configuration (
      .clk_i(clk), .rst_i(rst_pci), .write_i(config_write), .index_i(config_index), .enable_i(config_enable),
      .wdata_i(config_wdata), .rdata_o(config_rdata), .memory_o(memory), .master_o(master), .parity_o(parity),
      .serr_o(serr), .intx_o(intx), .latency_o(latency), .status_o(pci_status), .bar_o(bar), .interrupt_i(interrupt),
      .detected_parity_i(target_detected | address_parity | master_detected),
      .signaled_serr_i(address_parity & parity & serr), .master_abort_i(master_abort), .target_abort_i(target_abort),
      .signaled_target_abort_i(target_aborts), .master_parity_i(master_parity));
  pci_target target (
      .clk_i(clk), .rst_i(rst_pci), .active_o(target_active), .ad_i(ad), .cbe_i(cbe_n), .frame_i(frame), .irdy_i(irdy),
      .idsel_i(idsel), .req64_i(!req64_n), .own_i(own), .parity_error_i(parity_error),
      .parity64_error_i(parity64_error), .ad_o(target_ad), .ad_oe_o(target_ad_oe), .ad64_oe_o(target_ad64_oe),
      .oe_o(target_oe), .trdy_o(trdy), .stop_o(stop), .devsel_o(devsel), .ack64_o(ack64), .perr_o(target_perr),
      .detected_parity_o(target_detected), .address_parity_o(address_parity), .target_abort_o(target_aborts),
      .memory_i(memory), .bar_i(bar), .config_write_o(config_write), .config_index_o(config_index),
      .config_enable_o(config_enable), .config_wdata_o(config_wdata), .config_rdata_i(config_rdata),
      .request_valid_o(request_valid), .request_write_o(target_write), .request_offset_o(target_offset),
      .request_wdata_o(target_wdata), .request_pop_i(target_pop), .rvalid_i(target_rvalid), .rdata_i(target_rdata));
  assign {pci_trdy_n_o, pci_stop_n_o, pci_devsel_n_o, pci_ack64_n_o} = ~{trdy, stop, devsel, ack64};
  assign {pci_trdy_oe, pci_stop_oe, pci_devsel_oe, pci_ack64_oe} = {4{target_oe}};

  // ---- Bus master ----
  logic [7:0] master_cbe, done_code;
  logic master_ad_oe, master_ad64_oe, master_frame, master_req64, master_irdy, master_req, master_perr;
  logic start, write, wpop, rvalid, done, retry, disconnect, burst, beat, waiting;
  logic [31:3] addr;
  logic [9:0] qwords, moved;
  logic [63:0] wdata, rdata;
  logic [31:0] done_addr;
  logic [15:0] retry_limit;
  pci_master initiator (
      .clk_i(clk), .rst_i(rst_pci), .active_o(master_active), .start_i(start), .write_i(write), .addr_i(addr),
      .qwords_i(qwords), .wdata_i(wdata), .wpop_o(wpop), .rvalid_o(rvalid), .rdata_o(rdata), .done_o(done),
      .code_o(done_code), .fault_addr_o(done_addr), .moved_o(moved), .enable_i(master), .parity_i(parity),
      .latency_i(latency), .retry_limit_i(retry_limit), .req_o(master_req), .gnt_i(!gnt_n),
      .ad_i(ad), .frame_i(frame), .irdy_i(irdy), .trdy_i(!trdy_n), .stop_i(!stop_n), .devsel_i(!devsel_n),
      .ack64_i(!ack64_n), .perr_i(!perr_n), .parity_error_i(parity_error), .parity64_error_i(parity64_error),
      .own_o(own), .ad_o(master_ad), .cbe_o(master_cbe), .ad_oe_o(master_ad_oe), .ad64_oe_o(master_ad64_oe),
      .cbe_oe_o(pci_cbe_oe), .frame_o(master_frame), .frame_oe_o(pci_frame_oe), .req64_o(master_req64),
      .irdy_o(master_irdy), .irdy_oe_o(pci_irdy_oe), .perr_o(master_perr), .burst_o(burst), .beat_o(beat),
      .wait_o(waiting), .retry_o(retry), .disconnect_o(disconnect), .detected_parity_o(master_detected),
      .master_parity_o(master_parity), .master_abort_o(master_abort), .target_abort_o(target_abort));
  assign pci_ad_o = target_ad_oe ? target_ad : master_ad;
  assign pci_ad_oe = target_ad_oe | master_ad_oe;
  assign pci_ad64_oe = target_ad64_oe | master_ad64_oe;
  assign pci_cbe_n_o = master_cbe;
  assign {pci_frame_n_o, pci_req64_n_o, pci_irdy_n_o, pci_req_n_o} =
      ~{master_frame, master_req64, master_irdy, master_req};
  assign pci_req64_oe = pci_frame_oe;

  // PERR# is driven high for one cycle before it is released. SERR# and INTA# have pull-ups.
  assign perr = master_perr | (target_perr & parity);
  assign pci_perr_n_o = !perr;
  assign pci_perr_oe = perr | perr_q;
  assign inta = interrupt & intx;
  always_ff @(posedge clk) begin
    perr_q <= perr && !rst_pci;
    pci_serr_oe <= address_parity && parity && serr && !rst_pci;
    pci_inta_oe <= inta && !rst_pci;
  end

  // ---- Registers, page table, DMA ----
  logic run, clear, busy, completion, fault, card_irq_q, register_write, page_write, page_valid, page_writable;
  logic [23:0] ring_base, completion_base;
  logic [15:0] ring_size, ring_tail, head;
  logic [12:0] burst_bytes;
  logic [7:0] fault_code, fault_where;
  logic [31:0] fault_addr;
  logic [63:0] register_rdata, page_rdata, local_data;
  logic [11:0] page;
  logic [31:PCI_PAGE_BITS] page_frame;
  logic local_valid, local_write, local_ready, local_rvalid;
  logic [registers_pkg::SPACE_BITS-1:0] local_space;
  logic [31:0] local_offset;
  pci_registers registers (
      .clk_i(clk), .rst_i(rst_pci), .write_i(register_write), .offset_i(target_offset[11:0]), .wdata_i(target_wdata),
      .rdata_o(register_rdata), .interrupt_o(interrupt), .active_o(registers_active), .run_o(run), .clear_o(clear),
      .ring_base_o(ring_base), .ring_size_o(ring_size), .ring_tail_o(ring_tail), .completion_base_o(completion_base),
      .burst_o(burst_bytes), .retry_limit_o(retry_limit), .head_i(head), .busy_i(busy), .clearing_i(clearing),
      .completion_i(completion), .fault_i(fault), .code_i(fault_code), .where_i(fault_where),
      .fault_addr_i(fault_addr), .card_irq_i(card_irq_q),
      .count_i({master_abort | target_abort, target_detected | address_parity | master_detected, disconnect, retry,
                waiting, beat, burst}),
      .bus_busy_i(frame | irdy));
  pci_page_table pages (
      .clk_i(clk), .rst_i(rst_pci), .clearing_o(clearing), .write_i(page_write), .entry_i(target_offset[14:3]),
      .wdata_i(target_wdata), .rdata_o(page_rdata), .lookup_i(page), .valid_o(page_valid), .writable_o(page_writable),
      .frame_o(page_frame));
  logic [63:0] response_data;
  pci_dma dma (
      .clk_i(clk), .rst_i(rst_pci), .active_o(dma_active), .run_i(run), .clear_i(clear), .ring_base_i(ring_base),
      .ring_size_i(ring_size), .ring_tail_i(ring_tail), .completion_base_i(completion_base), .burst_i(burst_bytes),
      .head_o(head), .busy_o(busy), .completion_o(completion), .fault_o(fault), .code_o(fault_code),
      .where_o(fault_where), .fault_addr_o(fault_addr), .pci_status_i(pci_status), .page_o(page),
      .page_valid_i(page_valid), .page_writable_i(page_writable), .page_frame_i(page_frame),
      .start_o(start), .write_o(write), .addr_o(addr), .qwords_o(qwords), .wdata_o(wdata), .wpop_i(wpop),
      .rvalid_i(rvalid), .rdata_i(rdata), .done_i(done), .done_code_i(done_code), .done_addr_i(done_addr),
      .moved_i(moved), .local_valid_o(local_valid), .local_write_o(local_write), .local_space_o(local_space),
      .local_offset_o(local_offset), .local_data_o(local_data), .local_ready_i(local_ready),
      .local_rvalid_i(local_rvalid), .local_rdata_i(response_data));

  // ---- Destination of a host access, which has priority over the DMA's ----
  logic to_card, to_pages, page_read_q, request_ready, forward, response_irq, response_dma;
  logic [$clog2(REQUESTS):0] request_free;
  logic [$clog2(RESPONSES):0] response_free;
  assign request_ready = request_free != 0;
  assign to_card = target_offset < PCI_REGISTERS;
  assign to_pages = target_offset >= PCI_PAGE_TABLE;
  assign forward = request_valid && to_card;
  assign local_ready = request_ready && !forward;
  assign register_write = request_valid && target_write && !to_card && !to_pages;
  assign page_write = request_valid && target_write && to_pages && !clearing;
  assign target_pop = request_valid && (to_card ? request_ready : !to_pages ||
      (target_write ? !clearing : page_read_q));
  assign target_rvalid = (response_valid && !response_irq && !response_dma) ||
      (target_pop && !target_write && !to_card);
  assign target_rdata = response_valid && !response_irq && !response_dma ? response_data :
      to_pages ? page_rdata : register_rdata;
  assign local_rvalid = response_valid && !response_irq && response_dma;
  always_ff @(posedge clk) begin
    page_read_q <= request_valid && to_pages && !target_write && !clearing && !page_read_q;
    if (response_valid && response_irq) card_irq_q <= response_data[0];
    if (rst_pci) begin
      page_read_q <= 0;
      card_irq_q <= 0;
    end
  end

  // ---- Core side ----
  logic clk_local, local_request_valid, local_request_pop, response_write, unused_settled;
  card_pkg::local_request_t request, local_request;
  card_pkg::local_response_t response;
  registers_pkg::bus_request_t bus_request;
  registers_pkg::bus_response_t bus_response;
  assign request = forward ?
      {1'b0, target_write, registers_pkg::SPACE_REG, 16'b0, target_offset, target_write ? target_wdata : 64'd1} :
      {1'b1, local_write, local_space, local_offset, local_data};
  async_fifo #(.W($bits(request)), .DEPTH(REQUESTS)) requests (
      .wclk_i(clk), .wrst_i(rst_pci), .write_i(request_ready && (forward || local_valid)), .wdata_i(request),
      .free_o(request_free), .rclk_i(clk_local), .rclk_free_i(clk_i), .rrst_i(rst_o), .valid_o(local_request_valid),
      .rdata_o(local_request), .read_i(local_request_pop), .settled_o(unused_settled));
  async_fifo #(.W($bits(response)), .DEPTH(RESPONSES)) responses (
      .wclk_i(clk_local), .wrst_i(rst_o), .write_i(response_write), .wdata_i(response), .free_o(response_free),
      .rclk_i(clk), .rclk_free_i(clk_pci_i), .rrst_i(rst_pci), .valid_o(response_valid),
      .rdata_o({response_irq, response_dma, response_data}),
      .read_i(response_valid), .settled_o(response_settled));
  local_master #(.FREE_W($clog2(RESPONSES) + 1)) local_bus (
      .clk_i, .rst_i(rst_o), .clk_o(clk_local), .request_valid_i(local_request_valid), .request_i(local_request),
      .request_pop_o(local_request_pop), .response_write_o(response_write), .response_o(response),
      .response_free_i(response_free), .bus_o(bus_request), .bus_i(bus_response), .irq_i);
  assign {bus_valid_o, bus_write_o, bus_space_o, bus_addr_o, bus_wdata_o} = bus_request;
  assign bus_response = {bus_ready_i, bus_rvalid_i, bus_rdata_i};

`ifndef SYNTHESIS
  always_ff @(posedge clk)
    if (!rst_pci) begin
      assert (!(target_ad_oe && master_ad_oe)) else $error("pci_bridge: target and master drive AD together");
      assert (!(target_rvalid && target_pop && response_valid && !response_irq &&
          !response_dma)) else $error("pci_bridge: two responses in one cycle");
    end
`endif
endmodule
