// SPDX-License-Identifier: Apache-2.0
// LANES lanes of the collision detection engine, with their own part of the primary register file, the pipe, the update
// engine and the output FIFO. Only control bits and single records leave a group. It is not inlined, so that all groups
// run one function over objects that fit the first-level cache.
// Latency: same as the pipe.
// Throughput: same as the pipe, at most one row per cycle.
// Stall: none.
module lane_group #(
    parameter config_pkg::config_t CONFIG,
    parameter int LANES = 8,
    parameter int ROWS = 32,
    localparam int EXP = CONFIG.exp,
    localparam int MAN = CONFIG.man,
    localparam int PAIRS = CONFIG.pairs,
    localparam int ALGORITHM = CONFIG.algorithm,
    localparam int BOX = CONFIG.box,
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
    localparam int N_PAIRS = pairs_pkg::PAIRS,
    localparam int PORTS = 1 + PARALLEL,  // pairs in a pass
    localparam int POINTS = (NORMALS != 0) ? 6 : 3,
    localparam int ROW_W = (ROWS > 1) ? $clog2(ROWS) : 1,
    localparam int LANE_W = (LANES > 1) ? $clog2(LANES) : 1,
    localparam int FIFO_W = $clog2(FIFO_DEPTH),
    localparam int HITS_W = $clog2(LANES + 1),
    localparam int SUM_W = HITS_W + PARALLEL
) (
    input logic clk_i,
    input logic clk_prim_i,  // runs while a primary is written

    input logic prim_write_i /*verilator public_flat_rd*/,
    input logic [ROW_W-1:0] prim_row_i,
    input logic [LANE_W-1:0] prim_lane_i,
    input logic [PRIM_WORDS-1:0][CW-1:0] prim_slot_i,

    input logic clear_i,
    input logic [ROW_W-1:0] clear_row_i,
    input logic [LANES-1:0] clear_mask_i /*verilator public_flat_rd*/,
    input logic [LANES-1:0] clear_bad_i /*verilator public_flat_rd*/,  // primaries out of contract

    input pairs_pkg::pair_t [PORTS-1:0] pair_i,  // pairs of the pass
    input logic [PORTS-1:0] solid_i,      // a pair of solids: T is the size of a signed distance
    input logic [PORTS-1:0] swap_i,
    input logic [N_PAIRS-1:0] clk_pipe_i,  // each runs while its pipe is used
    input logic [PORTS-1:0][ROW_W-1:0] row_i,  // row and secondary that enter the datapath
    input logic [PORTS-1:0][SEC_WORDS-1:0][CW-1:0] secondary_i,
    input logic [2:0] turn_i,
    input card_pkg::lane_operands_t leaf_i,  // leaves of a BVH, with SHARED_LANE
    output card_pkg::lane_results_t leaf_o,
    output logic [N_PAIRS-1:0][15:0] latency_o,
    input logic [PORTS-1:0] issue_i,  // a row is issued: only for ordered pipes, and for gates with SAT_II = 3
    input logic rst_i,  // reset of pipes that keep only the order (config_pkg::ordered_pairs); they take a row at issue
    input logic [23:0] iterations_i,
    input logic [PORTS-1:0][ROW_W-1:0] ordered_row_i,
    input logic [SEC_WORDS-1:0][CW-1:0] ordered_secondary_i,
    input logic ordered_bad_i,  // the secondary is bad
    output logic [N_PAIRS-1:0] ordered_ready_o,
    output logic [N_PAIRS-1:0] ordered_valid_o,
    output logic [1:0] uncertain_o,  // pairs with certified filters that are uncertain and go through the wide pipe

    input logic [PORTS-1:0] valid_i,  // the row whose results leave the pipe
    input logic [PORTS-1:0][ROW_W-1:0] row_out_i,
    input logic [PORTS-1:0] parity_i,
    input logic [PORTS-1:0][31:0] index_i,
    input logic [PORTS-1:0] secondary_bad_i,
    input logic [2:0] mode_i,
    input logic streaming_i,
    output logic [SUM_W-1:0] new_hits_o,
    output logic [LANES-1:0] f_o,  // in the streaming modes
    output logic [LANES-1:0] bad_o,
    output logic [LANES-1:0] unmasked_o,

    input logic push_i,
    input logic [FIFO_W-1:0] write_i,
    // lane lane_i of FIFO row head_i, else of row result_row_i of the update buffers
    input logic read_i /*verilator public_flat_rd*/,
    input logic [FIFO_W-1:0] head_i,
    input logic [PORTS-1:0] result_i /*verilator public_flat_rd*/,
    input logic [ROW_W-1:0] result_row_i,
    input logic result_parity_i,
    input logic [LANE_W-1:0] lane_i,
    output logic result_f_o,  // the group's part of an OR: zeros unless it is read
    output logic [31:0] result_index_o,
    output logic [CW-1:0] result_t_o,
    output logic [POINTS-1:0][CW-1:0] result_point_o  // CP and, with normals, n
);
  /*verilator no_inline_module*/
  // ---- Primaries: one block RAM per lane and word, read by every pipe ----
  for (genvar k = 0; k < PRIM_WORDS; k++) begin : word
    (* ram_style = "distributed", no_rw_check *) logic [LANES-1:0][CW-1:0] mem[ROWS];
    always_ff @(posedge clk_prim_i) if (prim_write_i) mem[prim_row_i][prim_lane_i] <= prim_slot_i[k];
  end

  // ---- Pipes. Only the pass's pipe is read. With several pipes, each has operand registers, so an idle one does
  // nothing ----
  localparam int ORDERED = config_pkg::ordered_pairs(CONFIG);
  localparam int FILTERED = config_pkg::filter_pairs(CONFIG);
  logic unused_ordered;
  assign unused_ordered = &{1'b0, rst_i, iterations_i, ordered_row_i, ordered_secondary_i, ordered_bad_i};
  logic [N_PAIRS-1:0] uncertain;
  if (FILTERED != 0) begin : g_filters
    logic [LANES-1:0] requested_mem[ROWS];  // lanes with primaries in use
    always_ff @(posedge clk_i) if (clear_i) requested_mem[clear_row_i] <= ~(clear_mask_i | clear_bad_i);
    logic prove;  // only hits are reported, so the filter may prove misses
    assign prove = mode_i == registers_pkg::MODE_ANY || mode_i == registers_pkg::MODE_HITS;
    always_comb begin
      uncertain_o = '0;
      for (int p = 0; p < N_PAIRS; p++) uncertain_o = uncertain_o + 2'(uncertain[p]);
    end
  end else begin : g_no_filters
    logic unused_uncertain;
    assign unused_uncertain = &{1'b0, uncertain};
    assign uncertain_o = '0;
  end
  localparam bit MANY = (PAIRS & (PAIRS - 1)) != 0;
  localparam bit SHARED = config_pkg::shares_lane(CONFIG);
  for (genvar p = 0; p < N_PAIRS; p++) begin : pair
    if (((PAIRS >> p) & 1) != 0) begin : g_present
      logic [LANES-1:0][CW-1:0] f, t;
      logic [2:0][LANES-1:0][CW-1:0] cp, n;
      localparam int A_WORDS = pairs_pkg::shape_words(pairs_pkg::primary_shape(p));
      localparam int B_WORDS = pairs_pkg::shape_words(pairs_pkg::secondary_shape(p));
      localparam int B_LANES = (SWAP != 0) ? LANES : 1;
      localparam int S_WORDS = (SWAP != 0 && A_WORDS > B_WORDS) ? A_WORDS : B_WORDS;  // words of the secondary
      logic [ROW_W-1:0] row;
      logic swap;
      logic [S_WORDS-1:0][CW-1:0] secondary;
      logic [A_WORDS-1:0][LANES-1:0][CW-1:0] a;
      logic [B_WORDS-1:0][B_LANES-1:0][CW-1:0] b;
      localparam bit ITERATIVE = pairs_pkg::has(pairs_pkg::ITERATIVE_PAIRS, p);
      localparam bit FILTER = pairs_pkg::has(FILTERED, p);
      localparam bit LATE = !pairs_pkg::has(ORDERED, p);  // host arithmetic takes the row when it is due
      localparam int INTERVAL = pairs_pkg::has(pairs_pkg::SAT_PAIRS, p) ? SAT_II : 1;
      logic of;  // which of the pass's pairs it computes
      assign of = PARALLEL != 0 && pair_i[PORTS-1] == pairs_pkg::PAIR_BITS'(p);
      logic issue, enter;  // for this pipe: issue, and entry of its operands
      assign issue = issue_i[of] && (!MANY || pair_i[of] == pairs_pkg::PAIR_BITS'(p));
      if (MANY) begin : g_register
        always_ff @(posedge clk_pipe_i[p]) enter <= issue && !rst_i;
        always_ff @(posedge clk_pipe_i[p]) begin
          row <= LATE ? row_i[of] : ordered_row_i[of];
          swap <= swap_i[of];
          secondary <= LATE ? secondary_i[of][S_WORDS-1:0] : ordered_secondary_i[S_WORDS-1:0];
        end
      end else begin : g_direct
        assign enter = issue;
        assign row = LATE ? row_i[0] : ordered_row_i[0];
        assign swap = swap_i[0];
        assign secondary = LATE ? secondary_i[0][S_WORDS-1:0] : ordered_secondary_i[S_WORDS-1:0];
        logic unused_of;
        assign unused_of = of;
      end
      if (SWAP == 0) begin : g_fixed
        logic unused_swap;
        assign unused_swap = &{1'b0, swap, swap_i};
      end
      for (genvar k = 0; k < A_WORDS; k++) begin : word_a
        if (SHARED) begin : g_shared
          assign a[k][0] = leaf_i.valid ? leaf_i.ray[k] : word[k].mem[row][0];
        end else if (SWAP != 0) begin : g_either
          assign a[k] = swap ? {LANES{secondary[k]}} : word[k].mem[row];
        end else begin : g_primary
          assign a[k] = word[k].mem[row];
        end
      end
      for (genvar k = 0; k < B_WORDS; k++) begin : word_b
        if (SHARED) begin : g_shared
          assign b[k][0] = leaf_i.valid ? leaf_i.triangle[k] : secondary[k];
        end else if (SWAP != 0) begin : g_either
          assign b[k] = swap ? word[k].mem[row] : {LANES{secondary[k]}};
        end else begin : g_secondary
          assign b[k] = secondary[k];
        end
      end
      if (!FILTER) begin : g_all_wide
        assign uncertain[p] = 1'b0;
      end
      if (FILTER) begin : g_filter
        logic bad;
        if (MANY) begin : g_bad_register
          always_ff @(posedge clk_pipe_i[p]) bad <= ordered_bad_i;
        end else begin : g_bad_direct
          assign bad = ordered_bad_i;
        end
        filter_pair #(
            .PAIR(p), .NARROW_EXP(CONFIG.filter_exp), .NARROW_MAN(CONFIG.filter_man), .B_LANES(B_LANES),
            .DEPTH(config_pkg::pipe_depth(CONFIG)), .EXP(EXP), .MAN(MAN), .LANES(LANES), .LAT(LAT), .ARITH(ARITH)
        ) pipe (
            .clk_i(MANY ? clk_pipe_i[p] : clk_i), .rst_i, .prove_i(g_filters.prove), .valid_i(enter),
            .ready_o(ordered_ready_o[p]), .requested_i(g_filters.requested_mem[row] & {LANES{!bad}}), .a_i(a),
            .b_i(b), .valid_o(ordered_valid_o[p]), .f_o(f), .t_o(t), .cp_o(cp), .n_o(n), .uncertain_o(uncertain[p]),
            .latency_o(latency_o[p]));
      end else if (ITERATIVE) begin : g_iterative
        logic [31:0] latency, unused_tag;
        logic [LANES-1:0][CW-1:0] unused_bad;
        logic [7:0][LANES-1:0][CW-1:0] b_lanes;
        for (genvar k = 0; k < 8; k++) begin : word_lanes
          if (B_LANES == LANES) begin : g_own
            assign b_lanes[k] = b[k];
          end else begin : g_broadcast
            assign b_lanes[k] = {LANES{b[k][0]}};
          end
        end
        cylinder_pair #(
            .BODY(pairs_pkg::cylinder_body(p)), .AHEAD(MANY ? 1 : 0),
            .ENTRY(pairs_pkg::iterative_entry(LAT.add, LAT.mul, LAT.cmp)), .EXP(EXP), .MAN(MAN), .LANES(LANES),
            .LAT(LAT), .ARITH(ARITH)
        ) pipe (
            .clk_i(MANY ? clk_pipe_i[p] : clk_i), .rst_i, .iterations_i, .valid_i(issue),
            .ready_o(ordered_ready_o[p]), .tag_i('0), .a_i(a), .b_i(b_lanes), .bad_i('0), .valid_o(ordered_valid_o[p]),
            .tag_o(unused_tag), .bad_o(unused_bad), .f_o(f), .t_o(t), .cp_o(cp), .n_o(n), .latency_o(latency));
        assign latency_o[p] = (latency > 32'hffff) ? 16'hffff : 16'(latency);
        logic unused;
        assign unused = &{1'b0, unused_tag, unused_bad, enter};
      end else if (CONFIG.shared_lane != 0) begin : g_shared_lane
        logic unused_enter;
        assign unused_enter = enter;
        assign ordered_ready_o[p] = 1'b1;
        assign ordered_valid_o[p] = 1'b0;
        ray_triangle_shared #(.TURNS(CONFIG.shared_lane), .LAT(LAT), .ARITH(ARITH)) pipe (
            .clk_i, .turn_i, .a_i(a), .b_i(b), .f_o(f), .t_o(t), .cp_o(cp), .latency_o(latency_o[p]));
        assign n = '0;
      end else begin : g_free
        assign ordered_ready_o[p] = 1'b1;
        assign ordered_valid_o[p] = 1'b0;
        bounded_pipe #(
            .PAIR(p), .ALGORITHM(ALGORITHM), .BOX(pairs_pkg::has(pairs_pkg::BOX_PAIRS, p) ? BOX : 0),
            .BOUND(32'(pairs_pkg::has(config_pkg::bound_pairs(CONFIG), p))), .SAT_II(INTERVAL), .EXP(EXP),
            .MAN(MAN), .LANES(LANES), .B_LANES(B_LANES), .LAT(LAT), .ARITH(ARITH)
        ) pipe (
            .clk_i(MANY ? clk_pipe_i[p] : clk_i), .enter_i(enter), .a_i(a), .b_i(b), .f_o(f), .t_o(t), .cp_o(cp),
            .n_o(n), .latency_o(latency_o[p]));
      end
    end else begin : g_absent
      assign ordered_ready_o[p] = 1'b1;
      assign ordered_valid_o[p] = 1'b0;
      assign uncertain[p] = 1'b0;
      assign latency_o[p] = '0;
      logic unused_clk;
      assign unused_clk = clk_pipe_i[p];
    end
  end

  if (SHARED) begin : g_shared
    localparam int RAY = int'(pairs_pkg::PAIR_RAY_TRIANGLE);
    assign leaf_o = {pair[RAY].g_present.f, pair[RAY].g_present.t, pair[RAY].g_present.cp, latency_o[RAY]};
  end else begin : g_not_shared
    assign leaf_o = '0;
    logic unused_lane;
    assign unused_lane = &{1'b0, leaf_i, turn_i};
  end

  // ---- Results of each of the pass's pairs ----
  logic [LANES-1:0] f_stream[PORTS], bad_stream[PORTS], unmasked_stream[PORTS];
  logic [LANES-1:0][CW-1:0] t_port[PORTS];
  logic [POINTS-1:0][LANES-1:0][CW-1:0] point[PORTS];  // CP and, with normals, n
  logic [PORTS-1:0] kept_f;
  logic [PORTS-1:0][31:0] kept_index;
  logic [PORTS-1:0][CW-1:0] kept_t;
  logic [PORTS-1:0][POINTS-1:0][CW-1:0] kept_point;
  logic [PORTS-1:0][HITS_W-1:0] new_hits;
  for (genvar k = 0; k < PORTS; k++) begin : port
    logic [LANES-1:0][CW-1:0] f_pipe, t_pipe;
    logic [2:0][LANES-1:0][CW-1:0] cp_pipe, n_pipe;
    if (MANY) begin : g_choose
      logic [LANES-1:0][CW-1:0] f_all[N_PAIRS], t_all[N_PAIRS];
      logic [2:0][LANES-1:0][CW-1:0] cp_all[N_PAIRS], n_all[N_PAIRS];
      for (genvar p = 0; p < N_PAIRS; p++) begin : from
        if (((PAIRS >> p) & 1) != 0) begin : g_present
          assign f_all[p] = pair[p].g_present.f;
          assign t_all[p] = pair[p].g_present.t;
          assign cp_all[p] = pair[p].g_present.cp;
          assign n_all[p] = pair[p].g_present.n;
        end else begin : g_absent
          assign f_all[p] = '0;
          assign t_all[p] = '0;
          assign cp_all[p] = '0;
          assign n_all[p] = '0;
        end
      end
      logic [pairs_pkg::PAIR_INDEX-1:0] index;
      assign index = pair_i[k][pairs_pkg::PAIR_INDEX-1:0];
      assign f_pipe = f_all[index];
      assign t_pipe = t_all[index];
      assign cp_pipe = cp_all[index];
      assign n_pipe = n_all[index];
    end else begin : g_only
      localparam int ONLY = $clog2(PAIRS);
      logic unused_pair;
      assign unused_pair = &{1'b0, pair_i, clk_pipe_i[ONLY]};
      assign f_pipe = pair[ONLY].g_present.f;
      assign t_pipe = pair[ONLY].g_present.t;
      assign cp_pipe = pair[ONLY].g_present.cp;
      assign n_pipe = pair[ONLY].g_present.n;
    end
    lane_results #(.EXP(EXP), .MAN(MAN), .LANES(LANES), .ROWS(ROWS), .NORMALS(NORMALS),
        .SPACING(config_pkg::early_rows(CONFIG) ? CONFIG.shared_lane : 1)) results (
        .clk_i, .clear_i, .clear_row_i, .clear_mask_i, .clear_bad_i, .solid_i(solid_i[k]), .mode_i, .streaming_i,
        .valid_i(valid_i[k]), .row_i(row_out_i[k]), .parity_i(parity_i[k]), .index_i(index_i[k]),
        .secondary_bad_i(secondary_bad_i[k]), .f_i(f_pipe), .t_i(t_pipe), .cp_i(cp_pipe), .n_i(n_pipe),
        .new_hits_o(new_hits[k]), .f_o(f_stream[k]), .bad_o(bad_stream[k]), .unmasked_o(unmasked_stream[k]),
        .t_o(t_port[k]), .point_o(point[k]), .result_i(result_i[k]), .result_row_i, .result_lane_i(lane_i),
        .result_parity_i, .result_f_o(kept_f[k]), .result_index_o(kept_index[k]), .result_t_o(kept_t[k]),
        .result_point_o(kept_point[k]));
  end

  // ---- Records of the streaming modes, of the first pair ----
  logic [CW-1:0] fifo_t;
  logic [POINTS-1:0][CW-1:0] fifo_point;
  record_lanes #(.CW(CW), .LANES(LANES), .DEPTH(FIFO_DEPTH), .POINTS(POINTS)) records (
      .clk_i, .push_i, .write_i, .t_i(t_port[0]), .point_i(point[0]), .read_i, .head_i, .lane_i, .t_o(fifo_t),
      .point_o(fifo_point));
  assign result_f_o = |kept_f;
  assign f_o = f_stream[0];
  assign bad_o = bad_stream[0];
  assign unmasked_o = unmasked_stream[0];
  if (PARALLEL != 0) begin : g_two
    logic unused_stream;
    assign unused_stream = &{1'b0, f_stream[1], bad_stream[1], unmasked_stream[1], t_port[1], point[1]};
    assign new_hits_o = SUM_W'(new_hits[0]) + SUM_W'(new_hits[1]);
    assign result_index_o = kept_index[0] | kept_index[1];
    assign result_t_o = kept_t[0] | kept_t[1] | fifo_t;
    assign result_point_o = kept_point[0] | kept_point[1] | fifo_point;
  end else begin : g_one
    assign new_hits_o = SUM_W'(new_hits[0]);
    assign result_index_o = kept_index[0];
    assign result_t_o = kept_t[0] | fifo_t;
    assign result_point_o = kept_point[0] | fifo_point;
  end
endmodule
