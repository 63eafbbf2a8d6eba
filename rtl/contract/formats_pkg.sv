// SPDX-License-Identifier: Apache-2.0
// Number formats, and the codes of operations on them. rtl/fp, rtl/vector and rtl/pipes share them with
// host/include/cde/contract/formats.hpp. A format has `exp` exponent bits and `man` fraction bits. A word is in a
// container of 32 or 64 bits.
package formats_pkg;

  // ---- Operations (parameter OP of fp_lanes and of modules built on it; index of their clock in fp_unit) ----
  localparam int FP_ADD = 0;
  localparam int FP_SUB = 1;
  localparam int FP_MUL = 2;
  localparam int FP_DIV = 3;
  localparam int FP_SQRT = 4;  // square root of a
  localparam int FP_LT = 5;    // comparisons give all ones or all zeros; lt and le signal a quiet NaN, eq does not
  localparam int FP_LE = 6;
  localparam int FP_EQ = 7;
  localparam int FP_MIN = 8;
  localparam int FP_MAX = 9;
  localparam int FP_ARITHMETIC = 10;  // number of the operations above; conversions follow
  localparam int FP_TO_FORMAT = 10;   // FP_TO_FORMAT + k: to format k of FORMAT_*
  localparam int FP_FROM_I32 = 18;
  localparam int FP_FROM_UI32 = 19;
  localparam int FP_FROM_I64 = 20;
  localparam int FP_FROM_UI64 = 21;
  localparam int FP_TO_I32 = 22;  // to nearest even
  localparam int FP_TO_UI32 = 23;
  localparam int FP_TO_I64 = 24;
  localparam int FP_TO_UI64 = 25;
  localparam int FP_TO_I32_TRUNC = 26;  // toward zero
  localparam int FP_TO_UI32_TRUNC = 27;
  localparam int FP_TO_I64_TRUNC = 28;
  localparam int FP_TO_UI64_TRUNC = 29;
  localparam int FP_OPS = 30;

  // Kinds of conversions (parameter KIND of fp_convert).
  localparam int CONVERT_FORMAT = 0;
  localparam int CONVERT_FROM_INT = 1;
  localparam int CONVERT_TO_INT = 2;

  // ---- Operations on bits, without arithmetic ----
  localparam int SIGN_ABS = 0;   // of fp_sign: |a|
  localparam int SIGN_NEG = 1;   // -a
  localparam int SIGN_COPY = 2;  // |a| with the sign of b
  localparam int SIGN_XOR = 3;   // a times the sign of b
  localparam int CLASS_FINITE = 0;    // of fp_class
  localparam int CLASS_NAN = 1;
  localparam int CLASS_POSITIVE = 2;  // a number above zero, or +inf
  localparam int CLASS_NONZERO = 3;
  localparam int EXPONENT_MAX = 0;   // of fp_exponent: the larger exponent, in place
  localparam int EXPONENT_DOWN = 1;  // the shift by 2^-k, k the exponent of a
  localparam int EXPONENT_UP = 2;    // the shift by 2^k
  localparam int EXPONENT_MOVE = 3;  // a shifted by b
  localparam int WIRE_SIGN = 0;  // of df_wire: a times the sign of b
  localparam int WIRE_AND = 1;   // of masks
  localparam int WIRE_OR = 2;
  localparam int WIRE_XOR = 3;

  // ---- Exceptions, bit numbers ----
  localparam int FLAG_INEXACT = 0;
  localparam int FLAG_UNDERFLOW = 1;
  localparam int FLAG_OVERFLOW = 2;
  localparam int FLAG_DIVIDE_BY_ZERO = 3;
  localparam int FLAG_INVALID = 4;

  // ---- Formats with names, in the order of their conversions ----
  localparam int FORMAT_FP16 = 0;
  localparam int FORMAT_BF16 = 1;
  localparam int FORMAT_TF32 = 2;
  localparam int FORMAT_FP24 = 3;
  localparam int FORMAT_FP32 = 4;
  localparam int FORMAT_FP64 = 5;
  localparam int FORMAT_E4M3 = 6;
  localparam int FORMAT_E3M2 = 7;
  localparam int FORMATS = 8;
  localparam logic [0:6*FORMATS-1] FORMAT_EXPS = {6'd5, 6'd8, 6'd8, 6'd7, 6'd8, 6'd11, 6'd4, 6'd3};
  localparam logic [0:6*FORMATS-1] FORMAT_MANS = {6'd10, 6'd7, 6'd10, 6'd16, 6'd23, 6'd52, 6'd3, 6'd2};

  function automatic int format_exp(input int format);
    format_exp = int'(FORMAT_EXPS[6*format+:6]);
  endfunction
  function automatic int format_man(input int format);
    format_man = int'(FORMAT_MANS[6*format+:6]);
  endfunction
  function automatic int container(input int exp, input int man);  // bits of the word that holds one
    container = (1 + exp + man <= 32) ? 32 : 64;
  endfunction
