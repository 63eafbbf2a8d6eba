// SPDX-License-Identifier: Apache-2.0
// A ray and the eight boxes of a node in whole numbers: the children that the ray enters, and their keys. The reference
// is integer_visit() of host/include/cde/reference/integer_node.hpp. docs/background/bvh_integer.md has the proof.
// Operators per node: 3 sub, 3 mul in fp32. Per child: 6 products of a byte and a unit of UNIT_BITS + 2 bits, 6 sums.
// With CYCLES = 2 a node takes two cycles, and most operators work in both: 2 sub, 2 mul, and those of four children.
// Latency: NODE_T_INT cycles (bvh.svh).
// Throughput: one node per CYCLES cycles. Its inputs stay for as long.
// Stall: none, runs free.
`include "bvh.svh"
module node_boxes_int #(
    parameter int EXP = 8,
    parameter int MAN = 23,
    parameter latency_pkg::latency_t LAT = latency_pkg::ONES,
    parameter ARITH = "rtl",
    parameter int UNIT_BITS = 16,  // IntegerFormat, as in node_scale.sv
    parameter int STEP_BITS = 6,
    parameter int CYCLES = 1,      // per node: 1 or 2
    localparam int CHILDREN = bvh_pkg::CHILDREN,
    localparam int CW = 32,
    localparam int KEY = bvh_pkg::RAY_KEY
) (
    input logic clk_i,
    input logic valid_i,               // the first cycle of a node; used with CYCLES = 2
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
  localparam int LANES = (CYCLES == 1) ? 3 : 2;  // axes at a time
  localparam int BOXES = CHILDREN / CYCLES;      // children at a time
  localparam int T_LO = 2;
  localparam int T_STEP = 3;
  localparam int T_MARGIN = `NODE_T_MARGIN(CYCLES);
  localparam int T_CORNER = `DF_MAX2(LAT.add + LAT.mul + CYCLES - 1, T_LO);
  localparam int T_REFERENCE = T_CORNER + 1;
  localparam int T_STEPS = T_REFERENCE + `TIME_T_STEPS;
  localparam int T_PLANES = T_STEPS + 1;
  localparam int T_AXES = T_PLANES + 1;
  localparam int T_BOXES = T_AXES + 1;
  localparam int T_OUT = T_BOXES + CYCLES;
  localparam int BOUND = UNIT_BITS + 9;  // planes are within +-2^BOUND
  localparam int NW = BOUND + 2;         // bits of all bounds
  localparam int UW = UNIT_BITS + 2;
  localparam int MW = UNIT_BITS + 8;
  localparam logic [NW-1:0] LEAST = {1'b1, {(NW - 1) {1'b0}}};
  localparam logic [NW-1:0] MOST = ~LEAST;
  if (EXP != 8 || MAN != 23) $error("node_boxes_int: the format must be fp32");
  if (CYCLES != 1 && CYCLES != 2) $error("node_boxes_int: CYCLES must be 1 or 2");
  if (T_OUT != `NODE_T_INT(CYCLES)) $error("node_boxes_int: NODE_T_INT does not match");
  if (T_STEP > T_REFERENCE || T_MARGIN > T_STEPS) $error("node_boxes_int: node_scale is too slow");

  // first[k]: the first cycle of a node in stage k. With CYCLES = 2, stages up to T_CORNER and values that are kept
  // have two cycles per node.
  logic [T_BOXES:0] first;
  if (CYCLES == 1) begin : g_always
    assign first = '1;
  end else begin : g_first
    logic [T_BOXES-1:0] first_q;
    always_ff @(posedge clk_i) first_q <= first[T_BOXES-1:0];
    assign first = {first_q, valid_i};
  end
  logic unused;  // places of the children
  assign unused = &{1'b0, node_i[5][PLACE-1:0], node_i[4][PLACE-1:0], first, valid_i};

  // ---- T of the planes of byte 0, in fp32. The host back end computes them in the first cycle. With CYCLES = 2,
  // axis 2 follows axis 0 ----
  localparam int T_NOW = 0;
  logic [LANES-1:0][31:0] o_now, inverse_now, origin_now, plane_now;
  logic [2:0][31:0] corner, corner_now;
  if (CYCLES == 1) begin : g_all_axes
    assign {o_now, inverse_now, origin_now} = {ray_i[2:0], ray_i[8:6], node_i[2:0]};
    assign corner_now = plane_now;
  end else begin : g_in_turn
    assign o_now = {ray_i[1], first[0] ? ray_i[0] : ray_i[2]};
    assign inverse_now = {ray_i[7], first[0] ? ray_i[6] : ray_i[8]};
    assign origin_now = {node_i[1], first[0] ? node_i[0] : node_i[2]};
    logic [1:0][31:0] plane_q;
    always_ff @(posedge clk_i) plane_q <= plane_now;
    assign corner_now = {plane_now[0], plane_q};
  end
  `DF_IN(o, o_now, T_NOW)
  `DF_IN(inverse, inverse_now, T_NOW)
  `DF_IN(origin, origin_now, T_NOW)
  `DF_SUB(from_origin, origin, o)
  `DF_MUL(plane, from_origin, inverse)
  assign plane_now = plane;
  pipe_delay #(.W(96), .FROM(((ARITH == "rtl") ? T_plane : T_NOW) + CYCLES - 1), .TO(T_CORNER)) delay_corner (
      .clk_i, .d_i(corner_now), .q_o(corner));

  // ---- Steps of T, units and margins ----
  logic [2:0] lo, lo_late, infinite, infinite_late;
  logic [7:0] scale, scale_late;
  logic [2:0][7:0] step, step_late;
  logic [2:0][UW-1:0] near_unit, far_unit, near_unit_late, far_unit_late;
  logic [2:0][MW-1:0] near_margin, far_margin, near_margin_late, far_margin_late;
  node_scale #(
      .UNIT_BITS(UNIT_BITS), .STEP_BITS(STEP_BITS), .CYCLES(CYCLES)
  ) scales (
      .clk_i, .first_i(first[0]), .inverse_i(ray_i[8:6]), .margin_i(ray_i[5:3]), .exponent_i(node_i[3][23:0]),
      .lo_o(lo), .scale_o(scale), .step_o(step), .near_unit_o(near_unit), .far_unit_o(far_unit),
      .near_margin_o(near_margin), .far_margin_o(far_margin), .infinite_o(infinite));
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
    if (first[T_CORNER])
      reference_q <= (corner[0] & {32{lo_late[0]}}) | (corner[1] & {32{lo_late[1]}}) | (corner[2] & {32{lo_late[2]}});
  end
  pipe_delay #(.W(64), .TO(T_REFERENCE)) delay_interval (
      .clk_i, .d_i({limit_i, floor_i}), .q_o({limit_late, floor_late}));

  // ---- Planes in steps, and the ray's interval: in units of their own, or in the next cycle ----
  localparam int COUNTED = (CYCLES == 1) ? 5 : 3;
  localparam int T_INTERVAL = T_STEPS + CYCLES - 1;
  logic [COUNTED-1:0][31:0] times;
  logic [COUNTED-1:0][7:0] scales_of;
  logic [COUNTED-1:0][NW-1:0] steps;
  logic [COUNTED-1:0] inexact;
  if (CYCLES == 1) begin : g_all_times
    assign times = {limit_late, floor_late, corner_q};
    assign scales_of = {scale_late, scale_late, step_late};
  end else begin : g_times_in_turn
    assign times = first[T_REFERENCE] ? corner_q : {corner_q[2], limit_late, floor_late};
    assign scales_of = first[T_REFERENCE] ? step_late : {step_late[2], scale_late, scale_late};
  end
  for (genvar k = 0; k < COUNTED; k++) begin : whole
    time_steps #(.BITS(NW)) in_steps (
        .clk_i, .time_i(times[k]), .reference_i(reference_q), .step_i(scales_of[k]), .steps_o(steps[k]),
        .inexact_o(inexact[k]));
  end
  localparam int AT = COUNTED - 2 - (CYCLES - 1);  // of the interval's lower end
  logic [NW-1:0] lowest_q, highest_q, lowest, highest;
  always_ff @(posedge clk_i)
    if (first[T_INTERVAL]) begin
      lowest_q <= steps[AT] + NW'(inexact[AT] && steps[AT] != MOST);
      highest_q <= steps[AT+1];
    end
  pipe_delay #(.W(2 * NW), .FROM(T_INTERVAL + 1), .TO(T_BOXES)) delay_limits (
      .clk_i, .d_i({highest_q, lowest_q}), .q_o({highest, lowest}));
  logic unused_inexact;
  assign unused_inexact = inexact[AT+1];

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
    always_ff @(posedge clk_i) if (first[T_STEPS]) begin
      near_plane_q[k] <= ($signed(near) > $signed(BOUND_MOST)) ? BOUND_MOST[NW-1:0] : near[NW-1:0];
      far_plane_q[k] <= ($signed(far) < $signed(-BOUND_MOST)) ? -BOUND_MOST[NW-1:0] : far[NW-1:0];
      no_near_q[k] <= infinite_late[k] || $signed(near) < $signed(-BOUND_MOST);
      no_far_q[k] <= infinite_late[k] || $signed(far) > $signed(BOUND_MOST);
    end
  end

  // ---- Per child and axis: plane + byte * unit ----
  logic [2:0][BOXES-1:0][7:0] near_byte, far_byte, near_byte_late, far_byte_late;
  logic [2:0][BOXES-1:0][NW-1:0] near_axis_q, far_axis_q;
  pipe_delay #(.W(2 * 3 * BOXES * 8), .TO(T_STEPS)) delay_bytes (
      .clk_i, .d_i({far_byte, near_byte}), .q_o({far_byte_late, near_byte_late}));
  for (genvar k = 0; k < 3; k++) begin : axis
    logic [CHILDREN-1:0][7:0] lower, upper;
    logic [BOXES-1:0][7:0] lower_now, upper_now;
    assign lower = {node_i[6+2*k+1], node_i[6+2*k]};
    assign upper = {node_i[12+2*k+1], node_i[12+2*k]};
    assign lower_now = first[0] ? lower[BOXES-1:0] : lower[CHILDREN-1-:BOXES];
    assign upper_now = first[0] ? upper[BOXES-1:0] : upper[CHILDREN-1-:BOXES];
    assign near_byte[k] = ray_i[6+k][CW-1] ? upper_now : lower_now;
    assign far_byte[k] = ray_i[6+k][CW-1] ? lower_now : upper_now;
    for (genvar c = 0; c < BOXES; c++) begin : child
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
  logic [CHILDREN-1:0][1:0] kinds;
  logic [BOXES-1:0][1:0] kinds_now;
  logic farthest;
  logic [BOXES-1:0] entered_q;
  logic [BOXES-1:0][KEY-1:0] key_q;
  pipe_delay #(.W(2 * CHILDREN + 1), .TO(T_BOXES)) delay_kinds (
      .clk_i, .d_i({farthest_i, node_i[5][31:28], node_i[4][31:28], node_i[3][31:24]}), .q_o({farthest, kinds}));
  assign kinds_now = first[T_BOXES] ? kinds[BOXES-1:0] : kinds[CHILDREN-1-:BOXES];
  for (genvar c = 0; c < BOXES; c++) begin : box
    logic [2:0][NW-1:0] near, far;
    logic [NW-1:0] near_q, far_q, ordered_by, quarters;
    logic [2:0] later, sooner;  // [0]: axis 1 than 0, [1]: 2 than 0, [2]: 2 than 1
    for (genvar k = 0; k < 3; k++) begin : bound
      assign {near[k], far[k]} = {near_axis_q[k][c], far_axis_q[k][c]};
    end
    assign later = {$signed(near[2]) > $signed(near[1]), $signed(near[2]) > $signed(near[0]),
        $signed(near[1]) > $signed(near[0])};
    assign sooner = {$signed(far[2]) < $signed(far[1]), $signed(far[2]) < $signed(far[0]),
        $signed(far[1]) < $signed(far[0])};
    always_ff @(posedge clk_i) begin
      near_q <= (later[1] && later[2]) ? near[2] : later[0] ? near[1] : near[0];
      far_q <= (sooner[1] && sooner[2]) ? far[2] : sooner[0] ? far[1] : far[0];
    end
    assign ordered_by = farthest ? -far_q : near_q;
    assign quarters = $signed(ordered_by) >>> (STEP_BITS - 2);
    always_ff @(posedge clk_i) begin
      entered_q[c] <= kinds_now[c] != KIND_NONE && $signed(near_q) <= $signed(far_q) &&
          $signed(far_q) >= $signed(lowest) && $signed(near_q) <= $signed(highest);
      // The sign is inverted: keys are unsigned.
      if (quarters[NW-1:KEY-1] == {(NW - KEY + 1) {quarters[NW-1]}}) key_q[c] <= {!quarters[KEY-1], quarters[KEY-2:0]};
      else key_q[c] <= {KEY{!quarters[NW-1]}};
    end
  end
  if (CYCLES == 1) begin : g_all_boxes
    assign {entered_o, key_o} = {entered_q, key_q};
  end else begin : g_boxes_in_turn
    logic [BOXES-1:0] entered_first_q;
    logic [BOXES-1:0][KEY-1:0] key_first_q;
    always_ff @(posedge clk_i) {entered_first_q, key_first_q} <= {entered_q, key_q};
    assign {entered_o, key_o} = {entered_q, entered_first_q, key_q, key_first_q};
  end
  pipe_delay #(.W(40), .FROM(T_REFERENCE), .TO(T_OUT)) delay_reference (
      .clk_i, .d_i({reference_q, scale_late}), .q_o({reference_o, scale_o}));
endmodule
