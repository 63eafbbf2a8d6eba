// SPDX-License-Identifier: Apache-2.0
// Chains over lanes, independent lanes, and lanes with registers: the test of `gather` and `reroll` simulates this
// module with and without them.
module prefix_lanes #(parameter int LANES = 16) (
    input logic clk_i,
    input logic [LANES-1:0][31:0] a_i,
    input logic [LANES-1:0][31:0] b_i,
    output logic [LANES-1:0][31:0] any_o,
    output logic [LANES-1:0][31:0] turn_o,
    output logic [LANES-1:0][31:0] and_o,
    output logic [LANES-1:0][31:0] late_o,
    output logic [LANES-1:0][31:0] steps_o
);
  logic [LANES-1:0][31:0] any, turn, step, late_q;
  always_comb begin
    any = '0;
    any[0] = a_i[0];
    for (int l = 1; l < LANES; l++) any[l] = any[l-1] | a_i[l];
  end
  always_comb begin
    turn = '0;
    step = '0;
    turn[0] = b_i[0];
    for (int l = 0; l < LANES - 1; l++) begin
      step[l] = turn[l] ^ a_i[l];
      turn[l+1] = step[l] & b_i[l];
    end
  end
  always_ff @(posedge clk_i) for (int l = 0; l < LANES; l++) late_q[l] <= a_i[l] ^ late_q[l];
  assign any_o = any;
  assign turn_o = turn;
  assign and_o = a_i & b_i;
  assign late_o = late_q;
  for (genvar l = 0; l < LANES; l++) begin : g_lane
    logic [31:0] r;
    lane_steps lane (.clk_i, .a_i(a_i[l]), .b_i(b_i[l]), .r_o(r));
    assign steps_o[l] = r;
  end
endmodule
