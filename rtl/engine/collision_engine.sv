// SPDX-License-Identifier: Apache-2.0
// Collision detection engine: LANES lanes in groups behind one input port. In each cycle it tests a row of LANES
// primaries against one secondary, and keeps or streams the row's results in order.
// With ARITH = "host", the datapath is combinational. It takes its operands when its results are due, not when the row
// is issued. Cycles and bits at the ports are the same.
// A pass uses one pipe. With PARALLEL it uses at most two, which get the same secondaries and their own primaries. The
// clocks of the other pipes stand still.
// Latency: same as the pipe.
// Throughput: one row per cycle; per SAT_II cycles with candidate axes; as ready_o allows in an iterative pipeline.
// Stall: ready_o. Credits outside reserve space for results.
module collision_engine #(
    parameter config_pkg::config_t CONFIG,
    localparam int EXP = CONFIG.exp,
    localparam int MAN = CONFIG.man,
    localparam int LANES = CONFIG.lanes,
    localparam int PRIMARIES = CONFIG.primaries,
    localparam int PAIRS = CONFIG.pairs,
    localparam int SWAP = CONFIG.swap,
    localparam int NORMALS = CONFIG.normals,
    localparam int PARALLEL = CONFIG.parallel,
    localparam int SAT_II = CONFIG.sat_ii,
    localparam latency_pkg::latency_t LAT = CONFIG.lat,
    localparam ARITH = config_pkg::arith(CONFIG.host),
    localparam int FIFO_DEPTH = config_pkg::fifo_depth(CONFIG),
    localparam int CW = formats_pkg::container(EXP, MAN),
    localparam int PRIM_WORDS = pairs_pkg::slot_words(PAIRS, 1, SWAP != 0),
    localparam int SEC_WORDS = pairs_pkg::slot_words(PAIRS, 0, SWAP != 0),
    localparam int POINTS = (NORMALS != 0) ? 6 : 3,
    localparam int N_PAIRS = pairs_pkg::PAIRS,
    localparam int ROWS = PRIMARIES / LANES,
    localparam int ROW_W = (ROWS > 1) ? $clog2(ROWS) : 1,
    localparam int LANE_W = (LANES > 1) ? $clog2(LANES) : 1,
    localparam int PRIM_W = $clog2(PRIMARIES),
    localparam int FIFO_W = $clog2(FIFO_DEPTH)
) (
    input logic clk_i,  // may be gated while nothing is in flight
    input logic rst_i,
    input logic clk_bus_i,
    input logic clk_core_i,  // not gated, both

    input logic prim_write_i,
    input logic [31:0] prim_addr_i,
    input logic [63:0] prim_data_i,
    output logic [PRIMARIES-1:0] prim_bad_o,  // primaries outside their pair's contract
    output logic prim_busy_o,  // primaries are being checked
    input logic clk_moving_i,  // as in primary_regfile
    input logic [PRIM_W-1:0] prim_read_i,
    output logic [PRIM_WORDS-1:0][CW-1:0] prim_written_o,
    input logic pose_i,
    input logic [PRIM_W-1:0] pose_number_i,
    input logic [PRIM_WORDS-1:0][CW-1:0] pose_slot_i,
    input logic clear_i,  // start of a pass: one row per cycle
    input logic [ROW_W-1:0] clear_row_i,
    input logic [LANES-1:0] clear_mask_i,

    input pairs_pkg::pair_t [1:0] pair_i,  // pairs of the pass; the second one may be NO_PAIR
    input logic [1:0] swap_i,
    input logic [PRIM_W-1:0] split_i,  // first primary of the second pair
    input logic [23:0] iterations_i,  // iterations of cylinder pairs
    output logic [1:0] solid_o,  // the pair is a pair of solids
    output logic [1:0] ready_o,  // the pair's pipe takes a row
    input card_pkg::issue_t issue_i,
    input logic [31:0] index_i,
    input logic [SEC_WORDS-1:0][CW-1:0] secondary_i,
    input logic secondary_bad_i,
    input logic [2:0] mode_i,
    input logic streaming_i,
    input logic [2:0] turn_i,  // of a shared lane; rows enter in turn 0
    input logic first_turn_i,  // turn_i is 0
    input card_pkg::lane_operands_t leaf_i,  // leaves of a BVH in the lane, and their results
    output card_pkg::lane_results_t leaf_o,

    output logic [1:0] valid_o,
    output logic [ROW_W-1:0] row_o,  // row of the first pair
    output logic [31:0] index_o,
    output logic [PRIM_W:0] new_hits_o,
    output logic [LANES-1:0] f_o,  // in the streaming modes
    output logic [LANES-1:0] bad_o,
    output logic [LANES-1:0] unmasked_o,
    output logic [15:0] latency_o,
    output logic [1:0] uncertain_o,  // pairs with certified filters that are uncertain and go through the wide pipe

    input logic push_i,
    input logic [FIFO_W-1:0] write_i,
    input logic [FIFO_W-1:0] head_i,
    input card_pkg::streamed_t streamed_i,   // T and CP of its lane come from the FIFO
    input card_pkg::writeback_t result_i,  // T, CP and index of its primary come from the update buffers
    output logic result_f_o,
    output logic [31:0] result_index_o,
    output logic [CW-1:0] result_t_o,
    output logic [POINTS-1:0][CW-1:0] result_point_o
);
  // One vector register of the simulating processor wide. Gates have one object for all lanes.
