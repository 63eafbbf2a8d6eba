// Secondary register file: fetches slots FIRST..FIRST+COUNT-1 from DDR in order and holds them in a FIFO of DEPTH. The head stays
// until `pop_i`; with DEPTH above the memory latency there is a slot for every clock that asks for one.
// Latency: the memory's. Throughput: one slot a clock. Stall: requests only what the FIFO has room for.
module secondary_regfile #(
    parameter int EXP = 8,
    parameter int MAN = 23,
    parameter int DEPTH = 64,  // power of two
    localparam int CW = (1 + EXP + MAN <= 32) ? 32 : 64,
    localparam int WORDS = cde_pkg::SEC_WORDS
) (
    input logic clk_i,
    input logic rst_i,
    input logic start_i,
    input logic stop_i,  // ask for nothing more and drop what comes
    input logic [31:0] first_i,
    input logic [31:0] count_i,

    output logic ddr_read_o,
    output logic [31:0] ddr_slot_o,
    input logic ddr_valid_i,
    input logic [WORDS-1:0][CW-1:0] ddr_data_i,

    output logic valid_o,
    output logic [WORDS-1:0][CW-1:0] slot_o,
    output logic bad_o,             // not finite
    output logic [31:0] index_o,    // position in the stream, from 0
    output logic last_o,
    input logic pop_i,
    output logic idle_o             // nothing requested, nothing held
);
  localparam int AW = $clog2(DEPTH);
  logic [WORDS-1:0][CW-1:0] fifo[DEPTH];
  logic [AW:0] write_q, read_q, asked_q;  // fetched, popped, requested (modulo 2*DEPTH)
  logic [31:0] left_q, next_q, index_q, count_q;
  logic dropping_q;

  assign valid_o = write_q != read_q && !dropping_q;
  assign idle_o = write_q == asked_q && left_q == 0 && (write_q == read_q || dropping_q);
  assign index_o = index_q;
  assign last_o = index_q + 1 == count_q;
  assign slot_o = fifo[read_q[AW-1:0]];
  assign ddr_read_o = left_q != 0 && (asked_q - read_q) != (AW + 1)'(DEPTH);
  assign ddr_slot_o = next_q;

  logic [WORDS-1:0] special;
  for (genvar k = 0; k < WORDS; k++) begin : word
    assign special[k] = &slot_o[k][MAN+:EXP];
  end
  assign bad_o = |special;

  always_ff @(posedge clk_i) begin
    if (ddr_valid_i) begin
      fifo[write_q[AW-1:0]] <= ddr_data_i;
      write_q <= write_q + 1;
    end
    if (ddr_read_o) begin
      asked_q <= asked_q + 1;
      next_q <= next_q + 1;
      left_q <= left_q - 1;
    end
    if (pop_i) begin
      read_q <= read_q + 1;
      index_q <= index_q + 1;
    end
    if (stop_i) begin
      left_q <= 0;
      dropping_q <= 1;
    end
    if (start_i) begin
      read_q <= write_q;
      dropping_q <= 0;
      left_q <= count_i;
      count_q <= count_i;
      next_q <= first_i;
      index_q <= 0;
    end
    if (rst_i) begin
      {write_q, read_q, asked_q} <= '0;
      left_q <= 0;
      dropping_q <= 0;
    end
  end

`ifndef SYNTHESIS
  always_ff @(posedge clk_i)
    if (!rst_i) begin
      assert (!(pop_i && !valid_o)) else $error("secondary_regfile: pop of an empty FIFO");
      assert (!(ddr_valid_i && write_q == asked_q)) else $error("secondary_regfile: data nobody asked for");
      assert (!(start_i && !idle_o)) else $error("secondary_regfile: started while busy");
    end
`endif
endmodule
