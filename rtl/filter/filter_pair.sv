// SPDX-License-Identifier: Apache-2.0
// The pipe of a pair of solids with a certified filter: LANES narrow lanes and one wide lane.
// Each lane's pipe in a narrow format proposes a normal (filter_proposal.sv). A short sum in the wide format proves a
// miss for most pairs (filter_proof.sv). The wide pipe computes the uncertain pairs (scaled_pipe.sv),
// lane by lane, lowest first. So a pair with F = 1 has the F, T, CP and n of a wide lane. For a proved miss, F = 0 and
// the other results are undefined. Rows wait for the filter and then for the wide pipe, in memories with one slot per
// row, and leave in order.
// Latency: at least latency_o.
// Throughput: one row per cycle while each row has at most one uncertain pair, else one uncertain pair per cycle on
// average.
// Stall: ready_o is low while the slots are almost full; results leave in the order of entry. With ARITH = "host",
// narrow pipe, proof and wide pipe compute in the cycle in which gates would answer.
`include "filter.svh"
module filter_pair #(
    `DF_PARAMETERS,
    parameter int PAIR = int'(pairs_pkg::PAIR_SPHERE_SPHERE),
    parameter int NARROW_EXP = 5,
    parameter int NARROW_MAN = 10,
    parameter int B_LANES = LANES,  // secondaries per row: 1 or LANES
    parameter int DEPTH = 256,  // slots for rows, a power of two; more than the latency of each pipe
    localparam int SHAPE_A = pairs_pkg::primary_shape(PAIR),
    localparam int SHAPE_B = pairs_pkg::secondary_shape(PAIR),
    localparam int A_WORDS = pairs_pkg::shape_words(SHAPE_A),
    localparam int B_WORDS = pairs_pkg::shape_words(SHAPE_B)
) (
    input logic clk_i,
    input logic rst_i,
    input logic prove_i,  // only hits are reported, so the filter may prove misses; constant while a row is in flight
    input logic valid_i,  // at most one cycle after a cycle with ready_o
    output logic ready_o,
    input logic [LANES-1:0] requested_i,  // lanes of the row whose results are used
    input logic [A_WORDS-1:0][LANES-1:0][CW-1:0] a_i,
    input logic [B_WORDS-1:0][B_LANES-1:0][CW-1:0] b_i,
    output logic valid_o,
    output logic [LANES-1:0][CW-1:0] f_o,  // lane mask
    output logic [LANES-1:0][CW-1:0] t_o,
    output logic [2:0][LANES-1:0][CW-1:0] cp_o,
    output logic [2:0][LANES-1:0][CW-1:0] n_o,
    output logic uncertain_o,  // the wide pipe takes a pair
    output logic [15:0] latency_o
);
  /*verilator inline_module*/
  if (!pairs_pkg::has(config_pkg::FILTER_PAIRS, PAIR)) $error("filter_pair: PAIR must be one of FILTER_PAIRS");
  if (NARROW_EXP > EXP || NARROW_MAN >= MAN) $error("filter_pair: narrow format must be narrower than wide one");
  localparam bit GATES = ARITH == "rtl";
  localparam int AW = $clog2(DEPTH);
  localparam int LANE_W = config_pkg::index_bits(LANES);

  // ---- Slots ----
  logic [A_WORDS-1:0][LANES-1:0][CW-1:0] a_mem[DEPTH], a_proof;
  logic [B_WORDS-1:0][B_LANES-1:0][CW-1:0] b_mem[DEPTH], b_proof;
  logic [LANES-1:0] requested_mem[DEPTH], uncertain_mem[DEPTH];
  logic [AW-1:0] write_q, proof_q, checked_q, serial_q;
  logic [AW-1:0] used;
  assign used = write_q - serial_q;
  assign ready_o = used < AW'(DEPTH - 2);
  always_ff @(posedge clk_i)
    if (valid_i) begin
      a_mem[write_q] <= a_i;
      b_mem[write_q] <= b_i;
      requested_mem[write_q] <= requested_i;
    end

  // ---- Filter: gates propose when the row enters, the host back end when the result is due ----
  logic [A_WORDS-1:0][LANES-1:0][CW-1:0] a_enters;
  logic [B_WORDS-1:0][B_LANES-1:0][CW-1:0] b_enters;
  logic [B_WORDS-1:0][LANES-1:0][CW-1:0] b_lanes, b_proof_lanes;
  logic [2:0][LANES-1:0][CW-1:0] n;
  logic [15:0] proposed, proved;
  logic [LANES-1:0] miss;
  assign a_proof = a_mem[proof_q];
  assign b_proof = b_mem[proof_q];
  assign a_enters = GATES ? a_i : a_proof;
  assign b_enters = GATES ? b_i : b_proof;
  for (genvar k = 0; k < B_WORDS; k++) begin : word
    if (B_LANES == LANES) begin : g_own
      assign b_lanes[k] = b_enters[k];
      assign b_proof_lanes[k] = b_proof[k];
    end else begin : g_broadcast
      assign b_lanes[k] = {LANES{b_enters[k][0]}};
      assign b_proof_lanes[k] = {LANES{b_proof[k][0]}};
    end
  end
  filter_proposal #(`DF_SAME, .PAIR(PAIR), .NARROW_EXP(NARROW_EXP), .NARROW_MAN(NARROW_MAN)) proposal (
      .clk_i, .a_i(a_enters), .b_i(b_lanes), .n_o(n), .latency_o(proposed));
  filter_proof #(`DF_SAME, .SHAPE_A(SHAPE_A), .SHAPE_B(SHAPE_B)) proof (
      .clk_i, .a_i(a_proof), .b_i(b_proof_lanes), .n_i(n), .miss_o(miss), .latency_o(proved));
  logic due, checked, unused_due;
  issue_history #(.W(1), .DEPTH(DEPTH)) history_due (
      .clk_i, .rst_i, .latency_i(GATES ? proposed : proposed + proved), .valid_i, .d_i(1'b1), .valid_o(due),
      .q_o(unused_due));
  if (GATES) begin : g_proving
    logic unused_checked;
    issue_history #(.W(1), .DEPTH(DEPTH)) history_checked (
        .clk_i, .rst_i, .latency_i(proved), .valid_i(due), .d_i(1'b1), .valid_o(checked), .q_o(unused_checked));
  end else begin : g_proved
    assign checked = due;
  end
  always_ff @(posedge clk_i)
    if (checked) uncertain_mem[checked_q] <= requested_mem[checked_q] & ~(miss & {LANES{prove_i}});

  // ---- Uncertain pairs, lane by lane ----
  logic [LANES-1:0] uncertain_q, uncertain, lowest, rest;
  logic begun_q, row_valid, some, last;
  logic [LANE_W-1:0] lane;
  assign row_valid = serial_q != checked_q;
  assign uncertain = begun_q ? uncertain_q : uncertain_mem[serial_q];
  priority_encoder #(.N(LANES)) next_lane (.set_i(uncertain), .first_o(lowest), .index_o(lane));
  assign rest = uncertain & ~lowest;
  assign some = row_valid && |uncertain;
  assign last = rest == 0;
  assign uncertain_o = some;
  logic [A_WORDS-1:0][CW-1:0] a_one;
  logic [B_WORDS-1:0][CW-1:0] b_one;
  always_comb for (int k = 0; k < A_WORDS; k++) a_one[k] = a_mem[serial_q][k][lane];
  if (B_LANES == LANES) begin : g_own_b
    always_comb for (int k = 0; k < B_WORDS; k++) b_one[k] = b_mem[serial_q][k][lane];
  end else begin : g_one_b
    always_comb for (int k = 0; k < B_WORDS; k++) b_one[k] = b_mem[serial_q][k][0];
  end
  always_ff @(posedge clk_i) begin
    if (valid_i) write_q <= write_q + 1;
    if (due) proof_q <= proof_q + 1;
    if (checked) checked_q <= checked_q + 1;
    if (row_valid) begin
      uncertain_q <= rest;
      begun_q <= !last;
      if (last) serial_q <= serial_q + 1;
    end
    if (rst_i) begin
      {write_q, proof_q, checked_q, serial_q} <= '0;
      begun_q <= 0;
    end
  end

  // ---- The wide pipe ----
  localparam int TAG = LANE_W + 3, ANSWER = 8 * CW;
  logic [CW-1:0] f, t, f_pipe, t_pipe;
  logic [2:0][CW-1:0] cp, n_wide, cp_pipe, n_pipe;
  logic [15:0] wide;
  logic answered, of_some, of_first, of_last;
  logic [LANE_W-1:0] of_lane;
  scaled_pipe #(
      .EXP(EXP), .MAN(MAN), .LANES(1), .LAT(LAT), .ARITH(ARITH), .PAIR(PAIR)
  ) pipe (
      .clk_i, .enter_i(some), .a_i(a_one), .b_i(b_one), .f_o(f_pipe), .t_o(t_pipe), .cp_o(cp_pipe), .n_o(n_pipe),
      .latency_o(wide));
  if (GATES) begin : g_early
    assign {n_wide, cp, t, f} = {n_pipe, cp_pipe, t_pipe, f_pipe};
  end else begin : g_late  // it answers at once; results wait
    logic unused_valid;
    issue_history #(.W(ANSWER), .DEPTH(DEPTH)) history_answer (
        .clk_i, .rst_i, .latency_i(wide), .valid_i(some), .d_i({n_pipe, cp_pipe, t_pipe, f_pipe}),
        .valid_o(unused_valid), .q_o({n_wide, cp, t, f}));
  end
  issue_history #(.W(TAG), .DEPTH(DEPTH)) history_tag (
      .clk_i, .rst_i, .latency_i(wide), .valid_i(row_valid), .d_i({lane, some, !begun_q, last}), .valid_o(answered),
      .q_o({of_lane, of_some, of_first, of_last}));

  // ---- Reassembled rows ----
  always_ff @(posedge clk_i) begin
    valid_o <= answered && of_last && !rst_i;
    if (answered && of_first) f_o <= '0;
    if (answered && of_some) begin
      f_o[of_lane] <= f;
      t_o[of_lane] <= t;
      for (int k = 0; k < 3; k++) begin
        cp_o[k][of_lane] <= cp[k];
        n_o[k][of_lane] <= n_wide[k];
      end
    end
  end
  assign latency_o = proposed + proved + wide + 16'd2;

`ifndef SYNTHESIS
  always_ff @(posedge clk_i)
    if (!rst_i) begin
      assert (32'(proposed) + 32'(proved) < DEPTH && 32'(wide) < DEPTH) else $error("filter_pair: DEPTH is too small");
      assert (!valid_i || used < AW'(DEPTH - 1)) else $error("filter_pair: a row without a slot");
    end
`endif
endmodule
