// SPDX-License-Identifier: Apache-2.0
// The configuration of a card as one structure: config.svh has its fields. And what follows from it in more than one
// module.
`include "config.svh"
package config_pkg;
  typedef struct packed {
    `CARD_FIELDS
  } config_t;
  localparam int FIFO_DEPTH = 128;  // rows of the output FIFO

  // The parameter ARITH of units.
  function automatic logic [31:0] arith(input int host);
    arith = (host != 0) ? "host" : {8'b0, "rtl"};
  endfunction
  // Clocks of a check of the input contract (shape_check.sv).
  function automatic int check_latency(input int lat_add, input int lat_mul, input int lat_cmp);
    check_latency = lat_mul + 3 * lat_add + lat_cmp;
  endfunction
  function automatic int index_bits(input int n);  // to tell n things apart, at least one
    index_bits = (n > 1) ? $clog2(n) : 1;
  endfunction
endpackage
