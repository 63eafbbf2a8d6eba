// SPDX-License-Identifier: Apache-2.0
// Input port of the primary register file: the local bus writes PRIMARIES slots, 64 bits per beat. A staging register
// gathers the words of a slot, and the beat with the last word commits the slot to its lane group. At the same time the
// slot is checked as every shape that a primary of the card's pairs can have. The pair in use selects the check that
// counts. With TRANSFORM = 2, a RAM keeps the slots as written. Transformed slots return from the transformer, are
// checked, and replace them in the lanes.
// Latency: 1 cycle; check results take shape_check's latency more (busy_o).
// Throughput: one beat per cycle.
// Stall: none.
module primary_regfile #(
    parameter config_pkg::config_t CONFIG,
    localparam int EXP = CONFIG.exp,
    localparam int MAN = CONFIG.man,
    localparam int LANES = CONFIG.lanes,
    localparam int PRIMARIES = CONFIG.primaries,
    localparam int PAIRS = CONFIG.pairs,
    localparam int SWAP = CONFIG.swap,
    localparam int PARALLEL = CONFIG.parallel,
    localparam int TRANSFORM = CONFIG.transform,
    localparam latency_pkg::latency_t LAT = CONFIG.lat,
    localparam ARITH = config_pkg::arith(CONFIG.host),
    localparam int CW = formats_pkg::container(EXP, MAN),
    localparam int ROWS = PRIMARIES / LANES,
    localparam int ROW_W = (ROWS > 1) ? $clog2(ROWS) : 1,
    localparam int LANE_W = (LANES > 1) ? $clog2(LANES) : 1,
    localparam int PRIM_W = $clog2(PRIMARIES),
    localparam int WORDS = pairs_pkg::slot_words(PAIRS, 1, SWAP != 0)
) (
    input logic clk_i,       // gated bus clock
    input logic clk_core_i,
    input logic rst_i,
    input pairs_pkg::pair_t [1:0] pair_i,  // [0] for primaries below split_i, [1] for the others
    input logic [1:0] swap_i,
    input logic [PRIM_W-1:0] split_i,
    input logic write_i,
    input logic [31:0] write_addr_i,  // byte offset, 8-byte aligned
    input logic [63:0] write_data_i,
    input logic clk_moving_i,
    input logic [PRIM_W-1:0] read_i,  // number of a slot, shown as written in the next cycle
    output logic [WORDS-1:0][CW-1:0] written_o,
    input logic pose_i,  // a transformed slot; never during a bus write
    input logic [PRIM_W-1:0] pose_number_i,
    input logic [WORDS-1:0][CW-1:0] pose_slot_i,

    output logic [PRIMARIES-1:0] bad_o,  // primaries that are outside their pair's contract or were never written
    output logic busy_o,                 // check results are outstanding
    output logic commit_o,  // a slot is complete: its lane takes it in the next cycle
    output logic [ROW_W-1:0] row_o,
    output logic [LANE_W-1:0] lane_o,
    output logic [WORDS-1:0][CW-1:0] slot_o
);
  localparam int BEATS = (WORDS * CW + 63) / 64;
  localparam int PADDED = BEATS * 64 / CW;
  localparam int SHAPES = pairs_pkg::SHAPES;
  localparam int T_CHECK = config_pkg::check_latency(LAT);

  logic [31:0] beat;
  logic [PADDED-1:0][CW-1:0] slot, slot_q;
  logic commit, commit_q;
  logic [PRIM_W-1:0] number, number_q, committed;
  assign beat = write_addr_i >> 3;
  assign number = PRIM_W'(beat / 32'(BEATS));
  assign commit = write_i && beat % 32'(BEATS) == 32'(BEATS - 1);
  for (genvar b = 0; b < BEATS; b++) begin : gather
    assign slot[b*64/CW+:64/CW] = (beat % 32'(BEATS) == 32'(b)) ? write_data_i : slot_q[b*64/CW+:64/CW];
  end
  if (PADDED > WORDS) begin : g_padding
    logic unused_padding;
    assign unused_padding = &{1'b0, slot_q[PADDED-1:WORDS]};
  end
  always_ff @(posedge clk_i) begin
    commit_q <= commit && !rst_i;
    if (write_i) slot_q <= slot;
    if (commit) number_q <= number;
  end

  // ---- Commits: from the bus, from the transformer ----
  if (TRANSFORM == pairs_pkg::TRANSFORM_BOTH) begin : g_pose
    logic [WORDS-1:0][CW-1:0] mem[PRIMARIES];
    logic [PRIMARIES-1:0] stored_q;  // the slot was written
    always_ff @(posedge clk_i) begin
      if (commit) mem[number] <= slot[WORDS-1:0];
      if (commit) stored_q[number] <= 1;
      if (rst_i) stored_q <= '0;
    end
    always_ff @(posedge clk_moving_i) written_o <= mem[read_i];
    assign commit_o = commit_q || (pose_i && stored_q[pose_number_i]);
    assign committed = commit_q ? number_q : pose_number_i;
    assign slot_o = commit_q ? slot_q[WORDS-1:0] : pose_slot_i;
  end else begin : g_written
    logic unused_pose;
    assign unused_pose = &{1'b0, clk_moving_i, read_i, pose_i, pose_number_i, pose_slot_i};
    assign written_o = '0;
    assign commit_o = commit_q;
    assign committed = number_q;
    assign slot_o = slot_q[WORDS-1:0];
  end
  assign row_o = ROW_W'(32'(committed) / 32'(LANES));
  assign lane_o = LANE_W'(32'(committed) % 32'(LANES));

  // ---- Check results ----
  logic clk_check, checked;
  logic [PRIM_W-1:0] checked_number;
  check_clock #(.NUMBER_W(PRIM_W), .T_CHECK(T_CHECK)) check_time (
      .clk_i(clk_core_i), .rst_i, .commit_i(commit_o), .number_i(committed), .clk_o(clk_check), .busy_o,
      .checked_o(checked), .number_o(checked_number));
  logic [SHAPES-1:0][PRIMARIES-1:0] bad_by_shape;
  for (genvar shape = 0; shape < SHAPES; shape++) begin : check
    if (pairs_pkg::uses_shape(PAIRS, shape, 1, SWAP != 0)) begin : g_present
      localparam int N = pairs_pkg::shape_words(shape);
      logic [N-1:0][0:0][CW-1:0] words;
      logic [0:0][CW-1:0] bad;
      logic bad_checked;
      assign words = slot_o[N-1:0];
      shape_check #(.SHAPE(shape), .EXP(EXP), .MAN(MAN), .LANES(1), .LAT(LAT), .ARITH(ARITH)) check_u (
          .clk_i(clk_check), .en_i(1'b1), .words_i(words), .bad_o(bad));
      // The host back end answers at once, so its results are delayed to the cycles of the gates.
      pipe_delay #(.W(1), .FROM((ARITH != "rtl") ? 0 : T_CHECK), .TO(T_CHECK)) delay_bad (.clk_i(clk_check),
          .d_i(bad[0][0]), .q_o(bad_checked));
      logic [PRIMARIES-1:0] bad_q;
      always_ff @(posedge clk_check) begin
        if (checked) bad_q[checked_number] <= bad_checked;
        if (rst_i) bad_q <= '1;
      end
      assign bad_by_shape[shape] = bad_q;
    end else begin : g_absent
      assign bad_by_shape[shape] = '1;
    end
  end
  pairs_pkg::shape_t [1:0] shape_now;
  for (genvar k = 0; k < 2; k++) begin : of
    assign shape_now[k] = pairs_pkg::SHAPE_BITS'(swap_i[k] ? pairs_pkg::secondary_shape(int'(pair_i[k])) :
        pairs_pkg::primary_shape(int'(pair_i[k])));
  end
  if (PARALLEL != 0) begin : g_two
    logic [PRIMARIES-1:0] second;
    assign second = (pair_i[1] != pairs_pkg::NO_PAIR) ? {PRIMARIES{1'b1}} << split_i : '0;
    assign bad_o = (bad_by_shape[shape_now[0][pairs_pkg::SHAPE_INDEX-1:0]] & ~second) |
        (bad_by_shape[shape_now[1][pairs_pkg::SHAPE_INDEX-1:0]] & second);
  end else begin : g_one
    logic unused_second;
    assign unused_second = &{1'b0, split_i, shape_now[1]};
    assign bad_o = bad_by_shape[shape_now[0][pairs_pkg::SHAPE_INDEX-1:0]];
  end
endmodule
