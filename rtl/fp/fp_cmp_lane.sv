// SPDX-License-Identifier: Apache-2.0
// One lane of fp_cmp and fp_minmax. Combinational.
// Minimum and maximum are minimumNumber and maximumNumber of IEEE 754-2019. A NaN loses against a number, and -0 is
// below +0.
// Two NaNs give the canonical NaN. A signalling NaN raises NV.
module fp_cmp_lane #(
    parameter int OP    = formats_pkg::FP_LT,  // FP_LT to FP_MAX
    parameter int EXP   = 8,
    parameter int MAN   = 23,
    parameter bit LEAST = 0,
    parameter bit FLAGS = 0,
    localparam int CW   = formats_pkg::lane_word(EXP, MAN, LEAST),
    localparam int EW   = CW
) (
    input  logic [CW-1:0] a_i,
    input  logic [CW-1:0] b_i,
    output logic [CW-1:0] r_o,
    output logic [CW-1:0] flags_o
);
  /*verilator inline_module*/
`include "fp_mask.svh"
  logic [CW-1:0] am, bm, as, bs, below, above, same, less, a_nan, b_nan;
  always_comb begin
    am = a_i & MAG;
    bm = b_i & MAG;
    as = neg(a_i << (CW - 1 - EXP - MAN));
    bs = neg(b_i << (CW - 1 - EXP - MAN));
    below = neg(am - bm);
    above = neg(bm - am);
    less = sel(as, ~bs | above, below & ~bs);  // total order: -0 is below +0
    a_nan = is_nan(am);
    b_nan = is_nan(bm);
  end
  if (OP <= formats_pkg::FP_EQ) begin : g_compare
    always_comb begin
      same = ~(below | above | ((as ^ bs) & some(am)));
      if (OP == formats_pkg::FP_LT) r_o = less & ~same & ~(a_nan | b_nan);
      else if (OP == formats_pkg::FP_LE) r_o = (less | same) & ~(a_nan | b_nan);
      else r_o = same & ~(a_nan | b_nan);
    end
  end else begin : g_minmax
    always_comb begin
      same = (OP == formats_pkg::FP_MAX) ? ~less : less;
      r_o = sel(a_nan & b_nan, QNAN, sel((same | b_nan) & ~a_nan, a_i, b_i));
    end
  end
  if (FLAGS) begin : g_flags
    assign flags_o = ((OP <= formats_pkg::FP_LE) ? (a_nan | b_nan) : snan(a_i) | snan(b_i)) & (ONE << 4);
  end else begin : g_no_flags
    assign flags_o = '0;
  end
endmodule
