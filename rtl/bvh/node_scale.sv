// SPDX-License-Identifier: Apache-2.0
// The steps of T in which a node's boxes are tested for a ray, and what depends on them alone (planes_of() of
// host/src/reference/integer_node.cpp). The axis lo, on which the ray is in the node for the shortest T, sets the
// shared step. On a slow axis, where numbers would have too many bits, steps are longer. Its margins also have all T
// that lo allows, so that its bounds count as shared steps.
// Latency: 2 cycles to lo_o and scale_o, 3 to step_o, NODE_T_MARGIN to the others (bvh.svh).
// Throughput: one node per CYCLES cycles. The inputs of a node stay for as long, and so do its outputs.
// Stall: none, runs free.
`include "bvh.svh"
module node_scale #(
    parameter int UNIT_BITS = 16,  // 12 to 16
    parameter int STEP_BITS = 6,   // 2 to 6: the least unit has 2^STEP_BITS steps or more
    parameter int CYCLES = 1,      // 1 or 2
    localparam int UW = UNIT_BITS + 2,
    localparam int MARGIN = UNIT_BITS + 8
) (
    input logic clk_i,
    input logic first_i,                // the first cycle of a node; used with CYCLES = 2
    input logic [2:0][31:0] inverse_i,  // 1 / d
    input logic [2:0][31:0] margin_i,   // T of the margin; may be infinite
    input logic [2:0][7:0] exponent_i,  // of the node, signed
    output logic [2:0] lo_o,            // one bit is set
    output logic [7:0] scale_o,         // biased exponent of the shared step
    output logic [2:0][7:0] step_o,     // biased exponents of the steps
    output logic [2:0][UW-1:0] near_unit_o,  // steps per byte, signed, rounded down
    output logic [2:0][UW-1:0] far_unit_o,   // rounded up
    output logic [2:0][MARGIN-1:0] near_margin_o,  // steps
    output logic [2:0][MARGIN-1:0] far_margin_o,
    output logic [2:0] infinite_o  // the margin is infinite
);
  /*verilator inline_module*/
  localparam int T_MARGIN = `NODE_T_MARGIN(CYCLES);
  localparam int MW = 24;  // bits of a significand
  localparam int BYTE = 8;
  localparam int FOUR = 2;  // a margin has a scale of its own only if four of it exceed the node
  localparam int XW = 11;  // bits of an exponent, signed
  if (UNIT_BITS < 12 || UNIT_BITS > 16) $error("node_scale: UNIT_BITS must be 12 to 16");
  if (STEP_BITS < 2 || STEP_BITS > 6) $error("node_scale: STEP_BITS must be 2 to 6");
  if (CYCLES != 1 && CYCLES != 2) $error("node_scale: CYCLES must be 1 or 2");
  if (T_MARGIN != 6 + CYCLES) $error("node_scale: NODE_T_MARGIN does not match");

  // first[k]: the first cycle of a node in stage k.
  logic [T_MARGIN-1:0] first;
  logic unused_first;
  assign unused_first = &{1'b0, first, first_i};
  if (CYCLES == 1) begin : g_always
    assign first = '1;
  end else begin : g_first
    logic [T_MARGIN-2:0] first_q;
    always_ff @(posedge clk_i) first_q <= first[T_MARGIN-2:0];
    assign first = {first_q, first_i};
  end

  // ---- Ranges: the larger of 256 units and of 4 margins, as an exponent ----
  logic [2:0][XW-1:0] unit_1, margin_1, range_1;
  for (genvar k = 0; k < 3; k++) begin : sizes
    logic [XW-1:0] unit, margin;
    assign unit = {3'b0, inverse_i[k][30:23]} + {{3{exponent_i[k][7]}}, exponent_i[k]};
    assign margin = {3'b0, margin_i[k][30:23]} | XW'(margin_i[k][30:23] == 0);
    always_ff @(posedge clk_i) begin
      unit_1[k] <= unit;
      margin_1[k] <= margin;
      range_1[k] <= ($signed(unit + XW'(BYTE)) > $signed(margin + XW'(FOUR))) ? unit + XW'(BYTE) : margin + XW'(FOUR);
    end
  end

  // ---- Axis lo: the least range, ties the lowest axis ----
  logic [2:0] shorter, lo;  // [0]: axis 1 than 0, [1]: 2 than 0, [2]: 2 than 1
  logic [2:0][XW-1:0] unit_2, margin_2, range_2;
  logic [XW-1:0] shared, most_2, places_2;  // largest range that allows the shared step; exponent of words not shifted
  assign shorter = {$signed(range_1[2]) < $signed(range_1[1]), $signed(range_1[2]) < $signed(range_1[0]),
      $signed(range_1[1]) < $signed(range_1[0])};
  assign lo = {shorter[2] && shorter[1], shorter[0] && !shorter[2], !shorter[0] && !shorter[1]};
  assign shared = (range_1[0] & {XW{lo[0]}}) | (range_1[1] & {XW{lo[1]}}) | (range_1[2] & {XW{lo[2]}});
  always_ff @(posedge clk_i) begin
    lo_o <= lo;
    scale_o <= shared[7:0] - 8'(BYTE + STEP_BITS);
    most_2 <= shared + XW'(UNIT_BITS - 1 - STEP_BITS);
    places_2 <= shared + XW'(MW - 1 - BYTE - STEP_BITS);
    {unit_2, margin_2, range_2} <= {unit_1, margin_1, range_1};
  end

  // ---- Steps of each axis, and by how many places units and margins are larger ----
  localparam int LONGER = BYTE + UNIT_BITS - 1;
  logic [2:0] slow_3;
  logic [2:0][4:0] unit_shift_3, margin_shift_3;
  function automatic logic [4:0] shift_of(input logic [XW-1:0] places);
    shift_of = (places > XW'(31)) ? 5'd31 : places[4:0];
  endfunction
  for (genvar k = 0; k < 3; k++) begin : steps
    logic [XW-1:0] places;
    logic slow;
    assign slow = $signed(range_2[k]) > $signed(most_2);
    assign places = range_2[k] + XW'(MW - 1 - LONGER);
    always_ff @(posedge clk_i) begin
      slow_3[k] <= slow;
      step_o[k] <= slow ? range_2[k][7:0] - 8'(LONGER) : scale_o;
      unit_shift_3[k] <= slow ? shift_of(places - unit_2[k]) : shift_of(places_2 - unit_2[k]);
      margin_shift_3[k] <= slow ? shift_of(places - margin_2[k]) : shift_of(places_2 - margin_2[k]);
    end
  end

  // ---- Units and margins as whole numbers, rounded down. With CYCLES = 2, margins are shifted in the second
  // cycle ----
  logic [2:0][UNIT_BITS:0] down_4;
  logic [2:0][MARGIN-1:0] margin_4;
  logic [2:0] inexact_4, sign_3, infinite_3;
  for (genvar k = 0; k < 3; k++) begin : whole
    logic [56:0] words, words_3;
    logic [MW-1:0] unit_size, margin_size, unit, margin;
    logic [6:0] unused_zeros;
    logic inexact, unused_inexact, unused;
    assign words = {inverse_i[k][31], &margin_i[k][30:23], 1'b1, inverse_i[k][22:0], 7'd0, margin_i[k][30:23] != 0,
        margin_i[k][22:0]};
    pipe_delay #(.W(57), .TO(3)) delay_words (.clk_i, .d_i(words), .q_o(words_3));
    assign {sign_3[k], infinite_3[k], unit_size, unused_zeros, margin_size} = words_3;
    assign unused = &{1'b0, unit, margin, unused_inexact, margin_i[k][31], unused_zeros};  // upper bits are 0
    if (CYCLES == 1) begin : g_both
      shift_sticky #(.W(MW)) shift_unit (
          .d_i(unit_size), .fill_i(1'b0), .by_i(unit_shift_3[k]), .q_o(unit), .lost_o(inexact));
      shift_sticky #(.W(MW)) shift_margin (
          .d_i(margin_size), .fill_i(1'b0), .by_i(margin_shift_3[k]), .q_o(margin), .lost_o(unused_inexact));
    end else begin : g_in_turn
      shift_sticky #(.W(MW)) shift (
          .d_i(first[3] ? unit_size : margin_size), .fill_i(1'b0),
          .by_i(first[3] ? unit_shift_3[k] : margin_shift_3[k]), .q_o(unit), .lost_o(inexact));
      assign {margin, unused_inexact} = {unit, 1'b0};
    end
    always_ff @(posedge clk_i) begin
      if (first[3]) {down_4[k], inexact_4[k]} <= {unit[UNIT_BITS:0], inexact};
      if (CYCLES == 1 || !first[3]) margin_4[k] <= MARGIN'(margin);
    end
  end

  // ---- Units, and what lo allows before and after T_ref: 255 units one way ----
  logic [2:0] negative_4, slow_4, slow_5, slow_6, lo_3, lo_4;
  logic [2:0][UW-1:0] near_unit_5, far_unit_5, near_unit_6, far_unit_6;
  logic [2:0][MARGIN-1:0] margin_5, margin_6;
  logic [UNIT_BITS:0] lo_unit_5;
  logic [MARGIN-1:0] lo_margin_5, before_6, after_6, length;
  logic backwards_5;
  assign length = MARGIN'({lo_unit_5, 8'd0}) - MARGIN'(lo_unit_5);
  always_ff @(posedge clk_i) begin
    {lo_3, lo_4} <= {lo_o, lo_3};
    negative_4 <= sign_3;
    {slow_4, slow_5, slow_6} <= {slow_3, slow_4, slow_5};
    {lo_unit_5, lo_margin_5, backwards_5} <= '0;
    for (int k = 0; k < 3; k++)
      if (lo_4[k]) begin
        lo_unit_5 <= down_4[k] + (UNIT_BITS + 1)'(inexact_4[k]);
        {lo_margin_5, backwards_5} <= {margin_4[k] + 1'b1, negative_4[k]};
      end
    for (int k = 0; k < 3; k++) begin
      // The size rounded down, or up if inexact. A negative unit is rounded the other way.
      near_unit_5[k] <= ({UW{negative_4[k]}} ^ UW'(down_4[k])) + UW'(negative_4[k] && !inexact_4[k]);
      far_unit_5[k] <= ({UW{negative_4[k]}} ^ UW'(down_4[k])) + UW'(negative_4[k] || inexact_4[k]);
      margin_5[k] <= margin_4[k] + 1'b1;
    end
    {near_unit_6, far_unit_6, margin_6} <= {near_unit_5, far_unit_5, margin_5};
    before_6 <= lo_margin_5 + (backwards_5 ? length : '0);
    after_6 <= lo_margin_5 + (backwards_5 ? '0 : length);
  end

  // ---- Results ----
  logic [2:0] infinite_6;
  pipe_delay #(.W(3), .FROM(3), .TO(T_MARGIN - 1)) delay_infinite (.clk_i, .d_i(infinite_3), .q_o(infinite_6));
  always_ff @(posedge clk_i)
    if (first[T_MARGIN-1]) begin
      infinite_o <= infinite_6;
      {near_unit_o, far_unit_o} <= {near_unit_6, far_unit_6};
      for (int k = 0; k < 3; k++) begin
        near_margin_o[k] <= margin_6[k] + (slow_6[k] ? before_6 : '0);
        far_margin_o[k] <= margin_6[k] + (slow_6[k] ? after_6 : '0);
      end
    end
endmodule
