// SPDX-License-Identifier: Apache-2.0
// A solid's box and the eight boxes of a node (axis_distances() of reference/pipes/solid_node.hpp). On each axis: how
// far a child's box begins above the end of the solid's box, and ends above its start. node_boxes_int.sv is for rays.
// The children are lanes. host/include/cde/bvh/node.hpp lists the node's words. Operators per node: 6 sub. Operators
// per child: 6 add. A byte times a power of two is a number without rounding.
// Latency: NODE_T_AXES cycles (bvh.svh).
// Throughput: one node per cycle.
// Stall: none, runs free.
`include "bvh.svh"
module node_boxes #(
    parameter int EXP = 8,
    parameter int MAN = 23,
    parameter latency_pkg::latency_t LAT = latency_pkg::ONES,
    parameter ARITH = "rtl",
    localparam int LANES = bvh_pkg::CHILDREN,
    localparam int CW = 32
) (
    input logic clk_i,
    input logic [5:0][CW-1:0] solid_i,  // from solid_front.sv
    input logic [bvh_pkg::NODE_WORDS-1:0][31:0] node_i,
    output logic [2:0][LANES-1:0][CW-1:0] above_o,
    output logic [2:0][LANES-1:0][CW-1:0] below_o
);
  /*verilator inline_module*/
  localparam int B_LANES = 1;
  if (EXP != 8 || MAN != 23) $error("node_boxes: the format must be fp32");

  // ---- Per node: its origin ----
  `DF_SHARED_VIN(origin, node_i[2:0], 0)
  `DF_SHARED_VIN(upper, solid_i[2:0], 0)
  `DF_SHARED_VIN(lower, solid_i[5:3], 0)
  `DF_SHARED_VSUB(above_0, origin, upper)
  `DF_SHARED_VSUB(below_0, origin, lower)

  // ---- Per child: bytes from the origin ----
  function automatic logic [CW-1:0] number(input logic [7:0] q, input logic [7:0] exponent);
    number = '0;
    for (int bit_ = 0; bit_ < 8; bit_++)
      if (q[bit_]) begin
        number = (CW'((1 << (EXP - 1)) - 1 + bit_) << MAN) | ((CW'(q) << (MAN - bit_)) & CW'((1 << MAN) - 1));
      end
    if (q != 0) number = number + (CW'(signed'(exponent)) << MAN);
  endfunction
  logic [2:0][LANES-1:0][7:0] lower_now, upper_now, lower_byte, upper_byte;
  for (genvar k = 0; k < 3; k++) begin : bytes
    assign {lower_now[k], upper_now[k]} = {bvh_pkg::lower_of(node_i, k), bvh_pkg::upper_of(node_i, k)};
  end
  logic [2:0][7:0] exponent;
  pipe_delay #(.W(24 * (2 * LANES + 1)), .TO(LAT.add), .ARITH(ARITH)) delay_bytes (
      .clk_i, .d_i({upper_now, lower_now, bvh_pkg::exponents_of(node_i)}), .q_o({upper_byte, lower_byte, exponent}));
  logic [2:0][LANES-1:0][CW-1:0] lower_number, upper_number;
  for (genvar k = 0; k < 3; k++) begin : axis
    for (genvar l = 0; l < LANES; l++) begin : child
      assign lower_number[k][l] = number(lower_byte[k][l], exponent[k]);
      assign upper_number[k][l] = number(upper_byte[k][l], exponent[k]);
    end
  end
  `DF_VIN(lower_offset, lower_number, T_above_0)
  `DF_VIN(upper_offset, upper_number, T_below_0)
  `DF_VADD(above, lower_offset, above_0)
  `DF_VADD(below, upper_offset, below_0)
  if (T_above != `NODE_T_AXES || T_below != `NODE_T_AXES) $error("node_boxes: NODE_T_AXES does not match");
  assign {below_o, above_o} = {below, above};
endmodule
