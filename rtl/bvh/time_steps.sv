// SPDX-License-Identifier: Apache-2.0
// T - T_ref as a whole number of steps 2^E, rounded down (difference() of host/src/reference/integer_node.cpp). The
// difference is exact. Results beyond BITS bits saturate. T may be infinite, and T_ref is finite.
// Where bits of the smaller number are lost, the difference has at least 23 + GUARD bits. So it saturates if a step is
// finer than they are.
// Latency: TIME_T_STEPS cycles (bvh.svh).
// Throughput: one number per cycle.
// Stall: none, runs free.
`include "bvh.svh"
module time_steps #(
    parameter int BITS = 27  // of a signed result, 2 to 27
) (
    input logic clk_i,
    input logic [31:0] time_i,
    input logic [31:0] reference_i,
    input logic [7:0] step_i,  // biased exponent of a step: E + 127
    output logic [BITS-1:0] steps_o,
    output logic inexact_o  // T - T_ref is larger; 0 if saturated
);
  /*verilator inline_module*/
  localparam int MW = 24;  // bits of a significand
  localparam int GUARD = (BITS > 25) ? BITS - 23 : 2;  // bits kept below the larger number
  localparam int AW = MW + GUARD;
  localparam int DW = AW + 2;  // bits of a difference
  localparam int BY = 5;       // bits of a distance to shift: 31 shifts out any word
  if (BITS < 2 || BITS > 27) $error("time_steps: BITS must be 2 to 27");
  if (`TIME_T_STEPS != 5) $error("time_steps: TIME_T_STEPS does not match");

  // ---- The number with the larger exponent first; a subnormal number has exponent 1 ----
  logic [1:0][7:0] exponent;
  logic [1:0][MW-1:0] significand;
  logic [1:0] sign;
  logic swap;
  assign exponent[0] = time_i[30:23] | {7'd0, time_i[30:23] == 0};
  assign exponent[1] = reference_i[30:23] | {7'd0, reference_i[30:23] == 0};
  assign significand[0] = {time_i[30:23] != 0, time_i[22:0]};
  assign significand[1] = {reference_i[30:23] != 0, reference_i[22:0]};
  assign sign = {!reference_i[31], time_i[31]};
  assign swap = exponent[0] < exponent[1];
  logic [MW-1:0] large_1, small_1;
  logic [7:0] apart_1, exponent_1, step_1;
  logic large_sign_1, small_sign_1, infinite_1, sign_1;
  always_ff @(posedge clk_i) begin
    {large_sign_1, large_1} <= swap ? {sign[1], significand[1]} : {sign[0], significand[0]};
    {small_sign_1, small_1} <= swap ? {sign[0], significand[0]} : {sign[1], significand[1]};
    exponent_1 <= swap ? exponent[1] : exponent[0];
    apart_1 <= swap ? exponent[1] - exponent[0] : exponent[0] - exponent[1];
    step_1 <= step_i;
    infinite_1 <= &time_i[30:23];
    sign_1 <= time_i[31];
  end

  // ---- Aligned ----
  logic [AW-1:0] aligned;
  logic lost, far_apart;
  shift_sticky #(.W(AW), .BY(BY)) align (
      .d_i({small_1, GUARD'(0)}), .fill_i(1'b0), .by_i(apart_1[BY-1:0]), .q_o(aligned), .lost_o(lost));
  assign far_apart = apart_1[7:BY] != '0;
  logic [MW-1:0] large_2;
  logic [AW-1:0] small_2;
  logic signed [9:0] shift_2;  // places to the left from the difference to steps
  logic large_sign_2, small_sign_2, lost_2, infinite_2, sign_2;
  always_ff @(posedge clk_i) begin
    large_2 <= large_1;
    small_2 <= far_apart ? '0 : aligned;
    lost_2 <= far_apart ? small_1 != '0 : lost;
    shift_2 <= $signed({2'b0, exponent_1}) - $signed({2'b0, step_1}) - 10'(MW - 1 + GUARD);
    {large_sign_2, small_sign_2, infinite_2, sign_2} <= {large_sign_1, small_sign_1, infinite_1, sign_1};
  end

  // ---- Difference, rounded down ----
  logic [DW-1:0] difference_3, large_term, small_term;
  logic [9:0] distance;
  logic [BY-1:0] by_3;
  logic left_3, lost_3, infinite_3, sign_3;
  assign large_term = {2'b0, large_2, GUARD'(0)};
  assign small_term = {2'b0, small_2};
  assign distance = (shift_2 < 0) ? -shift_2 : shift_2;
  always_ff @(posedge clk_i) begin
    // Lost bits of a negative number are one less.
    difference_3 <= (large_sign_2 ? -large_term : large_term) +
        (small_sign_2 ? ~small_term + DW'(!lost_2) : small_term);
    left_3 <= shift_2 >= 0;
    by_3 <= (distance[9:BY] != '0) ? '1 : distance[BY-1:0];
    {lost_3, infinite_3, sign_3} <= {lost_2, infinite_2, sign_2};
  end

  // ---- In steps, in two stages. A word is shifted to the left in reverse order, with all bits inverted if it is
  // negative. So a one shifted out is a bit that differs from the sign ----
  logic [DW-1:0] word, reversed, near, far, near_4, steps;
  logic [BY-4:0] by_4;
  logic gone, gone_4, gone_far, left_4, lost_4, infinite_4, sign_4, negative_4, saturated;
  shift_sticky #(.W(DW), .BY(3)) shift_near (
      .d_i(word), .fill_i(difference_3[DW-1]), .by_i(by_3[2:0]), .q_o(near), .lost_o(gone));
  shift_sticky #(.W(DW), .BY(BY - 3), .FIRST(3)) shift_far (
      .d_i(near_4), .fill_i(negative_4), .by_i(by_4), .q_o(far), .lost_o(gone_far));
  always_comb begin
    for (int k = 0; k < DW; k++) begin
      word[k] = left_3 ? difference_3[DW-1-k] ^ difference_3[DW-1] : difference_3[k];
      reversed[k] = far[DW-1-k] ^ negative_4;
    end
    steps = left_4 ? reversed : far;
    saturated = infinite_4 || (left_4 && (gone_4 || gone_far)) || steps[DW-1:BITS-1] != {(DW - BITS + 1) {negative_4}};
  end
  always_ff @(posedge clk_i) begin
    {near_4, gone_4, by_4, left_4, negative_4} <= {near, gone, by_3[BY-1:3], left_3, difference_3[DW-1]};
    {lost_4, infinite_4, sign_4} <= {lost_3, infinite_3, sign_3};
    steps_o <= !saturated ? steps[BITS-1:0] : (infinite_4 ? sign_4 : negative_4) ? {1'b1, {(BITS - 1) {1'b0}}} :
        {1'b0, {(BITS - 1) {1'b1}}};
    inexact_o <= !saturated && (lost_4 || gone_4 || gone_far);
  end
endmodule
