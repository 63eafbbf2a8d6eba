// SPDX-License-Identifier: Apache-2.0
// One lane of fp_add: swap | exponent difference | align | add | count zeros | normalise | round | pack.
// The sum's carry lies at bit CARRY, and an operand's hidden bit lies below it. Guard and sticky bits fill the rest.
// Latency: CUTS cycles, 0..7.
// Throughput: one result per cycle.
// Stall: none.
module fp_add_lane #(
    parameter int EXP   = 8,
    parameter int MAN   = 23,
    parameter bit LEAST = 0,
    parameter bit SUB   = 0,
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
  localparam int CARRY = LEAST ? MAN + 4 : CW - 2;
  localparam int GUARD = CARRY - 1 - MAN;
  localparam int D_SWAP = (CUTS >= 5) ? 1 : 0;
  localparam int D_DIFF = (CUTS >= 6) ? 1 : 0;
  localparam int D_ALIGN = (CUTS >= 2) ? 1 : 0;
  localparam int D_SUM = (CUTS == 1 || CUTS >= 3) ? 1 : 0;
  localparam int D_COUNT = (CUTS >= 2) ? 1 : 0;
  localparam int D_SHIFT = (CUTS >= 4) ? 1 : 0;
  localparam int D_PACK = (CUTS >= 7) ? 1 : 0;

  // Swap: x is the operand of larger magnitude.
  logic [CW-1:0] b_s, less_s, x_s, y_s, x, y;
  always_comb begin
    b_s = SUB ? b_i ^ SIGN : b_i;
    less_s = neg((a_i & MAG) - (b_s & MAG));
    x_s = sel(less_s, b_s, a_i);
    y_s = a_i ^ b_s ^ x_s;
  end
  pipe_reg #(CW, D_SWAP) reg_x (.clk_i, .d_i(x_s), .q_o(x));
  pipe_reg #(CW, D_SWAP) reg_y (.clk_i, .d_i(y_s), .q_o(y));

  // Difference of exponents, and significands. The hidden bit is 1 unless the exponent is 0.
  logic [EW-1:0] ex_d, ey_d, hx_d, hy_d, e_d, n_d, n, e_a;
  logic [CW-1:0] xmag_d, xs_d, ys_d, sub_d, sign_d, inf_d, nan_d, xs_a, yl_a, sub_a, sign_a, inf_a, nan_a;
  always_comb begin
    xmag_d = x & MAG;
    ex_d = EW'(xmag_d >> MAN);
    ey_d = EW'((y & MAG) >> MAN);
    hx_d = hidden(ex_d);
    hy_d = hidden(ey_d);
    xs_d = ((x & FRAC) | (CW'(hx_d) << MAN)) << GUARD;
    ys_d = ((y & FRAC) | (CW'(hy_d) << MAN)) << GUARD;
    e_d = ex_d - hx_d;  // biased exponent less one
    n_d = at_most(e_d - (ey_d - hy_d));
    sub_d = neg((x ^ y) << (CW - 1 - EXP - MAN));
    sign_d = x & SIGN;
    inf_d = special(xmag_d);
    nan_d = is_nan(xmag_d) | (sub_d & special(y & MAG));
  end
  pipe_reg #(CW, D_DIFF) reg_xs_a (.clk_i, .d_i(xs_d), .q_o(xs_a));
  pipe_reg #(CW, D_DIFF) reg_yl_a (.clk_i, .d_i(ys_d), .q_o(yl_a));
  pipe_reg #(EW, D_DIFF) reg_n (.clk_i, .d_i(n_d), .q_o(n));
  pipe_reg #(EW, D_DIFF) reg_e_a (.clk_i, .d_i(e_d), .q_o(e_a));
  pipe_reg #(CW, D_DIFF) reg_sub_a (.clk_i, .d_i(sub_d), .q_o(sub_a));
  pipe_reg #(CW, D_DIFF) reg_sign_a (.clk_i, .d_i(sign_d), .q_o(sign_a));
  pipe_reg #(CW, D_DIFF) reg_inf_a (.clk_i, .d_i(inf_d), .q_o(inf_a));
  pipe_reg #(CW, D_DIFF) reg_nan_a (.clk_i, .d_i(nan_d), .q_o(nan_a));

  // Align: y is shifted right. The sticky bit keeps whether a lost bit was 1.
  logic [CW-1:0] ys_a, xs, ys, sub, sign_al, inf_al, nan_al;
  logic [EW-1:0] e_al;
  assign ys_a = (yl_a >> n[AB-1:0]) | (lost(yl_a, n[AB-1:0]) & ONE);
  pipe_reg #(CW, D_ALIGN) reg_xs (.clk_i, .d_i(xs_a), .q_o(xs));
  pipe_reg #(CW, D_ALIGN) reg_ys (.clk_i, .d_i(ys_a), .q_o(ys));
  pipe_reg #(EW, D_ALIGN) reg_e_al (.clk_i, .d_i(e_a), .q_o(e_al));
  pipe_reg #(CW, D_ALIGN) reg_sub (.clk_i, .d_i(sub_a), .q_o(sub));
  pipe_reg #(CW, D_ALIGN) reg_sign_al (.clk_i, .d_i(sign_a), .q_o(sign_al));
  pipe_reg #(CW, D_ALIGN) reg_inf_al (.clk_i, .d_i(inf_a), .q_o(inf_al));
  pipe_reg #(CW, D_ALIGN) reg_nan_al (.clk_i, .d_i(nan_a), .q_o(nan_al));

  // Add. In gates, the +1 of the two's complement enters as the carry of a bit below the lowest.
  logic [CW-1:0] sum_s, sum, sub_sum, sign_sum, inf_sum, nan_sum;
  logic [EW-1:0] e_sum;
  if (LEAST) begin : g_carry_in
    logic [CW:0] sum_2;
    assign sum_2 = {xs, 1'b1} + {ys ^ sub, sub[0]};
    assign sum_s = sum_2[CW:1];
    logic unused_low;
    assign unused_low = sum_2[0];
  end else begin : g_negative
    assign sum_s = xs + ((ys ^ sub) - sub);
  end
  pipe_reg #(CW, D_SUM) reg_sum (.clk_i, .d_i(sum_s), .q_o(sum));
  pipe_reg #(EW, D_SUM) reg_e_sum (.clk_i, .d_i(e_al), .q_o(e_sum));
  pipe_reg #(CW, D_SUM) reg_sub_sum (.clk_i, .d_i(sub), .q_o(sub_sum));
  pipe_reg #(CW, D_SUM) reg_sign_sum (.clk_i, .d_i(sign_al), .q_o(sign_sum));
  pipe_reg #(CW, D_SUM) reg_inf_sum (.clk_i, .d_i(inf_al), .q_o(inf_sum));
  pipe_reg #(CW, D_SUM) reg_nan_sum (.clk_i, .d_i(nan_al), .q_o(nan_sum));

  // Count the zeros to shift out: 0 after a carry, and never more than the exponent allows.
  // An exact zero has the sign of both operands if they agree, else it is +0.
  logic [EW-1:0] lim_c, e_c;
  logic [CW-1:0] k_c, k, sum_c, zero_c, zero_n, sign_c, sign_n, inf_c, nan_c;
  assign lim_c = e_sum + E_ONE;
  if (LEAST) begin : g_stop
    // A one at the place where the exponent is used up ends the count.
    logic [CW-1:0] stop_c;
    assign stop_c = ((ONE << (CW - 1)) >> lim_c[AB-1:0]) & ~{CW{|(lim_c >> AB)}};
    assign k_c = lzc((sum << (CW - 1 - CARRY)) | stop_c);
  end else begin : g_limit
    logic [CW-1:0] n_c;
    assign n_c = lzc(sum << (CW - 1 - CARRY));
    assign k_c = sel(neg(CW'(lim_c) - n_c), CW'(lim_c), n_c);
  end
  assign zero_c = ~some(sum);
  assign sign_c = sign_sum & ~(zero_c & sub_sum);
  pipe_reg #(CW, D_COUNT) reg_k (.clk_i, .d_i(k_c), .q_o(k));
  pipe_reg #(CW, D_COUNT) reg_sum_c (.clk_i, .d_i(sum), .q_o(sum_c));
  pipe_reg #(CW, D_COUNT) reg_zero_n (.clk_i, .d_i(zero_c), .q_o(zero_n));
  pipe_reg #(EW, D_COUNT) reg_e_c (.clk_i, .d_i(lim_c), .q_o(e_c));
  pipe_reg #(CW, D_COUNT) reg_sign_n (.clk_i, .d_i(sign_c), .q_o(sign_n));
  pipe_reg #(CW, D_COUNT) reg_inf_c (.clk_i, .d_i(inf_sum), .q_o(inf_c));
  pipe_reg #(CW, D_COUNT) reg_nan_c (.clk_i, .d_i(nan_sum), .q_o(nan_c));

  // Normalise: the hidden bit moves to CARRY. ef is the biased exponent less one, so adding the hidden bit completes
  // it.
  logic [CW-1:0] norm, zero, sign, inf, nan;
  logic [EW-1:0] ef;
  pipe_reg #(CW, D_SHIFT) reg_norm (.clk_i, .d_i(sum_c << k[AB-1:0]), .q_o(norm));
  pipe_reg #(EW, D_SHIFT) reg_ef (.clk_i, .d_i(e_c - EW'(k)), .q_o(ef));
  pipe_reg #(CW, D_SHIFT) reg_zero (.clk_i, .d_i(zero_n), .q_o(zero));
  pipe_reg #(CW, D_SHIFT) reg_sign (.clk_i, .d_i(sign_n), .q_o(sign));
  pipe_reg #(CW, D_SHIFT) reg_inf (.clk_i, .d_i(inf_c), .q_o(inf));
  pipe_reg #(CW, D_SHIFT) reg_nan (.clk_i, .d_i(nan_c), .q_o(nan));

  logic unused_bits;
  assign unused_bits = &{1'b0, n, k};

  // Round and pack.
  logic [CW-1:0] past, inexact;
  fp_pack #(.EXP(EXP), .MAN(MAN), .LEAST(LEAST), .DROP(GUARD + 1), .CUT(D_PACK)) pack (
      .clk_i, .norm_i(norm), .ef_i(ef), .sign_i(sign), .zero_i(zero), .inf_i(inf), .nan_i(nan), .r_o, .past_o(past),
      .inexact_o(inexact));

  // A sum is never both inexact and tiny: a sum below the normal range is exact.
  if (FLAGS) begin : g_flags
    logic [CW-1:0] nv_d, nv, specials, nx;
    assign nv_d = snan(x) | snan(y) | (~is_nan(xmag_d) & nan_d);
    pipe_reg #(CW, D_DIFF + D_ALIGN + D_SUM + D_COUNT + D_SHIFT + D_PACK) reg_nv (.clk_i, .d_i(nv_d), .q_o(nv));
    pipe_reg #(CW, D_PACK) reg_specials (.clk_i, .d_i(zero | inf | nan), .q_o(specials));
    always_comb begin
      nx = (inexact & ~specials) | past;
      flags_o = (nv & CW'(16)) | (past & CW'(4)) | (nx & ONE);
    end
  end else begin : g_no_flags
    logic unused_flags;
    assign unused_flags = &{1'b0, past, inexact};
    assign flags_o = '0;
  end
endmodule
