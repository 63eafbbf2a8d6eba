// SPDX-License-Identifier: Apache-2.0
// Nodes of a BVH, in their own memory beside the units that read them: external chips or on-chip memory.
// Each reader has a port, which in hardware is a copy. A write goes to all copies.
// Node n on the bus: words 0 to 15 are at byte 64 n, words 16 and 17 at 64 NODES + 8 n. So no address needs a division.
// With HALVES the words of a half come at a time, in both halves of node_o.
// Latency: 1 cycle; a read in the cycle of a write returns the old word.
// Throughput: per cycle, one beat or node written, and one node per reader.
// Stall: none.
`include "secded.svh"
module node_memory #(
    parameter int NODES = 4096,  // power of two
    parameter int READERS = 2,
    parameter int ECC = 0,       // 1: words have check bits
    parameter bit HALVES = 0,    // without ECC and refits
    localparam int NW = $clog2(NODES)
) (
    input logic clk_write_i,  // runs during writes and refits
    input logic write_i,
    input logic [31:0] addr_i,
    input logic [63:0] data_i,
    input logic [17:0][31:0] flip_i,  // injected bit errors, per word
    input logic refit_i,  // writes a whole node; never together with a bus write
    input logic [NW-1:0] refit_at_i,
    input logic [bvh_pkg::NODE_WORDS-1:0][31:0] refit_node_i,

    input logic clk_i,
    input logic [READERS-1:0][NW-1:0] at_i,
    input logic [READERS-1:0] second_i,  // with HALVES: the second half
    output logic [READERS-1:0][bvh_pkg::NODE_WORDS-1:0][31:0] node_o,
    output logic [READERS-1:0][4:0] corrected_o,  // corrected words of node_o
    output logic [READERS-1:0] failed_o
);
  localparam int WORDS = bvh_pkg::NODE_WORDS;
  if ((NODES & (NODES - 1)) != 0 || NODES > bvh_pkg::MOST_NODES) begin : g_nodes
    $error("node_memory: NODES must be a power of two, at most %0d", bvh_pkg::MOST_NODES);
  end
  logic last;
  assign last = addr_i[6+NW];
  logic unused;
  assign unused = &{1'b0, addr_i, flip_i, second_i};
  logic [3:0] beat;
  logic [NW-1:0] row;
  logic [1:0][31:0] written;
  assign beat = last ? 4'd8 : {1'b0, addr_i[5:3]};
  assign row = last ? addr_i[3+:NW] : addr_i[6+:NW];
  if (ECC != 0) begin : g_flipped
    assign written = data_i ^ flip_i[{beat, 1'b0}+:2];
  end else begin : g_whole
    assign written = data_i;
  end
  // The host writes between passes, and a refit reads a node before it writes it.
  if (HALVES) begin : g_halves
    localparam int HALF = bvh_pkg::HALF;
    if (ECC != 0) $error("node_memory: HALVES is without ECC");
    // A beat's two words are in different columns.
    for (genvar c = 0; c < HALF; c++) begin : column
      (* no_rw_check *) logic [31:0] words[2*NODES];
      logic first, second;
      assign first = beat == 4'(c / 2);
      assign second = beat == 4'((HALF + c) / 2);
      always_ff @(posedge clk_write_i)
        if (write_i && (first || second)) words[{row, second}] <= first ? written[c%2] : written[(HALF+c)%2];
      for (genvar r = 0; r < READERS; r++) begin : reader
        logic [31:0] word_q;
        always_ff @(posedge clk_i) word_q <= words[{at_i[r], second_i[r]}];
        assign {node_o[r][HALF+c], node_o[r][c]} = {2{word_q}};
      end
    end
    assign {corrected_o, failed_o} = '0;
    logic unused_refit;
    assign unused_refit = &{1'b0, refit_i, refit_at_i, refit_node_i};
  end else begin : g_at_once
    (* no_rw_check *) logic [WORDS-1:0][31:0] nodes[NODES];
    always_ff @(posedge clk_write_i)
      if (refit_i) nodes[refit_at_i] <= refit_node_i;
      else if (write_i) nodes[row][{beat, 1'b0}+:2] <= written;
    for (genvar r = 0; r < READERS; r++) begin : reader
      logic [WORDS-1:0][31:0] node_q;
      always_ff @(posedge clk_i) node_q <= nodes[at_i[r]];
`ifdef VERILATOR
      // Prefetches the node in simulation, before the cycle that reads it.
      always_comb $c("host_fp::expect(", nodes, "[", at_i[r], "]);");
`endif
      if (ECC == 0) begin : g_plain
        assign node_o[r] = node_q;
        assign {corrected_o[r], failed_o[r]} = '0;
      end
    end
  end

  // ---- Check bits ----
  if (ECC != 0) begin : g_ecc
    localparam int R = `SECDED_BITS(32);
    (* no_rw_check *) logic [WORDS-1:0][R-1:0] checks[NODES];
    logic [1:0][R-1:0] written_check;
    logic [WORDS-1:0][R-1:0] refit_check;
    for (genvar w = 0; w < 2; w++) begin : of_beat
      secded_encode #(.W(32)) encode (.data_i(data_i[32*w+:32]), .check_o(written_check[w]));
    end
    for (genvar w = 0; w < WORDS; w++) begin : of_node
      secded_encode #(.W(32)) encode (.data_i(refit_node_i[w]), .check_o(refit_check[w]));
    end
    always_ff @(posedge clk_write_i)
      if (refit_i) checks[refit_at_i] <= refit_check;
      else if (write_i) checks[row][{beat, 1'b0}+:2] <= written_check;
    for (genvar r = 0; r < READERS; r++) begin : checked
      logic [WORDS-1:0][R-1:0] check_q;
      always_ff @(posedge clk_i) check_q <= checks[at_i[r]];
      words_ecc #(.WORDS(WORDS)) correct (.data_i(g_at_once.reader[r].node_q), .check_i(check_q), .data_o(node_o[r]),
          .corrected_o(corrected_o[r]), .failed_o(failed_o[r]));
    end
  end
endmodule
