// SPDX-License-Identifier: Apache-2.0
// Memory of 16 bits behind the board's DDR port, so that the card has few pins. A read of some words becomes as many
// pairs of reads, and a write of 64 bits four writes. The lower half of a word has the lower address.
// The memory takes an access while ready_i is high. It answers reads in order, at any time. A master that waits for a
// write keeps it until write_o and ready_o are high. The next access waits in registers while one is under way.
// Latency: the memory's, 2 cycles per word, and 3 cycles.
// Throughput: one access to the memory per cycle: a read per 2 cycles per word, a write per 4 cycles.
// Stall: ready_o.
module memory_port #(
    localparam int WORDS = records_pkg::DDR_WORDS
) (
    input logic clk_i,
    input logic rst_i,
    // The board's port: a read of the first words of a beat, or a write.
    input logic read_i,
    input logic [31:0] read_word_i,
    input logic [3:0] read_words_i,
    input logic write_i,
    input logic [31:0] write_addr_i,  // in bytes, a multiple of 8
    input logic [63:0] write_data_i,
    output logic ready_o,
    output logic valid_o,
    output logic [WORDS-1:0][31:0] data_o,  // words beyond the read's are of earlier reads

    output logic access_o,
    output logic write_o,
    output logic [31:0] addr_o,  // in halves of words
    output logic [15:0] data_to_memory_o,
    input logic ready_i,
    input logic valid_i,
    input logic [15:0] data_i
);
  // ---- Accesses ----
  localparam int LEFT = 5;  // bits of a number of halves
  localparam int DEPTH = 16;  // most reads under way
  localparam int DW = $clog2(DEPTH);
  logic writing_q;
  logic [LEFT-1:0] left_q;  // halves of the access under way
  logic [31:0] addr_q;
  logic [63:0] data_q;
  assign access_o = left_q != 0;
  assign {write_o, addr_o, data_to_memory_o} = {writing_q, addr_q, data_q[15:0]};
  logic [DW:0] free;
  logic next_q, next_writing_q, next_starts;  // the next access
  logic [LEFT-1:0] next_left_q;
  logic [30:0] next_word_q, next_place_q;  // of a read, and of a write
  logic [63:0] next_data_q;
  assign ready_o = !next_q;
  assign next_starts = next_q && (left_q == 0 || (left_q == 1 && ready_i)) && free != 0;
  always_ff @(posedge clk_i) begin
    if (ready_o) begin
      next_q <= read_i || write_i;
      next_writing_q <= write_i;
      next_left_q <= write_i ? LEFT'(4) : {read_words_i, 1'b0};
      {next_word_q, next_place_q} <= {read_word_i[30:0], write_addr_i[31:1]};
      next_data_q <= write_data_i;
    end else if (next_starts) next_q <= 1'b0;
    if (ready_i) begin
      left_q <= left_q - LEFT'(access_o);
      addr_q <= addr_q + 1;
      data_q <= {16'b0, data_q[63:16]};
    end
    if (next_starts) begin
      {writing_q, left_q, data_q} <= {next_writing_q, next_left_q, next_data_q};
      addr_q <= next_writing_q ? {1'b0, next_place_q} : {next_word_q, 1'b0};
    end
    if (rst_i) {next_q, left_q} <= '0;
  end

  // ---- Answers ----
  logic [3:0] words;  // of the oldest read
  logic [LEFT-1:0] half_q;
  logic last, valid_q;
  logic [2*WORDS-1:0][15:0] halves_q;
  assign last = valid_i && half_q == {words, 1'b0} - 1'b1;
  sync_fifo #(.W(4), .DEPTH(DEPTH)) reads (
      .clk_i, .rst_i, .write_i(next_starts && !next_writing_q), .wdata_i(next_left_q[LEFT-1:1]), .free_o(free),
      .count_o(), .some_o(), .rdata_o(words), .read_i(last));
  assign {valid_o, data_o} = {valid_q, halves_q};
  always_ff @(posedge clk_i) begin
    for (int h = 0; h < 2 * WORDS; h++) if (valid_i && half_q == LEFT'(h)) halves_q[h] <= data_i;
    if (valid_i) half_q <= last ? '0 : half_q + 1'b1;
    valid_q <= last && !rst_i;
    if (rst_i) half_q <= '0;
  end
  logic unused;
  assign unused = &{1'b0, write_addr_i[0], read_word_i[31]};

`ifndef SYNTHESIS
  always_ff @(posedge clk_i)
    if (!rst_i) begin
      assert (!(read_i && write_i)) else $error("memory_port: a read and a write at once");
      assert (!(read_i && (read_words_i == 0 || 32'(read_words_i) > WORDS)))
      else $error("memory_port: a read of %0d words", read_words_i);
    end
`endif
endmodule
