// SPDX-License-Identifier: Apache-2.0
// A ray and the eight boxes of a node: the T interval of the ray in each box (stretch() of
// reference/pipes/ray_node.hpp).
// The children are lanes. host/include/cde/bvh/node.hpp lists the node's words. Operators per node: see
// node_planes.sv. Operators per child: 6 mul, 6 add, 4 min/max; one factor of each product is a byte.
// Latency: NODE_T_BOXES cycles (bvh.svh).
// Throughput: one node per cycle.
// Stall: none, runs free.
`include "bvh.svh"
module node_boxes #(
    parameter int EXP = 8,
    parameter int MAN = 23,
    parameter latency_pkg::latency_t LAT = latency_pkg::ONES,
    parameter ARITH = "rtl",
    localparam int CHILDREN = 8,
    localparam int CW = 32
) (
    input logic clk_i,
    input logic [8:0][CW-1:0] ray_i,    // from ray_front.sv
    input logic [17:0][31:0] node_i,
    output logic [2:0][CHILDREN-1:0][CW-1:0] near_axis_o,  // per axis, at NODE_T_AXES
    output logic [2:0][CHILDREN-1:0][CW-1:0] far_axis_o,
    output logic [CHILDREN-1:0][CW-1:0] near_o,
    output logic [CHILDREN-1:0][CW-1:0] far_o
);
  /*verilator inline_module*/
  localparam int LANES = CHILDREN;
  localparam int T_PLANES = LAT.add + LAT.mul;
  if (EXP != 8 || MAN != 23) $error("node_boxes: the format must be fp32");

  logic unused;  // kinds and places of the children
  assign unused = &{1'b0, node_i[5:4], node_i[3][31:24]};

  // ---- Per node ----
  logic [2:0][CW-1:0] near_0, far_0, byte_t, sign_t;
  logic [2:0][0:0][7:0] exponent;
  assign exponent = {node_i[3][23:16], node_i[3][15:8], node_i[3][7:0]};
  node_planes #(
      .EXP(EXP), .MAN(MAN), .LANES(1), .LAT(LAT), .ARITH(ARITH)
  ) planes (
      .clk_i, .ray_i, .origin_i(node_i[2:0]), .exponent_i(exponent), .near_o(near_0), .far_o(far_0), .unit_o(byte_t));

  // ---- A byte as a number, exactly ----
  function automatic logic [CW-1:0] number(input logic [7:0] q);
    number = '0;
    for (int bit_ = 0; bit_ < 8; bit_++)
      if (q[bit_]) begin
        number = (CW'((1 << (EXP - 1)) - 1 + bit_) << MAN) | ((CW'(q) << (MAN - bit_)) & CW'((1 << MAN) - 1));
      end
  endfunction
  logic [2:0][LANES-1:0][CW-1:0] near_byte, far_byte, near_first, far_first, byte_each;
  for (genvar k = 0; k < 3; k++) begin : axis
    logic [CHILDREN-1:0][7:0] lower, upper;
    assign lower = {node_i[6+2*k+1], node_i[6+2*k]};
    assign upper = {node_i[12+2*k+1], node_i[12+2*k]};
    assign sign_t[k] = {CW{ray_i[6+k][CW-1]}};
    for (genvar l = 0; l < LANES; l++) begin : child
      assign near_byte[k][l] = number(sign_t[k][0] ? upper[l] : lower[l]);
      assign far_byte[k][l] = number(sign_t[k][0] ? lower[l] : upper[l]);
    end
    assign near_first[k] = {LANES{near_0[k]}};
    assign far_first[k] = {LANES{far_0[k]}};
    assign byte_each[k] = {LANES{byte_t[k]}};
  end

  // ---- Per child ----
  `DF_VIN(near_q, near_byte, 0)
  `DF_VIN(far_q, far_byte, 0)
  `DF_VIN(near_base, near_first, T_PLANES)
  `DF_VIN(far_base, far_first, T_PLANES)
  `DF_VIN(unit, byte_each, T_PLANES)
  `DF_VMUL(near_offset, near_q, unit)
  `DF_VMUL(far_offset, far_q, unit)
  `DF_VADD(near, near_base, near_offset)
  `DF_VADD(far, far_base, far_offset)
  `DF_PICK(near_x, near, 0)
  `DF_PICK(near_y, near, 1)
  `DF_PICK(near_z, near, 2)
  `DF_PICK(far_x, far, 0)
  `DF_PICK(far_y, far, 1)
  `DF_PICK(far_z, far, 2)
  `DF_MAX(near_xy, near_x, near_y)
  `DF_MAX(nearest, near_xy, near_z)
  `DF_MIN(far_xy, far_x, far_y)
  `DF_MIN(farthest, far_xy, far_z)
  if (T_near != `NODE_T_AXES || T_far != `NODE_T_AXES) $error("node_boxes: NODE_T_AXES does not match");
  assign {far_axis_o, near_axis_o} = {far, near};
  if (T_nearest != `NODE_T_BOXES || T_farthest != `NODE_T_BOXES) $error("node_boxes: NODE_T_BOXES does not match");
  assign near_o = nearest;
  assign far_o = farthest;
endmodule
