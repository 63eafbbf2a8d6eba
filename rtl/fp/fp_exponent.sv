// SPDX-License-Identifier: Apache-2.0
// Operations on the exponents of words, without arithmetic on significands. They scale a pair by a power of two.
// A shift is a number added to the bits of a word: k << MAN, in two's complement if negative.
//   EXPONENT_MAX   the larger exponent of a and b, in its place in the word.
//   EXPONENT_DOWN  the shift by 2^-k. k is the exponent of a, at least LEAST.
//   EXPONENT_UP    the shift by 2^k.
//   EXPONENT_MOVE  a shifted by b. A number below the normal range, before or after, becomes a zero of its sign.
//                  With KEEP, a normal number becomes the smallest normal number of its sign instead.
// Latency: 0.
// Throughput: one result per lane per cycle.
// Stall: none.
module fp_exponent #(
    parameter int EXP = 8,
    parameter int MAN = 23,
    parameter int LANES = 1,
    parameter int OP = formats_pkg::EXPONENT_MAX,
    parameter int LEAST = 0,
    parameter bit KEEP = 0,
    parameter ARITH = "rtl",
    localparam int CW = (1 + EXP + MAN <= 32) ? 32 : 64
) (
    input logic en_i,  // 0: no reader uses the result, so host arithmetic may skip it
    input logic [LANES-1:0][CW-1:0] a_i,
    input logic [LANES-1:0][CW-1:0] b_i,  // used by EXPONENT_MAX and EXPONENT_MOVE
    output logic [LANES-1:0][CW-1:0] r_o
);
  /*verilator inline_module*/
  if (OP < 0 || OP > formats_pkg::EXPONENT_MOVE) $error("fp_exponent: OP must be one of formats_pkg::EXPONENT_*");
  localparam int BIAS = (1 << (EXP - 1)) - 1;
  localparam int STORED = LEAST + BIAS;
  logic [LANES-1:0][CW-1:0] r;
  logic unused;  // most bits of a word are not its exponent
  assign unused = &{1'b0, a_i, b_i};
`ifdef VERILATOR
  if (ARITH != "rtl" && CW == 32) begin : g_32
    always_comb begin
      r = '0;
      if (en_i)
        for (int l = 0; l < LANES; l++)
        if (OP == formats_pkg::EXPONENT_DOWN || OP == formats_pkg::EXPONENT_UP) r[l] =
            $c32("host_fp::shift<", OP, ",", EXP, ",", MAN, ",", STORED, ">(", a_i[l], ")");
        else r[l] = $c32("host_fp::exponent<", OP, ",", EXP, ",", MAN, ",", 32'(KEEP), ">(", a_i[l], ",", b_i[l], ")");
    end
  end else
`endif
  if (1) begin : g_gates
    logic unused_en;
    assign unused_en = en_i;
    // Signed exponents in EW bits: a sum of two, and one less, fits, or wraps as it does in a word.
    localparam int EW = (CW - MAN < EXP + 2) ? CW - MAN : EXP + 2;
    localparam logic [CW-1:0] FRACTION = (CW'(1) << MAN) - 1;
    localparam logic [CW-1:0] SIGN = CW'(1) << (EXP + MAN);
    function automatic logic signed [EW-1:0] larger(input logic signed [EW-1:0] a, input logic signed [EW-1:0] b);
      larger = b ^ ((a ^ b) & negative(b - a));
    endfunction
    function automatic logic signed [EW-1:0] negative(input logic signed [EW-1:0] v);  // sign as a mask
      negative = {EW{v[EW-1]}};
    endfunction
    function automatic logic [CW-1:0] in_place(input logic signed [EW-1:0] v);  // with its sign
      in_place = CW'(v) << MAN;
    endfunction
    for (genvar l = 0; l < LANES; l++) begin : g_lane
      logic [EW-1:0] ea;
      assign ea = EW'(a_i[l][MAN+:EXP]);
      if (OP == formats_pkg::EXPONENT_MAX) begin : g_max
        assign r[l] = in_place(larger(ea, EW'(b_i[l][MAN+:EXP])));
      end else if (OP == formats_pkg::EXPONENT_DOWN) begin : g_down
        assign r[l] = in_place(EW'(BIAS) - larger(ea, EW'(STORED)));
      end else if (OP == formats_pkg::EXPONENT_UP) begin : g_up
        assign r[l] = in_place(larger(ea, EW'(STORED)) - EW'(BIAS));
      end else begin : g_move
        logic [EW-1:0] moved;
        logic below;  // below the normal numbers, before or after
        logic [CW-1:0] least;
        assign moved = ea + b_i[l][MAN+:EW];
        assign below = &(negative(ea - EW'(1)) | negative(moved - EW'(1)));
        assign least = KEEP ? CW'(below && ea != 0) << MAN : '0;
        assign r[l] = (((CW'(moved[EXP-1:0]) << MAN) | (a_i[l] & FRACTION)) & ~{CW{below}}) | (a_i[l] & SIGN) | least;
      end
    end
  end
  assign r_o = r;
endmodule
