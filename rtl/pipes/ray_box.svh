// SPDX-License-Identifier: Apache-2.0
// Stage times of the box rule of ray and triangle (ray_box.sv), and its place in a pipe. In scope: BOX, B_LANES, LAT_*
// and the names that dataflow.svh needs. b_i has the triangles; if B_LANES is 1, all lanes share one.
`ifndef CDE_RAY_BOX_SVH
`define CDE_RAY_BOX_SVH
`include "pipe.svh"

// Outputs of triangle_bounds.sv for a triangle at stage time 0: centre and half size of its box.
`define RAY_T_CENTRE (2 * LAT.cmp + LAT.add + LAT.mul)
`define RAY_T_HALF (4 * LAT.cmp + 4 * LAT.add + 2 * LAT.mul)
// The rule on a point P = o + TD: stage times of P - c, of the distance outside, and of the decision.
`define RAY_T_AWAY(P) (`DF_MAX2(P, `RAY_T_CENTRE) + LAT.add)
`define RAY_T_OUT(P) (`DF_MAX2(`RAY_T_AWAY(P), `RAY_T_HALF) + LAT.add)
`define RAY_T_IN_BOX(TD, P) (`DF_MAX2(`RAY_T_OUT(P), TD + 2 * LAT.add + LAT.mul) + LAT.cmp)
// HIT = MET and, with BOX, P = o + TD is in the triangle's box.
`define RAY_BOX(HIT, MET, TD, P) \
  localparam int T_``HIT = (BOX != 0) ? `DF_MAX2(T_``MET, `RAY_T_IN_BOX(T_``TD, T_``P)) : T_``MET; \
  `DF_SCALAR HIT; \
  logic [8:0][B_LANES-1:0][CW-1:0] triangle_``HIT; \
  for (genvar k = 0; k < 9; k++) begin : triangle_of_``HIT assign triangle_``HIT[k] = b_i[k][B_LANES-1:0]; end \
  ray_box #(`DF_SAME, .B_LANES(B_LANES), .BOX(BOX), .T_MET(T_``MET), .T_TD(T_``TD), .T_P(T_``P)) box_``HIT ( \
      .clk_i, .b_i(triangle_``HIT), \
      .met_i(MET), .td_i(TD), .p_i(P), .hit_o(HIT));
`endif
