// SPDX-License-Identifier: Apache-2.0
// Raises a pipe's signed distance to the bound if it is below it (reference/pipes/distance_bound.hpp).
// Operators: 1 compare, 1 max.
// Latency: LAT.cmp cycles; 0 with ARITH = "host".
// Throughput: LANES pairs per cycle.
// Stall: none.
`include "distance_bound.svh"
module distance_at_least #(
    `DF_PARAMETERS
) (
    input logic clk_i,
    input logic [LANES-1:0][CW-1:0] bound_i,
    input logic [LANES-1:0][CW-1:0] f_i,  // lane mask
    input logic [LANES-1:0][CW-1:0] t_i,  // size of the signed distance
    input logic [2:0][LANES-1:0][CW-1:0] cp_i,
    input logic [2:0][LANES-1:0][CW-1:0] n_i,
    output logic [LANES-1:0][CW-1:0] f_o,
    output logic [LANES-1:0][CW-1:0] t_o,
    output logic [2:0][LANES-1:0][CW-1:0] cp_o,
    output logic [2:0][LANES-1:0][CW-1:0] n_o
);
  /*verilator inline_module*/
  localparam logic [CW-1:0] SIGN = CW'(formats_pkg::sign_bit(EXP, MAN));
  `DF_IN(bound, bound_i, 0)
  `DF_IN(s, t_i | (f_i & {LANES{SIGN}}), 0)
  `DF_IN(met, f_i, 0)
  `DF_VIN(cp, cp_i, 0)
  `DF_VIN(n, n_i, 0)
  `DF_CONST(zero, 0)
  `DF_MAX(raised, s, bound)
  `DF_LE(touches, bound, zero)
  `DF_AND(meets, met, touches)
  `DF_ABS(size, raised)
  `DF_VAT(cp_late, cp, LAT.cmp)
  `DF_VAT(n_late, n, LAT.cmp)
  assign {n_o, cp_o, t_o, f_o} = {n_late, cp_late, size, meets};
endmodule
