// SPDX-License-Identifier: Apache-2.0
// T at which a ray meets the nearer and farther planes of byte 0 of a node, per axis, and the T of one byte step.
// The reference is node_front() of reference/pipes/ray_node.hpp. Operators per node: 6 sub, 6 mul. The T of a step is
// an exponent, so it is exact.
// Latency: LAT.add + LAT.mul cycles.
// Throughput: LANES nodes per cycle.
// Stall: none, runs free.
`include "bvh.svh"
module node_planes #(
    `DF_PARAMETERS
) (
    input logic clk_i,
    input logic [8:0][LANES-1:0][CW-1:0] ray_i,     // from ray_front.sv
    input logic [2:0][LANES-1:0][CW-1:0] origin_i,  // of the node
    input logic [2:0][LANES-1:0][7:0] exponent_i,   // signed
    output logic [2:0][LANES-1:0][CW-1:0] near_o,
    output logic [2:0][LANES-1:0][CW-1:0] far_o,
    output logic [2:0][LANES-1:0][CW-1:0] unit_o
);
  /*verilator inline_module*/
  `DF_VIN(above, ray_i[2:0], 0)
  `DF_VIN(below, ray_i[5:3], 0)
  `DF_VIN(inverse, ray_i[8:6], 0)
  `DF_VIN(origin, origin_i, 0)
  logic [2:0][LANES-1:0][CW-1:0] sign, unit;
  for (genvar k = 0; k < 3; k++) begin : axis
    df_negative #(`DF_FORMAT) negative (.a_i(inverse[k]), .m_o(sign[k]));
    // Neither overflow nor underflow is possible: 2^-40 to 2^80 times 2^-80 to 2^40.
    for (genvar l = 0; l < LANES; l++) begin : lane
      assign unit[k][l] = inverse[k][l] + (CW'(signed'(exponent_i[k][l])) << MAN);
    end
  end
  `DF_VIN(negative, sign, 0)
  `DF_VIN(byte_t, unit, 0)
  `DF_VSUB(from_above, origin, above)
  `DF_VSUB(from_below, origin, below)
  `DF_VSELECT_EACH(near_offset, negative, from_below, from_above)
  `DF_VSELECT_EACH(far_offset, negative, from_above, from_below)
  `DF_VMUL(near, near_offset, inverse)
  `DF_VMUL(far, far_offset, inverse)
  `DF_VAT(unit_late, byte_t, T_near)
  assign near_o = near;
  assign far_o = far;
  assign unit_o = unit_late;
endmodule
