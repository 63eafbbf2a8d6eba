// Result memory: a ring of records in SRAM, written by the update engine one record a clock, read by the local bus 64 bits a beat
// (8 words a record, the last one 0). Two records are fetched ahead so that beats follow each other without gaps.
// Latency: 3 clocks from the first record to the first beat. Throughput: one record in, one beat out a clock. Stall: full_o.
module sram_ring #(
    parameter int CW = 32,
    parameter int RECORDS = 524288,  // power of two
    localparam int WORDS = cde_pkg::RECORD_WORDS,
    localparam int AW = $clog2(RECORDS)
) (
    input logic clk_i,
    input logic rst_i,
    input logic write_i,
    input logic [WORDS-1:0][CW-1:0] record_i,
    output logic active_o,  // has work of its own: the clock must run
    output logic full_o,
    output logic [31:0] count_o,  // records not yet read to their last beat

    output logic beat_valid_o,
    output logic [63:0] beat_o,
    input logic beat_pop_i,

    output logic sram_write_o,
    output logic [AW-1:0] sram_write_addr_o,
    output logic [WORDS-1:0][CW-1:0] sram_write_data_o,
    output logic sram_read_o,
    output logic [AW-1:0] sram_read_addr_o,
    input logic [WORDS-1:0][CW-1:0] sram_read_data_i  // the clock after sram_read_o
);
  localparam int BEATS = (WORDS + 1) * CW / 64;
  localparam int BW = $clog2(BEATS);
  logic [AW:0] write_q, fetch_q;
  logic [31:0] count_q;
  logic fetching_q, head_valid_q, next_valid_q;
  logic [WORDS-1:0][CW-1:0] head_q, next_q;
  logic [BW-1:0] beat_q;
  logic [(WORDS+1)*CW-1:0] head_words;
  logic finish;

  assign active_o = sram_read_o || fetching_q;
  assign full_o = count_q == 32'(RECORDS);
  assign count_o = count_q;
  assign sram_write_o = write_i;
  assign sram_write_addr_o = write_q[AW-1:0];
  assign sram_write_data_o = record_i;
  assign sram_read_o = write_q != fetch_q && !fetching_q && !next_valid_q;
  assign sram_read_addr_o = fetch_q[AW-1:0];
  assign head_words = {{CW{1'b0}}, head_q};
  assign beat_valid_o = head_valid_q;
  assign beat_o = head_words[64*32'(beat_q)+:64];
  assign finish = beat_pop_i && beat_q == BW'(BEATS - 1);

  always_ff @(posedge clk_i) begin
    if (write_i) write_q <= write_q + 1;
    if (sram_read_o) fetch_q <= fetch_q + 1;
    fetching_q <= sram_read_o;
    count_q <= count_q + 32'(write_i) - 32'(finish);
    if (beat_pop_i) beat_q <= beat_q + 1;
    if (!head_valid_q || finish) begin
      head_valid_q <= next_valid_q || fetching_q;
      head_q <= next_valid_q ? next_q : sram_read_data_i;
      next_valid_q <= 0;
    end else if (fetching_q) begin
      next_valid_q <= 1;
      next_q <= sram_read_data_i;
    end
    if (rst_i) begin
      {write_q, fetch_q} <= '0;
      count_q <= 0;
      beat_q <= 0;
      {fetching_q, head_valid_q, next_valid_q} <= '0;
    end
  end

`ifndef SYNTHESIS
  always_ff @(posedge clk_i)
    if (!rst_i) begin
      assert (!(write_i && full_o)) else $error("sram_ring: written while full");
      assert (!(beat_pop_i && !head_valid_q)) else $error("sram_ring: beat taken from an empty ring");
      assert (!(fetching_q && next_valid_q)) else $error("sram_ring: fetched record has no place");
    end
`endif
endmodule
