// Secondary register file: fetches slots FIRST..FIRST+COUNT-1 from DDR in order, 9 words a beat, checks them and holds them in a FIFO of
// DEPTH. A slot of more than 9 words takes two beats. The head stays until `pop_i`; with DEPTH above the memory latency there is a slot
// for every clock that asks for one.
// Latency: the memory's and shape_check's. Throughput: one beat a clock. Stall: requests only what the FIFO has room for.
module secondary_regfile #(
    parameter int EXP = 8,
    parameter int MAN = 23,
    parameter int DEPTH = 64,  // power of two
    parameter int PAIRS = 1,
    parameter int SWAP = 0,
    parameter int LAT_ADD = 1,
    parameter int LAT_MUL = 1,
    parameter int LAT_CMP = 1,
    parameter ARITH = "rtl",
    localparam int CW = (1 + EXP + MAN <= 32) ? 32 : 64,
    localparam int WORDS = cde_pkg::slot_words(PAIRS, 0, SWAP != 0),
    localparam int BEAT = cde_pkg::DDR_WORDS
) (
    input logic clk_i,
    input logic rst_i,
    input logic [3:0] pair_i,  // of the pass
    input logic swap_i,
    input logic start_i,
    input logic stop_i,  // ask for nothing more and drop what comes
    input logic [31:0] first_i,
    input logic [31:0] count_i,

    output logic ddr_read_o,
    output logic [31:0] ddr_word_o,  // address in words
    input logic ddr_valid_i,
    input logic [BEAT-1:0][CW-1:0] ddr_data_i,

    output logic valid_o,
    output logic [WORDS-1:0][CW-1:0] slot_o,
    output logic bad_o,             // out of the pair's contract
    output logic [31:0] index_o,    // position in the stream, from 0
    output logic last_o,
    input logic pop_i,
    output logic idle_o             // nothing requested, nothing held
);
  localparam int AW = $clog2(DEPTH);
  localparam int SHAPES = 7;
  localparam int T_CHECK = LAT_MUL + 3 * LAT_ADD + LAT_CMP;
  logic [WORDS:0][CW-1:0] fifo[DEPTH];  // verdict in front
  logic [AW:0] write_q, read_q, asked_q;  // fetched, popped, requested (modulo 2*DEPTH)
  logic [31:0] left_q, word_q, index_q, count_q;
  logic dropping_q, stopping_q, stop;

  // ---- Requests, a beat each ----
  logic [3:0] words;
  logic [2:0] shape;
  logic two, second_q, slot_asked;
  assign shape = 3'(swap_i ? cde_pkg::primary_shape(int'(pair_i)) : cde_pkg::secondary_shape(int'(pair_i)));
  assign words = 4'(cde_pkg::shape_words(int'(shape)));
  assign two = WORDS > BEAT && 32'(words) > BEAT;
  assign ddr_read_o = left_q != 0 && (asked_q - read_q) != (AW + 1)'(DEPTH);
  assign ddr_word_o = word_q + (second_q ? BEAT : 0);
  assign slot_asked = ddr_read_o && (!two || second_q);
  assign stop = (stop_i || stopping_q) && (!two || second_q == ddr_read_o);  // never after half a slot

  // ---- Beats to slots ----
  logic [WORDS-1:0][CW-1:0] arrived;
  logic half_q, whole;
  if (WORDS > BEAT) begin : g_two
    logic [BEAT-1:0][CW-1:0] low_q;
    always_ff @(posedge clk_i) begin
      if (ddr_valid_i) low_q <= ddr_data_i;
      half_q <= !rst_i && (ddr_valid_i ? two && !half_q : half_q);
    end
    assign whole = ddr_valid_i && (!two || half_q);
    assign arrived = two ? {ddr_data_i[WORDS-BEAT-1:0], low_q} : {{((WORDS - BEAT) * CW) {1'b0}}, ddr_data_i};
  end else begin : g_one
    assign half_q = 0;
    assign whole = ddr_valid_i;
    assign arrived = ddr_data_i[WORDS-1:0];
    if (WORDS < BEAT) begin : g_rest
      logic unused_data;
      assign unused_data = &{1'b0, ddr_data_i[BEAT-1:WORDS]};
    end
    logic unused_half;
    assign unused_half = half_q;
  end

  // ---- The check ----
  logic checked;
  logic [WORDS-1:0][CW-1:0] checked_slot;
  logic [SHAPES-1:0] verdicts, bad;
  logic [T_CHECK:0] on_its_way;
  assign on_its_way[0] = whole;
  if (T_CHECK > 0) begin : g_wait
    logic [T_CHECK-1:0] q;
    always_ff @(posedge clk_i) q <= rst_i ? '0 : T_CHECK'({q, whole});
    assign on_its_way[T_CHECK:1] = q;
  end
  assign checked = on_its_way[T_CHECK];
  align #(.W(WORDS * CW), .FROM(0), .TO(T_CHECK)) align_slot (.clk_i, .d_i(arrived), .q_o(checked_slot));
  for (genvar k = 0; k < SHAPES; k++) begin : check
    if (cde_pkg::uses_shape(PAIRS, k, 0, SWAP != 0)) begin : g_there
      localparam int N = cde_pkg::shape_words(k);
      logic [N-1:0][0:0][CW-1:0] shape_words;
      logic [0:0][CW-1:0] verdict;
      assign shape_words = arrived[N-1:0];
      shape_check #(.SHAPE(k), .EXP(EXP), .MAN(MAN), .LANES(1), .LAT_ADD(LAT_ADD), .LAT_MUL(LAT_MUL), .LAT_CMP(LAT_CMP), .ARITH(ARITH)) check_u (
          .clk_i, .words_i(shape_words), .bad_o(verdict));
      assign verdicts[k] = verdict[0][0];
    end else begin : g_absent
      assign verdicts[k] = 1'b1;
    end
  end

  // The host back end answers at once; the clocks are those of the gates.
  align #(.W(SHAPES), .FROM((ARITH != "rtl") ? 0 : T_CHECK), .TO(T_CHECK)) align_bad (.clk_i, .d_i(verdicts), .q_o(bad));

  assign valid_o = write_q != read_q && !dropping_q;
  assign idle_o = write_q == asked_q && left_q == 0 && (write_q == read_q || dropping_q);
  assign index_o = index_q;
  assign last_o = index_q + 1 == count_q;
  assign slot_o = fifo[read_q[AW-1:0]][WORDS-1:0];
  assign bad_o = fifo[read_q[AW-1:0]][WORDS][0];

  always_ff @(posedge clk_i) begin
    if (checked) begin
      fifo[write_q[AW-1:0]] <= {CW'(bad[shape]), checked_slot};
      write_q <= write_q + 1;
    end
    if (ddr_read_o) second_q <= two && !second_q;
    if (slot_asked) begin
      asked_q <= asked_q + 1;
      word_q <= word_q + 32'(words);
      left_q <= left_q - 1;
    end
    if (pop_i) begin
      read_q <= read_q + 1;
      index_q <= index_q + 1;
    end
    if (stop) begin
      left_q <= 0;
      dropping_q <= 1;
    end
    stopping_q <= !rst_i && !start_i && (stop_i || stopping_q) && !stop;
    if (start_i) begin
      read_q <= write_q;
      dropping_q <= 0;
      left_q <= count_i;
      count_q <= count_i;
      word_q <= first_i * 32'(words);
      index_q <= 0;
    end
    if (rst_i) begin
      {write_q, read_q, asked_q} <= '0;
      left_q <= 0;
      dropping_q <= 0;
      second_q <= 0;
    end
  end

`ifndef SYNTHESIS
  always_ff @(posedge clk_i)
    if (!rst_i) begin
      assert (!(pop_i && !valid_o)) else $error("secondary_regfile: pop of an empty FIFO");
      assert (!(checked && write_q == asked_q)) else $error("secondary_regfile: data nobody asked for");
      assert (!(start_i && !idle_o)) else $error("secondary_regfile: started while busy");
    end
`endif
endmodule
