// One pipe by itself: LANES pairs a clock in, each lane with a primary and a secondary of its own, with the check of the input
// contract and the handling of bad input. What `cde query`, the regressions and the benchmarks of pairs run on.
// Latency: latency_o clocks. Throughput: LANES pairs a clock. Stall: none, runs free.
module pair_unit #(
    parameter int PAIR = 0,       // cde_pkg::PAIR_*
    parameter int ALGORITHM = 0,  // of ray-triangle, cde_pkg::ALGORITHM_*
    parameter int HALF_SPACE = 0,  // of obb-plane, 1: the plane is the solid n.x <= d
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
    localparam int A_WORDS = cde_pkg::shape_words(cde_pkg::primary_shape(PAIR)),
    localparam int B_WORDS = cde_pkg::shape_words(cde_pkg::secondary_shape(PAIR))
) (
    input logic clk_i,
    input logic rst_i,
    input logic valid_i,
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
    output logic [15:0] latency_o,
    output logic [63:0] config_hash_o
);
  localparam logic [CW-1:0] QNAN = (((CW'(1) << EXP) - 1) << MAN) | (CW'(1) << (MAN - 1));
  localparam int T_CHECK = LAT_MUL + 3 * LAT_ADD + LAT_CMP;
  localparam int SLOWEST = (LAT_ADD + LAT_MUL + LAT_DIV + LAT_SQRT + LAT_CMP + 4) / 5;
  localparam int HISTORY = 128 << $clog2(SLOWEST);
  localparam int LW = LANES * CW;
  assign config_hash_o = CONFIG_HASH;

  logic [LANES-1:0][CW-1:0] f_pipe, t_pipe, bad_a, bad_b, bad_check;
  logic [2:0][LANES-1:0][CW-1:0] cp_pipe, n_pipe;
  pair_pipe #(
      .PAIR(PAIR), .ALGORITHM(ALGORITHM), .HALF_SPACE(HALF_SPACE), .EXP(EXP), .MAN(MAN), .LANES(LANES), .LAT_ADD(LAT_ADD), .LAT_MUL(LAT_MUL),
      .LAT_DIV(LAT_DIV), .LAT_SQRT(LAT_SQRT), .LAT_CMP(LAT_CMP), .ARITH(ARITH)
  ) pipe (.clk_i, .a_i, .b_i, .f_o(f_pipe), .t_o(t_pipe), .cp_o(cp_pipe), .n_o(n_pipe), .latency_o);
  shape_check #(
      .SHAPE(cde_pkg::primary_shape(PAIR)), .EXP(EXP), .MAN(MAN), .LANES(LANES), .LAT_ADD(LAT_ADD), .LAT_MUL(LAT_MUL), .LAT_CMP(LAT_CMP),
      .ARITH(ARITH)
  ) check_a (.clk_i, .words_i(a_i), .bad_o(bad_a));
  shape_check #(
      .SHAPE(cde_pkg::secondary_shape(PAIR)), .EXP(EXP), .MAN(MAN), .LANES(LANES), .LAT_ADD(LAT_ADD), .LAT_MUL(LAT_MUL), .LAT_CMP(LAT_CMP),
      .ARITH(ARITH)
  ) check_b (.clk_i, .words_i(b_i), .bad_o(bad_b));
  assign bad_check = bad_a | bad_b;

  issue_history #(.W(32), .DEPTH(HISTORY)) history_tag (
      .clk_i, .rst_i, .latency_i(latency_o), .valid_i, .d_i(tag_i), .valid_o, .q_o(tag_o));
  logic [LANES-1:0][CW-1:0] bad, f, t;
  logic [2:0][LANES-1:0][CW-1:0] cp, n;
  logic unused_valid;
  if (ARITH != "rtl") begin : g_late  // the pipe answers at once; its results wait
    issue_history #(.W(9 * LW), .DEPTH(HISTORY)) history (
        .clk_i, .rst_i, .latency_i(latency_o), .valid_i, .d_i({n_pipe, cp_pipe, t_pipe, f_pipe, bad_check}), .valid_o(unused_valid),
        .q_o({n, cp, t, f, bad}));
  end else begin : g_early  // the check answers before the pipe
    issue_history #(.W(LW), .DEPTH(HISTORY)) history (
        .clk_i, .rst_i, .latency_i(latency_o - 16'(T_CHECK)), .valid_i(1'b1), .d_i(bad_check), .valid_o(unused_valid), .q_o(bad));
    assign {n, cp, t, f} = {n_pipe, cp_pipe, t_pipe, f_pipe};
  end
  assign bad_o = bad;
  assign f_o = f & ~bad;
  lane_select #(.CW(CW), .LANES(LANES)) select_t (.m_i(bad), .a_i({LANES{QNAN}}), .b_i(t), .r_o(t_o));
  lane_select #(.CW(CW), .LANES(LANES), .WORDS(3)) select_cp (.m_i(bad), .a_i({(3 * LANES) {QNAN}}), .b_i(cp), .r_o(cp_o));
  lane_select #(.CW(CW), .LANES(LANES), .WORDS(3)) select_n (.m_i(bad), .a_i({(3 * LANES) {QNAN}}), .b_i(n), .r_o(n_o));
endmodule
