// SPDX-License-Identifier: Apache-2.0
// Largest distance along an axis from a point or box to the far end of the BVH root's box, from end to end of both.
// Operators: 6 sub, 5 max.
// Latency: RAY_T_REACH cycles (bvh.svh).
// Throughput: LANES results per cycle.
// Stall: none, runs free.
`include "bvh.svh"
module root_reach #(
    `DF_PARAMETERS
) (
    input logic clk_i,
    input logic [2:0][LANES-1:0][CW-1:0] low_i,  // both corners; for a point they are equal
    input logic [2:0][LANES-1:0][CW-1:0] high_i,
    input logic [5:0][LANES-1:0][CW-1:0] root_i,  // root: lower corner x y z, upper corner x y z
    output logic [LANES-1:0][CW-1:0] reach_o
);
  /*verilator inline_module*/
  `DF_VIN(low, low_i, 0)
  `DF_VIN(high, high_i, 0)
  `DF_VIN(lower, root_i[2:0], 0)
  `DF_VIN(upper, root_i[5:3], 0)
  `DF_VSUB(to_lower, lower, high)
  `DF_VSUB(to_upper, upper, low)
  `DF_VABS(from_lower, to_lower)
  `DF_VABS(from_upper, to_upper)
  `DF_VMAX(far, from_lower, from_upper)
  `DF_PICK(far_x, far, 0)
  `DF_PICK(far_y, far, 1)
  `DF_PICK(far_z, far, 2)
  `DF_MAX(far_xy, far_x, far_y)
  `DF_MAX(reach, far_xy, far_z)
  if (T_reach != `RAY_T_REACH) $error("root_reach: RAY_T_REACH does not match");
  assign reach_o = reach;
endmodule
