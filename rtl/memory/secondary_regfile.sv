// SPDX-License-Identifier: Apache-2.0
// Secondary register file: fetches slots FIRST..FIRST+COUNT-1 from DDR in order, or with TRANSFORM the slots of the
// objects in use. It checks them and holds them in a FIFO. A beat has 9 words, so a larger slot takes two beats. The
// head stays until `pop_i`. With DEPTH above the memory latency, a slot is ready in every cycle.
// With TRANSFORM, every slot goes through the transformer before the check. So the check applies to the values that
// meet the primaries, and an overflow in the transform is bad input.
// Latency: the memory's plus shape_check's; with TRANSFORM also 1 cycle plus the transformer's.
// Throughput: one beat per cycle.
// Stall: requests only slots that the FIFO has room for, and holds slots until they are taken.
module secondary_regfile #(
    parameter config_pkg::config_t CONFIG,
    localparam int EXP = CONFIG.exp,
    localparam int MAN = CONFIG.man,
    localparam int PAIRS = CONFIG.pairs,
    localparam int SWAP = CONFIG.swap,
    localparam int TRANSFORM = CONFIG.transform,
    localparam latency_pkg::latency_t LAT = CONFIG.lat,
    localparam ARITH = config_pkg::arith(CONFIG.host),
    localparam int CW = formats_pkg::container(EXP, MAN),
    localparam int WORDS = pairs_pkg::slot_words(PAIRS, 0, SWAP != 0),
    localparam int BEAT = records_pkg::DDR_WORDS,
    localparam int OBJECTS = (TRANSFORM != pairs_pkg::TRANSFORM_NONE) ? CONFIG.objects : 0,  // most objects of a pass
    localparam int T_TRANSFORM = pairs_pkg::transform_latency(PAIRS, SWAP != 0, TRANSFORM, LAT.add, LAT.mul),
    localparam int DEPTH = (TRANSFORM != pairs_pkg::TRANSFORM_NONE && T_TRANSFORM > 16) ? 256 :  // power of two
        // 16 slots of a lane with eight turns last 128 cycles: the check's, and 64 of the memory
        (CONFIG.shared_lane == 8 && config_pkg::check_latency(LAT) <= 64) ? 16 : 64,
    localparam int OBJECT_W = (OBJECTS > 1) ? $clog2(OBJECTS) : 1
) (
    input logic clk_i,
    input logic rst_i,
    input pairs_pkg::pair_t pair_i,  // of the pass
    input logic swap_i,
    input logic start_i,
    input logic stop_i,  // stops requests and drops responses
    input card_pkg::pass_t pass_i,  // objects or range of the pass

    // To the object table and the transformer, which are outside, because primaries also use the transformer.
    output logic [OBJECT_W-1:0] range_entry_o,
    input logic [1:0][31:0] range_i,
    output logic [OBJECT_W-1:0] transform_entry_o,   // object of the arriving slot
    output logic moving_o,                           // a slot arrives or is in the transformer
    input logic clk_moving_i,                        // clock that runs while moving_o
    output logic [WORDS-1:0][CW-1:0] unmoved_o,      // the slot, one cycle later, with its transform
    input logic [WORDS-1:0][CW-1:0] moved_i,         // from the transformer

    output card_pkg::ddr_request_t ddr_o,
    input logic ddr_ready_i,  // the request is taken
    input logic ddr_valid_i,
    input logic [BEAT-1:0][CW-1:0] ddr_data_i,
    output logic [3:0] ddr_words_o,  // words of the beat that belong to a slot

    output logic valid_o,
    output logic [WORDS-1:0][CW-1:0] slot_o,
    output logic bad_o,             // out of the pair's contract
    output logic [31:0] index_o,    // position in the range; with objects, the slot's number in DDR
    output logic last_o,
    input logic pop_i,
    output logic idle_o             // nothing requested, nothing held
);
  localparam int AW = $clog2(DEPTH);
  localparam int SHAPES = pairs_pkg::SHAPES;
  localparam int T_CHECK = config_pkg::check_latency(LAT);
  localparam int T_MOVED = (TRANSFORM != 0) ? 1 + T_TRANSFORM : 0;
  localparam int T_CHECKED = T_MOVED + T_CHECK;
  // A slot enters the FIFO before its check, and is counted after it. The host back end answers at once.
  localparam int T_PLACED = (ARITH == "rtl") ? T_MOVED : (TRANSFORM != 0) ? 1 : 0;
  localparam int T_JUDGED = (ARITH == "rtl") ? T_CHECKED : T_PLACED;
  // A slot is used after its check, so at the earliest one cycle after it is written.
  if (T_CHECKED <= T_PLACED) $error("secondary_regfile: a slot is read as it is written");
  logic bads[DEPTH];  // results of checks
  // counts of slots in the FIFO, shown, popped, requested (modulo 2*DEPTH)
  logic [AW:0] placed_q, write_q, read_q, requested_q;
  // write_q != read_q, and requests for DEPTH slots: the comparisons would be in the paths of rows and requests
  logic any_q, full_q;
  logic dropping_q, stopping_q, stop;

  // ---- Requests, one beat each ----
  pairs_pkg::words_t words;
  pairs_pkg::shape_t shape;
  logic two, second_q, taken, slot_requested, requesting, last_requested;
  logic [31:0] word, slot_number;
  logic [OBJECT_W-1:0] object;
  assign shape = pairs_pkg::SHAPE_BITS'(swap_i ? pairs_pkg::primary_shape(int'(pair_i)) :
      pairs_pkg::secondary_shape(int'(pair_i)));
  assign words = pairs_pkg::WORDS_BITS'(pairs_pkg::shape_words(int'(shape)));
  assign two = WORDS > BEAT && 32'(words) > BEAT;
  assign ddr_o.valid = requesting && !full_q;
  assign ddr_o.word = word + (second_q ? BEAT : 0);
  assign ddr_o.words = second_q ? 4'(32'(words) - BEAT) : two ? 4'(BEAT) : 4'(words);
  assign taken = ddr_o.valid && ddr_ready_i;
  assign slot_requested = taken && (!two || second_q);
  assign stop = (stop_i || stopping_q) && (!two || second_q == taken);  // never between the two beats of a slot
  address_generator #(.ENTRIES(OBJECTS)) addresses (
      .clk_i, .rst_i, .start_i, .stop_i(stop), .step_i(slot_requested), .stride_i(words),
      .objects_i((OBJECT_W + 1)'(pass_i.objects)), .first_i(pass_i.first), .count_i(pass_i.count),
      .entry_o(range_entry_o), .range_i, .valid_o(requesting), .address_o(word), .slot_o(slot_number),
      .object_o(object),
      .last_o(last_requested));

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

  assign ddr_words_o = !two ? 4'(words) : half_q ? 4'(32'(words) - BEAT) : 4'(BEAT);

  logic [T_CHECKED:0] in_flight;
  assign in_flight[0] = whole;
  if (T_CHECKED > 0) begin : g_wait
    logic [T_CHECKED-1:0] q;
    always_ff @(posedge clk_i) q <= rst_i ? '0 : T_CHECKED'({q, whole});
    assign in_flight[T_CHECKED:1] = q;
  end

  // ---- Object of each slot, stored with the request ----
  logic [WORDS-1:0][CW-1:0] unchecked;
  if (TRANSFORM != 0) begin : g_objects
    logic [OBJECT_W+32:0] tags[DEPTH];  // last, object, number
    logic [AW:0] arrived_q;
    logic [WORDS-1:0][CW-1:0] slot_q;
    always_ff @(posedge clk_i) begin
      if (slot_requested) tags[requested_q[AW-1:0]] <= {last_requested, object, slot_number};
      if (whole) arrived_q <= arrived_q + 1;
      if (rst_i) arrived_q <= '0;
    end
    always_ff @(posedge clk_moving_i) slot_q <= arrived;
    assign moving_o = (ARITH == "rtl") ? |in_flight[T_MOVED-1:0] : whole;
    assign transform_entry_o = tags[arrived_q[AW-1:0]][32+:OBJECT_W];
    assign unmoved_o = slot_q;
    assign unchecked = moved_i;
    assign index_o = tags[read_q[AW-1:0]][31:0];
    assign last_o = tags[read_q[AW-1:0]][OBJECT_W+32];
  end else begin : g_range
    logic [31:0] index_q, count_q;
    always_ff @(posedge clk_i) begin
      if (pop_i) index_q <= index_q + 1;
      if (start_i) count_q <= pass_i.count;
      if (start_i) index_q <= 0;
    end
    assign transform_entry_o = '0;
    assign moving_o = 1'b0;
    assign unmoved_o = '0;
    assign unchecked = arrived;
    assign index_o = index_q;
    assign last_o = index_q + 1 == count_q;
    logic unused_objects;
    assign unused_objects = &{1'b0, clk_moving_i, moved_i, object, slot_number, last_requested};
  end

  // ---- The check ----
  logic [SHAPES-1:0] bad_by_shape;
  for (genvar k = 0; k < SHAPES; k++) begin : check
    if (pairs_pkg::uses_shape(PAIRS, k, 0, SWAP != 0)) begin : g_present
      localparam int N = pairs_pkg::shape_words(k);
      logic [N-1:0][0:0][CW-1:0] shape_words;
      logic [0:0][CW-1:0] bad;
      assign shape_words = unchecked[N-1:0];
      shape_check #(.SHAPE(k), .EXP(EXP), .MAN(MAN), .LANES(1), .LAT(LAT), .ARITH(ARITH)) check_u (
          .clk_i, .en_i(1'b1), .words_i(shape_words), .bad_o(bad));
      assign bad_by_shape[k] = bad[0][0];
    end else begin : g_absent
      assign bad_by_shape[k] = 1'b1;
    end
  end

  assign valid_o = any_q && !dropping_q;
  assign idle_o = write_q == requested_q && !requesting && (!any_q || dropping_q);
  if (DEPTH <= 16) begin : g_distributed
    (* no_rw_check *) logic [WORDS-1:0][CW-1:0] fifo[DEPTH];
    always_ff @(posedge clk_i) if (in_flight[T_PLACED]) fifo[placed_q[AW-1:0]] <= unchecked;
    assign slot_o = fifo[read_q[AW-1:0]];
  end else begin : g_block
    (* ram_style = "block", no_rw_check *) logic [WORDS-1:0][CW-1:0] fifo[DEPTH];
    always_ff @(posedge clk_i) if (in_flight[T_PLACED]) fifo[placed_q[AW-1:0]] <= unchecked;
    assign slot_o = fifo[read_q[AW-1:0]];
  end
  assign bad_o = bads[read_q[AW-1:0]];

  always_ff @(posedge clk_i) begin
    if (in_flight[T_PLACED]) placed_q <= placed_q + 1;
    if (in_flight[T_JUDGED])
      bads[(ARITH == "rtl") ? write_q[AW-1:0] : placed_q[AW-1:0]] <= bad_by_shape[shape[pairs_pkg::SHAPE_INDEX-1:0]];
    if (in_flight[T_CHECKED]) write_q <= write_q + 1;
    if (taken) second_q <= two && !second_q;
    if (slot_requested) requested_q <= requested_q + 1;
    if (pop_i) read_q <= read_q + 1;
    full_q <= (full_q || (slot_requested && (requested_q - read_q) == (AW + 1)'(DEPTH - 1))) && !pop_i;
    any_q <= in_flight[T_CHECKED] || (any_q && !(pop_i && read_q + 1'b1 == write_q));
    if (stop) dropping_q <= 1;
    stopping_q <= !rst_i && !start_i && (stop_i || stopping_q) && !stop;
    if (start_i) begin
      read_q <= write_q;
      {any_q, full_q} <= '0;
      dropping_q <= 0;
    end
    if (rst_i) begin
      {placed_q, write_q, read_q, requested_q} <= '0;
      {any_q, full_q} <= '0;
      dropping_q <= 0;
      second_q <= 0;
    end
  end

`ifndef SYNTHESIS
  always_ff @(posedge clk_i)
    if (!rst_i) begin
      assert (any_q == (write_q != read_q) && full_q == (requested_q - read_q == (AW + 1)'(DEPTH)))
          else $error("secondary_regfile: wrong comparisons");
      assert (!(pop_i && !valid_o)) else $error("secondary_regfile: pop of an empty FIFO");
      assert (!(in_flight[T_CHECKED] && write_q == requested_q))
          else $error("secondary_regfile: data without a request");
      assert (!(start_i && !idle_o)) else $error("secondary_regfile: started while busy");
    end
`endif
endmodule
