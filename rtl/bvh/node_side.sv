// SPDX-License-Identifier: Apache-2.0
// Where a ray enters the boxes of a node's children, in whole steps of T: the near side. For the far side, where it
// leaves them, all T have the other sign. So each side is the greatest of three lower bounds.
// Latency: T_STEPS - T_SIZES cycles from sizes_i to the use of steps_i and byte_i, at least 3. 3 cycles from there.
// Throughput: one side of CHILDREN boxes per cycle.
// Stall: none, runs free.
`include "bvh.svh"
module node_side #(
    parameter int CHILDREN = bvh_pkg::CHILDREN,  // or half of them
    parameter int UNIT_BITS = 16,
    parameter int T_SIZES = 4,   // stage of sizes_i
    parameter int T_STEPS = 8,   // stage of steps_i and byte_i
    localparam int NW = `NODE_BOUND_BITS(UNIT_BITS)
) (
    input logic clk_i,
    input logic far_i,  // the far side; for sizes_i
    input logic [2:0][`NODE_SIZES_BITS(UNIT_BITS)-1:0] sizes_i,
    input logic far_steps_i,  // the same, for steps_i
    input logic [2:0][NW-1:0] steps_i,  // T of the planes of byte 0, rounded down
    input logic [2:0] inexact_i,        // it is larger
    input logic [2:0][CHILDREN-1:0][7:0] byte_i,
    output logic [CHILDREN-1:0][NW-1:0] bound_o
);
  /*verilator inline_module*/
  `NODE_SIZES(UNIT_BITS)
  localparam int BOUND = UNIT_BITS + 9;  // planes are within +-2^BOUND
  localparam int UW = UNIT_BITS + 2;
  localparam int MW = UNIT_BITS + 8;
  localparam int T_MARGIN = T_SIZES + 3;
  if (T_MARGIN > T_STEPS) $error("node_side: T_STEPS is too early");
  localparam logic [NW-1:0] LEAST = {1'b1, {(NW - 1) {1'b0}}};
  sizes_t [2:0] sizes;
  assign sizes = sizes_i;

  // ---- Units with sign, and the T that axis lo allows beyond T_ref on this side: its margin, or also 255 units.
  // Margins are one step larger than the numbers for them ----
  logic [2:0][UW-1:0] unit_1;
  logic [2:0][MW-1:0] margin_1, margin_2, margin_3;
  logic [2:0] slow_1, slow_2;
  logic [UNIT_BITS:0] lo_unit_1;
  logic [MW-1:0] lo_margin_1, allowed_2;
  logic long_1;
  always_ff @(posedge clk_i) begin
    {lo_unit_1, lo_margin_1, long_1} <= '0;
    for (int k = 0; k < 3; k++) begin
      if (sizes[k].lo) begin
        lo_unit_1 <= sizes[k].unit + (UNIT_BITS + 1)'(sizes[k].inexact);
        {lo_margin_1, long_1} <= {sizes[k].margin, sizes[k].negative ^ far_i};
      end
      // The size rounded down, or its negative rounded down.
      unit_1[k] <= ({UW{sizes[k].negative ^ far_i}} ^ UW'(sizes[k].unit)) +
          UW'((sizes[k].negative ^ far_i) && !sizes[k].inexact);
      {margin_1[k], slow_1[k]} <= {sizes[k].margin, sizes[k].slow};
    end
    allowed_2 <= lo_margin_1 + (long_1 ? {lo_unit_1[UNIT_BITS-1:0], 8'd0} - MW'(lo_unit_1) : '0) + 1'b1;
    {margin_2, slow_2} <= {margin_1, slow_1};
    for (int k = 0; k < 3; k++) margin_3[k] <= margin_2[k] + (slow_2[k] ? allowed_2 : '0);
  end
  logic [2:0] infinite, infinite_late;
  logic [2:0][UW-1:0] unit_late;
  logic [2:0][MW-1:0] margin_late;
  for (genvar k = 0; k < 3; k++) begin : axes
    assign infinite[k] = sizes[k].infinite;
  end
  pipe_delay #(.W(3), .FROM(T_SIZES), .TO(T_STEPS)) delay_infinite (.clk_i, .d_i(infinite), .q_o(infinite_late));
  pipe_delay #(.W(3 * UW), .FROM(T_SIZES + 1), .TO(T_STEPS)) delay_unit (.clk_i, .d_i(unit_1), .q_o(unit_late));
  pipe_delay #(.W(3 * MW), .FROM(T_MARGIN), .TO(T_STEPS)) delay_margin (.clk_i, .d_i(margin_3), .q_o(margin_late));

  // ---- Planes of byte 0, widened: beyond 2^BOUND there is a weaker bound, or none. Then plane + byte * unit ----
  localparam int RW = NW + 1;
  localparam logic [RW-1:0] BOUND_MOST = RW'(1) << BOUND;
  logic [2:0][CHILDREN-1:0][NW-1:0] axis_q;
  for (genvar k = 0; k < 3; k++) begin : axis
    logic [RW-1:0] now, plane;
    logic [NW-1:0] plane_q;
    logic none_q;
    assign now = {steps_i[k][NW-1], steps_i[k]} ^ {RW{far_steps_i}};
    assign plane = now + ~RW'(margin_late[k]) + RW'(far_steps_i && !inexact_i[k]);
    always_ff @(posedge clk_i) begin
      plane_q <= ($signed(plane) > $signed(BOUND_MOST)) ? BOUND_MOST[NW-1:0] : plane[NW-1:0];
      none_q <= infinite_late[k] || $signed(plane) < $signed(-BOUND_MOST);
    end
    for (genvar c = 0; c < CHILDREN; c++) begin : child
      logic [NW-1:0] offset_q;
      always_ff @(posedge clk_i) begin
        offset_q <= NW'($signed({1'b0, byte_i[k][c]}) * $signed(unit_late[k]));
        axis_q[k][c] <= none_q ? LEAST : plane_q + offset_q;
      end
    end
  end

  // ---- The greatest of three ----
  for (genvar c = 0; c < CHILDREN; c++) begin : box
    logic [2:0][NW-1:0] at;
    logic [2:0] later;  // [0]: axis 1 than 0, [1]: 2 than 0, [2]: 2 than 1
    assign at = {axis_q[2][c], axis_q[1][c], axis_q[0][c]};
    assign later = {$signed(at[2]) > $signed(at[1]), $signed(at[2]) > $signed(at[0]), $signed(at[1]) > $signed(at[0])};
    always_ff @(posedge clk_i) bound_o[c] <= (later[1] && later[2]) ? at[2] : later[0] ? at[1] : at[0];
  end
endmodule
