// SPDX-License-Identifier: Apache-2.0
// Inside test of a ray against a triangle, on barycentric coordinates that sum to det. Inside: det is not 0 and no
// coordinate has the opposite sign. A NaN is outside. 4 compare.
// Latency: LAT.cmp cycles from det; 0 with ARITH = "host".
// Throughput: LANES pairs per cycle.
// Stall: none.
`include "dataflow.svh"
module same_side #(
    `DF_PARAMETERS,
    parameter int T_UVW = 0,  // stage times of the inputs
    parameter int T_DET = 0  // at least T_UVW
) (
    input logic clk_i,
    input logic [2:0][LANES-1:0][CW-1:0] uvw_i,
    input logic [LANES-1:0][CW-1:0] det_i,
    output logic [LANES-1:0][CW-1:0] inside_o  // lane mask
);
  /*verilator inline_module*/
  `DF_VIN(uvw, uvw_i, T_UVW)
  `DF_IN(det, det_i, T_DET)
  `DF_CONST(zero, 0)
  `DF_PICK(u, uvw, 0)
  `DF_PICK(v, uvw, 1)
  `DF_PICK(w, uvw, 2)
  `DF_MOVE_SIGN(u_s, det, u)
  `DF_MOVE_SIGN(v_s, det, v)
  `DF_MOVE_SIGN(w_s, det, w)
  `DF_ABS(size, det)
  `DF_LE(u_in, zero, u_s)
  `DF_LE(v_in, zero, v_s)
  `DF_LE(w_in, zero, w_s)
  `DF_LT(area, zero, size)
  assign inside_o = u_in & v_in & w_in & area;
endmodule
