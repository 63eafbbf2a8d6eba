// SPDX-License-Identifier: Apache-2.0
// One pipe as a top module: LANES pairs per cycle, each lane with its own primary and secondary.
// It checks the input contract and handles bad input. `cde query`, the regressions and the benchmarks of pairs use it.
// Latency: latency_o cycles.
// Throughput: LANES pairs per SAT_II cycles.
// Cylinder pairs: LANES pairs per as many cycles as their iterations take passes.
// Stall: ready_o of cylinder pairs (cylinder_pair.sv), and with SAT_II = 3 (issue_throttle.sv).
// Other pipes run free, ready_o = 1.
module pair_unit #(
    parameter int PAIR = 0,       // pairs_pkg::PAIR_*
    parameter int ALGORITHM = 0,  // ray-triangle: pairs_pkg::ALGORITHM_*
    parameter int BOX = 0,  // as in config.svh
    parameter int HALF_SPACE = 0,  // pairs with a plane, 1: the plane is the solid n.x <= d
    parameter int SAT_II = 1,  // pairs with candidate axes: cycles from one row to the next, 1 or 3
    parameter int EXP = 8,
    parameter int MAN = 23,
    parameter int LANES = 8,
    parameter int LAT_ADD = 1,
    parameter int LAT_MUL = 1,
    parameter int LAT_DIV = 1,
    parameter int LAT_SQRT = 1,
    parameter int LAT_CMP = 1,
    parameter ARITH = "rtl",
    parameter logic [63:0] CONFIG_HASH = 0,
    localparam int CW = (1 + EXP + MAN <= 32) ? 32 : 64,
    localparam int A_WORDS = pairs_pkg::shape_words(pairs_pkg::primary_shape(PAIR)),
    localparam int B_WORDS = pairs_pkg::shape_words(pairs_pkg::secondary_shape(PAIR))
) (
    input logic clk_i,
    input logic rst_i,
    // cylinder pairs: iterations (cylinder_pair.sv), constant from the cycle before a row enters until it leaves
    input logic [23:0] iterations_i,
    input logic valid_i,
    output logic ready_o,
    input logic [31:0] tag_i,
    input logic [A_WORDS-1:0][LANES-1:0][CW-1:0] a_i,
    input logic [B_WORDS-1:0][LANES-1:0][CW-1:0] b_i,
    output logic valid_o,
    output logic [31:0] tag_o,
    output logic [LANES-1:0][CW-1:0] f_o,    // lane masks
    output logic [LANES-1:0][CW-1:0] bad_o,
    output logic [LANES-1:0][CW-1:0] t_o,
    output logic [2:0][LANES-1:0][CW-1:0] cp_o,
    output logic [2:0][LANES-1:0][CW-1:0] n_o,
    output logic [31:0] latency_o,
    output logic [63:0] config_hash_o
);
  localparam logic [CW-1:0] QNAN = (((CW'(1) << EXP) - 1) << MAN) | (CW'(1) << (MAN - 1));
  localparam latency_pkg::latency_t LAT = latency_pkg::latencies(LAT_ADD, LAT_MUL, LAT_DIV, LAT_SQRT, LAT_CMP);
  localparam int T_CHECK = config_pkg::check_latency(LAT);
  localparam int SLOWEST = latency_pkg::mean(LAT);
  localparam int HISTORY = 128 << $clog2(SLOWEST);
  localparam int LW = LANES * CW;
  assign config_hash_o = CONFIG_HASH;

  logic [LANES-1:0][CW-1:0] bad_a, bad_b, bad_check, bad, f, t;
  logic [2:0][LANES-1:0][CW-1:0] cp, n;
  // Host arithmetic takes operands from registers: otherwise,
  // the simulator would evaluate logic on inputs at both edges of the clock.
  localparam bit HELD = ARITH != "rtl";
  logic [31:0] tag;
  logic [A_WORDS-1:0][LANES-1:0][CW-1:0] a;
  logic [B_WORDS-1:0][LANES-1:0][CW-1:0] b;
  logic taken;  // a and b are operands of this cycle
  if (HELD) begin : g_held
    always_ff @(posedge clk_i) taken <= valid_i && ready_o;
    always_ff @(posedge clk_i) if (valid_i && ready_o) {tag, a, b} <= {tag_i, a_i, b_i};
  end else begin : g_direct
    assign taken = valid_i && ready_o;
    assign {tag, a, b} = {tag_i, a_i, b_i};
  end
  shape_check #(
      .SHAPE(pairs_pkg::primary_shape(PAIR)), .EXP(EXP), .MAN(MAN), .LANES(LANES), .LAT(LAT), .ARITH(ARITH)
  ) check_a (.clk_i, .en_i(taken), .words_i(a), .bad_o(bad_a));
  shape_check #(
      .SHAPE(pairs_pkg::secondary_shape(PAIR)), .EXP(EXP), .MAN(MAN), .LANES(LANES), .LAT(LAT), .ARITH(ARITH)
  ) check_b (.clk_i, .en_i(taken), .words_i(b), .bad_o(bad_b));
  assign bad_check = bad_a | bad_b;

  if (pairs_pkg::has(pairs_pkg::ITERATIVE_PAIRS, PAIR)) begin : g_iterative
    localparam int ENTRY = formats_pkg::larger(T_CHECK, 1 + pairs_pkg::iterative_entry(LAT.add, LAT.mul, LAT.cmp));
    logic [LANES-1:0][CW-1:0] bad_entry;
    pipe_delay #(.W(LW), .FROM(T_CHECK), .TO(ENTRY), .ARITH(ARITH)) delay_bad (
        .clk_i, .d_i(bad_check), .q_o(bad_entry));
    cylinder_pair #(
        .BODY(pairs_pkg::cylinder_body(PAIR)), .AHEAD(32'(HELD)), .ENTRY(ENTRY - 32'(HELD)), .EXP(EXP), .MAN(MAN),
        .LANES(LANES), .LAT(LAT),
        .ARITH(ARITH)
    ) pipe (
        .clk_i, .rst_i, .iterations_i, .valid_i, .ready_o, .tag_i(tag), .a_i(a), .b_i(b), .bad_i(bad_entry), .valid_o,
        .tag_o, .bad_o(bad), .f_o(f), .t_o(t), .cp_o(cp), .n_o(n), .latency_o);
  end else begin : g_free
    logic unused_iterations;
    assign unused_iterations = &{1'b0, iterations_i};
    logic [15:0] latency, rest;  // rest: cycles from a and b to the result
    assign latency_o = 32'(latency);
    assign rest = latency - 16'(HELD);
    issue_throttle #(.INTERVAL(SAT_II)) interval (.clk_i, .rst_i, .take_i(valid_i && ready_o), .ready_o);
    logic [LANES-1:0][CW-1:0] f_pipe, t_pipe;
    logic [2:0][LANES-1:0][CW-1:0] cp_pipe, n_pipe;
    bounded_pipe #(
        .PAIR(PAIR), .ALGORITHM(ALGORITHM), .BOX(pairs_pkg::has(config_pkg::BOUND_PAIRS, PAIR) ? 0 : BOX),
        .BOUND(pairs_pkg::has(config_pkg::BOUND_PAIRS, PAIR) ? BOX : 0), .HALF_SPACE(HALF_SPACE), .SAT_II(SAT_II),
        .EXP(EXP), .MAN(MAN), .LANES(LANES), .LAT(LAT), .ARITH(ARITH)
    ) pipe (.clk_i, .enter_i(taken), .a_i(a), .b_i(b), .f_o(f_pipe), .t_o(t_pipe), .cp_o(cp_pipe), .n_o(n_pipe),
        .latency_o(latency));
    issue_history #(.W(32), .DEPTH(HISTORY)) history_tag (
        .clk_i, .rst_i, .latency_i(rest), .valid_i(taken), .d_i(tag), .valid_o, .q_o(tag_o));
    logic unused_valid;
    if (ARITH != "rtl") begin : g_late  // the pipe answers at once; its results wait
      issue_history #(.W(9 * LW), .DEPTH(HISTORY)) history (
          .clk_i, .rst_i, .latency_i(rest), .valid_i(taken), .d_i({n_pipe, cp_pipe, t_pipe, f_pipe, bad_check}),
          .valid_o(unused_valid), .q_o({n, cp, t, f, bad}));
    end else begin : g_early  // the check answers before the pipe
      issue_history #(.W(LW), .DEPTH(HISTORY)) history (
          .clk_i, .rst_i, .latency_i(latency - 16'(T_CHECK)), .valid_i(1'b1), .d_i(bad_check), .valid_o(unused_valid),
          .q_o(bad));
      assign {n, cp, t, f} = {n_pipe, cp_pipe, t_pipe, f_pipe};
    end
  end
  assign bad_o = bad;
  assign f_o = f & ~bad;
  lane_select #(.CW(CW), .LANES(LANES)) select_t (.m_i(bad), .a_i({LANES{QNAN}}), .b_i(t), .r_o(t_o));
  lane_select #(.CW(CW), .LANES(LANES), .WORDS(3)) select_cp (.m_i(bad), .a_i({(3 * LANES) {QNAN}}), .b_i(cp),
      .r_o(cp_o));
  lane_select #(.CW(CW), .LANES(LANES), .WORDS(3)) select_n (.m_i(bad), .a_i({(3 * LANES) {QNAN}}), .b_i(n), .r_o(n_o));
endmodule
