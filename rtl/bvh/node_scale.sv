// SPDX-License-Identifier: Apache-2.0
// The steps of T in which a node's boxes are tested for a ray, and what depends on them alone (planes_of() of
// host/src/reference/integer_node.cpp). The axis lo, on which the ray is in the node for the shortest T, sets the
// shared step. On a slow axis, where numbers would have too many bits, steps are longer. Its margins also have all T
// that lo allows, so that its bounds count as shared steps.
// Latency: 3 cycles to lo_o and scale_o, 4 to step_o, NODE_T_SIZES to sizes_o (bvh.svh).
// Throughput: one node per CYCLES cycles. The inputs of a node stay for as long, and so do its outputs.
// Stall: none, runs free.
`include "bvh.svh"
module node_scale #(
    parameter int UNIT_BITS = 16,  // 12 to 16
    parameter int STEP_BITS = 6,   // 2 to 6: the least unit has 2^STEP_BITS steps or more
    parameter int CYCLES = 1       // 1 or 2
) (
    input logic clk_i,
    input logic first_i,                // the first cycle of a node; used with CYCLES = 2
    input logic [2:0][31:0] inverse_i,  // 1 / d
    input logic [2:0][31:0] margin_i,   // T of the margin; may be infinite
    input logic [2:0][7:0] exponent_i,  // of the node, signed
    output logic [2:0] lo_o,            // one bit is set
    output logic [7:0] scale_o,         // biased exponent of the shared step
    output logic [2:0][7:0] step_o,     // biased exponents of the steps
    output logic [2:0][`NODE_SIZES_BITS(UNIT_BITS)-1:0] sizes_o  // of each axis
);
  /*verilator inline_module*/
  `NODE_SIZES(UNIT_BITS)
  localparam int T_SIZES = `NODE_T_SIZES(CYCLES);
  localparam int MW = 24;  // bits of a significand
  localparam int BYTE = 8;
  localparam int FOUR = 2;  // a margin has a scale of its own only if four of it exceed the node
  localparam int XW = 11;  // bits of an exponent, signed
  if (UNIT_BITS < 12 || UNIT_BITS > 16) $error("node_scale: UNIT_BITS must be 12 to 16");
  if (STEP_BITS < 2 || STEP_BITS > 6) $error("node_scale: STEP_BITS must be 2 to 6");
  if (CYCLES != 1 && CYCLES != 2) $error("node_scale: CYCLES must be 1 or 2");
  if (T_SIZES != 4 + CYCLES) $error("node_scale: NODE_T_SIZES does not match");

  // first[k]: the first cycle of a node in stage k.
  logic [5:0] first;
  logic unused_first;
  assign unused_first = &{1'b0, first, first_i};
  if (CYCLES == 1) begin : g_always
    assign first = '1;
  end else begin : g_first
    logic [4:0] first_q;
    always_ff @(posedge clk_i) first_q <= first[4:0];
    assign first = {first_q, first_i};
  end

  // ---- Ranges: the larger of 256 units and of 4 margins, as an exponent ----
  logic [2:0][XW-1:0] unit_1, margin_1, unit_2, margin_2, range_2;
  for (genvar k = 0; k < 3; k++) begin : sizes
    logic wider;
    assign wider = $signed(unit_1[k]) > $signed(margin_1[k] - XW'(BYTE - FOUR));
    always_ff @(posedge clk_i) begin
      unit_1[k] <= {3'b0, inverse_i[k][30:23]} + {{3{exponent_i[k][7]}}, exponent_i[k]};
      margin_1[k] <= {3'b0, margin_i[k][30:23]} | XW'(margin_i[k][30:23] == 0);
      unit_2[k] <= unit_1[k];
      margin_2[k] <= margin_1[k];
      range_2[k] <= (wider ? unit_1[k] : margin_1[k]) + (wider ? XW'(BYTE) : XW'(FOUR));
    end
  end

  // ---- Axis lo: the least range, ties the lowest axis ----
  logic [2:0] shorter, lo;  // [0]: axis 1 than 0, [1]: 2 than 0, [2]: 2 than 1
  logic [2:0][XW-1:0] unit_3, margin_3, range_3;
  logic [XW-1:0] shared, most_3, places_3;  // largest range that allows the shared step; exponent of words not shifted
  assign shorter = {$signed(range_2[2]) < $signed(range_2[1]), $signed(range_2[2]) < $signed(range_2[0]),
      $signed(range_2[1]) < $signed(range_2[0])};
  assign lo = {shorter[2] && shorter[1], shorter[0] && !shorter[2], !shorter[0] && !shorter[1]};
  assign shared = (range_2[0] & {XW{lo[0]}}) | (range_2[1] & {XW{lo[1]}}) | (range_2[2] & {XW{lo[2]}});
  always_ff @(posedge clk_i) begin
    lo_o <= lo;
    scale_o <= shared[7:0] - 8'(BYTE + STEP_BITS);
    most_3 <= shared + XW'(UNIT_BITS - 1 - STEP_BITS);
    places_3 <= shared + XW'(MW - 1 - BYTE - STEP_BITS);
    {unit_3, margin_3, range_3} <= {unit_2, margin_2, range_2};
  end

  // ---- Steps of each axis, and by how many places units and margins are larger. With CYCLES = 2, margins follow
  // units ----
  localparam int LONGER = BYTE + UNIT_BITS - 1;
  localparam int SHIFTS = (CYCLES == 1) ? 2 : 1;
  logic [2:0] slow_4;
  logic [2:0][SHIFTS-1:0][4:0] shift_4;
  function automatic logic [4:0] shift_of(input logic [XW-1:0] places);
    shift_of = (places > XW'(31)) ? 5'd31 : places[4:0];
  endfunction
  for (genvar k = 0; k < 3; k++) begin : steps
    logic [XW-1:0] places;
    logic slow;
    assign slow = $signed(range_3[k]) > $signed(most_3);
    assign places = range_3[k] + XW'(MW - 1 - LONGER);
    always_ff @(posedge clk_i) begin
      slow_4[k] <= slow;
      step_o[k] <= slow ? range_3[k][7:0] - 8'(LONGER) : scale_o;
    end
    for (genvar s = 0; s < SHIFTS; s++) begin : of
      logic [XW-1:0] size;
      assign size = (s == 0 && first[3]) ? unit_3[k] : margin_3[k];
      always_ff @(posedge clk_i) shift_4[k][s] <= slow ? shift_of(places - size) : shift_of(places_3 - size);
    end
  end

  // ---- Units and margins as whole numbers, rounded down ----
  logic [2:0] lo_4;
  always_ff @(posedge clk_i) lo_4 <= lo_o;
  for (genvar k = 0; k < 3; k++) begin : whole
    logic [56:0] words, words_4;
    logic [MW-1:0] unit_size, margin_size;
    logic [SHIFTS-1:0][MW-1:0] shifted;
    logic [SHIFTS-1:0] lost;
    logic [6:0] unused_zeros;
    logic sign_4, infinite_4, unused;
    sizes_t sizes_q;
    assign words = {inverse_i[k][31], &margin_i[k][30:23], 1'b1, inverse_i[k][22:0], 7'd0, margin_i[k][30:23] != 0,
        margin_i[k][22:0]};
    pipe_delay #(.W(57), .TO(4)) delay_words (.clk_i, .d_i(words), .q_o(words_4));
    assign {sign_4, infinite_4, unit_size, unused_zeros, margin_size} = words_4;
    assign unused = &{1'b0, shifted, lost, margin_i[k][31], unused_zeros};  // upper bits are 0
    for (genvar s = 0; s < SHIFTS; s++) begin : of
      shift_sticky #(.W(MW)) shift (
          .d_i((s == 0 && first[4]) ? unit_size : margin_size), .fill_i(1'b0), .by_i(shift_4[k][s]), .q_o(shifted[s]),
          .lost_o(lost[s]));
    end
    if (CYCLES == 1) begin : g_at_once
      always_ff @(posedge clk_i)
        sizes_q <= '{lo: lo_4[k], slow: slow_4[k], negative: sign_4, infinite: infinite_4, inexact: lost[0],
            unit: shifted[0][UNIT_BITS:0], margin: (UNIT_BITS + 8)'(shifted[SHIFTS-1])};
    end else begin : g_in_turn
      sizes_t early_q;  // all but the margin
      always_ff @(posedge clk_i) begin
        if (first[4])
          early_q <= '{lo: lo_4[k], slow: slow_4[k], negative: sign_4, infinite: infinite_4, inexact: lost[0],
              unit: shifted[0][UNIT_BITS:0], margin: '0};
        if (first[5]) begin
          sizes_q <= early_q;
          sizes_q.margin <= (UNIT_BITS + 8)'(shifted[0]);
        end
      end
    end
    assign sizes_o[k] = sizes_q;
  end
endmodule
