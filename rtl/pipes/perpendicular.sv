// SPDX-License-Identifier: Apache-2.0
// A vector made perpendicular to the edge f that it ends on: v - (v.f / f.f) f. The input 1 / f.f is 0 if v ends on no
// edge. 5 add, 7 mul.
// Latency: LATENCY_PERPENDICULAR cycles from the latest input; 0 with ARITH = "host".
// Throughput: one vector per lane per cycle.
// Stall: none.
`include "convex.svh"
module perpendicular #(
    `DF_PARAMETERS,
    parameter int T_V = 0,  // stage times of the inputs
    parameter int T_F = 0,
    parameter int T_INVERSE = 0
) (
    input logic clk_i,
    input logic [2:0][LANES-1:0][CW-1:0] v_i,
    input logic [2:0][LANES-1:0][CW-1:0] f_i,
    input logic [LANES-1:0][CW-1:0] inverse_ff_i,
    output logic [2:0][LANES-1:0][CW-1:0] r_o
);
  /*verilator inline_module*/
  `DF_VIN(v, v_i, T_V)
  `DF_VIN(f, f_i, T_F)
  `DF_IN(inverse_ff, inverse_ff_i, T_INVERSE)
  `DF_DOT(vf, v, f)
  `DF_MUL(along, vf, inverse_ff)
  `DF_VSCALE(part, f, along)
  `DF_VSUB(r, v, part)
  `DF_VAT(result, r, `DF_MAX3(T_V, T_F, T_INVERSE) + `LATENCY_PERPENDICULAR)
  assign r_o = result;
endmodule
