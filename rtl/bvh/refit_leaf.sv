// SPDX-License-Identifier: Apache-2.0
// The box of a leaf's one or two triangles, and which of them have no box (a NaN or a coordinate beyond 2^40). Corners
// are ordered words (bvh_pkg): lower x y z, upper x y z.
// Latency: 3 cycles.
// Throughput: one leaf per cycle.
// Stall: none, runs free.
module refit_leaf (
    input logic clk_i,
    input logic two_i,
    input logic [1:0][8:0][31:0] triangles_i,  // v0 x y z, v1, v2
    output logic [5:0][31:0] box_o,
    output logic [1:0] bad_o
);
  import bvh_pkg::*;
  localparam logic [31:0] MOST = 32'h5380_0000;  // 2^40

  function automatic logic [31:0] least(input logic [31:0] a, input logic [31:0] b);
    least = (a < b) ? a : b;
  endfunction
  function automatic logic [31:0] most(input logic [31:0] a, input logic [31:0] b);
    most = (a > b) ? a : b;
  endfunction

  // ---- Ordered words ----
  logic two_1, two_2;
  logic [1:0] bad_1, bad_2;
  logic [1:0][8:0][31:0] keys_1;
  always_ff @(posedge clk_i) begin
    {two_1, two_2} <= {two_i, two_1};
    bad_2 <= bad_1 & {two_1, 1'b1};
    bad_o <= bad_2;
  end
  for (genvar t = 0; t < 2; t++) begin : triangle
    logic [8:0] bad;
    for (genvar w = 0; w < 9; w++) begin : coordinate
      assign bad[w] = {1'b0, triangles_i[t][w][30:0]} > MOST;
      always_ff @(posedge clk_i) keys_1[t][w] <= ordered(triangles_i[t][w]);
    end
    always_ff @(posedge clk_i) bad_1[t] <= bad != '0;
  end

  // ---- Box of each triangle, and of both ----
  logic [1:0][5:0][31:0] boxes_2;
  for (genvar k = 0; k < 3; k++) begin : axis
    for (genvar t = 0; t < 2; t++) begin : each
      always_ff @(posedge clk_i) begin
        boxes_2[t][k] <= least(least(keys_1[t][k], keys_1[t][3+k]), keys_1[t][6+k]);
        boxes_2[t][3+k] <= most(most(keys_1[t][k], keys_1[t][3+k]), keys_1[t][6+k]);
      end
    end
    always_ff @(posedge clk_i) begin
      box_o[k] <= two_2 ? least(boxes_2[0][k], boxes_2[1][k]) : boxes_2[0][k];
      box_o[3+k] <= two_2 ? most(boxes_2[0][3+k], boxes_2[1][3+k]) : boxes_2[0][3+k];
    end
  end
endmodule
