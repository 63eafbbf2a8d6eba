// SPDX-License-Identifier: Apache-2.0
// Words and helpers of all lane modules. Include this file in a module with parameters EXP, MAN, LEAST, CW and EW.
// CW is the word of a lane, EW the width of an exponent in a datapath (formats_pkg::lane_word, lane_exponent).
// LEAST = 0 is for simulation: both are the format's container, but 64 bits from 24 fraction bits on. In 32 bits the
// carry, guard and sticky bits would not fit beside the significand, nor would exponents past the largest.
// LEAST = 1 is for synthesis: both are as narrow as the format allows. Results are the same in every bit.
// The masked style: a condition is a word of all ones or all zeros, made from the sign bit of a subtraction. A choice
// is a select by mask. The code has no branch and no word narrower than a lane, so a simulator's compiler can vectorise
// the lanes. In gates, the masks fold to one bit. A helper has two bodies where gates need another form, such as a tree
// of ORs instead of a subtraction's carry.
  localparam int AB = $clog2(CW);  // bits of a shift amount
  localparam logic [CW-1:0] ONE = 1;
  localparam logic [CW-1:0] SHIFT_MAX = (ONE << AB) - 1;
  localparam logic [CW-1:0] SIGN = ONE << (EXP + MAN);
  localparam logic [CW-1:0] MAG = SIGN - 1;
  localparam logic [CW-1:0] FRAC = (ONE << MAN) - 1;
  localparam logic [CW-1:0] EMAX = (ONE << EXP) - 1;
  localparam logic [CW-1:0] INF = EMAX << MAN;
  localparam logic [CW-1:0] QUIET = ONE << (MAN - 1);
  localparam logic [CW-1:0] QNAN = INF | QUIET;
  localparam logic [EW-1:0] E_ONE = EW'(ONE);
  localparam logic [EW-1:0] E_SHIFT_MAX = EW'(SHIFT_MAX);
  // a module need not use all of them
  localparam logic unused_constants = (&{FRAC, EMAX, QNAN, E_SHIFT_MAX}) & E_ONE[0];

  // All ones if v is negative. neg(a - b) is a < b if the difference fits.
  function automatic [CW-1:0] neg(input [CW-1:0] v);
    neg = {CW{v[CW-1]}};
  endfunction
  function automatic [EW-1:0] negative(input [EW-1:0] e);
    negative = {EW{e[EW-1]}};
  endfunction

  // All ones if v is not zero. The top bit of v may be set only if it is the only one.
  function automatic [CW-1:0] some(input [CW-1:0] v);
    if (LEAST) some = {CW{|v}};
    else some = neg(ONE - ONE - v);
  endfunction

  function automatic [CW-1:0] sel(input [CW-1:0] m, input [CW-1:0] t, input [CW-1:0] f);
    sel = f ^ ((f ^ t) & m);
  endfunction

  // Masks of a magnitude: infinity or NaN; NaN. Mask of a word: signalling NaN.
  function automatic [CW-1:0] special(input [CW-1:0] mag);
    if (LEAST) special = {CW{(mag >> MAN) == EMAX}};
    else special = ~neg(mag - INF);
  endfunction
  function automatic [CW-1:0] is_nan(input [CW-1:0] mag);
    if (LEAST) is_nan = {CW{(mag >> MAN) == EMAX && (mag & FRAC) != ONE - ONE}};
    else is_nan = neg(INF - mag);
  endfunction
  function automatic [CW-1:0] snan(input [CW-1:0] v);
    snan = is_nan(v & MAG) & neg((v & QUIET) - ONE);
  endfunction

  // The hidden bit: 1 unless the stored exponent e is 0.
  function automatic [EW-1:0] hidden(input [EW-1:0] e);
    if (LEAST) hidden = {{EW - 1{1'b0}}, |e};
    else hidden = (e + EW'(EMAX)) >> EXP;
  endfunction

  // Limits a shift amount n >= 0 to the largest that AB bits hold.
  function automatic [EW-1:0] at_most(input [EW-1:0] n);
    if (LEAST) at_most = (n | {EW{|(n >> AB)}}) & E_SHIFT_MAX;
    else at_most = (n | negative(E_SHIFT_MAX - n)) & E_SHIFT_MAX;
  endfunction

  // Mask: v >> n loses a bit that is 1.
  function automatic [CW-1:0] lost(input [CW-1:0] v, input [AB-1:0] n);
    lost = some(v & ~(~(ONE - ONE) << n));
  endfunction

  // Leading zeros of v; 2^AB - 1 for zero. In gates a tree: the higher half counts unless it is zero.
  function automatic [CW-1:0] zeros_by_halves(input [CW-1:0] v);
    integer i, j;
    logic [(1<<AB)-1:0] zero;
    logic [(1<<AB)*AB-1:0] count;
    begin
      zero = '1;
      zero[(1<<AB)-1-:CW] = ~v;
      count = '0;
      for (i = 0; i < AB; i = i + 1)
        for (j = 0; j < (1 << AB) >> (i + 1); j = j + 1) begin
          count[j*AB+:AB] = zero[2*j+1] ? count[2*j*AB+:AB] | AB'(1 << i) : count[(2*j+1)*AB+:AB];
          zero[j] = zero[2*j+1] & zero[2*j];
        end
      zeros_by_halves = CW'(count[AB-1:0]);
    end
  endfunction
  function automatic [CW-1:0] lzc(input [CW-1:0] v);
    integer i;
    begin
      lzc = ONE - ONE;
      if (LEAST) lzc = zeros_by_halves(v);
      else
        for (i = CW / 2; i > 0; i = i / 2) lzc = lzc | (neg(((v << lzc[AB-1:0]) >> (CW - i)) - ONE) & CW'(i));
    end
  endfunction
