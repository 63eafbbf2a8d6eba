// The card: local bus, primary and secondary register files, collision detection engine, update engine, record memory.
// DDR and SRAM chips are outside; the ports name what they need. All of it runs on one core clock; the engine's part is gated
// while no pass runs.
`include "secded.svh"
module board #(
    parameter int EXP = 8,
    parameter int MAN = 23,
    parameter int LANES = 16,       // power of two that divides PRIMARIES
    parameter int PRIMARIES = 256,  // 64, 128, 192 or 256
    parameter int PAIRS = 1,        // bit p: the card has the pipe of pair p (pairs_pkg::PAIR_*)
    parameter int ALGORITHM = 0,    // of ray-triangle (pairs_pkg::ALGORITHM_*)
    parameter int BOX = 0,          // of ray-triangle, 1: a hit must lie in the triangle's box
    parameter int SWAP = 0,         // a command can exchange the roles of primary and secondary
    parameter int NORMALS = 0,      // a command can ask for normals
    parameter int PARALLEL = 0,     // two pipes can work on the same secondaries at a time
    parameter int FACET_II = 1,     // of pairs with facets: clocks from one row to the next, 1 or 3
    parameter int TRANSFORM = 0,    // objects move by a rigid transform: pairs_pkg::TRANSFORM_*
    parameter int OBJECTS = 1024,   // entries of their table, 2 to 2,048; PRIM_OBJECTS of that of primaries
    parameter int PRIM_OBJECTS = 64,
    parameter int ECC = 0,          // 1: words in DDR have check bits; single wrong bits are corrected
    parameter int LAT_ADD = 1,
    parameter int LAT_MUL = 1,
    parameter int LAT_DIV = 1,
    parameter int LAT_SQRT = 1,
    parameter int LAT_CMP = 1,
    parameter ARITH = "rtl",
    parameter int DDR_SLOTS = 55555555,     // two 1 GB modules of 36-byte beats
    parameter int SRAM_RECORDS = 524288,    // seven 2 MB chips, one word of a record each
    parameter logic [63:0] CONFIG_HASH = 0,
    localparam int CW = (1 + EXP + MAN <= 32) ? 32 : 64,
    localparam int SEC_WORDS = pairs_pkg::slot_words(PAIRS, 0, SWAP != 0),
    localparam int PRIM_WORDS = pairs_pkg::slot_words(PAIRS, 1, SWAP != 0),
    localparam int POINTS = (NORMALS != 0) ? 6 : 3,
    localparam int RECORD_WORDS = records_pkg::RECORD_WORDS,
    localparam int SRAM_AW = $clog2(SRAM_RECORDS)
) (
    input logic clk_i,
    input logic rst_i,

    input logic bus_valid_i,
    input logic bus_write_i,
    input logic [1:0] bus_space_i,
    input logic [31:0] bus_addr_i,
    input logic [63:0] bus_wdata_i,
    output logic bus_ready_o,
    output logic bus_rvalid_o,
    output logic [63:0] bus_rdata_o,
    output logic irq_o,

    output logic ddr_write_o,  // 64 bits at a byte offset
    output logic [31:0] ddr_write_addr_o,
    output logic [63:0] ddr_write_data_o,
    output logic [64/CW-1:0][7:0] ddr_write_check_o,  // with ECC, check bits of the words; as many of the 8 as secded.svh has
    output logic ddr_read_o,  // DDR_WORDS words from an address in words; answers come in order
    output logic [31:0] ddr_read_word_o,
    input logic ddr_valid_i,
    input logic [records_pkg::DDR_WORDS-1:0][CW-1:0] ddr_data_i,
    input logic [records_pkg::DDR_WORDS-1:0][7:0] ddr_check_i,

    output logic sram_write_o,
    output logic [SRAM_AW-1:0] sram_write_addr_o,
    output logic [RECORD_WORDS-1:0][CW-1:0] sram_write_data_o,
    output logic sram_read_o,
    output logic [SRAM_AW-1:0] sram_read_addr_o,
    input logic [RECORD_WORDS-1:0][CW-1:0] sram_read_data_i  // the clock after sram_read_o
);
  localparam int FIFO_DEPTH = 128;
  localparam int ROWS = PRIMARIES / LANES;
  localparam int ROW_W = (ROWS > 1) ? $clog2(ROWS) : 1;
  localparam int LANE_W = (LANES > 1) ? $clog2(LANES) : 1;
  localparam int PRIM_W = $clog2(PRIMARIES);
  if (PRIMARIES % 64 != 0 || PRIMARIES > 256) begin : g_illegal
    $error("board: PRIMARIES must be 64, 128, 192 or 256");
  end
  if (PAIRS <= 0 || PAIRS >= (1 << pairs_pkg::PAIRS)) begin : g_no_pairs
    $error("board: PAIRS must be a set of pairs, 1 to %0d", (1 << pairs_pkg::PAIRS) - 1);
  end

  if (BOX != 0 && (BOX != 1 || ((PAIRS >> int'(pairs_pkg::PAIR_RAY_TRIANGLE)) & 1) == 0)) begin : g_no_box
    $error("board: BOX must be 0 or 1, and is of ray-triangle");
  end
  if (FACET_II != 1 && FACET_II != 3) begin : g_no_interval
    $error("board: FACET_II must be 1 or 3");
  end
  if (TRANSFORM < 0 || TRANSFORM > 2 || (TRANSFORM != 0 && (OBJECTS < 2 || OBJECTS > 2048 || PRIM_OBJECTS < 2 || PRIM_OBJECTS > 2048))) begin : g_no_transform
    $error("board: TRANSFORM must be 0 to 2, OBJECTS and PRIM_OBJECTS 2 to 2048");
  end

  // ---- Local bus and registers ----
  logic clk_bus, clk_engine, prim_write, sram_pop, sram_readable, sram_beat_valid, sram_full, go, abort, busy, done, streaming;
  logic [63:0] sram_beat, wdata;
  logic [31:0] addr;
  logic [31:0] sram_count, sec_first, sec_count;
  logic [2:0] command_mode, mode;
  logic [1:0][3:0] command_pair, pair;
  logic [1:0] command_swap, swap, gap;
  logic normals, prim_busy;
  logic [PRIM_W-1:0] split;
  logic [23:0] budget;
  logic [PRIM_W:0] prim_count, new_hits;
  logic [PRIMARIES-1:0] active, prim_bad;
  logic [1:0] issue, retire, ready;
  logic bubble, stall, sec_pop, sec_bad, record_write, writeback;
  logic [15:0] latency;
  logic [3:0] ecc_corrected, ecc_failed;
  logic object_write, objects_good, objects_busy, posed;
  logic [31:0] object_count, prim_object_count;
  card_registers #(
      .EXP(EXP), .MAN(MAN), .LANES(LANES), .PRIMARIES(PRIMARIES), .PAIRS(PAIRS), .ALGORITHM(ALGORITHM), .BOX(BOX), .SWAP(SWAP),
      .NORMALS(NORMALS), .PARALLEL(PARALLEL), .TRANSFORM(TRANSFORM), .OBJECTS(OBJECTS), .PRIM_OBJECTS(PRIM_OBJECTS), .ECC(ECC), .DDR_SLOTS(DDR_SLOTS), .SRAM_RECORDS(SRAM_RECORDS),
      .CONFIG_HASH(CONFIG_HASH)
  ) registers (
      .clk_i, .clk_engine_i(clk_engine), .rst_i, .bus_valid_i, .bus_write_i, .bus_space_i, .bus_addr_i, .bus_wdata_i, .bus_ready_o, .bus_rvalid_o,
      .bus_rdata_o, .irq_o, .clk_bus_o(clk_bus), .addr_o(addr), .wdata_o(wdata), .prim_write_o(prim_write), .ddr_write_o, .sram_pop_o(sram_pop), .sram_readable_i(sram_readable), .sram_valid_i(sram_beat_valid),
      .sram_beat_i(sram_beat), .sram_count_i(sram_count), .sram_full_i(sram_full), .go_o(go), .abort_o(abort), .mode_o(command_mode), .pair_o(command_pair), .swap_o(command_swap), .split_o(split), .budget_o(budget), .normals_o(normals),
      .prim_count_o(prim_count), .sec_first_o(sec_first), .sec_count_o(sec_count), .active_o(active), .busy_i(busy),
      .done_i(done), .writeback_i(writeback), .prim_bad_i(prim_bad), .issue_i(issue), .bubble_i(bubble), .stall_i(stall), .secondary_i(sec_pop),
      .secondary_bad_i(sec_bad), .record_i(record_write), .latency_i(latency),
      .object_write_o(object_write), .object_count_o(object_count), .prim_object_count_o(prim_object_count), .objects_good_i(objects_good),
      .objects_busy_i(objects_busy), .posed_i(posed), .ecc_corrected_i(ecc_corrected), .ecc_failed_i(ecc_failed));
  assign ddr_write_addr_o = addr;
  assign ddr_write_data_o = wdata;

  // ---- Check bits of DDR ----
  localparam int BEAT = records_pkg::DDR_WORDS;
  logic ddr_valid;
  logic [BEAT-1:0][CW-1:0] ddr_data;
  logic [3:0] ddr_words;  // of the beat that belong to a slot
  if (ECC != 0) begin : g_ecc
    localparam int R = `SECDED_BITS(CW);
    logic [BEAT-1:0][R-1:0] check;
    logic [BEAT-1:0] corrected, failed, mine;
    for (genvar k = 0; k < 64 / CW; k++) begin : written
      logic [R-1:0] bits;
      secded_encode #(.W(CW)) encode (.data_i(wdata[k*CW+:CW]), .check_o(bits));
      assign ddr_write_check_o[k] = 8'(bits);
    end
    for (genvar k = 0; k < BEAT; k++) begin : word
      assign check[k] = ddr_check_i[k][R-1:0];
      assign mine[k] = ddr_valid && 4'(k) < ddr_words;
    end
    ddr_ecc #(.EXP(EXP), .MAN(MAN)) correct (
        .clk_i(clk_engine), .rst_i, .valid_i(ddr_valid_i), .data_i(ddr_data_i), .check_i(check), .valid_o(ddr_valid), .data_o(ddr_data),
        .corrected_o(corrected), .failed_o(failed));
    assign ecc_corrected = 4'($countones(corrected & mine));
    assign ecc_failed = 4'($countones(failed & mine));
    logic unused_check;
    assign unused_check = &{1'b0, ddr_check_i};
  end else begin : g_no_ecc
    assign ddr_write_check_o = '0;
    assign ddr_valid = ddr_valid_i;
    assign ddr_data = ddr_data_i;
    assign {ecc_corrected, ecc_failed} = '0;
    logic unused_check;
    assign unused_check = &{1'b0, ddr_check_i, ddr_words};
  end

  clock_gate gate (.clk_i, .enable_i(busy | go | rst_i), .clk_o(clk_engine));

  // ---- Secondaries ----
  localparam int RANGES = (TRANSFORM != 0) ? OBJECTS : 0;  // that a pass can have
  localparam int OBJECT_W = (RANGES > 1) ? $clog2(RANGES) : 1;
  localparam int T_TRANSFORM = pairs_pkg::transform_latency(PAIRS, SWAP != 0, TRANSFORM, LAT_ADD, LAT_MUL);
  logic fetch_start, fetch_stop, sec_valid, sec_last, sec_idle;
  logic [SEC_WORDS-1:0][CW-1:0] secondary, unmoved, moved;
  logic [31:0] sec_index;
  logic [OBJECT_W-1:0] range_entry, transform_entry;
  logic [1:0][31:0] range;
  logic moving, clk_moving;
  secondary_regfile #(
      .EXP(EXP), .MAN(MAN), .DEPTH((TRANSFORM != 0 && T_TRANSFORM > 16) ? 256 : 64), .PAIRS(PAIRS), .SWAP(SWAP), .TRANSFORM(TRANSFORM), .OBJECTS(RANGES),
      .LAT_ADD(LAT_ADD), .LAT_MUL(LAT_MUL), .LAT_CMP(LAT_CMP), .ARITH(ARITH)
  ) secondaries (
      .clk_i(clk_engine), .rst_i, .pair_i(pair[0]), .swap_i(swap[0]), .start_i(fetch_start), .stop_i(fetch_stop), .first_i(sec_first), .count_i(sec_count),
      .objects_i((OBJECT_W + 1)'(object_count)), .range_entry_o(range_entry), .range_i(range), .transform_entry_o(transform_entry), .moving_o(moving), .clk_moving_i(clk_moving),
      .unmoved_o(unmoved), .moved_i(moved),
      .ddr_read_o, .ddr_word_o(ddr_read_word_o), .ddr_valid_i(ddr_valid), .ddr_data_i(ddr_data), .ddr_words_o(ddr_words), .valid_o(sec_valid), .slot_o(secondary),
      .bad_o(sec_bad), .index_o(sec_index), .last_o(sec_last), .pop_i(sec_pop), .idle_o(sec_idle));

  // ---- Objects ----
  logic pose_wanted, pose, pose_commit;
  logic [PRIM_W-1:0] prim_read, pose_number;
  logic [PRIM_WORDS-1:0][CW-1:0] prim_written, pose_slot;
  if (TRANSFORM != 0) begin : g_objects
    objects #(
        .EXP(EXP), .MAN(MAN), .PRIMARIES(PRIMARIES), .PAIRS(PAIRS), .SWAP(SWAP), .TRANSFORM(TRANSFORM), .OBJECTS(OBJECTS),
        .PRIM_OBJECTS(PRIM_OBJECTS), .DDR_SLOTS(DDR_SLOTS), .LAT_ADD(LAT_ADD), .LAT_MUL(LAT_MUL), .LAT_CMP(LAT_CMP), .ARITH(ARITH)
    ) tables (
        .clk_i(clk_engine), .clk_bus_i(clk_bus), .clk_core_i(clk_i), .rst_i, .write_i(object_write), .addr_i(addr), .data_i(wdata),
        .primary_write_i(prim_write), .objects_i(object_count), .prim_objects_i(prim_object_count), .command_pair_i(command_pair),
        .command_swap_i(command_swap), .split_i(split), .good_o(objects_good), .busy_o(objects_busy), .pair_i(pair[0]), .swap_i(swap[0]),
        .range_entry_i(range_entry), .range_o(range), .transform_entry_i(transform_entry), .moving_i(moving), .clk_moving_o(clk_moving), .unmoved_i(unmoved), .moved_o(moved),
        .pose_wanted_o(pose_wanted), .pose_i(pose), .posed_o(posed), .read_o(prim_read), .written_i(prim_written), .pose_commit_o(pose_commit),
        .pose_number_o(pose_number), .pose_slot_o(pose_slot));
  end else begin : g_no_objects
    logic unused;
    assign unused = &{1'b0, object_write, object_count, prim_object_count, range_entry, transform_entry, moving, unmoved, pose, prim_written};
    assign {objects_good, objects_busy, pose_wanted, posed, pose_commit} = 5'b10000;
    assign clk_moving = 1'b0;
    assign range = '0;
    assign moved = '0;
    assign prim_read = '0;
    assign pose_number = '0;
    assign pose_slot = '0;
  end

  // ---- Sequencer ----
  logic flush, clear, issue_parity, fifo_empty, writeback_parity, writeback_ready;
  logic [ROW_W-1:0] clear_row;
  logic [1:0][ROW_W-1:0] issue_row;
  logic [LANES-1:0] clear_mask;
  logic [1:0] credit;
  logic [PRIM_W-1:0] writeback_primary;
  engine_control #(.LANES(LANES), .PRIMARIES(PRIMARIES), .FIFO_DEPTH(FIFO_DEPTH)) control (
      .clk_i(clk_engine), .rst_i, .go_i(go), .abort_i(abort), .mode_i(command_mode), .pair_i(command_pair),
      .swap_i(command_swap), .split_i(split), .mode_o(mode), .pair_o(pair), .swap_o(swap), .primaries_busy_i(prim_busy), .prim_count_i(prim_count), .active_i(active),
      .busy_o(busy), .done_o(done), .flush_o(flush), .streaming_mode_o(streaming), .pose_wanted_i(pose_wanted), .pose_o(pose), .posed_i(posed), .clear_o(clear), .clear_row_o(clear_row),
      .clear_mask_o(clear_mask), .fetch_start_o(fetch_start), .fetch_stop_o(fetch_stop), .secondary_valid_i(sec_valid),
      .secondary_last_i(sec_last), .secondary_idle_i(sec_idle), .secondary_pop_o(sec_pop), .ready_i(ready), .issue_o(issue),
      .issue_row_o(issue_row), .issue_parity_o(issue_parity), .retire_i(retire), .new_hits_i(new_hits), .credit_i(credit),
      .fifo_empty_i(fifo_empty), .writeback_o(writeback), .writeback_primary_o(writeback_primary),
      .writeback_parity_o(writeback_parity), .writeback_ready_i(writeback_ready), .sram_idle_i(!record_write),
      .bubble_o(bubble), .stall_o(stall));

  // ---- Collision detection engine and output FIFO ----
  localparam int FIFO_W = $clog2(FIFO_DEPTH);
  logic [ROW_W-1:0] row, fifo_row;
  logic [31:0] index, fifo_index, result_index;
  logic [LANES-1:0] f, bad, unmasked;
  logic fifo_keep, fifo_valid, fifo_ready, fifo_f, fifo_bad;
  logic [FIFO_W-1:0] fifo_write, fifo_head;
  logic [LANE_W-1:0] fifo_lane;
  logic [CW-1:0] result_t;
  logic [POINTS-1:0][CW-1:0] result_point;
  cde #(
      .EXP(EXP), .MAN(MAN), .LANES(LANES), .PRIMARIES(PRIMARIES), .FIFO_DEPTH(FIFO_DEPTH), .PAIRS(PAIRS), .ALGORITHM(ALGORITHM), .BOX(BOX),
      .SWAP(SWAP), .NORMALS(NORMALS), .PARALLEL(PARALLEL), .FACET_II(FACET_II), .TRANSFORM(TRANSFORM), .LAT_ADD(LAT_ADD), .LAT_MUL(LAT_MUL), .LAT_DIV(LAT_DIV),
      .LAT_SQRT(LAT_SQRT), .LAT_CMP(LAT_CMP), .ARITH(ARITH)
  ) engine (
      .clk_i(clk_engine), .rst_i, .clk_bus_i(clk_bus), .clk_core_i(clk_i), .prim_write_i(prim_write), .prim_addr_i(addr), .prim_data_i(wdata),
      .prim_bad_o(prim_bad), .prim_busy_o(prim_busy), .clk_moving_i(clk_moving), .prim_read_i(prim_read), .prim_written_o(prim_written), .pose_i(pose_commit), .pose_number_i(pose_number), .pose_slot_i(pose_slot), .pair_i(pair), .swap_i(swap), .split_i(split), .budget_i(budget), .gap_o(gap), .ready_o(ready), .clear_i(clear), .clear_row_i(clear_row), .clear_mask_i(clear_mask), .valid_i(issue), .row_i(issue_row),
      .parity_i(issue_parity), .index_i(sec_index), .secondary_i(secondary), .secondary_bad_i(sec_bad), .mode_i(mode),
      .streaming_i(streaming), .valid_o(retire), .row_o(row), .index_o(index), .new_hits_o(new_hits), .f_o(f), .bad_o(bad),
      .unmasked_o(unmasked), .latency_o(latency), .push_i(fifo_keep), .write_i(fifo_write), .read_i(streaming && fifo_valid),
      .head_i(fifo_head), .lane_i(fifo_lane), .result_i(writeback), .result_primary_i(writeback_primary),
      .result_parity_i(writeback_parity), .result_index_o(result_index), .result_t_o(result_t), .result_point_o(result_point));
  record_fifo #(.LANES(LANES), .ROW_W(ROW_W), .DEPTH(FIFO_DEPTH)) fifo (
      .clk_i(clk_engine), .rst_i(rst_i | clear | flush), .hits_only_i(mode == registers_pkg::MODE_HITS), .push_i(retire[0] && streaming),
      .row_i(row), .index_i(index), .unmasked_i(unmasked), .f_i(f), .bad_i(bad), .keep_o(fifo_keep), .write_o(fifo_write),
      .credit_o(credit), .empty_o(fifo_empty), .valid_o(fifo_valid), .ready_i(fifo_ready), .head_o(fifo_head), .row_o(fifo_row),
      .lane_o(fifo_lane), .index_o(fifo_index), .f_o(fifo_f), .bad_o(fifo_bad));

  // ---- Records: from the update buffers at the end of a pass, from the FIFO during it; with normals a second one follows ----
  localparam logic [CW-1:0] SIGN = CW'(1) << (EXP + MAN);
  localparam logic [CW-1:0] INF = ((CW'(1) << EXP) - 1) << MAN;
  localparam logic [CW-1:0] QNAN = INF | (CW'(1) << (MAN - 1));
  logic [RECORD_WORDS-1:0][CW-1:0] record_q, record;
  logic record_f, record_bad, record_there, second_q, last_beat;
  logic [CW-1:0] record_t;
  logic [31:0] record_index;
  logic [PRIM_W-1:0] record_primary;
  logic sram_room;  // counting the record on its way
  assign sram_room = !sram_full && !(record_write && sram_count + 1 == 32'(SRAM_RECORDS));
  assign last_beat = !normals || second_q;
  assign writeback_ready = sram_room && last_beat;
  assign fifo_ready = sram_room && last_beat;
  assign record_there = streaming ? fifo_valid : writeback;
  // The update buffers hold signed gaps for solids.
  logic record_gap;
  assign record_gap = (PARALLEL != 0 && pair[1] != pairs_pkg::NO_PAIR && writeback_primary >= split) ? gap[1] : gap[0];
  assign record_bad = streaming ? fifo_bad : prim_bad[writeback_primary];
  assign record_f = streaming ? fifo_f : result_index != '1 && (!record_gap || (result_t & SIGN) != 0) && !record_bad;
  assign record_t = record_bad ? QNAN : record_gap ? result_t & ~SIGN : result_t;
  assign record_index = !streaming ? result_index : (fifo_f || (record_gap && !fifo_bad)) ? fifo_index : '1;
  assign record_primary = streaming ? PRIM_W'(32'(fifo_row) * 32'(LANES) + 32'(fifo_lane)) : writeback_primary;
  always_comb begin
    record[2:0] = record_bad ? {3{QNAN}} : result_point[2:0];
    record[records_pkg::RECORD_FLAGS] = CW'({record_bad, record_f});
    record[records_pkg::RECORD_INDEX] = CW'(record_index);
    record[records_pkg::RECORD_T] = record_t;
    record[records_pkg::RECORD_PRIMARY] = CW'(record_primary);
    if (normals && second_q) begin
      record[2:0] = record_bad ? {3{QNAN}} : result_point[POINTS-1:POINTS-3];
      record[records_pkg::RECORD_FLAGS] = CW'({1'b1, record_bad, record_f});
      record[records_pkg::RECORD_T] = (record_f && record_gap) ? record_t | SIGN : record_t;
    end
  end
  always_ff @(posedge clk_engine) begin
    record_write <= !rst_i && !flush && record_there && sram_room;
    if (record_there) record_q <= record;
    second_q <= !rst_i && !flush && (record_there && sram_room ? normals && !second_q : second_q);
  end

  logic clk_ring, ring_active;
  clock_gate gate_ring (.clk_i, .enable_i(record_write | sram_pop | ring_active | flush | rst_i), .clk_o(clk_ring));
  sram_ring #(.CW(CW), .RECORDS(SRAM_RECORDS)) ring (
      .clk_i(clk_ring), .active_o(ring_active), .rst_i(rst_i | flush), .write_i(record_write & busy), .record_i(record_q), .full_o(sram_full), .count_o(sram_count),
      .last_i(!busy), .readable_o(sram_readable), .beat_valid_o(sram_beat_valid), .beat_o(sram_beat), .beat_pop_i(sram_pop), .sram_write_o, .sram_write_addr_o,
      .sram_write_data_o, .sram_read_o, .sram_read_addr_o, .sram_read_data_i);
endmodule
