// SPDX-License-Identifier: Apache-2.0
// The steps of T in which a node's boxes are tested for a ray, and what depends on them alone (planes_of() of
// host/src/reference/integer_node.cpp). The axis lo, on which the ray is in the node for the shortest T, sets the
// shared step. On a slow axis, where numbers would have too many bits, steps are longer. Its margins also have all T
// that lo allows, so that its bounds count as shared steps.
// Latency: 2 cycles to lo_o and scale_o, 3 to step_o, 6 to the others.
// Throughput: one node per cycle.
// Stall: none, runs free.
module node_scale #(
    parameter int UNIT_BITS = 16,  // 12 to 16
    parameter int STEP_BITS = 6,   // 2 to 6: the least unit has 2^STEP_BITS steps or more
    localparam int UW = UNIT_BITS + 2,
    localparam int MARGIN = UNIT_BITS + 8
) (
    input logic clk_i,
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
  localparam int MW = 24;  // bits of a significand
  localparam int BYTE = 8;
  localparam int FOUR = 2;  // a margin has a scale of its own only if four of it exceed the node
  localparam int XW = 11;  // bits of an exponent, signed
  if (UNIT_BITS < 12 || UNIT_BITS > 16) $error("node_scale: UNIT_BITS must be 12 to 16");
  if (STEP_BITS < 2 || STEP_BITS > 6) $error("node_scale: STEP_BITS must be 2 to 6");

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
  logic [XW-1:0] shared, scale_2;
  assign shorter = {$signed(range_1[2]) < $signed(range_1[1]), $signed(range_1[2]) < $signed(range_1[0]),
      $signed(range_1[1]) < $signed(range_1[0])};
  assign lo = {shorter[2] && shorter[1], shorter[0] && !shorter[2], !shorter[0] && !shorter[1]};
  assign shared = (range_1[0] & {XW{lo[0]}}) | (range_1[1] & {XW{lo[1]}}) | (range_1[2] & {XW{lo[2]}});
  always_ff @(posedge clk_i) begin
    lo_o <= lo;
    scale_2 <= shared - XW'(BYTE + STEP_BITS);
    {unit_2, margin_2, range_2} <= {unit_1, margin_1, range_1};
  end
  assign scale_o = scale_2[7:0];

  // ---- Steps of each axis ----
  logic [2:0] slow_3;
  logic [2:0][4:0] unit_shift_3, margin_shift_3;
  function automatic logic [4:0] shift_of(input logic [XW-1:0] places);
    shift_of = (places > XW'(31)) ? 5'd31 : places[4:0];
  endfunction
  for (genvar k = 0; k < 3; k++) begin : steps
    logic [XW-1:0] longer, step;
    logic slow;
    assign longer = range_2[k] - XW'(BYTE + UNIT_BITS - 1);
    assign slow = $signed(longer) > $signed(scale_2);
    assign step = slow ? longer : scale_2;
    always_ff @(posedge clk_i) begin
      slow_3[k] <= slow;
      step_o[k] <= step[7:0];
      unit_shift_3[k] <= shift_of(step - unit_2[k] + XW'(MW - 1));
      margin_shift_3[k] <= shift_of(step - margin_2[k] + XW'(MW - 1));
    end
  end

  // ---- Units and margins as whole numbers ----
  logic [2:0][MW-1:0] unit_size, margin_size;
  logic [2:0] sign_3, negative_4, negative_5, infinite_3, lo_3, lo_4, slow_4, slow_5;
  for (genvar k = 0; k < 3; k++) begin : words
    logic [57-1:0] now;
    assign now = {inverse_i[k][31], &margin_i[k][30:23], 1'b1, inverse_i[k][22:0], 7'd0, margin_i[k][30:23] != 0,
        margin_i[k][22:0]};
    logic [57-1:0] then;
    logic [6:0] unused;
    pipe_delay #(.W(57), .TO(3)) delay_words (.clk_i, .d_i(now), .q_o(then));
    assign {sign_3[k], infinite_3[k], unit_size[k], unused, margin_size[k]} = then;
  end
  logic [2:0][UNIT_BITS:0] down_4, up_4, down_5, up_5;  // sizes of units, rounded down and up
  logic [2:0][MARGIN-1:0] margin_4, margin_5;
  for (genvar k = 0; k < 3; k++) begin : whole
    logic [MW-1:0] down, margin;
    logic inexact, unused_margin;
    assign unused_margin = &{1'b0, margin};  // its upper bits are 0
    assign down = unit_size[k] >> unit_shift_3[k];
    assign inexact = (down << unit_shift_3[k]) != unit_size[k];
    assign margin = margin_size[k] >> margin_shift_3[k];
    always_ff @(posedge clk_i) begin
      down_4[k] <= (UNIT_BITS + 1)'(down);
      up_4[k] <= (UNIT_BITS + 1)'(down) + (UNIT_BITS + 1)'(inexact);
      margin_4[k] <= MARGIN'(margin) + 1'b1;
    end
  end
  always_ff @(posedge clk_i) begin
    {lo_3, lo_4} <= {lo_o, lo_3};
    {negative_4, negative_5} <= {sign_3, negative_4};
    {slow_4, slow_5} <= {slow_3, slow_4};
    {down_5, up_5, margin_5} <= {down_4, up_4, margin_4};
  end

  // ---- What lo allows before and after T_ref: 255 units one way ----
  logic [UNIT_BITS:0] lo_unit;
  logic [MARGIN-1:0] lo_margin, length, before_5, after_5;
  logic backwards;
  always_comb begin
    {lo_unit, lo_margin, backwards} = '0;
    for (int k = 0; k < 3; k++)
      if (lo_4[k]) {lo_unit, lo_margin, backwards} = {up_4[k], margin_4[k], negative_4[k]};
    length = MARGIN'({lo_unit, 8'd0}) - MARGIN'(lo_unit);
  end
  always_ff @(posedge clk_i) begin
    before_5 <= lo_margin + (backwards ? length : '0);
    after_5 <= lo_margin + (backwards ? '0 : length);
  end
  for (genvar k = 0; k < 3; k++) begin : results
    logic [UW-1:0] down, up;
    assign down = {1'b0, down_5[k]};
    assign up = {1'b0, up_5[k]};
    always_ff @(posedge clk_i) begin
      near_unit_o[k] <= negative_5[k] ? -up : down;
      far_unit_o[k] <= negative_5[k] ? -down : up;
      near_margin_o[k] <= margin_5[k] + (slow_5[k] ? before_5 : '0);
      far_margin_o[k] <= margin_5[k] + (slow_5[k] ? after_5 : '0);
    end
  end
  pipe_delay #(.W(3), .FROM(3), .TO(6)) delay_infinite (.clk_i, .d_i(infinite_3), .q_o(infinite_o));
endmodule
