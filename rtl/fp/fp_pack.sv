// SPDX-License-Identifier: Apache-2.0
// Last step of a lane's rounding: round to nearest even | assemble the word of the result.
// Input norm_i has its hidden bit at MAN + DROP, and DROP bits below the last place; the lowest is sticky.
// Input ef_i is the biased exponent less one if the hidden bit is 1, else 0.
// The masks zero, infinity and NaN have rising priority.
// Output past_o is a mask: the result is, or rounds, past the largest number and is not special.
// Output inexact_o is a mask: bits were lost.
// Latency: CUT cycles, 0..1.
// Throughput: one result per cycle.
// Stall: none.
module fp_pack #(
    parameter int EXP   = 8,
    parameter int MAN   = 23,
    parameter bit LEAST = 0,
    parameter int DROP  = 7,  // >= 2
    parameter int CUT   = 0,
    localparam int CW   = formats_pkg::lane_word(EXP, MAN, LEAST),
    localparam int EW   = formats_pkg::lane_exponent(EXP, MAN, LEAST)
) (
    input  logic          clk_i,
    input  logic [CW-1:0] norm_i,
    input  logic [EW-1:0] ef_i,
    input  logic [CW-1:0] sign_i,
    input  logic [CW-1:0] zero_i,
    input  logic [CW-1:0] inf_i,
    input  logic [CW-1:0] nan_i,
    output logic [CW-1:0] r_o,
    output logic [CW-1:0] past_o,
    output logic [CW-1:0] inexact_o
);
  /*verilator inline_module*/
`include "fp_mask.svh"
  // The hidden bit completes the exponent. A rounding carry runs into the exponent, and overflow stops at infinity.
  logic [CW-1:0] over, sign, inf, nan, special_p, inexact_s;
  pipe_reg #(CW, CUT) reg_sign (.clk_i, .d_i(sign_i), .q_o(sign));
  pipe_reg #(CW, CUT) reg_inf (.clk_i, .d_i(inf_i), .q_o(inf));
  pipe_reg #(CW, CUT) reg_nan (.clk_i, .d_i(nan_i), .q_o(nan));
  pipe_reg #(CW, CUT) reg_special (.clk_i, .d_i(zero_i | inf_i | nan_i), .q_o(special_p));
  pipe_reg #(CW, CUT) reg_inexact (.clk_i, .d_i(inexact_s), .q_o(inexact_o));
  assign inexact_s = some(norm_i & ((ONE << DROP) - ONE));
  assign past_o = over & ~special_p;
  if (LEAST) begin : g_gates
    // Exponent and fraction share one carry chain.
    logic [EW+MAN-1:0] p_s, p;
    logic up_s;
    always_comb begin
      up_s = norm_i[DROP-1] & (norm_i[DROP] | (|norm_i[DROP-2:0]));
      p_s = {ef_i, norm_i[DROP+:MAN]} + {EW'(norm_i[DROP+MAN]), MAN'(up_s)};
      p_s = p_s & ~{EW + MAN{zero_i[0]}};
    end
    pipe_reg #(EW + MAN, CUT) reg_p (.clk_i, .d_i(p_s), .q_o(p));
    assign over = {CW{(&p[EXP+MAN-1:MAN]) | (|p[EW+MAN-1:EXP+MAN])}};
    assign r_o = sel(nan, QNAN, sign | sel(over | inf, INF, CW'(p[EXP+MAN-1:0])));
  end else begin : g_words
    localparam logic [CW-1:0] HALF = (ONE << (DROP - 1)) - 1;
    logic [CW-1:0] p_s, p;
    assign p_s = ((CW'(ef_i) << MAN) + ((norm_i + HALF + ((norm_i >> DROP) & ONE)) >> DROP)) & ~zero_i;
    pipe_reg #(CW, CUT) reg_p (.clk_i, .d_i(p_s), .q_o(p));
    assign over = ~neg(p - INF);
    assign r_o = sel(nan, QNAN, sign | sel(neg(INF - p) | inf, INF, p));
  end
endmodule
