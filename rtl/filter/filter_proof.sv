// SPDX-License-Identifier: Apache-2.0
// Proof of a miss: the plane with normal n separates A and B, for any n. The signed distance along n,
// n.(oB - oA) - h_A(n) - h_B(-n), has a rounding error below 10 u S. It must be beyond 32 u S, with n.n <= 1.25. For an
// S below 2^length_low, nothing is proved, because the wide pipe's own F may be wrong there
// (docs/background/certified_filters.md, `host/include/cde/reference/filter/proof.hpp`).
// Latency: latency_o; 0 with ARITH = "host".
// Throughput: LANES pairs per cycle.
// Stall: none, runs free.
`include "filter.svh"
module filter_proof #(
    `DF_PARAMETERS,
    parameter int SHAPE_A = pairs_pkg::SHAPE_SPHERE,  // pairs_pkg::SHAPE_*
    parameter int SHAPE_B = pairs_pkg::SHAPE_SPHERE,
    localparam int A_WORDS = pairs_pkg::shape_words(SHAPE_A),
    localparam int B_WORDS = pairs_pkg::shape_words(SHAPE_B)
) (
    input logic clk_i,
    input logic [A_WORDS-1:0][LANES-1:0][CW-1:0] a_i,
    input logic [B_WORDS-1:0][LANES-1:0][CW-1:0] b_i,
    input logic [2:0][LANES-1:0][CW-1:0] n_i,
    output logic [LANES-1:0] miss_o,
    output logic [15:0] latency_o
);
  /*verilator inline_module*/
  localparam int TOLERANCE = (MAN - 3 < 20) ? MAN - 3 : 20;  // of unit vectors: 16 u = 2^-TOLERANCE (unit_check.sv)
  `PAIR_SIZE
  `DF_VIN(n, n_i, 0)
  `DF_VNEG(minus_n, n)
  `DF_DOT(nn, n, n)
  localparam int T_h_a = `T_SUPPORT(SHAPE_A, T_rest_a, T_n, T_nn);
  localparam int T_h_b = `T_SUPPORT(SHAPE_B, T_rest_b, T_n, T_nn);
  `DF_SCALAR h_a;
  `DF_SCALAR h_b;
  body_support #(`DF_SAME, .SHAPE(SHAPE_A), .T_REST(T_rest_a), .T_N(T_n), .T_NN(T_nn)) support_a (
      .clk_i, .rest_i(rest_a), .n_i(n), .nn_i(nn), .h_o(h_a));
  body_support #(`DF_SAME, .SHAPE(SHAPE_B), .T_REST(T_rest_b), .T_N(T_n), .T_NN(T_nn)) support_b (
      .clk_i, .rest_i(rest_b), .n_i(minus_n), .nn_i(nn), .h_o(h_b));
  `DF_DOT(along, n, between)
  `DF_ADD(supports, h_a, h_b)
  `DF_SUB(distance_along, along, supports)
  `DF_CONST(share, `DF_POWER_OF_TWO(1 - TOLERANCE))
  `DF_MUL(least, size, share)
  `DF_LT(separate, least, distance_along)
  `DF_CONST(longest, (CW'(`DF_POWER_OF_TWO(0)) | (CW'(1) << (MAN - 2))))  // 1.25
  `DF_LE(short, nn, longest)
  `DF_CONST(smallest, `DF_POWER_OF_TWO(formats_pkg::length_low(EXP, MAN)))
  `DF_LE(sizeable, smallest, size)
  `DF_AND(fair, short, sizeable)
  `DF_AND(miss, separate, fair)
  assign latency_o = 16'(T_miss);
  for (genvar l = 0; l < LANES; l++) begin : lane
    logic unused;
    assign unused = &{1'b0, miss[l]};
    assign miss_o[l] = miss[l][0];
  end
endmodule
