// SPDX-License-Identifier: Apache-2.0
// Error correction of DDR read data, per word. One wrong bit is corrected. A word with two wrong bits becomes NaN,
// which is bad input in every shape, so no result depends on it. A correction is not written back.
// Latency: 1 cycle.
// Throughput: one beat per cycle.
// Stall: none.
`include "secded.svh"
module ddr_ecc #(
    parameter config_pkg::config_t CONFIG,
    localparam int EXP = CONFIG.exp,
    localparam int MAN = CONFIG.man,
    localparam int CW = formats_pkg::container(EXP, MAN),
    localparam int BEAT = records_pkg::DDR_WORDS,
    localparam int R = `SECDED_BITS(CW)
) (
    input logic clk_i,
    input logic rst_i,
    input logic valid_i,
    input logic [BEAT-1:0][CW-1:0] data_i,
    input logic [BEAT-1:0][R-1:0] check_i,
    output logic valid_o,
    output logic [BEAT-1:0][CW-1:0] data_o,
    output logic [BEAT-1:0] corrected_o,  // words, in the cycles of valid_o
    output logic [BEAT-1:0] failed_o
);
  localparam logic [CW-1:0] QNAN = (((CW'(1) << EXP) - 1) << MAN) | (CW'(1) << (MAN - 1));
  logic [BEAT-1:0][CW-1:0] data;
  logic [BEAT-1:0] corrected, failed;
  for (genvar k = 0; k < BEAT; k++) begin : word
    logic [CW-1:0] decoded;
    secded_decode #(.W(CW)) decode (.data_i(data_i[k]), .check_i(check_i[k]), .data_o(decoded),
        .corrected_o(corrected[k]), .failed_o(failed[k]));
    assign data[k] = failed[k] ? QNAN : decoded;
  end
  always_ff @(posedge clk_i) begin
    valid_o <= valid_i && !rst_i;
    data_o <= data;
    corrected_o <= valid_i ? corrected : '0;
    failed_o <= valid_i ? failed : '0;
  end
endmodule
