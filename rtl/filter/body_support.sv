// SPDX-License-Identifier: Apache-2.0
// Support function of a shape relative to its origin: an upper bound of n.x over the shape, with nn = n.n.
// Sphere: r (1 + nn) / 2, which is at least r |n|; 1 add, 2 mul. Box: half extents times |U^T n|; 8 add, 12 mul.
// Triangle: the largest of 0, n.e1 and n.e2; 4 add, 6 mul, 2 max. AABB: edges times the positive part of n; 2 add, 3
// mul, 3 max.
// Latency: result at T_SUPPORT (`filter.svh`) for operands at T_REST, T_N and T_NN; 0 with ARITH = "host".
// Throughput: one shape per lane per cycle.
// Stall: none.
`include "filter.svh"
module body_support #(
    `DF_PARAMETERS,
    parameter int SHAPE = pairs_pkg::SHAPE_SPHERE,
    parameter int T_REST = 0,
    parameter int T_N = 0,
    parameter int T_NN = 0,
    localparam int WORDS = pairs_pkg::shape_words(SHAPE)
) (
    input logic clk_i,
    input logic [WORDS-4:0][LANES-1:0][CW-1:0] rest_i,  // from body.sv
    input logic [2:0][LANES-1:0][CW-1:0] n_i,
    input logic [LANES-1:0][CW-1:0] nn_i,
    output logic [LANES-1:0][CW-1:0] h_o
);
  /*verilator inline_module*/
  localparam int T = `T_SUPPORT(SHAPE, T_REST, T_N, T_NN);
  `DF_VIN(n, n_i, T_N)
  if (SHAPE != pairs_pkg::SHAPE_SPHERE) begin : g_no_length
    logic unused;
    assign unused = &{1'b0, nn_i};
  end
  if (SHAPE == pairs_pkg::SHAPE_SPHERE) begin : g_sphere
    `DF_IN(r, rest_i[0], T_REST)
    `DF_IN(nn, nn_i, T_NN)
    `DF_CONST(one, `DF_POWER_OF_TWO(0))
    `DF_CONST(half, `DF_POWER_OF_TWO(-1))
    `DF_ADD(twice, nn, one)
    `DF_MUL(length, twice, half)
    `DF_MUL(h, r, length)
    if (T_h != T) $error("body_support: latency");
    logic unused;
    assign unused = &{1'b0, n};
    assign h_o = h;
  end else if (SHAPE == pairs_pkg::SHAPE_OBB) begin : g_obb
    `DF_VIN(extents, rest_i[2:0], T_REST)
    `DF_MATRIX_IN(rotation, rest_i[5:3], rest_i[8:6], rest_i[11:9], T_REST)
    `DF_TRANSPOSE(axes, rotation)
    `DF_APPLY(along, axes, n)
    `DF_BOX_RADIUS(h, along, extents)
    if (T_h != T) $error("body_support: latency");
    assign h_o = h;
  end else if (SHAPE == pairs_pkg::SHAPE_TRIANGLE) begin : g_triangle
    `DF_VIN(e1, rest_i[2:0], T_REST)
    `DF_VIN(e2, rest_i[5:3], T_REST)
    `DF_CONST(zero, 0)
    `DF_DOT(h1, n, e1)
    `DF_DOT(h2, n, e2)
    `DF_MAX(h12, h1, h2)
    `DF_MAX(h, h12, zero)
    if (T_h != T) $error("body_support: latency");
    assign h_o = h;
  end else if (SHAPE == pairs_pkg::SHAPE_AABB) begin : g_aabb
    `DF_VIN(edges, rest_i, T_REST)
    `DF_VCONST(zeros, 0, 0, 0)
    `DF_VMAX(positive, n, zeros)
    `DF_DOT(h, edges, positive)
    if (T_h != T) $error("body_support: latency");
    assign h_o = h;
  end else begin : g_illegal
    $error("body_support: no such SHAPE");
  end
endmodule
