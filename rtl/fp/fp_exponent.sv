// SPDX-License-Identifier: Apache-2.0
// Work on the exponents of words, without arithmetic on their significands: how a pair is scaled by a power of two. A
// shift is a number that is added to the bits of a word: k << MAN, negative ones in two's complement.
//   EXPONENT_MAX  the larger of |a| and |b|, as bits
//   EXPONENT_DOWN the shift by 2^-k, k the exponent of a, at least LEAST
//   EXPONENT_UP   the shift by 2^k
//   EXPONENT_MOVE a shifted by b; what is below the normal numbers, before or after, becomes a zero of its sign
// Latency: 0. Throughput: one result a lane a clock. Stall: none.
module fp_exponent #(
    parameter int EXP = 8,
    parameter int MAN = 23,
    parameter int LANES = 1,
    parameter int OP = formats_pkg::EXPONENT_MAX,
    parameter int LEAST = 0,
    parameter ARITH = "rtl",
    localparam int CW = (1 + EXP + MAN <= 32) ? 32 : 64
) (
    input logic on_i,  // 0: nobody looks at the result of ARITH = "host"
    input logic [LANES-1:0][CW-1:0] a_i,
    input logic [LANES-1:0][CW-1:0] b_i,  // EXPONENT_MAX, EXPONENT_MOVE
    output logic [LANES-1:0][CW-1:0] r_o
);
  /*verilator inline_module*/
  if (OP < 0 || OP > formats_pkg::EXPONENT_MOVE) $error("fp_exponent: OP must be one of formats_pkg::EXPONENT_*");
  localparam int BIAS = (1 << (EXP - 1)) - 1;
  localparam int STORED = LEAST + BIAS;
  logic [LANES-1:0][CW-1:0] r;
  if (OP == formats_pkg::EXPONENT_DOWN || OP == formats_pkg::EXPONENT_UP) begin : g_one_operand
    logic unused_b;
    assign unused_b = &{1'b0, b_i};
  end
`ifdef VERILATOR
  if (ARITH != "rtl" && CW == 32) begin : g_32
    always_comb begin
      r = '0;
      if (on_i)
        for (int l = 0; l < LANES; l++)
        if (OP == formats_pkg::EXPONENT_DOWN || OP == formats_pkg::EXPONENT_UP) r[l] =
            $c32("host_fp::shift<", OP, ",", EXP, ",", MAN, ",", STORED, ">(", a_i[l], ")");
        else r[l] = $c32("host_fp::exponent<", OP, ",", EXP, ",", MAN, ">(", a_i[l], ",", b_i[l], ")");
    end
  end else
`endif
  if (1) begin : g_gates
    logic unused_on;
    assign unused_on = on_i;
    localparam logic [CW-1:0] SIGN = CW'(1) << (EXP + MAN);
    localparam logic [CW-1:0] INF = ((CW'(1) << EXP) - 1) << MAN;
    localparam logic [CW-1:0] NORMAL = CW'(1) << MAN;
    function automatic logic [CW-1:0] negative(input logic [CW-1:0] v);  // as a mask
      negative = {CW{v[CW-1]}};
    endfunction
    function automatic logic [CW-1:0] larger(input logic [CW-1:0] a, input logic [CW-1:0] b);  // both below the top bit
      larger = b ^ ((a ^ b) & negative(b - a));
    endfunction
    always_comb begin
      r = '0;
      for (int l = 0; l < LANES; l++)
        if (OP == formats_pkg::EXPONENT_MAX) r[l] = larger(a_i[l] & ~SIGN, b_i[l] & ~SIGN);
        else if (OP == formats_pkg::EXPONENT_DOWN) r[l] = (CW'(BIAS) << MAN) - larger(a_i[l] & INF, CW'(STORED) << MAN);
        else if (OP == formats_pkg::EXPONENT_UP) r[l] = larger(a_i[l] & INF, CW'(STORED) << MAN) - (CW'(BIAS) << MAN);
        else r[l] = (((a_i[l] & ~SIGN) + b_i[l]) & ~SIGN &
                     ~negative(((a_i[l] & ~SIGN) - NORMAL) | ((a_i[l] & ~SIGN) + b_i[l] - NORMAL))) | (a_i[l] & SIGN);
    end
  end
  assign r_o = r;
endmodule
