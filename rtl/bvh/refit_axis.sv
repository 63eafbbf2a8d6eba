// SPDX-License-Identifier: Apache-2.0
// Encodes the boxes of a node's children as bytes, for one axis. First comes the box of all children, which gives
// origin and exponent, then child after child.
//
// Corners become integers in units of 2^(m-24), with m the larger exponent of the two ends of all. That is one bit more
// than the mantissa of the larger end. Rounding is down or up, so that boxes grow. So bytes always contain the box:
//
//     lower byte = floor(max(down(corner) - up(origin), 0) / 2^s)
//     upper byte = ceil((up(corner) - down(origin)) / 2^s)
//
// Only numbers below half of the largest (M) lose bits. Then the node is longer than M / 2 and a byte is at least 2^16
// units. So the loss costs at most one more byte. Otherwise all corners are near each other and far from zero, and all
// is exact. The shift s is the least value >= 0 with which bytes fit: no step is finer than a unit.
// Latency: 4 cycles.
// Throughput: one box per cycle.
// Stall: none, runs free.
module refit_axis (
    input logic clk_i,
    input logic first_i,         // the box of all children; the others follow before the next first_i
    input logic [31:0] lower_i,  // corners as ordered words (bvh_pkg)
    input logic [31:0] upper_i,
    output logic [31:0] origin_o,  // from the first box: fp32
    output logic [7:0] exponent_o,
    output logic [7:0] lower_o,    // from the other boxes
    output logic [7:0] upper_o
);
  localparam int MW = 25;      // bits of a mantissa, plus one below
  localparam int DW = MW + 2;  // bits of a difference
  localparam int BIAS = 127 + MW - 1;
  localparam int LEAST = -80;  // exponent of a node: Node::kLeastExponent

  // ---- Sign, exponent, mantissa; the larger exponent of the first box ----
  function automatic logic [31:0] word(input logic [31:0] key);
    word = key[31] ? {1'b0, key[30:0]} : ~key;
  endfunction
  function automatic logic [7:0] normal(input logic [7:0] exponent);
    normal = (exponent == 0) ? 8'd1 : exponent;
  endfunction
  logic [1:0][31:0] x;  // lower, upper
  logic [1:0][7:0] exponent;
  assign x = {word(upper_i), word(lower_i)};
  assign exponent = {normal(x[1][30:23]), normal(x[0][30:23])};
  logic first_1;
  logic [7:0] most_q;
  logic [1:0] sign_1;
  logic [1:0][7:0] exponent_1;
  logic [1:0][MW-1:0] mantissa_1;
  logic [31:0] origin_1;
  always_ff @(posedge clk_i) begin
    first_1 <= first_i;
    origin_1 <= x[0];
    if (first_i) most_q <= (exponent[1] > exponent[0]) ? exponent[1] : exponent[0];
  end
  for (genvar c = 0; c < 2; c++) begin : number
    always_ff @(posedge clk_i) begin
      sign_1[c] <= x[c][31];
      exponent_1[c] <= exponent[c];
      mantissa_1[c] <= {x[c][30:23] != 0, x[c][22:0], 1'b0};
    end
  end

  // ---- Shift to one exponent ----
  logic first_2;
  logic [7:0] most_2;
  logic [31:0] origin_2;
  logic [1:0] sign_2, lost_2;
  logic [1:0][MW-1:0] mantissa_2;
  always_ff @(posedge clk_i) {first_2, origin_2, most_2, sign_2} <= {first_1, origin_1, most_q, sign_1};
  for (genvar c = 0; c < 2; c++) begin : moved
    logic [7:0] by;
    logic [MW-1:0] kept;
    assign by = most_q - exponent_1[c];
    assign kept = mantissa_1[c] >> by;
    always_ff @(posedge clk_i) begin
      mantissa_2[c] <= kept;
      lost_2[c] <= (kept << by) != mantissa_1[c];
    end
  end

  // ---- Relative to the origin ----
  function automatic logic signed [DW-1:0] rounded(
      input logic negative, input logic [MW-1:0] mantissa, input logic lost, input logic up);
    rounded = DW'(mantissa) + DW'(lost && negative != up);
    if (negative) rounded = -rounded;
  endfunction
  logic first_3;
  logic [7:0] most_3;
  logic [31:0] origin_3;
  logic signed [DW-1:0] base_down_q, base_up_q, base_down, base_up, lower_down, lower_3;
  logic [DW-1:0] upper_3;
  assign lower_down = rounded(sign_2[0], mantissa_2[0], lost_2[0], 1'b0);
  assign base_down = first_2 ? lower_down : base_down_q;
  assign base_up = first_2 ? rounded(sign_2[0], mantissa_2[0], lost_2[0], 1'b1) : base_up_q;
  always_ff @(posedge clk_i) begin
    {first_3, origin_3, most_3} <= {first_2, origin_2, most_2};
    {base_down_q, base_up_q} <= {base_down, base_up};
    lower_3 <= lower_down - base_up;  // below 0 by the rounding
    upper_3 <= rounded(sign_2[1], mantissa_2[1], lost_2[1], 1'b1) - base_down;
  end

  // ---- Bytes ----
  function automatic logic [DW-1:0] ceiling(input logic [DW-1:0] d, input logic [6:0] s);
    ceiling = d >> s;
    if ((ceiling << s) != d) ceiling = ceiling + 1;
  endfunction
  logic [6:0] shift, least, shift_q;
  logic [DW-1:0] short_;  // length less one unit: its floor is one less than the length's ceiling
  always_comb begin
    short_ = upper_3 - DW'(upper_3 != 0);
    shift = '0;
    for (int s = DW - 8; s >= 0; s--) if ((short_ >> s) < 255) shift = 7'(s);  // the least with which bytes fit
    least = (int'(most_3) < BIAS + LEAST) ? 7'(BIAS + LEAST - int'(most_3)) : '0;
    if (shift < least) shift = least;
  end
  logic [DW-1:0] floors, ceilings;
  assign floors = lower_3[DW-1] ? '0 : (lower_3 >> shift_q);
  assign ceilings = ceiling(upper_3, shift_q);
  always_ff @(posedge clk_i) begin
    origin_o <= origin_3;
    exponent_o <= most_3 - 8'(BIAS) + 8'(shift);
    if (first_3) shift_q <= shift;
    lower_o <= floors[7:0];
    upper_o <= ceilings[7:0];
  end
  logic unused;
  assign unused = &{1'b0, floors[DW-1:8], ceilings[DW-1:8]};
endmodule
