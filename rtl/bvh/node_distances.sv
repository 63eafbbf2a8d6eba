// SPDX-License-Identifier: Apache-2.0
// Distance key of a solid to each of a node's boxes (distance_key() of reference/pipes/solid_node.hpp). It is the
// squared distance of two boxes that are apart, else the largest distance on an axis. The inputs come from
// node_boxes.sv. The children are lanes. Operators per child: 3 mul, 2 add, 1 compare, 8 max.
// Latency: NODE_T_DISTANCES - NODE_T_AXES cycles (bvh.svh).
// Throughput: one node per cycle.
// Stall: none, runs free.
`include "bvh.svh"
module node_distances #(
    `DF_PARAMETERS
) (
    input logic clk_i,
    input logic [2:0][LANES-1:0][CW-1:0] above_i,
    input logic [2:0][LANES-1:0][CW-1:0] below_i,
    output logic [LANES-1:0][CW-1:0] key_o
);
  /*verilator inline_module*/
  `DF_VIN(above, above_i, 0)
  `DF_VIN(below, below_i, 0)
  `DF_CONST(zero, 0)
  `DF_VCONST(zeros, 0, 0, 0)
  `DF_VNEG(beyond, below)
  `DF_VMAX(distances, above, beyond)
  `DF_PICK(distance_x, distances, 0)
  `DF_PICK(distance_y, distances, 1)
  `DF_PICK(distance_z, distances, 2)
  `DF_MAX(distance_xy, distance_x, distance_y)
  `DF_MAX(widest, distance_xy, distance_z)
  `DF_LT(apart, zero, widest)
  `DF_VMAX(clamped, distances, zeros)
  `DF_DOT(square, clamped, clamped)
  `DF_SELECT(key, apart, square, widest)
  if (T_key != `NODE_T_DISTANCES - `NODE_T_AXES) $error("node_distances: NODE_T_DISTANCES does not match");
  assign key_o = key;
endmodule
