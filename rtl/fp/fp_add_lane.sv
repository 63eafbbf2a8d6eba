// SPDX-License-Identifier: Apache-2.0
// One lane of fp_add: swap | align | add | count zeros | normalise | round. A significand is left aligned, its hidden
// bit at CW-3, so that the carry of the sum lies at CW-2 and guard and sticky bits fill the rest of the container.
// Latency: CUTS clocks, 0..5. Throughput: one a clock. Stall: none.
module fp_add_lane #(
    parameter int EXP   = 8,
    parameter int MAN   = 23,
    parameter bit SUB   = 0,
    parameter int CUTS  = 0,
    parameter bit FLAGS = 0,
    localparam int CW   = (1 + EXP + MAN <= 32 && MAN <= 23) ? 32 : 64
) (
    input  logic          clk_i,
    input  logic [CW-1:0] a_i,
    input  logic [CW-1:0] b_i,
    output logic [CW-1:0] r_o,
    output logic [CW-1:0] flags_o
);
  /*verilator inline_module*/
`include "fp_mask.svh"
  localparam int GUARD = CW - 3 - MAN;
  localparam int D_SWAP = (CUTS >= 5) ? 1 : 0;
  localparam int D_ALIGN = (CUTS >= 2) ? 1 : 0;
  localparam int D_SUM = (CUTS == 1 || CUTS >= 3) ? 1 : 0;
  localparam int D_COUNT = (CUTS >= 2) ? 1 : 0;
  localparam int D_SHIFT = (CUTS >= 4) ? 1 : 0;

  // Swap: x is the operand of larger magnitude.
  logic [CW-1:0] b_s, less_s, x_s, y_s, x, y;
  always_comb begin
    b_s = SUB ? b_i ^ SIGN : b_i;
    less_s = neg((a_i & MAG) - (b_s & MAG));
    x_s = sel(less_s, b_s, a_i);
    y_s = a_i ^ b_s ^ x_s;
  end
  fp_cut #(CW, D_SWAP) cut_x (.clk_i, .d_i(x_s), .q_o(x));
  fp_cut #(CW, D_SWAP) cut_y (.clk_i, .d_i(y_s), .q_o(y));

  // Align: y is shifted right, what falls off is kept as a sticky bit. The hidden bit is 1 unless the exponent is 0.
  logic [CW-1:0] ex_a, ey_a, hx_a, hy_a, d_a, sh_a, xs_a, ys_a, yl_a, xmag_a, e_a, sub_a, sign_a, inf_a, nan_a;
  logic [CW-1:0] xs, ys, e_al, sub, sign_al, inf_al, nan_al;
  always_comb begin
    xmag_a = x & MAG;
    ex_a = xmag_a >> MAN;
    ey_a = (y & MAG) >> MAN;
    hx_a = (ex_a + EMAX) >> EXP;
    hy_a = (ey_a + EMAX) >> EXP;
    xs_a = ((x & FRAC) | (hx_a << MAN)) << GUARD;
    yl_a = ((y & FRAC) | (hy_a << MAN)) << GUARD;
    e_a = ex_a - hx_a;  // biased exponent less one
    d_a = e_a - (ey_a - hy_a);
    d_a = (d_a | neg(SHIFT_MAX - d_a)) & SHIFT_MAX;
    sh_a = yl_a >> d_a[AB-1:0];
    ys_a = sh_a | (some(yl_a ^ (sh_a << d_a[AB-1:0])) & ONE);
    sub_a = neg((x ^ y) << (CW - 1 - EXP - MAN));
    sign_a = x & SIGN;
    inf_a = ~neg(xmag_a - INF);
    nan_a = neg(INF - xmag_a) | (sub_a & ~neg((y & MAG) - INF));
  end
  fp_cut #(CW, D_ALIGN) cut_xs (.clk_i, .d_i(xs_a), .q_o(xs));
  fp_cut #(CW, D_ALIGN) cut_ys (.clk_i, .d_i(ys_a), .q_o(ys));
  fp_cut #(CW, D_ALIGN) cut_e_al (.clk_i, .d_i(e_a), .q_o(e_al));
  fp_cut #(CW, D_ALIGN) cut_sub (.clk_i, .d_i(sub_a), .q_o(sub));
  fp_cut #(CW, D_ALIGN) cut_sign_al (.clk_i, .d_i(sign_a), .q_o(sign_al));
  fp_cut #(CW, D_ALIGN) cut_inf_al (.clk_i, .d_i(inf_a), .q_o(inf_al));
  fp_cut #(CW, D_ALIGN) cut_nan_al (.clk_i, .d_i(nan_a), .q_o(nan_al));

  // Add. An exact zero has the sign of both operands if they agree, and is +0 if they differ.
  logic [CW-1:0] sum_s, sign_s, sum, e_sum, sign_sum, inf_sum, nan_sum;
  always_comb begin
    sum_s = xs + ((ys ^ sub) - sub);
    sign_s = sign_al & ~(~some(sum_s) & sub);
  end
  fp_cut #(CW, D_SUM) cut_sum (.clk_i, .d_i(sum_s), .q_o(sum));
  fp_cut #(CW, D_SUM) cut_e_sum (.clk_i, .d_i(e_al), .q_o(e_sum));
  fp_cut #(CW, D_SUM) cut_sign_sum (.clk_i, .d_i(sign_s), .q_o(sign_sum));
  fp_cut #(CW, D_SUM) cut_inf_sum (.clk_i, .d_i(inf_al), .q_o(inf_sum));
  fp_cut #(CW, D_SUM) cut_nan_sum (.clk_i, .d_i(nan_al), .q_o(nan_sum));

  // Count the zeros to shift out: k = 0 after a carry, and never more than the exponent allows.
  logic [CW-1:0] n_c, lim_c, k_c, k, sum_c, e_c, sign_c, inf_c, nan_c;
  always_comb begin
    n_c = lzc(sum << 1);
    lim_c = e_sum + ONE;
    k_c = sel(neg(lim_c - n_c), lim_c, n_c);
  end
  fp_cut #(CW, D_COUNT) cut_k (.clk_i, .d_i(k_c), .q_o(k));
  fp_cut #(CW, D_COUNT) cut_sum_c (.clk_i, .d_i(sum), .q_o(sum_c));
  fp_cut #(CW, D_COUNT) cut_e_c (.clk_i, .d_i(e_sum), .q_o(e_c));
  fp_cut #(CW, D_COUNT) cut_sign_c (.clk_i, .d_i(sign_sum), .q_o(sign_c));
  fp_cut #(CW, D_COUNT) cut_inf_c (.clk_i, .d_i(inf_sum), .q_o(inf_c));
  fp_cut #(CW, D_COUNT) cut_nan_c (.clk_i, .d_i(nan_sum), .q_o(nan_c));

  // Normalise: hidden bit to CW-2. ef is the biased exponent less one, so that adding the hidden bit completes it.
  logic [CW-1:0] norm_n, ef_n, zero_n, norm, ef, zero, sign, inf, nan;
  always_comb begin
    norm_n = sum_c << k[AB-1:0];
    ef_n = e_c + ONE - k;
    zero_n = ~some(sum_c);
  end
  fp_cut #(CW, D_SHIFT) cut_norm (.clk_i, .d_i(norm_n), .q_o(norm));
  fp_cut #(CW, D_SHIFT) cut_ef (.clk_i, .d_i(ef_n), .q_o(ef));
  fp_cut #(CW, D_SHIFT) cut_zero (.clk_i, .d_i(zero_n), .q_o(zero));
  fp_cut #(CW, D_SHIFT) cut_sign (.clk_i, .d_i(sign_c), .q_o(sign));
  fp_cut #(CW, D_SHIFT) cut_inf (.clk_i, .d_i(inf_c), .q_o(inf));
  fp_cut #(CW, D_SHIFT) cut_nan (.clk_i, .d_i(nan_c), .q_o(nan));

  // Round to nearest even; the carry of the significand runs into the exponent, and overflow stops at infinity.
  localparam logic [CW-1:0] HALF = (ONE << GUARD) - 1;
  logic [CW-1:0] p;
  always_comb begin
    p = ((ef << MAN) + ((norm + HALF + ((norm >> (GUARD + 1)) & ONE)) >> (GUARD + 1))) & ~zero;
    r_o = sel(nan, QNAN, sign | sel(neg(INF - p) | inf, INF, p));
  end

  // A sum is never inexact and tiny at once: what lies below the normal range is exact.
  if (FLAGS) begin : g_flags
    logic [CW-1:0] nv_a, nv_al, nv_sum, nv_c, nv, of, nx;
    always_comb begin
      nv_a = snan(x) | snan(y) | (~neg(INF - xmag_a) & nan_a);
    end
    fp_cut #(CW, D_ALIGN) cut_nv_al (.clk_i, .d_i(nv_a), .q_o(nv_al));
    fp_cut #(CW, D_SUM) cut_nv_sum (.clk_i, .d_i(nv_al), .q_o(nv_sum));
    fp_cut #(CW, D_COUNT) cut_nv_c (.clk_i, .d_i(nv_sum), .q_o(nv_c));
    fp_cut #(CW, D_SHIFT) cut_nv (.clk_i, .d_i(nv_c), .q_o(nv));
    always_comb begin
      of = ~neg(p - INF) & ~inf & ~nan;
      nx = (some(norm & ((ONE << (GUARD + 1)) - ONE)) & ~zero & ~inf & ~nan) | of;
      flags_o = (nv & CW'(16)) | (of & CW'(4)) | (nx & ONE);
    end
  end else begin : g_no_flags
    assign flags_o = '0;
  end
endmodule
