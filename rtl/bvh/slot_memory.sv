// SPDX-License-Identifier: Apache-2.0
// One word per slot of a BVH's leaves: its secondary, or its object. The bus writes two words per beat, slot s at byte
// 4 s.
// Latency: 1 cycle.
// Throughput: one beat written and one word read per cycle.
// Stall: none.
`include "secded.svh"
module slot_memory #(
    parameter int SLOTS = 32768,  // power of two
    parameter int ECC = 0,        // 1: words have check bits
    localparam int SW = $clog2(SLOTS)
) (
    input logic clk_bus_i,
    input logic write_i,
    input logic [31:0] addr_i,
    input logic [63:0] data_i,
    input logic [1:0][31:0] flip_i,  // injected bit errors of a write

    input logic clk_i,
    input logic read_i,
    input logic [SW-1:0] slot_i,
    output logic [31:0] word_o,  // held until the next read
    output logic corrected_o,
    output logic failed_o
);
  logic [1:0][31:0] words[SLOTS/2];
  logic [31:0] word_q;
  logic unused;
  assign unused = &{1'b0, addr_i, flip_i};
  always_ff @(posedge clk_bus_i) if (write_i) words[addr_i[3+:SW-1]] <= (ECC != 0) ? data_i ^ flip_i : data_i;
  always_ff @(posedge clk_i) if (read_i) word_q <= words[slot_i[SW-1:1]][slot_i[0]];
  if (ECC != 0) begin : g_ecc
    localparam int R = `SECDED_BITS(32);
    logic [1:0][R-1:0] checks[SLOTS/2];
    logic [1:0][R-1:0] written;
    logic [R-1:0] check_q;
    logic [4:0] count;
    for (genvar w = 0; w < 2; w++) begin : of_beat
      secded_encode #(.W(32)) encode (.data_i(data_i[32*w+:32]), .check_o(written[w]));
    end
    always_ff @(posedge clk_bus_i) if (write_i) checks[addr_i[3+:SW-1]] <= written;
    always_ff @(posedge clk_i) if (read_i) check_q <= checks[slot_i[SW-1:1]][slot_i[0]];
    words_ecc #(.WORDS(1)) correct (.data_i(word_q), .check_i(check_q), .data_o(word_o), .corrected_o(count),
        .failed_o);
    assign corrected_o = count[0];
    logic unused_count;
    assign unused_count = &{1'b0, count[4:1]};
  end else begin : g_no_ecc
    assign word_o = word_q;
    assign {corrected_o, failed_o} = '0;
  end
endmodule
