// SPDX-License-Identifier: Apache-2.0
// Unit vector of e_i x f: components -f_l / |.| and f_k / |.| on the next two axes, 0 on axis i. `inverse2` is
// 1 / |e_i x f|^2, or 0 if there is no normal; `valid` is a lane mask.
// Operators: 1 add, 5 mul, 1 div, 1 sqrt, 1 compare.
// Latency: LATENCY_EDGE_NORMAL cycles; 0 with ARITH = "host".
// Throughput: one normal per lane per cycle.
// Stall: none.
`include "convex.svh"
module edge_normal #(
    `DF_PARAMETERS
) (
    input logic clk_i,
    input logic [LANES-1:0][CW-1:0] f_k_i,
    input logic [LANES-1:0][CW-1:0] f_l_i,
    output logic [LANES-1:0][CW-1:0] n_k_o,
    output logic [LANES-1:0][CW-1:0] n_l_o,
    output logic [LANES-1:0][CW-1:0] inverse2_o,
    output logic [LANES-1:0][CW-1:0] valid_o
);
  /*verilator inline_module*/
  `DF_IN(f_k, f_k_i, 0)
  `DF_IN(f_l, f_l_i, 0)
  `DF_DOT2(squared, f_k, f_k, f_l, f_l)
  `DF_USABLE(valid, squared)
  `DF_SQRT(length, squared)
  `DF_RECIPROCAL_OR_ZERO(inverse, valid, length)
  `DF_MUL(minus_n_k, f_l, inverse)
  `DF_NEG(n_k, minus_n_k)
  `DF_MUL(n_l, f_k, inverse)
  `DF_MUL(inverse2, inverse, inverse)

  if (T_inverse2 != `LATENCY_EDGE_NORMAL) $error("edge_normal: latency");
  `DF_AT(valid_out, valid, T_inverse2)
  assign n_k_o = n_k;
  assign n_l_o = n_l;
  assign inverse2_o = inverse2;
  assign valid_o = valid_out;
endmodule
