// SPDX-License-Identifier: Apache-2.0
// One evaluation of a cylinder pair (reference/pipes/cylinder/evaluator.hpp), for a unit normal n and for -n. It gives
// the signed distance g of the projections of A and B, and a point y of B - A with n.y = g. It also gives the
// cylinders' rims and A's support point. All positions are relative to A's origin.
// Operators (cylinder): 46 add, 56 mul, 2 div, 2 sqrt, 2 compare.
// Operators (box): 46 add, 39 mul, 1 div, 1 sqrt, 1 compare.
// Operators (triangle): 36 add, 36 mul, 1 div, 1 sqrt, 5 compare, 4 min/max.
// Latency: LATENCY_EVALUATOR cycles; 0 with ARITH = "host".
// Throughput: one evaluation per lane per cycle.
// Stall: none, runs free.
`include "cylinder.svh"
module cylinder_evaluator #(
    `DF_PARAMETERS,
    parameter int BODY = `BODY_CYLINDER
) (
    input logic clk_i,
    input logic off_a_i,  // that rim counts as the centre of its cap
    input logic off_b_i,
    input logic [2:0][LANES-1:0][CW-1:0] n_i,
    input logic [2:0][LANES-1:0][CW-1:0] a_i,  // the primary cylinder: axis, radius
    input logic [LANES-1:0][CW-1:0] radius_i,
    input logic [2:0][2:0][LANES-1:0][CW-1:0] reach_i,
    input logic [2:0][LANES-1:0][CW-1:0] d_i,  // centre of B
    input logic [2:0][LANES-1:0][CW-1:0] b_i,  // B: axis, half height times axis, half height, radius
    input logic [2:0][LANES-1:0][CW-1:0] b_reach_i,
    input logic [LANES-1:0][CW-1:0] b_half_i,
    input logic [LANES-1:0][CW-1:0] b_radius_i,
    output logic [LANES-1:0][CW-1:0] plus_g_o,
    output logic [2:0][LANES-1:0][CW-1:0] plus_y_o,
    output logic [LANES-1:0][CW-1:0] minus_g_o,
    output logic [2:0][LANES-1:0][CW-1:0] minus_y_o,
    output logic [LANES-1:0][CW-1:0] a_kappa_o,  // 0 where A has no rim
    output logic [2:0][LANES-1:0][CW-1:0] a_v_o,
    output logic [2:0][LANES-1:0][CW-1:0] a_side_o,
    output logic [LANES-1:0][CW-1:0] b_kappa_o,
    output logic [2:0][LANES-1:0][CW-1:0] b_v_o,
    output logic [2:0][LANES-1:0][CW-1:0] b_side_o,
    output logic [LANES-1:0][CW-1:0] b_along_o,  // dot product b.n
    output logic [2:0][LANES-1:0][CW-1:0] pa_o  // support point of A
);
  /*verilator inline_module*/
  `DF_VIN(n, n_i, 0)
  `DF_VIN(d, d_i, 0)
  `DF_VIN(b, b_i, 0)
  `DF_VIN(b_reach, b_reach_i, 0)
  `DF_IN(b_half, b_half_i, 0)

  // ---- The primary ----
  localparam int T_a_kappa = `LATENCY_RIM, T_a_v = `LATENCY_RIM, T_a_side = `LATENCY_RIM;
  `DF_SCALAR a_width, a_kappa;
  `DF_VECTOR a_side, a_v;
  if (BODY == `BODY_CYLINDER) begin : g_rim
    `DF_VIN(axis, a_i, 0)
    `DF_RIM(rim, axis, radius_i, n, off_a_i)
    assign {a_width, a_side, a_kappa, a_v} = {rim_width, rim_side, rim_kappa, rim_v};
  end else begin : g_no_rim
    logic unused;
    assign unused = &{1'b0, a_i, radius_i, off_a_i};
    assign {a_width, a_side, a_kappa, a_v} = '0;
  end
  localparam int T_high = `LATENCY_REACH, T_low = `LATENCY_REACH, T_at_high = `LATENCY_REACH, T_at_low = `LATENCY_REACH;
  `DF_SCALAR high, low;
  `DF_VECTOR at_high, at_low;
  cylinder_reach #(`DF_SAME, .BODY(BODY)) reach (
      .clk_i, .n_i, .reach_i, .width_i(a_width), .side_i(a_side), .high_o(high), .low_o(low), .at_high_o(at_high),
      .at_low_o(at_low));

  // ---- B ----
  `DF_RIM(b, b, b_radius_i, n, off_b_i)
  `DF_DOT(along, b, n)
  `DF_ABS(along_size, along)
  `DF_MUL(axial, along_size, b_half)
  `DF_ADD(half, axial, b_width)
  `DF_VFLIP(b_end, along, b_reach)
  `DF_VADD(pb, b_end, b_side)

  // ---- Both orientations ----
  `DF_DOT(centre, d, n)
  `DF_SUB(above, centre, high)
  `DF_SUB(plus_g, above, half)
  `DF_SUB(below, low, centre)
  `DF_SUB(minus_g, below, half)
  `DF_VSUB(from_high, d, at_high)
  `DF_VSUB(plus_y, from_high, pb)
  `DF_VSUB(from_low, d, at_low)
  `DF_VADD(minus_y, from_low, pb)

  localparam int T_END = `LATENCY_EVALUATOR;
  `DF_AT(plus_g_end, plus_g, T_END)
  `DF_VAT(plus_y_end, plus_y, T_END)
  `DF_AT(minus_g_end, minus_g, T_END)
  `DF_VAT(minus_y_end, minus_y, T_END)
  `DF_AT(a_kappa_end, a_kappa, T_END)
  `DF_VAT(a_v_end, a_v, T_END)
  `DF_VAT(a_side_end, a_side, T_END)
  `DF_AT(b_kappa_end, b_kappa, T_END)
  `DF_VAT(b_v_end, b_v, T_END)
  `DF_VAT(b_side_end, b_side, T_END)
  `DF_AT(along_end, along, T_END)
  `DF_VAT(pa_end, at_high, T_END)
  assign {plus_g_o, plus_y_o, minus_g_o, minus_y_o} = {plus_g_end, plus_y_end, minus_g_end, minus_y_end};
  assign {a_kappa_o, a_v_o, a_side_o} = {a_kappa_end, a_v_end, a_side_end};
  assign {b_kappa_o, b_v_o, b_side_o, b_along_o, pa_o} = {b_kappa_end, b_v_end, b_side_end, along_end, pa_end};
endmodule
