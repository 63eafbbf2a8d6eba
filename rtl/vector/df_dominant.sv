// SPDX-License-Identifier: Apache-2.0
// Dominant axis of a datapath (dataflow.svh): the largest component by magnitude, ties to the lowest index.
// Two masks say which: z if m_o[1], else y if m_o[0], else x. A NaN never dominates. 2 compare.
// Latency: 2*LAT.cmp cycles; 0 with ARITH = "host".
// Throughput: one result per lane per cycle.
// Stall: none.
`include "dataflow.svh"
module df_dominant #(
    parameter int EXP = 8,
    parameter int MAN = 23,
    parameter int LANES = 1,
    parameter latency_pkg::latency_t LAT = latency_pkg::ONES,
    parameter ARITH = "rtl",
    localparam int CW = (1 + EXP + MAN <= 32) ? 32 : 64
) (
    input logic clk_i,
    input logic [2:0][LANES-1:0][CW-1:0] a_i,
    output logic [1:0][LANES-1:0][CW-1:0] m_o
);
  /*verilator inline_module*/
  `DF_VIN(a, a_i, 0)
  `DF_VABS(size, a)
  `DF_PICK(x, size, 0)
  `DF_PICK(y, size, 1)
  `DF_PICK(z, size, 2)
  `DF_LT(y_over_x, x, y)
  `DF_SELECT(larger, y_over_x, y, x)
  `DF_LT(z_over_both, larger, z)
  `DF_AT(y_late, y_over_x, T_z_over_both)
  assign m_o = {z_over_both, y_late};
endmodule
