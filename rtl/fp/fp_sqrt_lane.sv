// SPDX-License-Identifier: Apache-2.0
// One lane of fp_sqrt: count zeros | normalise | MAN + 1 steps of the restoring root | count | shift | round | pack.
// Invariant after step i: r = 2^i (s - root^2), for s in [1, 4) and the current root; d holds twice the root. Both have
// MAN + 1 fraction bits. The root in [1, 2) is never tiny and never overflows.
// Latency: CUTS cycles, 0..MAN + 6, spread evenly over the MAN + 6 possible places.
// Throughput: one result per cycle.
module fp_sqrt_lane #(
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
    output logic [CW-1:0] r_o,
    output logic [CW-1:0] flags_o
);
  /*verilator inline_module*/
`include "fp_mask.svh"
  localparam logic [EW-1:0] BIAS = EW'(EMAX >> 1);
  localparam int STEPS = MAN + 1;
  localparam int TOP = formats_pkg::round_top(EXP, MAN, LEAST);
  // Places of cuts: between count and shift of the operand, before each step, after the last step, and three in
  // fp_round.
  localparam int PLACES = STEPS + 5;
  localparam int D_LZC = formats_pkg::cuts_at(CUTS, PLACES, 0);
  localparam int D_LAST = formats_pkg::cuts_at(CUTS, PLACES, STEPS + 1);
  localparam int D_COUNT = formats_pkg::cuts_at(CUTS, PLACES, STEPS + 2);
  localparam int D_SHIFT = formats_pkg::cuts_at(CUTS, PLACES, STEPS + 3);
  localparam int D_PACK = formats_pkg::cuts_at(CUTS, PLACES, STEPS + 4);

  // Halving rounds the exponent down; an odd exponent leaves a factor of 2 in s. An even offset keeps it positive.
  localparam logic [EW-1:0] OFFSET = E_ONE << $clog2(MAN + 4);
  logic [CW-1:0] mag_n, s_n, sign_n, minus_n, zero_n, inf_n, nan_n, nv_n;
  logic [EW-1:0] e_n, v_n, half_n;
  fp_normalise #(.EXP(EXP), .MAN(MAN), .LEAST(LEAST), .CUT(D_LZC)) norm (.clk_i, .mag_i(mag_n), .s_o(s_n), .e_o(e_n));
  assign v_n = e_n + E_ONE + BIAS + OFFSET;
  assign half_n = (v_n >> 1) - (OFFSET >> 1) - E_ONE;
  always_comb begin
    mag_n = a_i & MAG;
    sign_n = a_i & SIGN;
    minus_n = neg(a_i << (CW - 1 - EXP - MAN));
    zero_n = ~some(mag_n);
    inf_n = special(mag_n);
    nan_n = is_nan(mag_n) | (minus_n & ~zero_n);
  end
  if (FLAGS) begin : g_flags
    assign nv_n = snan(a_i) | (nan_n & ~is_nan(mag_n));
  end else begin : g_no_flags
    assign nv_n = '0;
  end

  for (genvar i = 0; i < STEPS; i++) begin : g_step
    localparam int D = formats_pkg::cuts_at(CUTS, PLACES, i + 1);
    localparam logic [CW-1:0] BIT = ONE << (STEPS - 1 - i);
    logic [CW-1:0] r_d, d_d, r, d, trial, t, m, r_next, d_next;
    if (i == 0) begin : g_first
      assign r_d = ((s_n >> (CW - 2 - MAN)) << v_n[0]) - (ONE << STEPS);
      assign d_d = ONE << (STEPS + 1);
    end else begin : g_next
      assign r_d = g_step[i-1].r_next;
      assign d_d = g_step[i-1].d_next;
    end
    pipe_reg #(CW, D) reg_r (.clk_i, .d_i(r_d), .q_o(r));
    pipe_reg #(CW, D) reg_d (.clk_i, .d_i(d_d), .q_o(d));
    always_comb begin
      trial = d | BIT;
      t = r + r - trial;
      m = neg(t);
      r_next = sel(m, r + r, t);
      d_next = d | (~m & (BIT << 1));
    end
  end

  logic [CW-1:0] rest, twice;
  pipe_reg #(CW, D_LAST) reg_rest (.clk_i, .d_i(g_step[STEPS-1].r_next), .q_o(rest));
  pipe_reg #(CW, D_LAST) reg_twice (.clk_i, .d_i(g_step[STEPS-1].d_next), .q_o(twice));

  logic [CW-1:0] root, sign, zero, inf, nan, nv;
  logic [EW-1:0] e;
  localparam int D = CUTS - D_COUNT - D_SHIFT - D_PACK;
  pipe_reg #(EW, D - D_LZC) delay_e (.clk_i, .d_i(half_n), .q_o(e));
  pipe_reg #(CW, D) delay_sign (.clk_i, .d_i(sign_n), .q_o(sign));
  pipe_reg #(CW, D) delay_zero (.clk_i, .d_i(zero_n), .q_o(zero));
  pipe_reg #(CW, D) delay_inf (.clk_i, .d_i(inf_n), .q_o(inf));
  pipe_reg #(CW, D) delay_nan (.clk_i, .d_i(nan_n), .q_o(nan));
  pipe_reg #(CW, D) delay_nv (.clk_i, .d_i(nv_n), .q_o(nv));
  assign root = (twice << (TOP - 3 - MAN)) | (some(rest) & ONE);
  fp_round #(.EXP(EXP), .MAN(MAN), .LEAST(LEAST), .CUT_COUNT(D_COUNT), .CUT(D_SHIFT), .CUT_PACK(D_PACK),
      .FLAGS(FLAGS)) round (
      .clk_i, .m_i(root), .e_i(e), .sign_i(sign), .zero_i(zero), .inf_i(inf), .nan_i(nan), .nv_i(nv), .dz_i('0),
      .r_o, .flags_o);
endmodule
