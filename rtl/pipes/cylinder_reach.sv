// SPDX-License-Identifier: Apache-2.0
// Support points of the primary of a cylinder pair: the largest and the smallest n.x, relative to its origin, and
// where. Signs, and the choice of a vertex, are wires.
// Operators (cylinder): 3 mul, 6 add.
// Operators (box): 9 mul, 14 add.
// Operators (triangle): 6 mul, 4 add, 4 compare, 4 min/max.
// Latency: LATENCY_REACH cycles from n; the rim comes LATENCY_RIM after n; 0 with ARITH = "host".
// Throughput: one normal per lane per cycle.
// Stall: none.
`include "cylinder.svh"
module cylinder_reach #(
    `DF_PARAMETERS,
    parameter int BODY = `BODY_CYLINDER
) (
    input logic clk_i,
    input logic [2:0][LANES-1:0][CW-1:0] n_i,
    // cylinder: [0] is half height times axis; box: half extents times axes; triangle: v1 - v0, v2 - v0, unused
    input logic [2:0][2:0][LANES-1:0][CW-1:0] reach_i,
    input logic [LANES-1:0][CW-1:0] width_i,  // the cylinder's rim
    input logic [2:0][LANES-1:0][CW-1:0] side_i,
    output logic [LANES-1:0][CW-1:0] high_o,
    output logic [LANES-1:0][CW-1:0] low_o,
    output logic [2:0][LANES-1:0][CW-1:0] at_high_o,
    output logic [2:0][LANES-1:0][CW-1:0] at_low_o
);
  /*verilator inline_module*/
  if (BODY == `BODY_TRIANGLE) begin : g_triangle
    logic unused;
    assign unused = &{1'b0, reach_i[2], width_i, side_i};
    `DF_VIN(n, n_i, 0)
    `DF_VIN(e1, reach_i[0], 0)
    `DF_VIN(e2, reach_i[1], 0)
    `DF_CONST(zero, 0)
    `DF_VCONST(v0, 0, 0, 0)
    `DF_DOT(p0, n, e1)
    `DF_DOT(p1, n, e2)
    `DF_MAX(larger, p0, p1)
    `DF_MIN(smaller, p0, p1)
    `DF_LT(second, p0, p1)
    `DF_LT(third, p1, p0)
    `DF_LT(first, zero, larger)
    `DF_LT(last, smaller, zero)
    `DF_MAX(high, zero, larger)
    `DF_MIN(low, zero, smaller)
    `DF_VSELECT(high_edge, second, e2, e1)
    `DF_VSELECT(low_edge, third, e2, e1)
    `DF_VSELECT(at_high, first, high_edge, v0)
    `DF_VSELECT(at_low, last, low_edge, v0)
    `DF_AT(high_late, high, `LATENCY_REACH)
    `DF_AT(low_late, low, `LATENCY_REACH)
    `DF_VAT(at_high_late, at_high, `LATENCY_REACH)
    `DF_VAT(at_low_late, at_low, `LATENCY_REACH)
    assign {high_o, low_o, at_high_o, at_low_o} = {high_late, low_late, at_high_late, at_low_late};
  end else begin : g_symmetric
    localparam int T_at_all = `LATENCY_REACH, T_high_all = `LATENCY_REACH;
    `DF_VECTOR at_all;
    `DF_SCALAR high_all;
    `DF_VIN(n, n_i, 0)
    `DF_VIN(reach0, reach_i[0], 0)
    `DF_DOT(p0, n, reach0)
    `DF_VFLIP(end0, p0, reach0)
    `DF_ABS(size0, p0)
    if (BODY == `BODY_BOX) begin : g_box
      logic unused;
      assign unused = &{1'b0, width_i, side_i};
      `DF_VIN(reach1, reach_i[1], 0)
      `DF_VIN(reach2, reach_i[2], 0)
      `DF_DOT(p1, n, reach1)
      `DF_DOT(p2, n, reach2)
      `DF_VFLIP(end1, p1, reach1)
      `DF_VFLIP(end2, p2, reach2)
      `DF_ABS(size1, p1)
      `DF_ABS(size2, p2)
      `DF_ADD(size12, size1, size2)
      `DF_ADD(high, size0, size12)
      `DF_VADD(end12, end1, end2)
      `DF_VADD(at, end0, end12)
      `DF_AT(high_late, high, T_high_all)
      `DF_VAT(at_late, at, T_at_all)
      assign {high_all, at_all} = {high_late, at_late};
    end else begin : g_cylinder
      logic unused;
      assign unused = &{1'b0, reach_i[2:1]};
      `DF_IN(width, width_i, `LATENCY_RIM)
      `DF_VIN(side, side_i, `LATENCY_RIM)
      `DF_ADD(high, size0, width)
      `DF_VADD(at, end0, side)
      `DF_AT(high_late, high, T_high_all)
      `DF_VAT(at_late, at, T_at_all)
      assign {high_all, at_all} = {high_late, at_late};
    end
    `DF_NEG(low_all, high_all)
    `DF_VNEG(at_low_all, at_all)
    assign {high_o, low_o, at_high_o, at_low_o} = {high_all, low_all, at_all, at_low_all};
  end
endmodule