`ifdef CDE_GROUP_LANES
  localparam int MOST = `CDE_GROUP_LANES;
`else
  localparam int MOST = 8;
`endif
  localparam int ORDERED = config_pkg::ordered_pairs(CONFIG);
  // Narrow lanes share a wide lane, so they are one group: two groups would not keep step.
  localparam bit APART = ARITH != "rtl" && LANES > MOST && config_pkg::filter_pairs(CONFIG) == 0;
  localparam int GROUP = APART ? MOST : LANES;
  localparam int GROUPS = LANES / GROUP;
  localparam int GLANE_W = (GROUP > 1) ? $clog2(GROUP) : 1;
  localparam int HITS_W = $clog2(GROUP + 1) + PARALLEL;

  logic [1:0][ROW_W-1:0] row;
  assign row = {issue_i.row[1][ROW_W-1:0], issue_i.row[0][ROW_W-1:0]};

  // ---- Primaries from the bus ----
  logic prim_commit, clk_prim;
  logic [ROW_W-1:0] prim_row;
  logic [LANE_W-1:0] prim_lane;
  logic [PRIM_WORDS-1:0][CW-1:0] prim_slot;
  primary_regfile #(.CONFIG(CONFIG)) primaries (
      .clk_i(clk_bus_i), .clk_core_i, .rst_i, .pair_i, .swap_i, .split_i, .busy_o(prim_busy_o), .write_i(prim_write_i),
      .write_addr_i(prim_addr_i), .write_data_i(prim_data_i), .bad_o(prim_bad_o), .clk_moving_i, .read_i(prim_read_i),
      .written_o(prim_written_o), .pose_i, .pose_number_i, .pose_slot_i, .commit_o(prim_commit), .row_o(prim_row),
      .lane_o(prim_lane), .slot_o(prim_slot));

  clock_gate gate_prim (.clk_i(clk_core_i), .enable_i(prim_commit), .clk_o(clk_prim));

  // ---- Rows in flight ----
  localparam bit MANY = (PAIRS & (PAIRS - 1)) != 0;
  localparam int HISTORY = config_pkg::pipe_depth(CONFIG);
  localparam int PORTS = 1 + PARALLEL;  // pairs in a pass
  localparam bit ANY_ORDERED = ORDERED != 0;
  // rows of some pairs need several cycles
  localparam bit TURNS = SAT_II != 1 && (PAIRS & pairs_pkg::SAT_PAIRS) != 0;
  localparam bit ISSUE = ANY_ORDERED || (TURNS && ARITH == "rtl");  // some pipe needs the cycle of issue
  localparam int REGISTERS = 2;  // behind the memory of rows in flight
  localparam int UNUSED = 1 + REGISTERS;  // latency where no row enters: it must have passed since a change
  // Rows in flight where only the order is kept.
  localparam int IN_ORDER = formats_pkg::larger(pairs_pkg::ITERATIVE_ROWS, 4 * HISTORY);
  pairs_pkg::pair_t [PORTS-1:0] pair;
  for (genvar k = 0; k < PORTS; k++) begin : pair_of
    assign pair[k] = MANY ? pair_i[k] : pairs_pkg::PAIR_BITS'($clog2(PAIRS));
  end
  logic [PORTS-1:0] parity, secondary_bad;
  logic [PORTS-1:0][15:0] pipe_latency, latency;
  logic [N_PAIRS-1:0] clk_pipe;
  logic [PORTS-1:0][ROW_W-1:0] row_in, row_out;
  logic [PORTS-1:0][31:0] index;
  logic [PORTS-1:0][SEC_WORDS-1:0][CW-1:0] secondary;
  for (genvar k = 0; k < PORTS; k++) begin : port
    assign latency[k] = pipe_latency[k] + 16'(MANY);  // the register in front of each of several pipes
    logic ordered, late_valid, throttle_ready, interval_ready;
    issue_throttle #(.INTERVAL(TURNS ? SAT_II : 1)) interval (
        .clk_i, .rst_i, .take_i(issue_i.valid[k] && pairs_pkg::has(pairs_pkg::SAT_PAIRS, int'(pair[k]))),
        .ready_o(throttle_ready));
    assign interval_ready = throttle_ready && first_turn_i;
    logic [ROW_W+33:0] tag, late_tag;
    assign tag = {row[k], issue_i.parity, index_i, secondary_bad_i};
    localparam bit EARLY = config_pkg::early_rows(CONFIG);
    logic now_valid;
    logic [ROW_W+33:0] now_tag;
    row_history #(.W(ROW_W + 34), .DEPTH(HISTORY), .REGISTERS(REGISTERS)) history (
        .clk_i, .rst_i, .latency_i(ordered ? 16'(UNUSED) : latency[k] - (EARLY ? 16'd2 : 16'd0)),
        .valid_i(issue_i.valid[k] && !ordered), .d_i(tag), .valid_o(now_valid), .q_o(now_tag));
    if (EARLY) begin : g_kept  // the tag comes one cycle before the row, and stays
      logic valid_q;
      always_ff @(posedge clk_i) begin
        if (now_valid) late_tag <= now_tag;
        {late_valid, valid_q} <= rst_i ? '0 : {valid_q, now_valid};
      end
    end else begin : g_at_once
      assign {late_valid, late_tag} = {now_valid, now_tag};
    end
    if (ANY_ORDERED) begin : g_order  // keeps the order, not the time
      logic [ROW_W+33:0] next_tag;
      logic [pairs_pkg::PAIR_INDEX-1:0] of_pair;
      assign of_pair = pair[k][pairs_pkg::PAIR_INDEX-1:0];
      assign ordered = pairs_pkg::has(ORDERED, int'(pair[k]));
      assign ready_o[k] = interval_ready && (!ordered || group[0].ordered_ready[of_pair]);
      tag_fifo #(.W(ROW_W + 34), .DEPTH(IN_ORDER)) order (
          .clk_i, .rst_i, .push_i(issue_i.valid[k] && ordered), .d_i(tag),
          .pop_i(ordered && group[0].ordered_valid[of_pair]),
          .q_o(next_tag));
      assign valid_o[k] = ordered ? group[0].ordered_valid[of_pair] : late_valid;
      assign {row_out[k], parity[k], index[k], secondary_bad[k]} = ordered ? next_tag : late_tag;
    end else begin : g_no_order
      assign ordered = 1'b0;
      assign ready_o[k] = interval_ready;
      assign valid_o[k] = late_valid;
      assign {row_out[k], parity[k], index[k], secondary_bad[k]} = late_tag;
    end
    if (ARITH != "rtl") begin : g_late
      logic unused_valid;
      row_history #(.W(ROW_W + SEC_WORDS * CW), .DEPTH(HISTORY)) history_operands (
          .clk_i, .rst_i, .latency_i(ordered ? 16'd1 : pipe_latency[k]), .valid_i(issue_i.valid[k] && !ordered),
          .d_i({row[k], secondary_i}), .valid_o(unused_valid), .q_o({row_in[k], secondary[k]}));
    end else begin : g_early
      assign row_in[k] = row[k];
      assign secondary[k] = secondary_i;
    end
  end
  assign latency_o = latency[0];
  assign row_o = row_out[0];
  assign index_o = index[0];
  if (PARALLEL == 0) begin : g_single
    logic unused_second;
    assign unused_second = &{1'b0, issue_i.valid[1], row[1], pair_i[1], swap_i[1], split_i};
    assign valid_o[1] = 1'b0;
    assign ready_o[1] = 1'b1;
  end
  for (genvar p = 0; p < N_PAIRS; p++) begin : pipe
    if (MANY && ((PAIRS >> p) & 1) != 0) begin : g_gate
      clock_gate gate (.clk_i,
          .enable_i(pair_i[0] == pairs_pkg::PAIR_BITS'(p) || (PARALLEL != 0 && pair_i[1] == pairs_pkg::PAIR_BITS'(p)) ||
          (pairs_pkg::has(ORDERED, p) && rst_i)), .clk_o(clk_pipe[p]));
    end else begin : g_none
      assign clk_pipe[p] = 1'b0;
    end
  end
  for (genvar k = 0; k < 2; k++) begin : of
    if (!MANY) begin : g_one
      assign solid_o[k] = pairs_pkg::primary_shape($clog2(PAIRS)) != pairs_pkg::SHAPE_RAY;
    end else begin : g_some
      assign solid_o[k] = pairs_pkg::primary_shape(int'(pair_i[k])) != pairs_pkg::SHAPE_RAY;
    end
  end

  // ---- Lanes ----
  logic [LANE_W-1:0] result_lane, lane;
  logic [ROW_W-1:0] result_row;
  assign result_row = ROW_W'(32'(result_i.primary) / 32'(LANES));
  assign result_lane = LANE_W'(32'(result_i.primary) % 32'(LANES));
  assign lane = result_i.valid ? result_lane : streamed_i.lane[LANE_W-1:0];
  logic [PORTS-1:0] result;
  if (PARALLEL != 0) begin : g_results
    logic second;
    assign second = pair_i[1] != pairs_pkg::NO_PAIR && result_i.primary[PRIM_W-1:0] >= split_i;
    assign result = {result_i.valid && second, result_i.valid && !second};
  end else begin : g_result
    assign result[0] = result_i.valid;
  end
  logic [HITS_W-1:0] new_hits[GROUPS];
  logic [1:0] uncertain[GROUPS];
  card_pkg::lane_results_t leaf_results[GROUPS];
  assign leaf_o = leaf_results[0];  // a shared lane is alone
  assign uncertain_o = uncertain[0];  // narrow lanes are one group
  logic [GROUPS-1:0] result_f;
  logic [31:0] result_index[GROUPS];
  logic [CW-1:0] result_t[GROUPS];
  logic [POINTS-1:0][CW-1:0] result_point[GROUPS];
  for (genvar g = 0; g < GROUPS; g++) begin : group
    logic selected;
    logic [N_PAIRS-1:0][15:0] latency_pipes;
    logic [N_PAIRS-1:0] ordered_ready, ordered_valid;
    logic unused_ordered;
    assign unused_ordered = &{1'b0, ordered_ready, ordered_valid};
    assign selected = 32'(lane) / 32'(GROUP) == 32'(g);
`ifndef SYNTHESIS
    always_ff @(posedge clk_i)
      assert (latency_pipes == group[0].latency_pipes) else $error("collision_engine: groups of different latency");
`endif
    lane_group #(.CONFIG(CONFIG), .LANES(GROUP), .ROWS(ROWS)) lanes (
        .clk_i, .clk_prim_i(clk_prim), .prim_write_i(prim_commit && 32'(prim_lane) / 32'(GROUP) == 32'(g)),
        .prim_row_i(prim_row), .prim_lane_i(GLANE_W'(prim_lane)), .prim_slot_i(prim_slot), .clear_i, .clear_row_i,
        .clear_mask_i(clear_mask_i[g*GROUP+:GROUP]), .clear_bad_i(prim_bad_o[32'(clear_row_i)*LANES+g*GROUP+:GROUP]),
        .pair_i(pair_i[PORTS-1:0]), .solid_i(solid_o[PORTS-1:0]), .swap_i(swap_i[PORTS-1:0]), .clk_pipe_i(clk_pipe),
        .row_i(row_in), .secondary_i(secondary), .turn_i, .leaf_i, .leaf_o(leaf_results[g]),
        .rst_i(ANY_ORDERED && rst_i),
        .iterations_i(ANY_ORDERED ? iterations_i : '0),
        .issue_i(ISSUE ? issue_i.valid[PORTS-1:0] : '0), .ordered_row_i(ANY_ORDERED ? row[PORTS-1:0] : '0),
        .ordered_secondary_i(ANY_ORDERED ? secondary_i : '0), .ordered_bad_i(ANY_ORDERED && secondary_bad_i),
        .ordered_ready_o(ordered_ready), .ordered_valid_o(ordered_valid), .uncertain_o(uncertain[g]),
        .latency_o(latency_pipes), .valid_i(valid_o[PORTS-1:0]), .row_out_i(row_out), .parity_i(parity),
        .index_i(index), .secondary_bad_i(secondary_bad), .mode_i, .streaming_i, .new_hits_o(new_hits[g]),
        .f_o(f_o[g*GROUP+:GROUP]), .bad_o(bad_o[g*GROUP+:GROUP]), .unmasked_o(unmasked_o[g*GROUP+:GROUP]),
        .push_i, .write_i, .read_i(streaming_i && streamed_i.valid && selected), .head_i,
        .result_i(result & {PORTS{selected}}),
        .result_row_i(result_row), .result_parity_i(result_i.parity), .lane_i(GLANE_W'(lane)),
        .result_f_o(result_f[g]), .result_index_o(result_index[g]),
        .result_t_o(result_t[g]), .result_point_o(result_point[g]));
  end
  for (genvar k = 0; k < PORTS; k++) begin : latency_of
    assign pipe_latency[k] = (k > 0 &&
        pair_i[k] == pairs_pkg::NO_PAIR) ? 16'(UNUSED) : group[0].latency_pipes[MANY ? int'(pair_i[k]) : $clog2(PAIRS)];
  end
  always_comb begin
    new_hits_o = '0;
    result_f_o = |result_f;
    result_index_o = '0;
    result_t_o = '0;
    result_point_o = '0;
    for (int g = 0; g < GROUPS; g++) new_hits_o = new_hits_o + (PRIM_W + 1)'(new_hits[g]);
    // Zeros while nothing is read; the condition saves simulation time.
    if (result_i.valid || (streaming_i && streamed_i.valid)) for (int g = 0; g < GROUPS; g++) begin
      result_index_o = result_index_o | result_index[g];
      result_t_o = result_t_o | result_t[g];
      result_point_o = result_point_o | result_point[g];
    end
  end
endmodule
