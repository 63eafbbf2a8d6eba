// SPDX-License-Identifier: Apache-2.0
// The upper corner of a node on one axis: origin + byte 2^exponent, rounded up to fp32.
// Both terms become integers at the larger exponent, with one bit more than fp32; each term and the sum are rounded up.
// The exponent of a byte is at least 2^-80, so no sum but zero is subnormal.
// Latency: 4 cycles.
// Throughput: one corner per cycle.
// Stall: none, runs free.
module refit_upper (
    input logic clk_i,
    input logic [31:0] origin_i,   // fp32, finite
    input logic [7:0] exponent_i,  // signed
    input logic [7:0] byte_i,
    output logic [31:0] upper_o    // an ordered word
);
  localparam int MW = 25;
  localparam int SW = MW + 2;  // bits of a sum, with its sign

  // ---- Distance of each exponent from the larger one ----
  logic negative_1;
  logic [7:0] origin_exponent, byte_exponent, most_1, origin_shift_1, byte_shift_1, byte_1;
  logic [MW-1:0] origin_1;
  assign origin_exponent = (origin_i[30:23] == 0) ? 8'd1 : origin_i[30:23];
  assign byte_exponent = exponent_i + 8'd134;  // exponent of the byte's highest bit, at the place of a mantissa's
  always_ff @(posedge clk_i) begin
    negative_1 <= origin_i[31];
    origin_1 <= {origin_i[30:23] != 0, origin_i[22:0], 1'b0};
    byte_1 <= byte_i;
    most_1 <= (origin_exponent > byte_exponent) ? origin_exponent : byte_exponent;
    origin_shift_1 <= (origin_exponent > byte_exponent) ? '0 : byte_exponent - origin_exponent;
    byte_shift_1 <= (origin_exponent > byte_exponent) ? origin_exponent - byte_exponent : '0;
  end

  // ---- Shifted to it, rounded up ----
  function automatic logic [SW-1:0] moved(input logic [MW-1:0] x, input logic [7:0] shift, input logic away);
    logic [MW-1:0] kept;
    kept = x >> shift;
    moved = SW'(kept) + SW'(away && (kept << shift) != x);
  endfunction
  logic negative_2;
  logic [7:0] most_2;
  logic [SW-1:0] origin_2, byte_2;
  always_ff @(posedge clk_i) begin
    {negative_2, most_2} <= {negative_1, most_1};
    origin_2 <= moved(origin_1, origin_shift_1, !negative_1);
    byte_2 <= moved({byte_1, 17'd0}, byte_shift_1, 1'b1);
  end

  // ---- The sum and its magnitude ----
  logic signed [SW-1:0] sum;
  logic negative_3;
  logic [7:0] most_3;
  logic [SW-2:0] size_3;
  assign sum = negative_2 ? byte_2 - origin_2 : byte_2 + origin_2;
  always_ff @(posedge clk_i) begin
    negative_3 <= sum[SW-1];
    most_3 <= most_2;
    size_3 <= sum[SW-1] ? (SW-1)'(-sum) : sum[SW-2:0];
  end

  // ---- The ordered word ----
  logic [30:0] magnitude;
  logic [4:0] lead;    // zeros before the highest bit
  logic [SW-2:0] high;
  logic [23:0] mantissa;
  always_comb begin
    lead = '0;
    for (int i = 0; i < SW - 1; i++) if (size_3[i]) lead = 5'(SW - 2 - i);
    high = size_3 << lead;
    // Only a sum with bits above can have non-zero bits below the mantissa.
    mantissa = high[SW-2-:24];
    magnitude = {most_3 - 8'(lead), 23'd0} + {7'd0, mantissa} + 31'(!negative_3 && high[SW-26:0] != 0);
  end
  always_ff @(posedge clk_i)
    upper_o <= (size_3 == 0) ? 32'h8000_0000 : {!negative_3, magnitude ^ {31{negative_3}}};
endmodule
