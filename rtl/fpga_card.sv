// SPDX-License-Identifier: Apache-2.0
// A card for one FPGA: the board, the record ring in its block memory, and the local bus and a memory of 16 bits at its
// pins. This module is wiring. tools/synthesis card places and routes it.
// Latency, throughput and stall: as in the modules.
`include "config.svh"
module fpga_card #(
    `CARD_PARAMETERS,
    parameter logic [63:0] CONFIG_HASH = 0,
    localparam config_pkg::config_t CONFIG = `CARD_CONFIG,
    localparam int WORDS = records_pkg::RECORD_WORDS,
    localparam int SRAM_AW = $clog2(SRAM_RECORDS)
) (
    input logic clk_i,
    input logic rst_i,

    // The local bus, as in board.sv.
    input logic bus_valid_i,
    input logic bus_write_i,
    input logic [registers_pkg::SPACE_BITS-1:0] bus_space_i,
    input logic [31:0] bus_addr_i,
    input logic [63:0] bus_wdata_i,
    output logic bus_ready_o,
    output logic bus_rvalid_o,
    output logic [63:0] bus_rdata_o,
    output logic irq_o,

    // The memory, as in memory_port.sv.
    output logic memory_access_o,
    output logic memory_write_o,
    output logic [31:0] memory_addr_o,
    output logic [15:0] memory_data_o,
    input logic memory_ready_i,
    input logic memory_valid_i,
    input logic [15:0] memory_data_i
);
  if (EXP != 8 || MAN != 23 || ECC != 0) begin : g_format
    $error("fpga_card: needs fp32, without check bits");
  end
  logic ddr_write, ddr_read, ddr_ready, ddr_valid, sram_write, sram_read;
  logic rst_q;  // the path from a pin would be long
  always_ff @(posedge clk_i) rst_q <= rst_i;
  logic [31:0] ddr_write_addr, ddr_read_word;
  logic [63:0] ddr_write_data;
  logic [3:0] ddr_read_words;
  logic [1:0][7:0] unused_check;
  logic [records_pkg::DDR_WORDS-1:0][31:0] ddr_data;
  logic [SRAM_AW-1:0] sram_write_addr, sram_read_addr;
  logic [WORDS-1:0][31:0] sram_write_data, sram_read_data;
  board #(.CONFIG(CONFIG)) functions (
      .clk_i, .rst_i(rst_q), .bus_valid_i, .bus_write_i, .bus_space_i, .bus_addr_i, .bus_wdata_i, .bus_ready_o,
      .bus_rvalid_o, .bus_rdata_o, .irq_o, .ddr_write_o(ddr_write), .ddr_write_addr_o(ddr_write_addr),
      .ddr_write_data_o(ddr_write_data), .ddr_write_check_o(unused_check), .ddr_read_o(ddr_read),
      .ddr_read_word_o(ddr_read_word), .ddr_read_words_o(ddr_read_words), .ddr_ready_i(ddr_ready),
      .ddr_valid_i(ddr_valid), .ddr_data_i(ddr_data), .ddr_check_i('0), .sram_write_o(sram_write),
      .sram_write_addr_o(sram_write_addr), .sram_write_data_o(sram_write_data), .sram_read_o(sram_read),
      .sram_read_addr_o(sram_read_addr), .sram_read_data_i(sram_read_data));
  memory_port port (
      .clk_i, .rst_i(rst_q), .read_i(ddr_read), .read_word_i(ddr_read_word), .read_words_i(ddr_read_words),
      .write_i(ddr_write), .write_addr_i(ddr_write_addr), .write_data_i(ddr_write_data), .ready_o(ddr_ready),
      .valid_o(ddr_valid), .data_o(ddr_data), .access_o(memory_access_o), .write_o(memory_write_o),
      .addr_o(memory_addr_o), .data_to_memory_o(memory_data_o), .ready_i(memory_ready_i), .valid_i(memory_valid_i),
      .data_i(memory_data_i));
  record_memory #(.W(32 * WORDS), .RECORDS(SRAM_RECORDS)) ring (
      .clk_i, .write_i(sram_write), .write_addr_i(sram_write_addr), .write_data_i(sram_write_data),
      .read_i(sram_read), .read_addr_i(sram_read_addr), .read_data_o(sram_read_data));
endmodule
