// SPDX-License-Identifier: Apache-2.0
// One lane of fp_sqrt: normalise | MAN + 1 steps of the restoring root | shift | round.
// Invariant after step i: r = 2^i (s - root^2), with s in [1, 4) and the root so far; d holds twice the root. Both have
// MAN + 1 fraction bits. The root in [1, 2) is never tiny and never overflows.
// Latency: CUTS clocks, 0..MAN + 3, spread evenly over the MAN + 3 places where a cut may lie. Throughput: one a clock.
module fp_sqrt_lane #(
    parameter int EXP   = 8,
    parameter int MAN   = 23,
    parameter int CUTS  = 0,
    parameter bit FLAGS = 0,
    localparam int CW   = (1 + EXP + MAN <= 32 && MAN <= 23) ? 32 : 64
) (
    input  logic          clk_i,
    input  logic [CW-1:0] a_i,
    output logic [CW-1:0] r_o,
    output logic [CW-1:0] flags_o
);
  /*verilator inline_module*/
`include "fp_mask.svh"
  localparam logic [CW-1:0] BIAS = EMAX >> 1;
  localparam int STEPS = MAN + 1;
  localparam int PLACES = MAN + 3;  // before each step, after the last, and in fp_round
  localparam int D_ROUND = (PLACES * CUTS + PLACES / 2) / PLACES - ((PLACES - 1) * CUTS + PLACES / 2) / PLACES;

  // The exponent is halved downwards; an odd one leaves a factor of 2 in s. An offset of 128 keeps it positive.
  logic [CW-1:0] mag_n, s_n, e_n, v_n, half_n, sign_n, minus_n, zero_n, inf_n, nan_n, nv_n;
  fp_normalise #(.EXP(EXP), .MAN(MAN)) norm (.mag_i(mag_n), .s_o(s_n), .e_o(e_n));
  always_comb begin
    mag_n = a_i & MAG;
    sign_n = a_i & SIGN;
    minus_n = neg(a_i << (CW - 1 - EXP - MAN));
    v_n = e_n + ONE + BIAS + (ONE << 7);
    half_n = (v_n >> 1) - (ONE << 6) - ONE;
    zero_n = ~some(mag_n);
    inf_n = ~neg(mag_n - INF);
    nan_n = neg(INF - mag_n) | (minus_n & ~zero_n);
  end
  if (FLAGS) begin : g_flags
    assign nv_n = snan(a_i) | (nan_n & ~neg(INF - mag_n));
  end else begin : g_no_flags
    assign nv_n = '0;
  end

  for (genvar i = 0; i < STEPS; i++) begin : g_step
    localparam int D = ((i + 1) * CUTS + PLACES / 2) / PLACES - (i * CUTS + PLACES / 2) / PLACES;
    localparam logic [CW-1:0] BIT = ONE << (STEPS - 1 - i);
    logic [CW-1:0] r_d, d_d, r, d, trial, t, m, r_next, d_next;
    if (i == 0) begin : g_first
      assign r_d = ((s_n >> (CW - 2 - MAN)) << v_n[0]) - (ONE << STEPS);
      assign d_d = ONE << (STEPS + 1);
    end else begin : g_next
      assign r_d = g_step[i-1].r_next;
      assign d_d = g_step[i-1].d_next;
    end
    fp_cut #(CW, D) cut_r (.clk_i, .d_i(r_d), .q_o(r));
    fp_cut #(CW, D) cut_d (.clk_i, .d_i(d_d), .q_o(d));
    always_comb begin
      trial = d | BIT;
      t = r + r - trial;
      m = neg(t);
      r_next = t + (trial & m);
      d_next = d | (~m & (BIT << 1));
    end
  end

  localparam int D_LAST = ((STEPS + 1) * CUTS + PLACES / 2) / PLACES - (STEPS * CUTS + PLACES / 2) / PLACES;
  logic [CW-1:0] rest, twice;
  fp_cut #(CW, D_LAST) cut_rest (.clk_i, .d_i(g_step[STEPS-1].r_next), .q_o(rest));
  fp_cut #(CW, D_LAST) cut_twice (.clk_i, .d_i(g_step[STEPS-1].d_next), .q_o(twice));

  logic [CW-1:0] root, e, sign, zero, inf, nan, nv;
  localparam int D = CUTS - D_ROUND;
  fp_cut #(CW, D) delay_e (.clk_i, .d_i(half_n), .q_o(e));
  fp_cut #(CW, D) delay_sign (.clk_i, .d_i(sign_n), .q_o(sign));
  fp_cut #(CW, D) delay_zero (.clk_i, .d_i(zero_n), .q_o(zero));
  fp_cut #(CW, D) delay_inf (.clk_i, .d_i(inf_n), .q_o(inf));
  fp_cut #(CW, D) delay_nan (.clk_i, .d_i(nan_n), .q_o(nan));
  fp_cut #(CW, D) delay_nv (.clk_i, .d_i(nv_n), .q_o(nv));
  assign root = (twice << (CW - 4 - MAN)) | (some(rest) & ONE);
  fp_round #(.EXP(EXP), .MAN(MAN), .CUT(D_ROUND), .FLAGS(FLAGS)) round (
      .clk_i, .m_i(root), .e_i(e), .sign_i(sign), .zero_i(zero), .inf_i(inf), .nan_i(nan), .nv_i(nv), .dz_i('0),
      .r_o, .flags_o);
endmodule
