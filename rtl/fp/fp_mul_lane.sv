// SPDX-License-Identifier: Apache-2.0
// One lane of fp_mul: swap | count zeros | normalise | partial products | sum | count | shift | round | pack.
// x is the operand of larger magnitude. Only y needs normalising: two subnormals multiply to less than half of the
// smallest subnormal (bias >= MAN + 2).
// Significands are multiplied as halves of H bits. So no word is wider than the container, and in gates no factor is
// wider than a multiplier block.
// Latency: CUTS cycles, 0..10.
// Throughput: one result per cycle.
// Stall: none.
module fp_mul_lane #(
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
  localparam bit NORMALISE_X = (1 << (EXP - 1)) - 1 < MAN + 2;
  // In gates, one multiplier block takes 18 bits.
  localparam bit WHOLE = LEAST ? MAN < 18 : 2 * MAN + 2 <= CW;
  // Half of a significand. In 32-bit words it has at least 12 bits: narrower halves of 1-7-16 do not vectorise.
  localparam int H = (CW == 32 && !LEAST) ? 12 : (MAN + 2) / 2;
  localparam int D_SWAP = (CUTS >= 5) ? 1 : 0;
  localparam int D_LZC = (CUTS >= 8) ? 1 : 0;
  // Multiplier blocks lie apart, so their output wires get a second register. With a third register, a word of up to 24
  // bits takes one block of 18 by 18 bits. Adders make the products with the remaining six bits.
  localparam int D_NORM = (CUTS >= 2) ? 1 : 0;
  localparam int D_PART = (CUTS >= 10) ? 3 : (CUTS >= 9) ? 2 : (CUTS == 1 || CUTS >= 3) ? 1 : 0;
  localparam bit ONE_BLOCK = LEAST && !WHOLE && MAN < 24 && D_PART == 3;
  localparam int D_PROD = (CUTS >= 2) ? 1 : 0;
  localparam int D_COUNT = (CUTS >= 7) ? 1 : 0;
  localparam int D_SHIFT = (CUTS >= 4) ? 1 : 0;
  localparam int D_PACK = (CUTS >= 6) ? 1 : 0;

  // Swap.
  logic [CW-1:0] am_s, bm_s, x_s, y_s, sign_s, x, y, sign_n;
  always_comb begin
    am_s = a_i & MAG;
    bm_s = b_i & MAG;
    x_s = sel(neg(am_s - bm_s), bm_s, am_s);
    y_s = am_s ^ bm_s ^ x_s;
    sign_s = (a_i ^ b_i) & SIGN;
  end
  pipe_reg #(CW, D_SWAP) reg_x (.clk_i, .d_i(x_s), .q_o(x));
  pipe_reg #(CW, D_SWAP) reg_y (.clk_i, .d_i(y_s), .q_o(y));
  pipe_reg #(CW, D_SWAP) reg_sign_n (.clk_i, .d_i(sign_s), .q_o(sign_n));

  // Normalise: significands have their leading one at the top. e is the biased exponent, less one, of a product in [1,
  // 2). A zero y has its own mask.
  logic [CW-1:0] sx_n, sy_n, inf_n, nan_n, zero_n, sx, sy, sign_p, inf_p, nan_p, zero_p;
  logic [EW-1:0] ex_n, ey_n, e_p;
  fp_normalise #(.EXP(EXP), .MAN(MAN), .LEAST(LEAST), .COUNT(NORMALISE_X), .CUT(D_LZC)) norm_x (
      .clk_i, .mag_i(x), .s_o(sx_n), .e_o(ex_n));
  fp_normalise #(.EXP(EXP), .MAN(MAN), .LEAST(LEAST), .COUNT(1), .CUT(D_LZC)) norm_y (
      .clk_i, .mag_i(y), .s_o(sy_n), .e_o(ey_n));
  always_comb begin
    zero_n = ~some(y);
    inf_n = special(x);
    nan_n = is_nan(x) | (inf_n & zero_n);
  end
  pipe_reg #(CW, D_NORM) reg_sx (.clk_i, .d_i(sx_n), .q_o(sx));
  pipe_reg #(CW, D_NORM) reg_sy (.clk_i, .d_i(sy_n), .q_o(sy));
  pipe_reg #(EW, D_NORM) reg_e_p (.clk_i, .d_i(ex_n + ey_n + E_ONE - BIAS), .q_o(e_p));
  pipe_reg #(CW, D_LZC + D_NORM) reg_sign_p (.clk_i, .d_i(sign_n), .q_o(sign_p));
  pipe_reg #(CW, D_LZC + D_NORM) reg_inf_p (.clk_i, .d_i(inf_n), .q_o(inf_p));
  pipe_reg #(CW, D_LZC + D_NORM) reg_nan_p (.clk_i, .d_i(nan_n), .q_o(nan_p));
  pipe_reg #(CW, D_LZC + D_NORM) reg_zero_p (.clk_i, .d_i(zero_n), .q_o(zero_p));

  logic unused_bits;
  assign unused_bits = &{1'b0, sx, sy};

  // Product in [1, 4): the top bit (weight 2) is where fp_round takes it. The sticky bit holds the bits that do not
  // fit.
  logic [CW-1:0] prod_m, prod, sign_m, sign_r, inf_m, inf_r, nan_m, nan_r, zero_m, zero_r;
  logic [EW-1:0] e_m, e_r;
  if (WHOLE && !LEAST) begin : g_word
    localparam int ALIGN = CW - 1 - MAN;  // shift that takes the hidden bit to the top
    logic [CW-1:0] full_p, full;
    assign full_p = (sx >> ALIGN) * (sy >> ALIGN);
    pipe_reg #(CW, D_PART) reg_full (.clk_i, .d_i(full_p), .q_o(full));
    assign prod_m = full << (CW - 2 * MAN - 2);
  end else if (WHOLE) begin : g_whole
    logic [2*MAN+1:0] full_p, full;
    assign full_p = (2 * MAN + 2)'(sx[CW-1-:MAN+1]) * (2 * MAN + 2)'(sy[CW-1-:MAN+1]);
    pipe_reg #(2 * MAN + 2, D_PART) reg_full (.clk_i, .d_i(full_p), .q_o(full));
    assign prod_m = CW'({full[2*MAN+1:MAN-1], |full[MAN-2:0]});
  end else if (ONE_BLOCK) begin : g_block
    logic [23:0] xw, yw, xl_yh, yl_xh;
    logic [35:0] hh_p, hh;
    logic [11:0] ll;
    logic [47:0] full;
    assign xw = 24'(sx[CW-1-:MAN+1]) << (23 - MAN);
    assign yw = 24'(sy[CW-1-:MAN+1]) << (23 - MAN);
    assign hh_p = 36'(xw[23:6]) * 36'(yw[23:6]);
    pipe_reg #(36, D_PART) reg_hh (.clk_i, .d_i(hh_p), .q_o(hh));
    fp_rows #(.W(18)) rows_x (.clk_i, .a_i(yw[23:6]), .b_i(xw[5:0]), .r_o(xl_yh));
    fp_rows #(.W(18)) rows_y (.clk_i, .a_i(xw[23:6]), .b_i(yw[5:0]), .r_o(yl_xh));
    fp_rows #(.W(6)) rows_xy (.clk_i, .a_i(xw[5:0]), .b_i(yw[5:0]), .r_o(ll));
    assign full = {hh, ll} + ((48'(xl_yh) + 48'(yl_xh)) << 6);
    assign prod_m = CW'({full[47-:MAN+3], |full[44-MAN:0]});
  end else if (LEAST) begin : g_blocks
    // Halves of H bits. The lower half ends in a zero if the significand has an odd number of bits.
    logic [2*H-1:0] xw, yw, hh_p, hl_p, lh_p, ll_p, hh, hl, lh, ll;
    logic [4*H-1:0] full;
    assign xw = (2 * H)'(sx[CW-1-:MAN+1]) << (2 * H - MAN - 1);
    assign yw = (2 * H)'(sy[CW-1-:MAN+1]) << (2 * H - MAN - 1);
    assign hh_p = (2 * H)'(xw[2*H-1:H]) * (2 * H)'(yw[2*H-1:H]);
    assign hl_p = (2 * H)'(xw[2*H-1:H]) * (2 * H)'(yw[H-1:0]);
    assign lh_p = (2 * H)'(xw[H-1:0]) * (2 * H)'(yw[2*H-1:H]);
    assign ll_p = (2 * H)'(xw[H-1:0]) * (2 * H)'(yw[H-1:0]);
    pipe_reg #(2 * H, D_PART) reg_hh (.clk_i, .d_i(hh_p), .q_o(hh));
    pipe_reg #(2 * H, D_PART) reg_hl (.clk_i, .d_i(hl_p), .q_o(hl));
    pipe_reg #(2 * H, D_PART) reg_lh (.clk_i, .d_i(lh_p), .q_o(lh));
    pipe_reg #(2 * H, D_PART) reg_ll (.clk_i, .d_i(ll_p), .q_o(ll));
    assign full = {hh, ll} + (((4 * H)'(hl) + (4 * H)'(lh)) << H);
    assign prod_m = CW'({full[4*H-1-:MAN+3], |full[4*H-MAN-4:0]});
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
    pipe_reg #(CW, D_PART) reg_hh (.clk_i, .d_i(hh_p), .q_o(hh));
    pipe_reg #(CW, D_PART) reg_mid (.clk_i, .d_i(mid_p), .q_o(mid));
    pipe_reg #(CW, D_PART) reg_ll (.clk_i, .d_i(ll_p), .q_o(ll));
    always_comb begin
      low = mid + (ll >> H);
      prod_m = (hh + (low >> H)) << (CW - 2 * H);
      low = ((low & LOW) << H) | (ll & LOW);
      prod_m = prod_m | (low >> (4 * H - CW)) | (some(low & STICKY) & ONE);
    end
  end
  pipe_reg #(EW, D_PART) reg_e_m (.clk_i, .d_i(e_p), .q_o(e_m));
  pipe_reg #(CW, D_PART) reg_sign_m (.clk_i, .d_i(sign_p), .q_o(sign_m));
  pipe_reg #(CW, D_PART) reg_inf_m (.clk_i, .d_i(inf_p), .q_o(inf_m));
  pipe_reg #(CW, D_PART) reg_nan_m (.clk_i, .d_i(nan_p), .q_o(nan_m));
  pipe_reg #(CW, D_PART) reg_zero_m (.clk_i, .d_i(zero_p), .q_o(zero_m));
  pipe_reg #(CW, D_PROD) reg_prod (.clk_i, .d_i(prod_m), .q_o(prod));
  pipe_reg #(EW, D_PROD) reg_e_r (.clk_i, .d_i(e_m), .q_o(e_r));
  pipe_reg #(CW, D_PROD) reg_sign_r (.clk_i, .d_i(sign_m), .q_o(sign_r));
  pipe_reg #(CW, D_PROD) reg_inf_r (.clk_i, .d_i(inf_m), .q_o(inf_r));
  pipe_reg #(CW, D_PROD) reg_nan_r (.clk_i, .d_i(nan_m), .q_o(nan_r));
  pipe_reg #(CW, D_PROD) reg_zero_r (.clk_i, .d_i(zero_m), .q_o(zero_r));

  // Invalid: a signalling NaN, or infinity times zero.
  logic [CW-1:0] nv_r;
  if (FLAGS) begin : g_nv
    logic [CW-1:0] nv_s, nv_n;
    assign nv_s = snan(a_i) | snan(b_i);
    pipe_reg #(CW, D_SWAP) reg_nv_n (.clk_i, .d_i(nv_s), .q_o(nv_n));
    pipe_reg #(CW, D_LZC + D_NORM + D_PART + D_PROD) reg_nv_r (
        .clk_i, .d_i(nv_n | (inf_n & zero_n & ~is_nan(x))), .q_o(nv_r));
  end else begin : g_no_nv
    assign nv_r = '0;
  end

  // Count, shift, round and pack.
  fp_round #(.EXP(EXP), .MAN(MAN), .LEAST(LEAST), .CUT_COUNT(D_COUNT), .CUT(D_SHIFT), .CUT_PACK(D_PACK),
      .FLAGS(FLAGS)) round (
      .clk_i, .m_i(prod), .e_i(e_r), .sign_i(sign_r), .zero_i(zero_r), .inf_i(inf_r), .nan_i(nan_r),
      .nv_i(nv_r), .dz_i('0), .r_o, .flags_o);
endmodule
