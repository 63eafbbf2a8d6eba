// SPDX-License-Identifier: Apache-2.0
// A ray and the eight boxes of a node in whole numbers: the children that the ray enters, and their keys. The reference
// is integer_visit() of host/include/cde/reference/integer_node.hpp. docs/background/bvh_integer.md has the proof.
// Operators per node: 3 sub, 3 mul in fp32. Per child: 6 products of a byte and a unit of UNIT_BITS + 2 bits, 6 sums.
// Latency: NODE_T_INT cycles (bvh.svh).
// Throughput: one node per cycle.
// Stall: none, runs free.
`include "bvh.svh"
module node_boxes_int #(
    parameter int EXP = 8,
    parameter int MAN = 23,
    parameter latency_pkg::latency_t LAT = latency_pkg::ONES,
    parameter ARITH = "rtl",
    parameter int UNIT_BITS = 16,  // IntegerFormat, as in node_scale.sv
    parameter int STEP_BITS = 6,
    localparam int CHILDREN = bvh_pkg::CHILDREN,
    localparam int CW = 32,
    localparam int KEY = bvh_pkg::RAY_KEY
) (
    input logic clk_i,
    input logic [8:0][CW-1:0] ray_i,  // from ray_front.sv
    input logic [bvh_pkg::NODE_WORDS-1:0][31:0] node_i,
    input logic [31:0] floor_i,  // lowest T that counts
    input logic [31:0] limit_i,  // highest T that counts
    input logic farthest_i,
    output logic [CHILDREN-1:0] entered_o,
    output logic [CHILDREN-1:0][KEY-1:0] key_o,  // the least is visited first; 0 is never culled
    output logic [31:0] reference_o,             // T_ref
    output logic [7:0] scale_o                   // biased exponent of a step: E + 127
);
  /*verilator inline_module*/
  import bvh_pkg::*;
  localparam int LANES = 1;
  localparam int T_LO = 2;
  localparam int T_STEP = 3;
  localparam int T_MARGIN = 6;
  localparam int T_CORNER = `DF_MAX2(LAT.add + LAT.mul, T_LO);
  localparam int T_REFERENCE = T_CORNER + 1;
  localparam int T_STEPS = T_REFERENCE + 4;
  localparam int T_PLANES = T_STEPS + 1;
  localparam int T_AXES = T_PLANES + 1;
  localparam int T_BOXES = T_AXES + 1;
  localparam int T_OUT = T_BOXES + 1;
  localparam int BOUND = UNIT_BITS + 9;  // planes are within +-2^BOUND
  localparam int NW = BOUND + 2;         // bits of all bounds
  localparam int UW = UNIT_BITS + 2;
  localparam int MW = UNIT_BITS + 8;
  localparam logic [NW-1:0] LEAST = {1'b1, {(NW - 1) {1'b0}}};
  localparam logic [NW-1:0] MOST = ~LEAST;
  if (EXP != 8 || MAN != 23) $error("node_boxes_int: the format must be fp32");
  if (T_OUT != `NODE_T_INT) $error("node_boxes_int: NODE_T_INT does not match");

  logic unused;  // places of the children
  assign unused = &{1'b0, node_i[5][PLACE-1:0], node_i[4][PLACE-1:0]};

  // ---- T of the planes of byte 0, in fp32. The host back end computes them in the first cycle ----
  localparam int T_NOW = 0;
  `DF_VIN(o, ray_i[2:0], T_NOW)
  `DF_VIN(inverse, ray_i[8:6], T_NOW)
  `DF_VIN(origin, node_i[2:0], T_NOW)
  `DF_VSUB(from_origin, origin, o)
  `DF_VMUL(plane, from_origin, inverse)
  logic [2:0][31:0] corner;
  pipe_delay #(.W(96), .FROM((ARITH == "rtl") ? T_plane : T_NOW), .TO(T_CORNER)) delay_corner (
      .clk_i, .d_i(plane), .q_o(corner));

  // ---- Steps of T, units and margins ----
  logic [2:0] lo, lo_late, infinite, infinite_late;
  logic [7:0] scale, scale_late;
  logic [2:0][7:0] step, step_late;
  logic [2:0][UW-1:0] near_unit, far_unit, near_unit_late, far_unit_late;
  logic [2:0][MW-1:0] near_margin, far_margin, near_margin_late, far_margin_late;
  node_scale #(
      .UNIT_BITS(UNIT_BITS), .STEP_BITS(STEP_BITS)
  ) scales (
      .clk_i, .inverse_i(ray_i[8:6]), .margin_i(ray_i[5:3]), .exponent_i(node_i[3][23:0]), .lo_o(lo), .scale_o(scale),
      .step_o(step), .near_unit_o(near_unit), .far_unit_o(far_unit), .near_margin_o(near_margin),
      .far_margin_o(far_margin), .infinite_o(infinite));
  pipe_delay #(.W(3), .FROM(T_LO), .TO(T_CORNER)) delay_lo (.clk_i, .d_i(lo), .q_o(lo_late));
  pipe_delay #(.W(8), .FROM(T_LO), .TO(T_REFERENCE)) delay_scale (.clk_i, .d_i(scale), .q_o(scale_late));
  pipe_delay #(.W(24), .FROM(T_STEP), .TO(T_REFERENCE)) delay_step (.clk_i, .d_i(step), .q_o(step_late));
  pipe_delay #(.W(6 * UW + 6 * MW + 3), .FROM(T_MARGIN), .TO(T_STEPS)) delay_margin (
      .clk_i, .d_i({infinite, near_unit, far_unit, near_margin, far_margin}),
      .q_o({infinite_late, near_unit_late, far_unit_late, near_margin_late, far_margin_late}));

  // ---- T_ref: the plane of axis lo ----
  logic [31:0] reference_q, floor_late, limit_late;
  logic [2:0][31:0] corner_q;
  always_ff @(posedge clk_i) begin
    corner_q <= corner;
    reference_q <= (corner[0] & {32{lo_late[0]}}) | (corner[1] & {32{lo_late[1]}}) | (corner[2] & {32{lo_late[2]}});
  end
  pipe_delay #(.W(64), .TO(T_REFERENCE)) delay_interval (
      .clk_i, .d_i({limit_i, floor_i}), .q_o({limit_late, floor_late}));

  // ---- Planes and the ray's interval in steps ----
  logic [4:0][31:0] times;
  logic [4:0][7:0] scales_of;
  logic [4:0][NW-1:0] steps;
  logic [4:0] inexact;
  assign times = {limit_late, floor_late, corner_q};
  assign scales_of = {scale_late, scale_late, step_late};
  for (genvar k = 0; k < 5; k++) begin : whole
    time_steps #(.BITS(NW)) in_steps (
        .clk_i, .time_i(times[k]), .reference_i(reference_q), .step_i(scales_of[k]), .steps_o(steps[k]),
        .inexact_o(inexact[k]));
  end
  logic [NW-1:0] lowest, highest;
  pipe_delay #(.W(2 * NW), .FROM(T_STEPS), .TO(T_BOXES)) delay_limits (
      .clk_i, .d_i({steps[4], steps[3] + NW'(inexact[3] && steps[3] != MOST)}), .q_o({highest, lowest}));
  logic unused_inexact;
  assign unused_inexact = inexact[4];

  // ---- Per axis: planes of byte 0, widened; beyond 2^BOUND there is no bound, or a weaker one ----
  localparam int RW = NW + 1;
  localparam logic [RW-1:0] BOUND_MOST = RW'(1) << BOUND;
  logic [2:0][NW-1:0] near_plane_q, far_plane_q;
  logic [2:0] no_near_q, no_far_q;
  for (genvar k = 0; k < 3; k++) begin : planes
    logic [RW-1:0] now, near, far;
    assign now = {steps[k][NW-1], steps[k]};
    assign near = now - RW'(near_margin_late[k]);
    assign far = now + RW'(far_margin_late[k]) + RW'(inexact[k]);
    always_ff @(posedge clk_i) begin
      near_plane_q[k] <= ($signed(near) > $signed(BOUND_MOST)) ? BOUND_MOST[NW-1:0] : near[NW-1:0];
      far_plane_q[k] <= ($signed(far) < $signed(-BOUND_MOST)) ? -BOUND_MOST[NW-1:0] : far[NW-1:0];
      no_near_q[k] <= infinite_late[k] || $signed(near) < $signed(-BOUND_MOST);
      no_far_q[k] <= infinite_late[k] || $signed(far) > $signed(BOUND_MOST);
    end
  end

  // ---- Per child and axis: plane + byte * unit ----
  logic [2:0][CHILDREN-1:0][7:0] near_byte, far_byte, near_byte_late, far_byte_late;
  logic [2:0][CHILDREN-1:0][NW-1:0] near_axis_q, far_axis_q;
  pipe_delay #(.W(2 * 3 * CHILDREN * 8), .TO(T_STEPS)) delay_bytes (
      .clk_i, .d_i({far_byte, near_byte}), .q_o({far_byte_late, near_byte_late}));
  for (genvar k = 0; k < 3; k++) begin : axis
    logic [CHILDREN-1:0][7:0] lower, upper;
    assign lower = {node_i[6+2*k+1], node_i[6+2*k]};
    assign upper = {node_i[12+2*k+1], node_i[12+2*k]};
    assign near_byte[k] = ray_i[6+k][CW-1] ? upper : lower;
    assign far_byte[k] = ray_i[6+k][CW-1] ? lower : upper;
    for (genvar c = 0; c < CHILDREN; c++) begin : child
      logic [NW-1:0] near_offset_q, far_offset_q;
      always_ff @(posedge clk_i) begin
        near_offset_q <= NW'($signed({1'b0, near_byte_late[k][c]}) * $signed(near_unit_late[k]));
        far_offset_q <= NW'($signed({1'b0, far_byte_late[k][c]}) * $signed(far_unit_late[k]));
        near_axis_q[k][c] <= no_near_q[k] ? LEAST : near_plane_q[k] + near_offset_q;
        far_axis_q[k][c] <= no_far_q[k] ? MOST : far_plane_q[k] + far_offset_q;
      end
    end
  end

  // ---- Per child: the interval, whether the ray enters, and the key ----
  logic [2*CHILDREN-1:0] kinds;
  logic farthest;
  pipe_delay #(.W(2 * CHILDREN + 1), .TO(T_BOXES)) delay_kinds (
      .clk_i, .d_i({farthest_i, node_i[5][31:28], node_i[4][31:28], node_i[3][31:24]}), .q_o({farthest, kinds}));
  for (genvar c = 0; c < CHILDREN; c++) begin : box
    logic [NW-1:0] near, far, near_q, far_q, first, quarters;
    always_comb begin
      near = near_axis_q[0][c];
      far = far_axis_q[0][c];
      for (int k = 1; k < 3; k++) begin
        if ($signed(near_axis_q[k][c]) > $signed(near)) near = near_axis_q[k][c];
        if ($signed(far_axis_q[k][c]) < $signed(far)) far = far_axis_q[k][c];
      end
    end
    always_ff @(posedge clk_i) {near_q, far_q} <= {near, far};
    assign first = farthest ? -far_q : near_q;
    assign quarters = $signed(first) >>> (STEP_BITS - 2);
    always_ff @(posedge clk_i) begin
      entered_o[c] <= kinds[2*c+:2] != KIND_NONE && $signed(near_q) <= $signed(far_q) &&
          $signed(far_q) >= $signed(lowest) && $signed(near_q) <= $signed(highest);
      // The sign is inverted: keys are unsigned.
      if (quarters[NW-1:KEY-1] == {(NW - KEY + 1) {quarters[NW-1]}}) key_o[c] <= {!quarters[KEY-1], quarters[KEY-2:0]};
      else key_o[c] <= {KEY{!quarters[NW-1]}};
    end
  end
  pipe_delay #(.W(40), .FROM(T_REFERENCE), .TO(T_OUT)) delay_reference (
      .clk_i, .d_i({reference_q, scale_late}), .q_o({reference_o, scale_o}));
endmodule
