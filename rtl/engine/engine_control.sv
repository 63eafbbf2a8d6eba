// SPDX-License-Identifier: Apache-2.0
// Sequencer of a brute-force pass. It transforms moved primaries, clears the update buffers, and sends every secondary
// over the rows of primaries. Then it drains the pipe, writes results back and reports done.
// A row enters the pipe when a secondary is present and the pipe is ready. Streaming modes also need a credit of the
// output FIFO. With a second pair, a row of its primaries enters its pipe in the same cycle.
// Throughput: one row per cycle without idle cycles, while secondaries and credits last and pipes are ready.
module engine_control #(
    parameter config_pkg::config_t CONFIG,
    localparam int LANES = CONFIG.lanes,
    localparam int PRIMARIES = CONFIG.primaries,
    localparam int FIFO_DEPTH = config_pkg::fifo_depth(CONFIG),
    localparam int ROWS = PRIMARIES / LANES,
    localparam int ROW_W = (ROWS > 1) ? $clog2(ROWS) : 1,
    localparam int PRIM_W = $clog2(PRIMARIES)
) (
    input logic clk_i,
    input logic rst_i,
    input logic go_i,      // starts a pass; taken when ready_o is also high
    output logic ready_o,
    input logic abort_i,
    input card_pkg::pass_t command_i,
    output logic [2:0] mode_o,  // mode of the pass, valid from go on
    output pairs_pkg::pair_t [1:0] pair_o,
    output logic [1:0] swap_o,
    input logic primaries_busy_i,  // primaries are being checked
    input logic [PRIMARIES-1:0] active_i,  // present and not masked
    output logic busy_o,
    output logic done_o,  // one cycle
    output logic flush_o,  // aborted: rows in flight or waiting are dropped
    output logic streaming_mode_o,

    input logic pose_request_i,  // primaries moved since they were last transformed
    output logic pose_o,
    input logic pose_done_i,

    output logic clear_o,
    output logic [ROW_W-1:0] clear_row_o,
    output logic [LANES-1:0] clear_mask_o,

    output logic fetch_start_o,
    output logic fetch_stop_o,
    input logic secondary_valid_i,
    input logic secondary_last_i,
    input logic secondary_idle_i,
    output logic secondary_pop_o,

    input logic [1:0] ready_i,   // the pair's pipe takes a row
    output card_pkg::issue_t issue_o,
    input logic [1:0] retire_i,       // a row left the pipe
    input logic [PRIM_W:0] new_hits_i,
    input logic [1:0] credit_i,
    input logic fifo_empty_i,

    output card_pkg::writeback_t writeback_o,
    input logic writeback_ready_i,
    input logic sram_idle_i,

    output logic bubble_o,
    output logic stall_o
);
  localparam bit ONE = (CONFIG.pairs & (CONFIG.pairs - 1)) == 0;  // the card has one pair
  typedef enum logic [2:0] {IDLE, POSE, CLEAR, BRUTE_FORCE, DRAIN, WRITEBACK, FLUSH} state_e;
  state_e state_q;
  logic [ROW_W-1:0] row_q, second_row;
  logic [PRIM_W-1:0] primary, primary_q;
  logic [ROW_W:0] rows, first_rows, second_rows, longer;  // rows in use
  logic parity_q, stop_q, write_q;  // write_q: primary_q is to be written back
  logic last_row_q;  // row_q is the last row of a secondary
  // The primary to write back after it, one-hot, and those after that one. One register for all of it would be slow.
  logic [PRIMARIES-1:0] next_q, pending_q, lowest;
  logic ahead_q;  // next_q has left pending_q
  logic [PRIM_W:0] missing_q, new_hits_q;  // active primaries without a hit, for mode any; of these, new hits
  logic [PRIM_W:0] found_q;  // active primaries of the row that was cleared
  logic [15:0] in_flight_q;
  logic [$clog2(FIFO_DEPTH):0] credits_q;
  logic [1:0] credit, credit_q;
  logic enter, has_credit, all_hit, taken, step, drained;
  logic [1:0] has_row;  // the pairs that have a row here

  assign rows = (ROW_W + 1)'((32'(command_i.primaries) + 32'(LANES - 1)) / 32'(LANES));
  assign first_rows = (pair_o[1] == pairs_pkg::NO_PAIR) ? rows : (ROW_W + 1)'(32'(command_i.split) / 32'(LANES));
  assign second_rows = rows - first_rows;
  assign longer = (first_rows > second_rows) ? first_rows : second_rows;
  assign busy_o = state_q != IDLE;
  assign ready_o = !busy_o;
  assign flush_o = abort_i || state_q == FLUSH;
  assign streaming_mode_o = mode_o == registers_pkg::MODE_ALL || mode_o == registers_pkg::MODE_HITS;

  assign pose_o = state_q == POSE;
  assign clear_o = state_q == CLEAR && !primaries_busy_i;
  assign clear_row_o = row_q;
  assign clear_mask_o = ~active_i[32'(row_q)*LANES+:LANES];

  // A shared lane takes few rows, so its credits may come a cycle later.
  assign credit = (CONFIG.shared_lane != 0) ? credit_q : credit_i;
  assign has_credit = !streaming_mode_o || credits_q != 0;
  assign all_hit = mode_o == registers_pkg::MODE_ANY && missing_q == new_hits_q && found_q == '0;
  // The only pair of a pass has every row.
  assign has_row = (CONFIG.parallel == 0) ? 2'b01 :
      {(ROW_W + 1)'(row_q) < second_rows, (ROW_W + 1)'(row_q) < first_rows};
  assign enter = state_q == BRUTE_FORCE && secondary_valid_i && has_credit && (has_row & ~ready_i) == 0 && !stop_q;
  assign issue_o.valid = has_row & {2{enter}};
  assign second_row = row_q + ROW_W'(first_rows);
  assign issue_o.row = {8'(second_row), 8'(row_q)};
  assign issue_o.parity = parity_q;
  assign secondary_pop_o = enter && last_row_q;
  assign fetch_start_o = clear_o && row_q == 0 && !abort_i;
  assign fetch_stop_o = state_q == BRUTE_FORCE && stop_q || abort_i;
  assign bubble_o = state_q == BRUTE_FORCE && !secondary_valid_i && !stop_q;
  assign stall_o = state_q == BRUTE_FORCE && secondary_valid_i && !stop_q && !enter;

  assign lowest = pending_q & (~pending_q + 1'b1);
  one_hot_index #(.N(PRIMARIES)) encode (.bit_i(next_q), .index_o(primary));
  assign writeback_o.valid = write_q;
  assign writeback_o.primary = 8'(primary_q);
  assign writeback_o.parity = parity_q;
  assign done_o = state_q == WRITEBACK && !write_q && fifo_empty_i && sram_idle_i;

  // The search works two primaries ahead, and finds the first ones before the write-back.
  assign taken = write_q && writeback_ready_i;
  assign drained = in_flight_q == 0 && secondary_idle_i;
  assign step = taken || (state_q == DRAIN && drained) || (state_q == BRUTE_FORCE && !ahead_q);
  always_ff @(posedge clk_i) begin
    if (taken) write_q <= next_q != 0;
    if (step) next_q <= lowest;
    if (step) pending_q <= pending_q & ~lowest;
    if (state_q == DRAIN || taken) primary_q <= primary;
    in_flight_q <= in_flight_q + 16'($countones(issue_o.valid)) - 16'($countones(retire_i));
    credit_q <= credit_i;
    credits_q <= credits_q + ($clog2(FIFO_DEPTH) + 1)'(credit) - ($clog2(FIFO_DEPTH) + 1)'(enter && streaming_mode_o);
    new_hits_q <= new_hits_i;
    found_q <= clear_o ? (PRIM_W + 1)'($countones(~clear_mask_o)) : '0;
    missing_q <= missing_q + found_q - new_hits_q;
    case (state_q)
      IDLE: begin
        row_q <= 0;
        if (go_i) begin
          mode_o <= command_i.mode;
          // Options that the card lacks are constants here, and so is all that depends on them.
          pair_o <= {(CONFIG.parallel != 0) ? command_i.pair[1] : pairs_pkg::NO_PAIR,
              ONE ? pairs_pkg::PAIR_BITS'($clog2(CONFIG.pairs)) : command_i.pair[0]};
          swap_o <= {2{CONFIG.swap != 0}} & command_i.swap;
          state_q <= pose_request_i ? POSE : CLEAR;
          credits_q <= ($clog2(FIFO_DEPTH) + 1)'(FIFO_DEPTH);
          missing_q <= '0;
        end
      end
      POSE: if (pose_done_i) state_q <= CLEAR;
      CLEAR: if (clear_o) begin
        stop_q <= 0;
        ahead_q <= 0;
        parity_q <= 0;
        pending_q <= streaming_mode_o ? '0 : active_i;
        row_q <= row_q + 1;
        if (32'(row_q) == ROWS - 1) begin
          row_q <= 0;
          last_row_q <= longer == 1;
          state_q <= BRUTE_FORCE;
        end
      end
      BRUTE_FORCE: begin
        ahead_q <= 1;
        if (enter) begin
          row_q <= last_row_q ? '0 : row_q + 1;
          last_row_q <= longer == (last_row_q ? (ROW_W + 1)'(1) : (ROW_W + 1)'(row_q) + (ROW_W + 1)'(2));
        end
        if (secondary_pop_o) begin
          parity_q <= ~parity_q;
          // Mode any ends between two secondaries, so every row has met the same ones.
          if (all_hit) stop_q <= 1;
        end
        if ((secondary_pop_o && secondary_last_i) || stop_q) state_q <= DRAIN;
      end
      DRAIN: if (drained) begin
        write_q <= next_q != 0;
        state_q <= WRITEBACK;
      end
      WRITEBACK: if (done_o) state_q <= IDLE;
      FLUSH: if (drained) state_q <= IDLE;
      default: state_q <= IDLE;
    endcase
    if (abort_i && state_q != IDLE) state_q <= FLUSH;
    if (abort_i || rst_i) write_q <= 0;
    if (rst_i) begin
      state_q <= IDLE;
      in_flight_q <= 0;
      stop_q <= 0;
    end
  end

`ifndef SYNTHESIS
  always_ff @(posedge clk_i)
    if (!rst_i) begin
      assert (16'($countones(retire_i)) <= in_flight_q)
      else $error("engine_control: a row left the pipe that never entered");
      assert (!(enter && last_row_q != ((ROW_W + 1)'(row_q) + 1'b1 == longer)))
      else $error("engine_control: wrong last row");
      assert (!(go_i && busy_o)) else $error("engine_control: go while busy");
    end
`endif
endmodule
