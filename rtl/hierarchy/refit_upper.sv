// SPDX-License-Identifier: Apache-2.0
// The upper corner of a node, of one axis: origin + byte 2^exponent, rounded up to fp32.
// Both are brought to the larger exponent as integers with a bit more than fp32 has, what does not fit is rounded up,
// and so is their sum. The exponent of a byte is 2^-80 at least, so no sum but zero is subnormal.
// Latency: 4 cycles.
// Throughput: one corner per cycle.
// Stall: none, runs free.
module refit_upper (
    input logic clk_i,
    input logic [31:0] origin_i,   // fp32, finite
    input logic [7:0] exponent_i,  // signed
    input logic [7:0] byte_i,
    output logic [31:0] upper_o    // as an ordered word
);
  localparam int MW = 25;
  localparam int SW = MW + 2;  // of a sum, with a sign

  // ---- How far each is from the larger exponent ----
  logic negative_1;
  logic [7:0] origin_exponent, byte_exponent, most_1, origin_shift_1, byte_shift_1, byte_1;
  logic [MW-1:0] origin_1;
  assign origin_exponent = (origin_i[30:23] == 0) ? 8'd1 : origin_i[30:23];
  assign byte_exponent = exponent_i + 8'd134;  // of its highest bit, where a mantissa has its own
  always_ff @(posedge clk_i) begin
    negative_1 <= origin_i[31];
    origin_1 <= {origin_i[30:23] != 0, origin_i[22:0], 1'b0};
    byte_1 <= byte_i;
    most_1 <= (origin_exponent > byte_exponent) ? origin_exponent : byte_exponent;
    origin_shift_1 <= (origin_exponent > byte_exponent) ? '0 : byte_exponent - origin_exponent;
    byte_shift_1 <= (origin_exponent > byte_exponent) ? origin_exponent - byte_exponent : '0;
  end

  // ---- There, rounded up ----
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

  // ---- The sum, and its size ----
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

  // ---- As a word in order ----
  logic [30:0] magnitude;
  logic [4:0] lead;    // zeros before the highest bit
  logic [SW-2:0] high;
  logic [23:0] mantissa;
  always_comb begin
    lead = '0;
    for (int i = 0; i < SW - 1; i++) if (size_3[i]) lead = 5'(SW - 2 - i);
    high = size_3 << lead;
    // Of the bits below the mantissa some are not zero only if the sum is that long.
    mantissa = high[SW-2-:24];
    magnitude = {most_3 - 8'(lead), 23'd0} + {7'd0, mantissa} + 31'(!negative_3 && high[SW-26:0] != 0);
  end
  always_ff @(posedge clk_i)
    upper_o <= (size_3 == 0) ? 32'h8000_0000 : {!negative_3, magnitude ^ {31{negative_3}}};
endmodule
