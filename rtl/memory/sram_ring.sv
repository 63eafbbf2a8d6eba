// SPDX-License-Identifier: Apache-2.0
// Result memory: a ring of records in SRAM. The update engine writes one record per cycle, and the local bus reads 64
// bits per beat. Beats are packed: with 32-bit words, the seventh word of a record shares a beat with the first word of
// the next one. So two records take seven beats. Only after a pass can a last record be alone in that beat, with 0
// beside it.
// The records of the next pass begin with a new beat. Two records are fetched ahead, so beats follow each other without
// gaps.
// Latency: 3 cycles from the first record to the first beat.
// Throughput: one record in and one beat out per cycle.
// Stall: full_o.
module sram_ring #(
    parameter int CW = 32,
    parameter int RECORDS = 524288,  // power of two
    localparam int WORDS = records_pkg::RECORD_WORDS,
    localparam int AW = $clog2(RECORDS)
) (
    input logic clk_i,
    input logic rst_i,
    input logic write_i,
    input logic [WORDS-1:0][CW-1:0] record_i,
    output logic active_o,  // work is pending: the clock must run
    output logic full_o,
    output logic nearly_full_o,  // there is room for one record
    output logic [31:0] count_o,  // records not yet read completely

    input logic last_i,  // no pass runs: the newest record is a last one
    output logic readable_o,  // the next beat is present or under way
    output logic beat_valid_o,
    output logic [63:0] beat_o,
    input logic beat_pop_i,

    output logic sram_write_o,
    output logic [AW-1:0] sram_write_addr_o,
    output logic [WORDS-1:0][CW-1:0] sram_write_data_o,
    output logic sram_read_o,
    output logic [AW-1:0] sram_read_addr_o,
    input logic [WORDS-1:0][CW-1:0] sram_read_data_i  // one cycle after sram_read_o
);
  localparam int BEAT = 64 / CW;  // words
  logic [AW:0] write_q, fetch_q;
  logic [31:0] count_q;
  logic any_q, one_q;  // count_q != 0 and count_q == 1: comparisons of the count would be in the path of every access
  logic fetching_q, head_valid_q, next_valid_q;
  logic [WORDS-1:0][CW-1:0] head_q, next_q;
  logic [2:0] word_q, next_word;  // first unread word of the head
  logic [WORDS+BEAT-2:0][CW-1:0] window;
  logic shared, alone, finish;

  assign active_o = sram_read_o || fetching_q;
  assign count_o = count_q;
  assign sram_write_o = write_i;
  assign sram_write_addr_o = write_q[AW-1:0];
  assign sram_write_data_o = record_i;
  assign sram_read_o = write_q != fetch_q && !fetching_q && !next_valid_q;
  assign sram_read_addr_o = fetch_q[AW-1:0];
  if (BEAT == 1) begin : g_whole
    assign window = head_q;
  end else begin : g_shared
    assign window = {next_valid_q ? next_q[BEAT-2:0] : '0, head_q};
  end
  assign shared = 32'(word_q) + BEAT > WORDS;
  assign alone = shared && one_q;
  assign readable_o = any_q && (!alone || last_i);
  assign beat_valid_o = head_valid_q && (!shared || next_valid_q || alone && last_i);
  assign beat_o = window[word_q+:BEAT];
  assign finish = beat_pop_i && 32'(word_q) + BEAT >= WORDS;
  assign next_word = alone ? 3'd0 : finish ? 3'(32'(word_q) + BEAT - WORDS) : word_q + 3'(BEAT);

  always_ff @(posedge clk_i) begin
    if (write_i) write_q <= write_q + 1;
    if (sram_read_o) fetch_q <= fetch_q + 1;
    fetching_q <= sram_read_o;
    count_q <= count_q + 32'(write_i) - 32'(finish);
    any_q <= write_i || (any_q && !(one_q && finish));
    one_q <= (one_q && write_i == finish) || (!any_q && write_i) || (count_q == 2 && finish && !write_i);
    full_o <= (full_o && !finish) || (nearly_full_o && write_i && !finish);
    nearly_full_o <= (full_o && finish) || (nearly_full_o && write_i == finish) ||
        (count_q == 32'(RECORDS - 2) && write_i && !finish);
    if (beat_pop_i) word_q <= next_word;
    if (!head_valid_q || finish) begin
      head_valid_q <= next_valid_q || fetching_q;
      head_q <= next_valid_q ? next_q : sram_read_data_i;
      next_valid_q <= 0;
    end else if (fetching_q) next_valid_q <= 1;
    if (fetching_q) next_q <= sram_read_data_i;  // also for the head, which is harmless
    if (rst_i) begin
      {write_q, fetch_q} <= '0;
      count_q <= 0;
      {any_q, one_q} <= '0;
      word_q <= 0;
      {fetching_q, head_valid_q, next_valid_q, full_o, nearly_full_o} <= '0;
    end
  end

`ifndef SYNTHESIS
  always_ff @(posedge clk_i)
    if (!rst_i) begin
      assert (!(write_i && full_o)) else $error("sram_ring: written while full");
      assert (!(beat_pop_i && !beat_valid_o)) else $error("sram_ring: a beat was taken before it was present");
      assert (!(beat_valid_o && !readable_o)) else $error("sram_ring: a beat is not readable");
      assert (any_q == (count_q != 0) && one_q == (count_q == 1)) else $error("sram_ring: wrong comparisons");
      assert (!(fetching_q && next_valid_q)) else $error("sram_ring: no room for a fetched record");
    end
`endif
endmodule
