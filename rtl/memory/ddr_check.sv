// SPDX-License-Identifier: Apache-2.0
// Check bits of DDR, if the card has them. They are made for written words and checked on read words. Errors are
// counted only for words of a beat that belong to a slot.
// Latency: 0 cycles for writes; 1 cycle for reads with ECC, else 0.
// Throughput: one beat per cycle in each direction.
// Stall: none.
`include "secded.svh"
module ddr_check #(
    parameter config_pkg::config_t CONFIG,
    localparam int CW = formats_pkg::container(CONFIG.exp, CONFIG.man),
    localparam int BEAT = records_pkg::DDR_WORDS
) (
    input logic clk_i,
    input logic rst_i,
    input logic [63:0] write_data_i,
    output logic [64/CW-1:0][7:0] write_check_o,
    input logic read_valid_i,
    input logic [BEAT-1:0][CW-1:0] read_data_i,
    input logic [BEAT-1:0][7:0] read_check_i,
    input logic [3:0] words_i,  // words of the current beat in use
    output logic valid_o,
    output logic [BEAT-1:0][CW-1:0] data_o,
    output logic [3:0] corrected_o,  // words, this cycle
    output logic [3:0] failed_o
);
  if (CONFIG.ecc != 0) begin : g_ecc
    localparam int R = `SECDED_BITS(CW);
    logic [BEAT-1:0][R-1:0] check;
    logic [BEAT-1:0] corrected, failed, in_use;
    for (genvar k = 0; k < 64 / CW; k++) begin : written
      logic [R-1:0] bits;
      secded_encode #(.W(CW)) encode (.data_i(write_data_i[k*CW+:CW]), .check_o(bits));
      assign write_check_o[k] = 8'(bits);
    end
    for (genvar k = 0; k < BEAT; k++) begin : word
      assign check[k] = read_check_i[k][R-1:0];
      assign in_use[k] = valid_o && 4'(k) < words_i;
    end
    ddr_ecc #(.CONFIG(CONFIG)) correct (
        .clk_i, .rst_i, .valid_i(read_valid_i), .data_i(read_data_i), .check_i(check), .valid_o, .data_o,
        .corrected_o(corrected), .failed_o(failed));
    assign corrected_o = 4'($countones(corrected & in_use));
    assign failed_o = 4'($countones(failed & in_use));
    logic unused_check;
    assign unused_check = &{1'b0, read_check_i};
  end else begin : g_no_ecc
    assign write_check_o = '0;
    assign valid_o = read_valid_i;
    assign data_o = read_data_i;
    assign {corrected_o, failed_o} = '0;
    logic unused_check;
    assign unused_check = &{1'b0, clk_i, rst_i, write_data_i, read_check_i, words_i};
  end
endmodule
