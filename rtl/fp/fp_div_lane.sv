// SPDX-License-Identifier: Apache-2.0
// One lane of fp_div: count zeros | normalise | MAN + 3 steps of restoring division | count | shift | round | pack.
// The quotient digit of a step is 1 unless the trial subtraction is negative.
// Digits start at weight 1 of x / y in (1/2, 2). So twice the quotient fills the word that fp_round takes.
// Latency: CUTS cycles, 0..MAN + 8, spread evenly over the MAN + 8 possible places.
// Throughput: one result per cycle.
module fp_div_lane #(
    parameter int EXP   = 8,
    parameter int MAN   = 23,
    parameter bit LEAST = 0,
    parameter int CUTS  = 0,
    parameter bit FLAGS = 0,
    localparam int CW   = formats_pkg::lane_word(EXP, MAN, LEAST),
    localparam int EW   = formats_pkg::lane_exponent(EXP, MAN, LEAST)
) (
    input  logic          clk_i,
    input  logic [CW-1:0] a_i,
    input  logic [CW-1:0] b_i,
    output logic [CW-1:0] r_o,
    output logic [CW-1:0] flags_o
);
  /*verilator inline_module*/
`include "fp_mask.svh"
  localparam logic [EW-1:0] BIAS = EW'(EMAX >> 1);
  localparam int STEPS = MAN + 3;
  localparam int TOP = formats_pkg::round_top(EXP, MAN, LEAST);
  // Places of cuts: between count and shift of the operands, before each step, after the last step, and three in
  // fp_round.
  localparam int PLACES = STEPS + 5;
  localparam int D_LZC = formats_pkg::cuts_at(CUTS, PLACES, 0);
  localparam int D_LAST = formats_pkg::cuts_at(CUTS, PLACES, STEPS + 1);
  localparam int D_COUNT = formats_pkg::cuts_at(CUTS, PLACES, STEPS + 2);
  localparam int D_SHIFT = formats_pkg::cuts_at(CUTS, PLACES, STEPS + 3);
  localparam int D_PACK = formats_pkg::cuts_at(CUTS, PLACES, STEPS + 4);

  logic [CW-1:0] x_n, y_n, am_n, bm_n, sign_n, x0_n, y0_n, xi_n, yi_n, zero_n, inf_n, nan_n, nv_n, dz_n;
  logic [EW-1:0] ex_n, ey_n, e_n;
  fp_normalise #(.EXP(EXP), .MAN(MAN), .LEAST(LEAST), .CUT(D_LZC)) norm_x (
      .clk_i, .mag_i(am_n), .s_o(x_n), .e_o(ex_n));
  fp_normalise #(.EXP(EXP), .MAN(MAN), .LEAST(LEAST), .CUT(D_LZC)) norm_y (
      .clk_i, .mag_i(bm_n), .s_o(y_n), .e_o(ey_n));
  assign e_n = ex_n - ey_n + BIAS - (E_ONE << 1);
  always_comb begin
    am_n = a_i & MAG;
    bm_n = b_i & MAG;
    sign_n = (a_i ^ b_i) & SIGN;
    x0_n = ~some(am_n);
    y0_n = ~some(bm_n);
    xi_n = special(am_n);
    yi_n = special(bm_n);
    zero_n = x0_n | yi_n;
    inf_n = xi_n | y0_n;
    nan_n = is_nan(am_n) | is_nan(bm_n) | (x0_n & y0_n) | (xi_n & yi_n);
  end
  if (FLAGS) begin : g_flags
    always_comb begin
      nv_n = snan(a_i) | snan(b_i) | (nan_n & ~is_nan(am_n) & ~is_nan(bm_n));
      dz_n = y0_n & ~x0_n & ~xi_n;
    end
  end else begin : g_no_flags
    assign nv_n = '0;
    assign dz_n = '0;
  end

  for (genvar i = 0; i < STEPS; i++) begin : g_step
    localparam int D = formats_pkg::cuts_at(CUTS, PLACES, i + 1);
    logic [CW-1:0] r_d, y_d, q_d, r, y, q, t, m, r_next, q_next;
    if (i == 0) begin : g_first
      assign r_d = x_n >> (CW - 1 - MAN);
      assign y_d = y_n >> (CW - 1 - MAN);
      assign q_d = '0;
    end else begin : g_next
      assign r_d = g_step[i-1].r_next;
      assign y_d = g_step[i-1].y;
      assign q_d = g_step[i-1].q_next;
    end
    pipe_reg #(CW, D) reg_r (.clk_i, .d_i(r_d), .q_o(r));
    pipe_reg #(CW, D) reg_y (.clk_i, .d_i(y_d), .q_o(y));
    pipe_reg #(CW, D) reg_q (.clk_i, .d_i(q_d), .q_o(q));
    always_comb begin
      t = (i == 0) ? r - y : r + r - y;
      m = neg(t);
      r_next = (i == 0) ? sel(m, r, t) : sel(m, r + r, t);
      q_next = (q << 1) | (~m & ONE);
    end
  end

  logic [CW-1:0] rest, digits;
  pipe_reg #(CW, D_LAST) reg_rest (.clk_i, .d_i(g_step[STEPS-1].r_next), .q_o(rest));
  pipe_reg #(CW, D_LAST) reg_digits (.clk_i, .d_i(g_step[STEPS-1].q_next), .q_o(digits));

  logic [CW-1:0] quotient, sign, zero, inf, nan, nv, dz;
  logic [EW-1:0] e;
  localparam int D = CUTS - D_COUNT - D_SHIFT - D_PACK;
  pipe_reg #(EW, D - D_LZC) delay_e (.clk_i, .d_i(e_n), .q_o(e));
  pipe_reg #(CW, D) delay_sign (.clk_i, .d_i(sign_n), .q_o(sign));
  pipe_reg #(CW, D) delay_zero (.clk_i, .d_i(zero_n), .q_o(zero));
  pipe_reg #(CW, D) delay_inf (.clk_i, .d_i(inf_n), .q_o(inf));
  pipe_reg #(CW, D) delay_nan (.clk_i, .d_i(nan_n), .q_o(nan));
  pipe_reg #(CW, D) delay_nv (.clk_i, .d_i(nv_n), .q_o(nv));
  pipe_reg #(CW, D) delay_dz (.clk_i, .d_i(dz_n), .q_o(dz));
  assign quotient = (digits << (TOP + 1 - STEPS)) | (some(rest) & ONE);
  fp_round #(.EXP(EXP), .MAN(MAN), .LEAST(LEAST), .CUT_COUNT(D_COUNT), .CUT(D_SHIFT), .CUT_PACK(D_PACK),
      .FLAGS(FLAGS)) round (
      .clk_i, .m_i(quotient), .e_i(e), .sign_i(sign), .zero_i(zero), .inf_i(inf), .nan_i(nan), .nv_i(nv), .dz_i(dz),
      .r_o, .flags_o);
endmodule
