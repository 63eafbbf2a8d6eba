// SPDX-License-Identifier: Apache-2.0
// Hamming code of a word with an overall parity bit (SECDED). Data bit i has position secded_position(i): the numbers
// from 3 on, without powers of two. Check bit j is the parity of the data bits whose position has bit j. The last check
// bit is the parity of all other bits. All zeros is a code word.
`ifndef CDE_SECDED_SVH
`define CDE_SECDED_SVH
`define SECDED_BITS(W) ($clog2((W) + $clog2(W) + 1) + 1)
`define SECDED_FUNCTIONS(W) \
  function automatic int secded_position(input int i); \
    int left, p; \
    p = 2; \
    left = i + 1; \
    while (left > 0) begin \
      p = p + 1; \
      if ((p & (p - 1)) != 0) left = left - 1; \
    end \
    secded_position = p; \
  endfunction \
  function automatic [W-1:0] secded_mask(input int j); \
    for (int i = 0; i < W; i++) secded_mask[i] = ((secded_position(i) >> j) & 1) != 0; \
  endfunction
`endif
