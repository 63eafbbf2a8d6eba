// SPDX-License-Identifier: Apache-2.0
// The design of the test waves (sample.hpp): it has the same values.
module core (
    input  logic [ 7:0] count,
    output logic [63:0] data_o
);
  logic late;
  assign late = count == 8'd7;
  assign data_o[63:32] = late ? 32'h7fc00000 : 32'h3f800000;
  assign data_o[31:0] = 32'(count) << 23;
endmodule

module top (
    input logic clk
);
  logic [7:0] count;
  logic [63:0] data;
  logic [2:0] state;
  logic valid, ready;

  always_ff @(posedge clk) count <= count + 8'd1;
  assign valid = count[1:0] != 2'd0;
  assign ready = count[0];
  always_ff @(posedge clk) begin
    if (count >= 8'd2) state <= 3'((count + 8'd1) % 8'd3);
  end
  core core (
      .count,
      .data_o(data)
  );
endmodule
