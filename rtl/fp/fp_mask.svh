// SPDX-License-Identifier: Apache-2.0
// Words and helpers that every lane module shares; include inside a module with parameters EXP, MAN and CW.
// CW is the word of a lane: the format's container, but 64 bits from 24 fraction bits on. In 32 bits there is then no
// room for the carry, guard and sticky bits beside the significand, nor for exponents past the largest.
// The masked style: a condition is a word of all ones or all zeros, made from the sign bit of a subtraction, and a
// choice is a select by mask. Nothing branches and nothing is narrower than a lane, so that a simulator's compiler can
// turn lanes into vector code; in gates the masks fold to one bit.
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
  localparam logic unused_constants = &{SHIFT_MAX, FRAC, EMAX, QNAN};  // not every module uses each

  // All ones if v is negative. neg(a - b) is a < b as long as the difference fits.
  function automatic [CW-1:0] neg(input [CW-1:0] v);
    neg = {CW{v[CW-1]}};
  endfunction

  // All ones if v is not zero; v must not have its top bit set unless it is the only one.
  function automatic [CW-1:0] some(input [CW-1:0] v);
    some = neg(ONE - ONE - v);
  endfunction

  function automatic [CW-1:0] sel(input [CW-1:0] m, input [CW-1:0] t, input [CW-1:0] f);
    sel = f ^ ((f ^ t) & m);
  endfunction

  // Mask of a signalling NaN.
  function automatic [CW-1:0] snan(input [CW-1:0] v);
    snan = neg(INF - (v & MAG)) & neg((v & QUIET) - ONE);
  endfunction

  // Leading zeros of v, at most CW - 1.
  function automatic [CW-1:0] lzc(input [CW-1:0] v);
    integer i;
    begin
      lzc = ONE - ONE;
      for (i = CW / 2; i > 0; i = i / 2) lzc = lzc | (neg(((v << lzc[AB-1:0]) >> (CW - i)) - ONE) & CW'(i));
    end
  endfunction
