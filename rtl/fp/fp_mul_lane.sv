// SPDX-License-Identifier: Apache-2.0
// One lane of fp_mul: swap | normalise | partial products | sum | shift | round. x is the operand of larger magnitude;
// only y needs normalising when two subnormals multiply to less than half of the smallest subnormal (bias >= MAN + 2).
// Significands are multiplied as halves of H bits so that nothing is wider than the container.
// Latency: CUTS clocks, 0..5. Throughput: one a clock. Stall: none.
module fp_mul_lane #(
    parameter int EXP   = 8,
    parameter int MAN   = 23,
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
  localparam logic [CW-1:0] BIAS = EMAX >> 1;
  localparam bit ONE_WORD = 2 * MAN + 2 <= CW;
  localparam bit NORMALISE_X = (1 << (EXP - 1)) - 1 < MAN + 2;
  // Half of a significand. 12 bits at least in 32-bit words: with halves of 9 the multiplier of 1-7-16 does not
  // vectorise (measured at 64 lanes: 58 against 209 M operations/s).
  localparam int H = (CW == 32) ? 12 : (MAN + 2) / 2;
  localparam int ALIGN = CW - 1 - MAN;  // shift that takes the hidden bit to the top
  localparam int D_SWAP = (CUTS >= 5) ? 1 : 0;
  localparam int D_NORM = (CUTS >= 2) ? 1 : 0;
  localparam int D_PART = (CUTS == 1 || CUTS >= 3) ? 1 : 0;
  localparam int D_PROD = (CUTS >= 2) ? 1 : 0;
  localparam int D_SHIFT = (CUTS >= 4) ? 1 : 0;

  // Swap.
  logic [CW-1:0] am_s, bm_s, x_s, y_s, sign_s, x, y, sign_n;
  always_comb begin
    am_s = a_i & MAG;
    bm_s = b_i & MAG;
    x_s = sel(neg(am_s - bm_s), bm_s, am_s);
    y_s = am_s ^ bm_s ^ x_s;
    sign_s = (a_i ^ b_i) & SIGN;
  end
  fp_cut #(CW, D_SWAP) cut_x (.clk_i, .d_i(x_s), .q_o(x));
  fp_cut #(CW, D_SWAP) cut_y (.clk_i, .d_i(y_s), .q_o(y));
  fp_cut #(CW, D_SWAP) cut_sign_n (.clk_i, .d_i(sign_s), .q_o(sign_n));

  // Normalise: significands with their leading one at the top; e is the biased exponent of the product less one, for a
  // product in [1, 2). A zero y is caught by its own mask.
  logic [CW-1:0] sx_n, sy_n, ex_n, ey_n, e_n, inf_n, nan_n, zero_n;
  logic [CW-1:0] sx, sy, e_p, sign_p, inf_p, nan_p, zero_p;
  fp_normalise #(.EXP(EXP), .MAN(MAN), .COUNT(NORMALISE_X)) norm_x (.mag_i(x), .s_o(sx_n), .e_o(ex_n));
  fp_normalise #(.EXP(EXP), .MAN(MAN), .COUNT(1)) norm_y (.mag_i(y), .s_o(sy_n), .e_o(ey_n));
  always_comb begin
    e_n = ex_n + ey_n + ONE - BIAS;
    zero_n = ~some(y);
    inf_n = ~neg(x - INF);
    nan_n = neg(INF - x) | (inf_n & zero_n);
  end
  fp_cut #(CW, D_NORM) cut_sx (.clk_i, .d_i(sx_n), .q_o(sx));
  fp_cut #(CW, D_NORM) cut_sy (.clk_i, .d_i(sy_n), .q_o(sy));
  fp_cut #(CW, D_NORM) cut_e_p (.clk_i, .d_i(e_n), .q_o(e_p));
  fp_cut #(CW, D_NORM) cut_sign_p (.clk_i, .d_i(sign_n), .q_o(sign_p));
  fp_cut #(CW, D_NORM) cut_inf_p (.clk_i, .d_i(inf_n), .q_o(inf_p));
  fp_cut #(CW, D_NORM) cut_nan_p (.clk_i, .d_i(nan_n), .q_o(nan_p));
  fp_cut #(CW, D_NORM) cut_zero_p (.clk_i, .d_i(zero_n), .q_o(zero_p));

  // Product in [1, 4), its top bit (weight 2) at the top of the word, what does not fit as a sticky bit.
  logic [CW-1:0] prod_m, prod, e_m, e_r, sign_m, sign_r, inf_m, inf_r, nan_m, nan_r, zero_m, zero_r;
  if (ONE_WORD) begin : g_word
    logic [CW-1:0] full_p, full;
    assign full_p = (sx >> ALIGN) * (sy >> ALIGN);
    fp_cut #(CW, D_PART) cut_full (.clk_i, .d_i(full_p), .q_o(full));
    assign prod_m = full << (CW - 2 * MAN - 2);
  end else begin : g_halves
    localparam logic [CW-1:0] LOW = (ONE << H) - 1;
    localparam logic [CW-1:0] STICKY = (ONE << (4 * H - CW)) - 1;
    logic [CW-1:0] xh_p, xl_p, yh_p, yl_p, hh_p, mid_p, ll_p, hh, mid, ll, low;
    always_comb begin
      xh_p = sx >> (CW - H);
      xl_p = (sx >> (CW - 2 * H)) & LOW;
      yh_p = sy >> (CW - H);
      yl_p = (sy >> (CW - 2 * H)) & LOW;
      hh_p = xh_p * yh_p;
      mid_p = xh_p * yl_p + xl_p * yh_p;
      ll_p = xl_p * yl_p;
    end
    fp_cut #(CW, D_PART) cut_hh (.clk_i, .d_i(hh_p), .q_o(hh));
    fp_cut #(CW, D_PART) cut_mid (.clk_i, .d_i(mid_p), .q_o(mid));
    fp_cut #(CW, D_PART) cut_ll (.clk_i, .d_i(ll_p), .q_o(ll));
    always_comb begin
      low = mid + (ll >> H);
      prod_m = (hh + (low >> H)) << (CW - 2 * H);
      low = ((low & LOW) << H) | (ll & LOW);
      prod_m = prod_m | (low >> (4 * H - CW)) | (some(low & STICKY) & ONE);
    end
  end
  fp_cut #(CW, D_PART) cut_e_m (.clk_i, .d_i(e_p), .q_o(e_m));
  fp_cut #(CW, D_PART) cut_sign_m (.clk_i, .d_i(sign_p), .q_o(sign_m));
  fp_cut #(CW, D_PART) cut_inf_m (.clk_i, .d_i(inf_p), .q_o(inf_m));
  fp_cut #(CW, D_PART) cut_nan_m (.clk_i, .d_i(nan_p), .q_o(nan_m));
  fp_cut #(CW, D_PART) cut_zero_m (.clk_i, .d_i(zero_p), .q_o(zero_m));
  fp_cut #(CW, D_PROD) cut_prod (.clk_i, .d_i(prod_m), .q_o(prod));
  fp_cut #(CW, D_PROD) cut_e_r (.clk_i, .d_i(e_m), .q_o(e_r));
  fp_cut #(CW, D_PROD) cut_sign_r (.clk_i, .d_i(sign_m), .q_o(sign_r));
  fp_cut #(CW, D_PROD) cut_inf_r (.clk_i, .d_i(inf_m), .q_o(inf_r));
  fp_cut #(CW, D_PROD) cut_nan_r (.clk_i, .d_i(nan_m), .q_o(nan_r));
  fp_cut #(CW, D_PROD) cut_zero_r (.clk_i, .d_i(zero_m), .q_o(zero_r));

  // Invalid: a signalling NaN, or infinity times zero.
  logic [CW-1:0] nv_r;
  if (FLAGS) begin : g_nv
    logic [CW-1:0] nv_s, nv_n, nv_p, nv_m;
    assign nv_s = snan(a_i) | snan(b_i);
    fp_cut #(CW, D_SWAP) cut_nv_n (.clk_i, .d_i(nv_s), .q_o(nv_n));
    fp_cut #(CW, D_NORM) cut_nv_p (.clk_i, .d_i(nv_n | (inf_n & zero_n & ~neg(INF - x))), .q_o(nv_p));
    fp_cut #(CW, D_PART) cut_nv_m (.clk_i, .d_i(nv_p), .q_o(nv_m));
    fp_cut #(CW, D_PROD) cut_nv_r (.clk_i, .d_i(nv_m), .q_o(nv_r));
  end else begin : g_no_nv
    assign nv_r = '0;
  end

  // Shift and round.
  fp_round #(.EXP(EXP), .MAN(MAN), .CUT(D_SHIFT), .FLAGS(FLAGS)) round (
      .clk_i, .m_i(prod), .e_i(e_r), .sign_i(sign_r), .zero_i(zero_r), .inf_i(inf_r), .nan_i(nan_r),
      .nv_i(nv_r), .dz_i('0), .r_o, .flags_o);
endmodule
