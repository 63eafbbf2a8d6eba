// SPDX-License-Identifier: Apache-2.0
// A ray and the eight boxes of a node in whole numbers: the children that the ray enters, and their keys. The reference
// is integer_visit() of host/include/cde/reference/integer_node.hpp. docs/background/bvh_integer.md has the proof.
// Operators per node: 3 sub, 3 mul in fp32. Per child: 6 products of a byte and a unit of UNIT_BITS + 2 bits, 6 sums.
// With CYCLES = 2 a node takes two cycles, and most operators work in both: 2 sub, 2 mul, and those for one side.
// With CYCLES = 4 there are 1 sub, 1 mul, and the operators for one side of four children. Halves of a node follow each
// other (node_reader.sv).
// Latency: NODE_T_INT cycles (bvh.svh).
// Throughput: one node per CYCLES cycles. Its inputs stay for as long. With CYCLES = 4, words of a node's first half
// are there for two cycles, then words of its second half.
// Stall: none, runs free.
`include "bvh.svh"
module node_boxes_int #(
    parameter int EXP = 8,
    parameter int MAN = 23,
    parameter latency_pkg::latency_t LAT = latency_pkg::ONES,
    parameter ARITH = "rtl",
    parameter int UNIT_BITS = 16,  // IntegerFormat, as in node_scale.sv
    parameter int STEP_BITS = 6,
    parameter int CYCLES = 1,      // per node: 1, 2 or 4
    localparam int CHILDREN = bvh_pkg::CHILDREN,
    localparam int CW = 32,
    localparam int KEY = bvh_pkg::RAY_KEY
) (
    input logic clk_i,
    input logic valid_i,               // the first cycle of a node; not used with CYCLES = 1
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
  localparam int TURNS = `NODE_TURNS(CYCLES);  // cycles for the axes
  localparam int LANES = (CYCLES == 1) ? 3 : (CYCLES == 2) ? 2 : 1;  // axes at a time
  localparam int HALVES = (CYCLES == 4) ? 2 : 1;  // of the children, one after the other
  localparam int AT_ONCE = CHILDREN / HALVES;
  localparam int T_SECOND = `NODE_T_SECOND(CYCLES);  // the second half of the node
  localparam int T_LO = T_SECOND + 3;
  localparam int T_STEP = T_SECOND + 4;
  localparam int T_SIZES = T_SECOND + `NODE_T_SIZES(CYCLES);
  localparam int T_CORNER = `DF_MAX2(LAT.add + LAT.mul + TURNS - 1, T_LO);
  localparam int T_REFERENCE = T_CORNER + 1;
  localparam int T_SCALE = T_REFERENCE + T_SECOND;
  localparam int T_STEPS = T_REFERENCE + `TIME_T_STEPS;
  localparam int T_HELD = T_STEPS + TURNS - 1;
  localparam int T_BOXES = T_HELD + 3;
  localparam int T_OUT = T_BOXES + CYCLES;
  localparam int NW = `NODE_BOUND_BITS(UNIT_BITS);  // bits of all bounds
  localparam logic [NW-1:0] LEAST = {1'b1, {(NW - 1) {1'b0}}};
  if (EXP != 8 || MAN != 23) $error("node_boxes_int: the format must be fp32");
  if (CYCLES != 1 && CYCLES != 2 && CYCLES != 4) $error("node_boxes_int: CYCLES must be 1, 2 or 4");
  if (T_OUT != `NODE_T_INT(CYCLES)) $error("node_boxes_int: NODE_T_INT does not match");
  if (T_STEP > T_REFERENCE || T_SIZES + 3 > T_HELD) $error("node_boxes_int: node_scale is too slow");

  // first[k]: the first cycle of a node in stage k. With CYCLES > 1, stages up to T_CORNER and values that are kept
  // have as many cycles per node.
  logic [T_OUT-1:0] first;
  if (CYCLES == 1) begin : g_always
    assign first = '1;
  end else begin : g_first
    logic [T_OUT-2:0] first_q;
    always_ff @(posedge clk_i) first_q <= first[T_OUT-2:0];
    assign first = {first_q, valid_i};
  end
  logic unused;
  assign unused = &{1'b0, first, valid_i};

  // ---- T of the planes of byte 0, in fp32. The host back end computes them in the first cycle. With CYCLES = 2,
  // axis 2 follows axis 0. With CYCLES = 4, each axis follows the one before ----
  localparam int T_NOW = 0;
  logic [LANES-1:0][31:0] o_now, inverse_now, origin_now, plane_now;
  logic [2:0][31:0] corner, corner_now;
  if (CYCLES == 1) begin : g_all_axes
    assign {o_now, inverse_now, origin_now} = {ray_i[2:0], ray_i[8:6], node_i[2:0]};
    assign corner_now = plane_now;
  end else if (CYCLES == 4) begin : g_one_by_one
    logic [31:0] origin_q;  // of axis 2, as the second half of the node has begun
    assign o_now = first[0] ? ray_i[0] : first[1] ? ray_i[1] : ray_i[2];
    assign inverse_now = first[0] ? ray_i[6] : first[1] ? ray_i[7] : ray_i[8];
    assign origin_now = first[0] ? node_i[0] : first[1] ? node_i[1] : origin_q;
    logic [1:0][31:0] plane_q;
    always_ff @(posedge clk_i) begin
      origin_q <= node_i[2];
      plane_q <= {plane_now, plane_q[1]};
    end
    assign corner_now = {plane_now, plane_q};
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
  pipe_delay #(.W(96), .FROM(((ARITH == "rtl") ? T_plane : T_NOW) + TURNS - 1), .TO(T_CORNER)) delay_corner (
      .clk_i, .d_i(corner_now), .q_o(corner));

  // ---- Steps of T, units and margins ----
  logic [2:0] lo, lo_late;
  logic [7:0] scale, scale_late;
  logic [2:0][7:0] step, step_late;
  logic [2:0][`NODE_SIZES_BITS(UNIT_BITS)-1:0] sizes;
  node_scale #(
      .UNIT_BITS(UNIT_BITS), .STEP_BITS(STEP_BITS), .CYCLES(CYCLES == 1 ? 1 : 2)
  ) scales (
      .clk_i, .first_i(first[T_SECOND]), .inverse_i(ray_i[8:6]), .margin_i(ray_i[5:3]),
      .exponent_i(exponents_of(node_i)), .lo_o(lo), .scale_o(scale), .step_o(step), .sizes_o(sizes));
  pipe_delay #(.W(3), .FROM(T_LO), .TO(T_CORNER)) delay_lo (.clk_i, .d_i(lo), .q_o(lo_late));
  pipe_delay #(.W(8), .FROM(T_LO), .TO(T_SCALE)) delay_scale (.clk_i, .d_i(scale), .q_o(scale_late));
  pipe_delay #(.W(24), .FROM(T_STEP), .TO(T_REFERENCE)) delay_step (.clk_i, .d_i(step), .q_o(step_late));

  // ---- T_ref: the plane of axis lo ----
  logic [31:0] reference_q, floor_late, limit_late;
  logic [2:0][31:0] corner_q;
  always_ff @(posedge clk_i) begin
    if (CYCLES != 4 || first[T_CORNER]) corner_q <= corner;
    if (first[T_CORNER])
      reference_q <= (corner[0] & {32{lo_late[0]}}) | (corner[1] & {32{lo_late[1]}}) | (corner[2] & {32{lo_late[2]}});
  end
  pipe_delay #(.W(64), .TO(T_REFERENCE)) delay_interval (
      .clk_i, .d_i({limit_i, floor_i}), .q_o({limit_late, floor_late}));

  // ---- Planes in steps, and the ray's interval: in units of their own, or in the next cycle. With CYCLES = 4, axis 2
  // is the first, then axes 0 and 1, then the interval ----
  localparam int COUNTED = (CYCLES == 1) ? 5 : (CYCLES == 2) ? 3 : 2;
  logic [COUNTED-1:0][31:0] times;
  logic [COUNTED-1:0][7:0] scales_of;
  logic [COUNTED-1:0][NW-1:0] steps;
  logic [COUNTED-1:0] inexact;
  if (CYCLES == 1) begin : g_all_times
    assign times = {limit_late, floor_late, corner_q};
    assign scales_of = {scale_late, scale_late, step_late};
  end else if (CYCLES == 4) begin : g_two_times
    assign times = first[T_REFERENCE] ? {32'd0, corner_q[2]} : first[T_REFERENCE+1] ? corner_q[1:0] :
        {limit_late, floor_late};
    assign scales_of = first[T_REFERENCE] ? {8'd0, step_late[2]} : first[T_REFERENCE+1] ? step_late[1:0] :
        {scale_late, scale_late};
  end else begin : g_times_in_turn
    assign times = first[T_REFERENCE] ? corner_q : {corner_q[2], limit_late, floor_late};
    assign scales_of = first[T_REFERENCE] ? step_late : {step_late[2], scale_late, scale_late};
  end
  for (genvar k = 0; k < COUNTED; k++) begin : whole
    time_steps #(.BITS(NW)) in_steps (
        .clk_i, .time_i(times[k]), .reference_i(reference_q), .step_i(scales_of[k]), .steps_o(steps[k]),
        .inexact_o(inexact[k]));
  end
  // The highest T and, for the far side, the lowest with the other sign.
  localparam int AT = (CYCLES == 1) ? 3 : 0;  // of the interval's lower end
  logic [NW-1:0] near_most_q, far_most_q, near_most, far_most;
  always_ff @(posedge clk_i)
    if (first[T_HELD]) begin
      near_most_q <= steps[AT+1];
      far_most_q <= (steps[AT] == LEAST) ? ~LEAST : ~steps[AT] + NW'(!inexact[AT]);
    end
  pipe_delay #(.W(2 * NW), .FROM(T_HELD + 1), .TO(T_BOXES)) delay_most (
      .clk_i, .d_i({far_most_q, near_most_q}), .q_o({far_most, near_most}));
  logic unused_inexact;
  assign unused_inexact = inexact[AT+1];

  // ---- Both sides: two units, or the far side in the second cycle. With CYCLES = 4, so for each half in turn ----
  localparam int SIDES = (CYCLES == 1) ? 2 : 1;
  logic [SIDES-1:0][2:0][AT_ONCE-1:0][7:0] side_byte;
  logic near_0;  // the near side
  assign near_0 = first[0] || (HALVES == 2 && first[T_SECOND]);
  for (genvar k = 0; k < 3; k++) begin : axis
    logic [AT_ONCE-1:0][7:0] lower, upper;
    if (HALVES == 2) begin : g_half
      logic [CHILDREN-1:0][7:0] lowers, uppers;
      logic now;
      assign {lowers, uppers} = {lower_of(node_i, k), upper_of(node_i, k)};
      assign now = first[0] || first[1];
      assign lower = now ? lowers[0+:AT_ONCE] : lowers[CHILDREN-1-:AT_ONCE];
      assign upper = now ? uppers[0+:AT_ONCE] : uppers[CHILDREN-1-:AT_ONCE];
    end else begin : g_all
      assign {lower, upper} = {lower_of(node_i, k), upper_of(node_i, k)};
    end
    for (genvar s = 0; s < SIDES; s++) begin : side
      assign side_byte[s][k] = (ray_i[6+k][CW-1] ^ (s == 1 || !near_0)) ? upper : lower;
    end
  end
  logic [2:0][NW-1:0] held;
  logic [2:0] held_inexact;
  if (CYCLES == 1) begin : g_now
    assign {held, held_inexact} = {steps[2:0], inexact[2:0]};
  end else if (CYCLES == 4) begin : g_held_together
    logic [NW-1:0] steps_q;
    logic inexact_q;
    always_ff @(posedge clk_i) begin
      {steps_q, inexact_q} <= {steps[0], inexact[0]};
      if (first[T_STEPS+1]) {held, held_inexact} <= {steps_q, steps, inexact_q, inexact};
    end
  end else begin : g_held
    always_ff @(posedge clk_i) if (first[T_STEPS]) {held, held_inexact} <= {steps, inexact};
  end
  logic far_sizes, far_held;
  assign far_sizes = !first[T_SIZES] && !(HALVES == 2 && first[T_SIZES+2]);
  assign far_held = !first[T_HELD] && !(HALVES == 2 && first[T_HELD+2]);
  logic [SIDES-1:0][AT_ONCE-1:0][NW-1:0] bound;
  for (genvar s = 0; s < SIDES; s++) begin : side
    logic [2:0][AT_ONCE-1:0][7:0] byte_late;
    long_delay #(.W(3 * AT_ONCE * 8), .DEPTH(T_HELD)) delay_bytes (
        .clk_i, .d_i(side_byte[s]), .q_o(byte_late));
    node_side #(
        .CHILDREN(AT_ONCE), .UNIT_BITS(UNIT_BITS), .T_SIZES(T_SIZES), .T_STEPS(T_HELD)
    ) bounds (
        .clk_i, .far_i(s == 1 || far_sizes), .sizes_i(sizes), .far_steps_i(s == 1 || far_held),
        .steps_i(held), .inexact_i(held_inexact), .byte_i(byte_late), .bound_o(bound[s]));
  end

  // ---- Per child: whether the ray enters, and the key. A first half is kept for the second ----
  localparam int T_LAST = T_OUT - 1;
  localparam int T_HALF = T_LAST - T_SECOND;  // the far side of the first half, or of all children
  logic farthest;
  pipe_delay #(.W(1), .TO(T_HALF)) delay_farthest (.clk_i, .d_i(farthest_i), .q_o(farthest));
  logic [CHILDREN-1:0][1:0] kinds_now;
  assign kinds_now = kinds_of(node_i);
  logic [AT_ONCE-1:0] entered;
  logic [AT_ONCE-1:0][KEY-1:0] key;
  for (genvar c = 0; c < AT_ONCE; c++) begin : box
    logic [NW-1:0] near, far, first_bound, quarters;
    logic [NW:0] apart;  // near + far: more than 0 if the interval is empty
    logic near_counts, far_counts;
    if (CYCLES == 1) begin : g_at_once
      assign {near, far} = {bound[0][c], bound[1][c]};
      assign near_counts = $signed(near) <= $signed(near_most);
      assign far_counts = $signed(far) <= $signed(far_most);
    end else begin : g_in_turn
      logic counts;
      assign counts = $signed(bound[0][c]) <=
          $signed((first[T_BOXES] || (HALVES == 2 && first[T_BOXES+2])) ? near_most : far_most);
      always_ff @(posedge clk_i) {near, near_counts} <= {bound[0][c], counts};
      assign {far, far_counts} = {bound[0][c], counts};
    end
    assign apart = {near[NW-1], near} + {far[NW-1], far};
    assign first_bound = farthest ? far : near;
    assign quarters = $signed(first_bound) >>> (STEP_BITS - 2);
    assign entered[c] = near_counts && far_counts && (apart[NW] || apart == '0);
    // The sign is inverted: keys are unsigned.
    assign key[c] = (quarters[NW-1:KEY-1] == {(NW - KEY + 1) {quarters[NW-1]}}) ?
        {!quarters[KEY-1], quarters[KEY-2:0]} : {KEY{!quarters[NW-1]}};
  end
  for (genvar h = 0; h < HALVES; h++) begin : half
    localparam int FIRST = h * AT_ONCE;
    localparam int T_FAR = T_LAST - T_SECOND * (HALVES - 1 - h);
    logic [AT_ONCE-1:0][1:0] kinds;
    pipe_delay #(.W(2 * AT_ONCE), .FROM(T_SECOND), .TO(T_FAR)) delay_kinds (
        .clk_i, .d_i(kinds_now[FIRST+:AT_ONCE]), .q_o(kinds));
    for (genvar c = 0; c < AT_ONCE; c++) begin : child
      always_ff @(posedge clk_i)
        if (h == HALVES - 1 || first[T_FAR]) begin
          entered_o[FIRST+c] <= kinds[c] != KIND_NONE && entered[c];
          key_o[FIRST+c] <= key[c];
        end
    end
  end
  pipe_delay #(.W(40), .FROM(T_SCALE), .TO(T_OUT)) delay_reference (
      .clk_i, .d_i({reference_q, scale_late}), .q_o({reference_o, scale_o}));
endmodule
