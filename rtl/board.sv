// SPDX-License-Identifier: Apache-2.0
// The card without its bus bridge: local bus, primary and secondary register files, collision detection engine, update
// engine, record memory. DDR and SRAM chips are outside, and the ports carry their signals. There is one core clock;
// the engine's part is gated while no pass runs. This module is wiring. config.svh lists its parameters, and
// everything else comes from CONFIG.
`include "config.svh"
module board #(
    `CARD_PARAMETERS,
    parameter logic [63:0] CONFIG_HASH = 0,
    parameter config_pkg::config_t CONFIG = `CARD_CONFIG,
    localparam int CW = formats_pkg::container(CONFIG.exp, CONFIG.man),
    localparam int SEC_WORDS = pairs_pkg::slot_words(CONFIG.pairs, 0, CONFIG.swap != 0),
    localparam int PRIM_WORDS = pairs_pkg::slot_words(CONFIG.pairs, 1, CONFIG.swap != 0),
    localparam int POINTS = (CONFIG.normals != 0) ? 6 : 3,
    localparam int RECORD_WORDS = records_pkg::RECORD_WORDS,
    localparam int SRAM_AW = $clog2(CONFIG.sram_records)
) (
    input logic clk_i,
    input logic rst_i,

    input logic bus_valid_i,
    input logic bus_write_i,
    input logic [registers_pkg::SPACE_BITS-1:0] bus_space_i,
    input logic [31:0] bus_addr_i,
    input logic [63:0] bus_wdata_i,
    output logic bus_ready_o,
    output logic bus_rvalid_o,
    output logic [63:0] bus_rdata_o,
    output logic irq_o,

    output logic ddr_write_o,  // 64 bits at a byte offset
    output logic [31:0] ddr_write_addr_o,
    output logic [63:0] ddr_write_data_o,
    // with ECC, check bits of the words: the lower bits of the 8, as secded.svh defines
    output logic [64/CW-1:0][7:0] ddr_write_check_o,
    output logic ddr_read_o,  // reads DDR_WORDS words at an address in words; data comes in order
    output logic [31:0] ddr_read_word_o,
    output logic [3:0] ddr_read_words_o,  // words in use; a memory may leave the others out
    input logic ddr_ready_i,  // a read or write is taken; until then it stays
    input logic ddr_valid_i,
    input logic [records_pkg::DDR_WORDS-1:0][CW-1:0] ddr_data_i,
    input logic [records_pkg::DDR_WORDS-1:0][7:0] ddr_check_i,

    output logic sram_write_o,
    output logic [SRAM_AW-1:0] sram_write_addr_o,
    output logic [RECORD_WORDS-1:0][CW-1:0] sram_write_data_o,
    output logic sram_read_o,
    output logic [SRAM_AW-1:0] sram_read_addr_o,
    input logic [RECORD_WORDS-1:0][CW-1:0] sram_read_data_i  // one cycle after sram_read_o
);
  localparam int ROW_W = config_pkg::index_bits(CONFIG.primaries / CONFIG.lanes);
  localparam int PRIM_W = $clog2(CONFIG.primaries);
  localparam int FIFO_W = $clog2(config_pkg::fifo_depth(CONFIG));
  localparam int OBJECT_W = (CONFIG.transform != pairs_pkg::TRANSFORM_NONE) ? $clog2(CONFIG.objects) : 1;
  config_check #(.CONFIG(CONFIG)) check ();

  // ---- Local bus and registers ----
  registers_pkg::bus_request_t bus_request;
  registers_pkg::bus_response_t bus_response;
  assign bus_request = {bus_valid_i, bus_write_i, bus_space_i, bus_addr_i, bus_wdata_i};
  assign {bus_ready_o, bus_rvalid_o, bus_rdata_o} = bus_response;
  logic clk_bus, clk_engine, prim_write, go, abort, busy, done;
  logic sram_pop, sram_last, sram_readable, sram_beat_valid, sram_full, sram_nearly_full;
  logic [63:0] sram_beat;
  logic [31:0] sram_count;
  logic [CONFIG.primaries-1:0] active, prim_bad;
  logic [15:0] latency;
  logic object_write, objects_good, objects_busy, pose_done;
  card_pkg::pass_t command;  // the pass that a go would start now
  card_pkg::events_t events;
  card_pkg::issue_t issue;
  card_pkg::writeback_t writeback;
  card_pkg::streamed_t streamed;
  logic bubble, stall, sec_pop, sec_bad, record_write;
  logic [3:0] ecc_corrected, ecc_failed;
  logic [1:0] uncertain;
  card_pkg::access_t access;
  logic [63:0] bvh_rdata;
  logic provided_good, node_error;
  logic [2:0] bvh_good;
  logic [7:0] node_corrected;
  assign events = {uncertain, ecc_failed, 8'(ecc_corrected) + node_corrected, record_write, writeback.valid, sec_bad,
      sec_pop, stall, bubble,
      issue.valid};
  card_registers #(.CONFIG(CONFIG)) registers (
      .clk_i, .clk_engine_i(clk_engine), .rst_i, .bus_i(bus_request), .bus_o(bus_response), .irq_o, .clk_bus_o(clk_bus),
      .addr_o(ddr_write_addr_o), .wdata_o(ddr_write_data_o), .prim_write_o(prim_write), .ddr_write_o, .ddr_ready_i,
      .sram_pop_o(sram_pop), .sram_last_o(sram_last), .sram_readable_i(sram_readable), .sram_valid_i(sram_beat_valid),
      .sram_beat_i(sram_beat),
      .sram_count_i(sram_count), .sram_full_i(sram_full), .go_o(go), .abort_o(abort), .pass_o(command),
      .active_o(active), .busy_i(busy), .done_i(done), .prim_bad_i(prim_bad), .events_i(events), .latency_i(latency),
      .object_write_o(object_write), .objects_good_i(objects_good), .objects_busy_i(objects_busy),
      .pose_done_i(pose_done),
      .access_o(access), .rdata_ext_i(bvh_rdata), .provided_good_i(provided_good),
      .bvh_good_i(bvh_good), .node_error_i(node_error));
  clock_gate gate (.clk_i, .enable_i(busy | go | rst_i), .clk_o(clk_engine));
  // Turn of a lane that takes a row per several cycles.
  logic [2:0] turn;
  logic first_turn;  // turn is 0
  if (CONFIG.shared_lane > 1) begin : g_turns
    always_ff @(posedge clk_engine) begin
      first_turn <= rst_i || turn == 3'(CONFIG.shared_lane - 1);
      turn <= (rst_i || turn == 3'(CONFIG.shared_lane - 1)) ? '0 : turn + 1'b1;
    end
  end else begin : g_one_turn
    assign turn = '0;
    assign first_turn = 1'b1;
  end
  // Clock of the brute-force pass. It stands still during a BVH pass, unless leaves use the lane.
  logic clk_brute_force, traversing;
  logic [bvh_pkg::TRAVERSAL_BITS-1:0] traversal;
  if (CONFIG.traversal_units != 0 && !config_pkg::shares_lane(CONFIG)) begin : g_brute_force
    clock_gate gate_brute_force (.clk_i, .enable_i((busy & !traversing) | go | rst_i), .clk_o(clk_brute_force));
  end else begin : g_all
    assign clk_brute_force = clk_engine;
    logic unused_traversing;
    assign unused_traversing = &{1'b0, traversing, traversal};
  end

  // ---- Secondaries ----
  localparam int BEAT = records_pkg::DDR_WORDS;
  logic ddr_valid;
  logic [BEAT-1:0][CW-1:0] ddr_data;
  logic [3:0] ddr_words;  // words of the beat that belong to a slot
  // Readers of DDR: [0] the secondary register file, then the BVH.
  localparam int BVH_READERS = config_pkg::bvh_readers(CONFIG);
  localparam int READERS = (BVH_READERS > 1) ? 1 + BVH_READERS : 2;
  card_pkg::ddr_request_t [READERS-1:0] reader_requests;
  card_pkg::ddr_request_t ddr_request;
  logic [READERS-1:0] reader_ready, reader_valid;
  logic [READERS-1:0][3:0] reader_words;
  assign {ddr_read_words_o, ddr_read_o, ddr_read_word_o} = ddr_request;
  ddr_readers #(.READERS(READERS), .USED(READERS'((2 << BVH_READERS) - 1))) readers (
      .clk_i(clk_engine), .rst_i, .readers_i(reader_requests), .ready_o(reader_ready),
      .valid_o(reader_valid), .words_i(reader_words), .request_o(ddr_request), .ready_i(ddr_ready_i),
      .valid_i(ddr_valid), .words_o(ddr_words));
  ddr_check #(.CONFIG(CONFIG)) check_bits (
      .clk_i(clk_engine), .rst_i, .write_data_i(ddr_write_data_o), .write_check_o(ddr_write_check_o),
      .read_valid_i(ddr_valid_i), .read_data_i(ddr_data_i), .read_check_i(ddr_check_i), .words_i(ddr_words),
      .valid_o(ddr_valid), .data_o(ddr_data), .corrected_o(ecc_corrected), .failed_o(ecc_failed));
  pairs_pkg::pair_t [1:0] pair;  // of the pass
  logic [1:0] swap;
  logic fetch_start, fetch_stop, sec_valid, sec_last, sec_idle, clk_moving;
  logic [SEC_WORDS-1:0][CW-1:0] secondary, moved;
  logic [31:0] sec_index;
  logic [OBJECT_W-1:0] range_entry;
  // Slots to transform: [0] of brute-force passes, [1] of BVH leaves.
  logic [1:0] moving;
  logic [1:0][OBJECT_W-1:0] transform_entry;
  logic [1:0][SEC_WORDS-1:0][CW-1:0] unmoved;
  logic [1:0][31:0] range;
  secondary_regfile #(.CONFIG(CONFIG)) secondaries (
      .clk_i(clk_brute_force), .rst_i, .pair_i(pair[0]), .swap_i(swap[0]), .start_i(fetch_start), .stop_i(fetch_stop),
      .pass_i(command), .range_entry_o(range_entry), .range_i(range), .transform_entry_o(transform_entry[0]),
      .moving_o(moving[0]), .clk_moving_i(clk_moving), .unmoved_o(unmoved[0]), .moved_i(moved),
      .ddr_o(reader_requests[0]),
      .ddr_ready_i(reader_ready[0]), .ddr_valid_i(reader_valid[0]), .ddr_data_i(ddr_data),
      .ddr_words_o(reader_words[0]),
      .valid_o(sec_valid), .slot_o(secondary), .bad_o(sec_bad), .index_o(sec_index), .last_o(sec_last), .pop_i(sec_pop),
      .idle_o(sec_idle));

  // ---- Objects ----
  logic pose_request, pose, pose_commit;
  logic [PRIM_W-1:0] prim_read, pose_number;
  logic [PRIM_WORDS-1:0][CW-1:0] prim_written, pose_slot;
  if (CONFIG.transform != pairs_pkg::TRANSFORM_NONE) begin : g_objects
    objects #(.CONFIG(CONFIG)) tables (
        .clk_i(clk_brute_force), .clk_bus_i(clk_bus), .clk_core_i(clk_i), .rst_i, .write_i(object_write),
        .addr_i(ddr_write_addr_o), .data_i(ddr_write_data_o), .primary_write_i(prim_write), .command_i(command),
        .good_o(objects_good), .busy_o(objects_busy),
        .pair_i(traversing ? traversal[bvh_pkg::TRAVERSAL_BITS-1:1] : pair[0]),
        .swap_i(traversing ? traversal[0] : swap[0]), .range_entry_i(range_entry),
        .range_o(range), .transform_entry_i(transform_entry[traversing]), .moving_i(moving != 0),
        .clk_moving_o(clk_moving),
        .unmoved_i(unmoved[traversing]), .moved_o(moved), .pose_request_o(pose_request), .pose_i(pose),
        .pose_done_o(pose_done),
        .read_o(prim_read), .written_i(prim_written), .pose_commit_o(pose_commit), .pose_number_o(pose_number),
        .pose_slot_o(pose_slot));
  end else begin : g_fixed
    logic unused;
    assign unused = &{1'b0, object_write, range_entry, transform_entry, moving, unmoved, pose, prim_written};
    assign {objects_good, objects_busy, pose_request, pose_done, pose_commit} = 5'b10000;
    assign clk_moving = 1'b0;
    assign range = '0;
    assign moved = '0;
    assign prim_read = '0;
    assign pose_number = '0;
    assign pose_slot = '0;
  end

  // ---- Units that do passes ----
  localparam int UNITS = (CONFIG.traversal_units != 0) ? card_pkg::UNITS : 1;
  logic [UNITS-1:0] unit_valid, unit_ready, unit_abort, unit_busy, unit_done;
  pass_dispatch #(.UNITS(UNITS)) dispatch (
      .clk_i(clk_engine), .rst_i, .go_i(go), .unit_i(command.unit), .abort_i(abort), .busy_o(busy), .done_o(done),
      .valid_o(unit_valid), .ready_i(unit_ready), .abort_o(unit_abort), .busy_i(unit_busy), .done_i(unit_done));
  localparam int ENGINE = int'(card_pkg::UNIT_ENGINE);
  logic [2:0] mode;
  logic streaming, prim_busy, flush, clear, fifo_empty, record_ready;
  logic [ROW_W-1:0] clear_row;
  logic [CONFIG.lanes-1:0] clear_mask;
  logic [1:0] retire, ready, credit, solid;
  logic [PRIM_W:0] new_hits;
  engine_control #(.CONFIG(CONFIG)) control (
      .clk_i(clk_brute_force), .rst_i, .go_i(unit_valid[ENGINE]), .ready_o(unit_ready[ENGINE]),
      .abort_i(unit_abort[ENGINE]),
      .command_i(command), .mode_o(mode), .pair_o(pair), .swap_o(swap), .primaries_busy_i(prim_busy),
      .active_i(active), .busy_o(unit_busy[ENGINE]), .done_o(unit_done[ENGINE]), .flush_o(flush),
      .streaming_mode_o(streaming), .pose_request_i(pose_request), .pose_o(pose), .pose_done_i(pose_done),
      .clear_o(clear),
      .clear_row_o(clear_row), .clear_mask_o(clear_mask), .fetch_start_o(fetch_start), .fetch_stop_o(fetch_stop),
      .secondary_valid_i(sec_valid), .secondary_last_i(sec_last), .secondary_idle_i(sec_idle),
      .secondary_pop_o(sec_pop), .ready_i(ready), .issue_o(issue), .retire_i(retire), .new_hits_i(new_hits),
      .credit_i(credit),
      .fifo_empty_i(fifo_empty), .writeback_o(writeback), .writeback_ready_i(record_ready), .sram_idle_i(!record_write),
      .bubble_o(bubble), .stall_o(stall));

  // ---- Collision detection engine and output FIFO ----
  card_pkg::lane_operands_t leaf_operands;
  card_pkg::lane_results_t leaf_results;
  logic [ROW_W-1:0] row;
  logic [31:0] index, result_index;
  logic [CONFIG.lanes-1:0] f, bad, unmasked;
  logic fifo_keep, result_f;
  logic [FIFO_W-1:0] fifo_write, fifo_head;
  logic [CW-1:0] result_t;
  logic [POINTS-1:0][CW-1:0] result_point;
  collision_engine #(.CONFIG(CONFIG)) engine (
      .clk_i(clk_brute_force), .rst_i, .clk_bus_i(clk_bus), .clk_core_i(clk_i), .prim_write_i(prim_write),
      .prim_addr_i(ddr_write_addr_o), .prim_data_i(ddr_write_data_o), .prim_bad_o(prim_bad), .prim_busy_o(prim_busy),
      .clk_moving_i(clk_moving), .prim_read_i(prim_read), .prim_written_o(prim_written), .pose_i(pose_commit),
      .pose_number_i(pose_number), .pose_slot_i(pose_slot), .pair_i(pair), .swap_i(swap),
      .split_i(command.split[PRIM_W-1:0]), .iterations_i(command.iterations),
      .solid_o(solid), .ready_o(ready), .clear_i(clear),
      .clear_row_i(clear_row), .clear_mask_i(clear_mask), .issue_i(issue),
      .index_i(sec_index), .secondary_i(secondary), .secondary_bad_i(sec_bad), .mode_i(mode), .streaming_i(streaming),
      .turn_i(turn), .first_turn_i(first_turn), .leaf_i(leaf_operands), .leaf_o(leaf_results),
      .valid_o(retire), .row_o(row), .index_o(index), .new_hits_o(new_hits), .f_o(f), .bad_o(bad),
      .unmasked_o(unmasked), .latency_o(latency), .uncertain_o(uncertain), .push_i(fifo_keep), .write_i(fifo_write),
      .head_i(fifo_head), .streamed_i(streamed), .result_i(writeback), .result_f_o(result_f),
      .result_index_o(result_index),
      .result_t_o(result_t), .result_point_o(result_point));
  record_fifo #(.LANES(CONFIG.lanes), .ROW_W(ROW_W), .DEPTH(config_pkg::fifo_depth(CONFIG))) fifo (
      .clk_i(clk_brute_force), .rst_i(rst_i | clear | flush), .hits_only_i(mode == registers_pkg::MODE_HITS),
      .push_i(retire[0] && streaming), .row_i(row), .index_i(index), .unmasked_i(unmasked), .f_i(f), .bad_i(bad),
      .keep_o(fifo_keep), .write_o(fifo_write), .credit_o(credit), .empty_o(fifo_empty),
      .ready_i(record_ready), .head_o(fifo_head), .streamed_o(streamed));

  // ---- Records ----
  logic [RECORD_WORDS-1:0][CW-1:0] record, brute_force_record, bvh_record;
  logic brute_force_write, bvh_write;
  logic clk_ring, ring_active;
  record_maker #(.CONFIG(CONFIG)) records (
      .clk_i(clk_brute_force), .rst_i, .flush_i(flush), .normals_i(command.normals), .streaming_i(streaming),
      .second_pair_i(pair[1]), .solid_i(solid), .split_i(command.split[PRIM_W-1:0]), .streamed_i(streamed),
      .writeback_i(writeback), .writeback_bad_i(prim_bad[writeback.primary[PRIM_W-1:0]]), .result_f_i(result_f),
      .result_index_i(result_index),
      .result_t_i(result_t), .result_point_i(result_point), .ready_o(record_ready), .sram_full_i(sram_full),
      .sram_nearly_full_i(sram_nearly_full), .write_o(brute_force_write), .record_o(brute_force_record));
  assign record_write = brute_force_write | bvh_write;
  assign record = bvh_write ? bvh_record : brute_force_record;
  if (CONFIG.traversal_units != 0) begin : g_bvh
    localparam int BVH = int'(card_pkg::UNIT_BVH);
    assign traversing = unit_busy[BVH];
    localparam int LEAF = bvh_pkg::leaf_words(bvh_pkg::card_traversals(CONFIG));
    logic [LEAF-1:0][CW-1:0] leaf_unmoved;
    bvh_unit #(.CONFIG(CONFIG)) bvh (
        .clk_core_i(clk_i), .clk_bus_i(clk_bus), .rst_i, .access_i(access), .rdata_o(bvh_rdata),
        .provided_good_o(provided_good), .good_o(bvh_good),
        .valid_i(unit_valid[BVH]), .ready_o(unit_ready[BVH]), .abort_i(unit_abort[BVH]),
        .pass_i(command), .busy_o(unit_busy[BVH]), .traversal_o(traversal),
        .done_o(unit_done[BVH]), .fault_o(node_error), .corrected_o(node_corrected),
        .ddr_o(reader_requests[READERS-1:1]), .ddr_ready_i(reader_ready[READERS-1:1]),
        .ddr_valid_i(reader_valid[READERS-1:1]), .ddr_data_i(ddr_data), .ddr_words_o(reader_words[READERS-1:1]),
        .transform_entry_o(transform_entry[1]), .moving_o(moving[1]),
        .clk_moving_i(clk_moving), .unmoved_o(leaf_unmoved), .moved_i((LEAF * CW)'(moved)),
        .turn_i(turn), .lane_o(leaf_operands), .lane_i(leaf_results),
        .sram_full_i(sram_full), .sram_nearly_full_i(sram_nearly_full), .write_o(bvh_write), .record_o(bvh_record));
    assign unmoved[1] = (SEC_WORDS * CW)'(leaf_unmoved);
    logic unused_rest;  // slots may be shorter or longer
    assign unused_rest = &{1'b0, leaf_unmoved, traversal};
  end else begin : g_brute_force_only
    assign {node_corrected, bvh_rdata, provided_good, bvh_good, node_error, bvh_write, traversing} = '0;
    assign {moving[1], transform_entry[1], unmoved[1]} = '0;
    assign reader_requests[1] = '0;
    assign reader_words[1] = '0;
    assign bvh_record = '0;
    assign traversal = '0;
    assign leaf_operands = '0;
    logic unused_bvh;
    assign unused_bvh = &{1'b0, access, reader_ready[1], reader_valid[1], leaf_results, turn};
  end
  clock_gate gate_ring (.clk_i, .enable_i(record_write | sram_pop | ring_active | flush | rst_i), .clk_o(clk_ring));
  sram_ring #(.CW(CW), .RECORDS(CONFIG.sram_records)) ring (
      .clk_i(clk_ring), .active_o(ring_active), .rst_i(rst_i | flush), .write_i(record_write & busy),
      .record_i(record), .full_o(sram_full), .nearly_full_o(sram_nearly_full), .count_o(sram_count), .last_i(sram_last),
      .readable_o(sram_readable), .beat_valid_o(sram_beat_valid), .beat_o(sram_beat), .beat_pop_i(sram_pop),
      .sram_write_o, .sram_write_addr_o, .sram_write_data_o, .sram_read_o, .sram_read_addr_o, .sram_read_data_i);
endmodule