`ifdef SYNTHESIS
  localparam bit LEAST_WORDS = 1;  // default width of gate lanes
`else
  localparam bit LEAST_WORDS = 0;
`endif
  // Bits of a gate lane's word (rtl/fp/fp_mask.svh). In simulation, the lane width of a vector register. The least
  // width holds the word and its sign, and a significand with carry, hidden, guard, round and sticky bits.
  function automatic int lane_word(input int exp, input int man, input bit least);
    lane_word = least ? larger(1 + exp + man, man + 6) : (1 + exp + man <= 32 && man <= 23) ? 32 : 64;
  endfunction
  // Bits of an exponent in a datapath, in two's complement. The least width holds the exponents of all products and
  // quotients.
  function automatic int lane_exponent(input int exp, input int man, input bit least);
    lane_exponent = least ? $clog2(3 * (1 << (exp - 1)) + 2 * man + 4) + 1 : lane_word(exp, man, least);
  endfunction
  // Bit of weight 2 in a significand to round: the top, or the least that leaves guard and sticky bits below.
  function automatic int round_top(input int exp, input int man, input bit least);
    round_top = least ? man + 3 : lane_word(exp, man, least) - 1;
  endfunction
  // Number of a lane's cuts at one of the possible places, spread as evenly as possible.
  function automatic int cuts_at(input int cuts, input int places, input int place);
    cuts_at = ((place + 1) * cuts + places / 2) / places - (place * cuts + places / 2) / places;
  endfunction
  function automatic logic [63:0] infinity(input int exp, input int man);
    infinity = ((64'd1 << exp) - 1) << man;
  endfunction
  function automatic logic [63:0] quiet_nan(input int exp, input int man);  // the canonical NaN
    quiet_nan = infinity(exp, man) | (64'd1 << (man - 1));
  endfunction
  function automatic logic [63:0] sign_bit(input int exp, input int man);
    sign_bit = 64'd1 << (exp + man);
  endfunction
  // the word of 2^e; 0 if it underflows
  function automatic logic [63:0] power_of_two(input int exp, input int man, input int e);
    int biased;
    biased = (1 << (exp - 1)) - 1 + e;
    power_of_two = (biased > 0) ? 64'(biased) << man : (biased + man > 0) ? 64'd1 << (biased + man - 1) : 64'd0;
  endfunction

  // The input contract's range of lengths, as exponents of two. Coordinates and sizes are at most 2^length_high. Sizes
  // and the largest component of a ray's direction are at least 2^length_low. host/include/cde/geometry/check.hpp gives
  // the reason.
  function automatic int length_high(input int exp);
    length_high = (exp < 8) ? ((1 << (exp - 1)) - 2) / 2 : ((1 << (exp - 1)) - 8) / 3;
  endfunction
  function automatic int length_low(input int exp, input int man);
    length_low = (exp < 8) ? -length_high(exp) : -(((1 << (exp - 1)) - 3 - man) / 3);
  endfunction

  // ---- Stage times ----
  function automatic int larger(input int a, input int b);
    larger = (a > b) ? a : b;
  endfunction
endpackage
