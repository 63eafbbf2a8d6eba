// SPDX-License-Identifier: Apache-2.0
// A PCI card: pci_bridge on one side, the board on the other, and the local bus between them.
// It has two clocks: the PCI clock, and the core clock for everything else. The ports belong to the two modules.
// Reset: `rst_i` is one line for both domains, held for at least four cycles of each. With RESET_STAGES = 0 it must be
// synchronous to both, as in a simulation. Hardware has 2 or more: then reset begins at once, and each domain leaves it
// with its own clock, in any order. Constraints: card.sdc.
// Latency, throughput and stall: as in the modules.
`include "config.svh"
module card #(
    `CARD_PARAMETERS,
    parameter int RESET_STAGES = 0,  // of the reset synchronisers, one per domain: 0, or 2 and more (reset_sync)
    parameter logic [63:0] CONFIG_HASH = 0,
    localparam config_pkg::config_t CONFIG = `CARD_CONFIG,
    localparam int CW = formats_pkg::container(EXP, MAN),
    localparam int RECORD_WORDS = records_pkg::RECORD_WORDS,
    localparam int SRAM_AW = $clog2(SRAM_RECORDS)
) (
    input logic clk_pci_i,
    input logic clk_i,
    input logic rst_i,  // of both clock domains
    output logic idle_o,

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

    output logic ddr_write_o,  // 64 bits at a byte offset
    output logic [31:0] ddr_write_addr_o,
    output logic [63:0] ddr_write_data_o,
    // with ECC, check bits of the words: the lower bits of the 8, as secded.svh defines
    output logic [64/CW-1:0][7:0] ddr_write_check_o,
    output logic ddr_read_o,  // reads DDR_WORDS words at an address in words; data comes in order
    output logic [31:0] ddr_read_word_o,
    output logic [3:0] ddr_read_words_o,  // words in use; a memory may leave the others out
    input logic ddr_ready_i,  // a read or write is taken; until then it stays
    input logic ddr_valid_i,
    input logic [records_pkg::DDR_WORDS-1:0][CW-1:0] ddr_data_i,
    input logic [records_pkg::DDR_WORDS-1:0][7:0] ddr_check_i,

    output logic sram_write_o,
    output logic [SRAM_AW-1:0] sram_write_addr_o,
    output logic [RECORD_WORDS-1:0][CW-1:0] sram_write_data_o,
    output logic sram_read_o,
    output logic [SRAM_AW-1:0] sram_read_addr_o,
    input logic [RECORD_WORDS-1:0][CW-1:0] sram_read_data_i  // one cycle after sram_read_o
);
  logic rst_core, bus_valid, bus_write, bus_ready, bus_rvalid, irq;
  logic [registers_pkg::SPACE_BITS-1:0] bus_space;
  logic [31:0] bus_addr;
  logic [63:0] bus_wdata, bus_rdata;
  pci_bridge #(.RESET_STAGES(RESET_STAGES)) bridge (
      .clk_pci_i, .clk_i, .rst_i, .rst_o(rst_core), .idle_o, .pci_ad_i, .pci_ad_o, .pci_ad_oe, .pci_ad64_oe,
      .pci_cbe_n_i, .pci_cbe_n_o,
      .pci_cbe_oe, .pci_par_i, .pci_par_o, .pci_par_oe, .pci_par64_i, .pci_par64_o, .pci_par64_oe, .pci_frame_n_i,
      .pci_frame_n_o, .pci_frame_oe, .pci_req64_n_i, .pci_req64_n_o, .pci_req64_oe, .pci_irdy_n_i, .pci_irdy_n_o,
      .pci_irdy_oe, .pci_trdy_n_i, .pci_trdy_n_o, .pci_trdy_oe, .pci_stop_n_i, .pci_stop_n_o, .pci_stop_oe,
      .pci_devsel_n_i, .pci_devsel_n_o, .pci_devsel_oe, .pci_ack64_n_i, .pci_ack64_n_o, .pci_ack64_oe, .pci_perr_n_i,
      .pci_perr_n_o, .pci_perr_oe, .pci_serr_oe, .pci_inta_oe, .pci_idsel_i, .pci_req_n_o, .pci_gnt_n_i,
      .bus_valid_o(bus_valid), .bus_write_o(bus_write), .bus_space_o(bus_space), .bus_addr_o(bus_addr),
      .bus_wdata_o(bus_wdata), .bus_ready_i(bus_ready), .bus_rvalid_i(bus_rvalid), .bus_rdata_i(bus_rdata),
      .irq_i(irq));
  board #(.CONFIG(CONFIG)) functions (
      .clk_i, .rst_i(rst_core), .bus_valid_i(bus_valid), .bus_write_i(bus_write), .bus_space_i(bus_space),
      .bus_addr_i(bus_addr),
      .bus_wdata_i(bus_wdata), .bus_ready_o(bus_ready), .bus_rvalid_o(bus_rvalid), .bus_rdata_o(bus_rdata), .irq_o(irq),
      .ddr_write_o, .ddr_write_addr_o, .ddr_write_data_o, .ddr_write_check_o, .ddr_read_o, .ddr_read_word_o,
      .ddr_read_words_o, .ddr_ready_i, .ddr_valid_i, .ddr_data_i, .ddr_check_i, .sram_write_o, .sram_write_addr_o,
      .sram_write_data_o, .sram_read_o, .sram_read_addr_o, .sram_read_data_i);
endmodule
