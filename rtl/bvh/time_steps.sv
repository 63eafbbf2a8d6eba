// SPDX-License-Identifier: Apache-2.0
// T - T_ref as a whole number of steps 2^E, rounded down (difference() of host/src/reference/integer_node.cpp). The
// difference is exact. Results beyond BITS bits saturate. T may be infinite, and T_ref is finite.
// Where bits of the smaller number are lost, the difference has at least 23 + GUARD bits. So it saturates if a step is
// finer than they are.
// Latency: 4 cycles.
// Throughput: one number per cycle.
// Stall: none, runs free.
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
  localparam int MW = 24;  // bits of a significand
  localparam int GUARD = (BITS > 25) ? BITS - 23 : 2;  // bits kept below the larger number
  localparam int AW = MW + GUARD;
  localparam int DW = AW + 2;  // bits of a difference
  localparam int UP = BITS - 1;  // from this shift to the left on, all but 0 saturates
  localparam int PW = DW + UP;
  if (BITS < 2 || BITS > 27) $error("time_steps: BITS must be 2 to 27");

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
  assign aligned = {small_1, GUARD'(0)} >> apart_1;
  logic [MW-1:0] large_2;
  logic [AW-1:0] small_2;
  logic signed [9:0] shift_2;  // places to the left from the difference to steps
  logic large_sign_2, small_sign_2, lost_2, infinite_2, sign_2;
  always_ff @(posedge clk_i) begin
    large_2 <= large_1;
    small_2 <= aligned;
    lost_2 <= (aligned << apart_1) != {small_1, GUARD'(0)};
    shift_2 <= $signed({2'b0, exponent_1}) - $signed({2'b0, step_1}) - 10'(MW - 1 + GUARD);
    {large_sign_2, small_sign_2, infinite_2, sign_2} <= {large_sign_1, small_sign_1, infinite_1, sign_1};
  end

  // ---- Difference, rounded down ----
  logic [DW-1:0] difference_3, large_term, small_term;
  logic signed [9:0] shift_3;
  logic lost_3, infinite_3, sign_3;
  assign large_term = {2'b0, large_2, GUARD'(0)};
  assign small_term = {2'b0, small_2};
  always_ff @(posedge clk_i) begin
    // Lost bits of a negative number are one less.
    difference_3 <= (large_sign_2 ? -large_term : large_term) +
        (small_sign_2 ? ~small_term + DW'(!lost_2) : small_term);
    {shift_3, lost_3, infinite_3, sign_3} <= {shift_2, lost_2, infinite_2, sign_2};
  end

  // ---- In steps ----
  logic [PW-1:0] shifted;
  logic [DW-1:0] below;
  logic [6:0] right;
  logic too_far, negative, saturated;
  always_comb begin
    negative = infinite_3 ? sign_3 : difference_3[DW-1];
    too_far = shift_3 > 10'(UP);
    right = (shift_3 < -10'(DW)) ? 7'(UP + DW) : 7'(10'(UP) - shift_3);
    if (too_far) right = '0;
    shifted = $signed({difference_3, UP'(0)}) >>> right;
    below = (right > 7'(UP)) ? difference_3 & ~({DW{1'b1}} << (right - 7'(UP))) : '0;
    saturated = infinite_3 || (too_far && difference_3 != 0) ||
        shifted[PW-1:BITS-1] != {(PW - BITS + 1) {shifted[PW-1]}};
  end
  always_ff @(posedge clk_i) begin
    steps_o <= saturated ? {negative, {(BITS - 1) {!negative}}} : shifted[BITS-1:0];
    inexact_o <= !saturated && (lost_3 || below != 0);
  end
endmodule
