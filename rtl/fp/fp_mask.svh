// SPDX-License-Identifier: Apache-2.0
// Words and helpers that every lane module shares; include inside a module with parameters EXP, MAN, LEAST, CW and EW.
// CW is the word of a lane, EW that of an exponent on its way (formats_pkg::lane_word, lane_exponent). With LEAST = 0,
// for simulation, both are the format's container, but 64 bits from 24 fraction bits on: in 32 bits there is then no
// room for the carry, guard and sticky bits beside the significand, nor for exponents past the largest. With LEAST = 1,
// for synthesis, they are as narrow as the format allows. The bits of all results are the same.
// The masked style: a condition is a word of all ones or all zeros, made from the sign bit of a subtraction, and a
// choice is a select by mask. Nothing branches and nothing is narrower than a lane, so that a simulator's compiler can
// turn lanes into vector code; in gates the masks fold to one bit. Where gates want another form than that (a tree of
// ORs, not the carry of a subtraction), a helper has two bodies.
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
  localparam logic unused_constants = (&{FRAC, EMAX, QNAN, E_SHIFT_MAX}) & E_ONE[0];  // not every module uses each

  // All ones if v is negative. neg(a - b) is a < b as long as the difference fits.
  function automatic [CW-1:0] neg(input [CW-1:0] v);
    neg = {CW{v[CW-1]}};
  endfunction
  function automatic [EW-1:0] negative(input [EW-1:0] e);
    negative = {EW{e[EW-1]}};
  endfunction

  // All ones if v is not zero; v must not have its top bit set unless it is the only one.
  function automatic [CW-1:0] some(input [CW-1:0] v);
    if (LEAST) some = {CW{|v}};
    else some = neg(ONE - ONE - v);
  endfunction

  function automatic [CW-1:0] sel(input [CW-1:0] m, input [CW-1:0] t, input [CW-1:0] f);
    sel = f ^ ((f ^ t) & m);
  endfunction

  // Masks of a magnitude: infinity or a NaN, a NaN; of a word: a signalling NaN.
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

  // The hidden bit, 1 unless the exponent e, as it stands in a word, is 0.
  function automatic [EW-1:0] hidden(input [EW-1:0] e);
    if (LEAST) hidden = {{EW - 1{1'b0}}, |e};
    else hidden = (e + EW'(EMAX)) >> EXP;
  endfunction

  // A shift amount n >= 0 that is too large becomes the largest.
  function automatic [EW-1:0] at_most(input [EW-1:0] n);
    if (LEAST) at_most = (n | {EW{|(n >> AB)}}) & E_SHIFT_MAX;
    else at_most = (n | negative(E_SHIFT_MAX - n)) & E_SHIFT_MAX;
  endfunction

  // Whether v >> n loses a bit that is 1.
  function automatic [CW-1:0] lost(input [CW-1:0] v, input [AB-1:0] n);
    lost = some(v & ~(~(ONE - ONE) << n));
  endfunction

  // Leading zeros of v, 2^AB - 1 of zero. In gates a tree: the higher half counts unless it is zero.
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
