// SPDX-License-Identifier: Apache-2.0
// The pipe of a pair (pairs_pkg::PAIR_*) with one kind of input port.
// Latency: latency_o, the pipe's latency; 0 with ARITH = "host".
// Throughput: LANES pairs per SAT_II cycles.
// Stall: none, runs free.
`include "pipe.svh"
module pair_pipe #(
    `DF_PARAMETERS,
    parameter int PAIR = 0,
    parameter int ALGORITHM = 0,  // ray-triangle: pairs_pkg::ALGORITHM_*
    parameter int BOX = 0,  // ray-triangle, 1: a hit must lie in the triangle's box (ray_box.sv)
    parameter int HALF_SPACE = 0,  // pairs with a plane, 1: the plane is the solid n.x <= d
    parameter int SAT_II = 1,  // pairs with candidate axes: cycles between pairs of a lane, 1 or 3
    parameter int B_LANES = LANES,  // secondaries per cycle: 1 (broadcast to all lanes) or LANES
    localparam int A_WORDS = pairs_pkg::shape_words(pairs_pkg::primary_shape(PAIR)),
    localparam int B_WORDS = pairs_pkg::shape_words(pairs_pkg::secondary_shape(PAIR))
) (
    input logic clk_i,
    input logic enter_i,  // a pair enters; used with SAT_II = 3
    input logic [A_WORDS-1:0][LANES-1:0][CW-1:0] a_i,
    input logic [B_WORDS-1:0][B_LANES-1:0][CW-1:0] b_i,
    `DISTANCE_OUTPUTS
);
  /*verilator inline_module*/
  if (HALF_SPACE != 0 && pairs_pkg::secondary_shape(PAIR) != pairs_pkg::SHAPE_PLANE)
      $error("pair_pipe: HALF_SPACE is of pairs with a plane");
  if (BOX != 0 && !pairs_pkg::has(pairs_pkg::BOX_PAIRS, PAIR)) $error("pair_pipe: BOX is of ray-triangle");
  if (SAT_II != 1 && !pairs_pkg::has(pairs_pkg::SAT_PAIRS, PAIR))
      $error("pair_pipe: SAT_II needs a pair with candidate axes");
  if (!pairs_pkg::has(pairs_pkg::SAT_PAIRS, PAIR)) begin : g_no_sat
    logic unused_enter;
    assign unused_enter = enter_i;
  end
  logic [B_WORDS-1:0][LANES-1:0][CW-1:0] b;  // one secondary per lane
  for (genvar k = 0; k < B_WORDS; k++) begin : word
    if (B_LANES == LANES) begin : g_own
      assign b[k] = b_i[k];
    end else begin : g_broadcast
      assign b[k] = {LANES{b_i[k][0]}};
    end
  end
  if (PAIR == int'(pairs_pkg::PAIR_RAY_TRIANGLE) && ALGORITHM == int'(pairs_pkg::ALGORITHM_MOLLER)) begin : g_pipe
    logic unused_b;
    assign unused_b = &{1'b0, b};
    ray_triangle_moller #(`DF_SAME, .B_LANES(B_LANES), .BOX(BOX)) pipe (
        .clk_i, .a_i, .b_i, .f_o, .t_o, .cp_o, .latency_o);
    assign n_o = '0;
  end else if (PAIR == int'(pairs_pkg::PAIR_RAY_TRIANGLE) && ALGORITHM == int'(pairs_pkg::ALGORITHM_BADOUEL)) begin :
      g_pipe
    ray_triangle_badouel #(`DF_SAME, .B_LANES(B_LANES), .BOX(BOX)) pipe (
        .clk_i, .a_i, .b_i(b), .f_o, .t_o, .cp_o, .latency_o);
    assign n_o = '0;
  end else if (PAIR == int'(pairs_pkg::PAIR_RAY_TRIANGLE) && ALGORITHM == int'(pairs_pkg::ALGORITHM_PLUECKER)) begin :
      g_pipe
    ray_triangle_pluecker #(`DF_SAME, .B_LANES(B_LANES), .BOX(BOX)) pipe (
        .clk_i, .a_i, .b_i(b), .f_o, .t_o, .cp_o, .latency_o);
    assign n_o = '0;
  end else if (PAIR == int'(pairs_pkg::PAIR_RAY_TRIANGLE) && ALGORITHM == int'(pairs_pkg::ALGORITHM_WATERTIGHT)) begin :
      g_pipe
    ray_triangle_watertight #(`DF_SAME, .B_LANES(B_LANES), .BOX(BOX)) pipe (
        .clk_i, .a_i, .b_i(b), .f_o, .t_o, .cp_o, .latency_o);
    assign n_o = '0;
  end else if (PAIR == int'(pairs_pkg::PAIR_RAY_SPHERE)) begin : g_pipe
    ray_sphere #(`DF_SAME) pipe (.clk_i, .a_i, .b_i(b), .f_o, .t_o, .cp_o, .latency_o);
    assign n_o = '0;
  end else if (PAIR == int'(pairs_pkg::PAIR_RAY_CYLINDER)) begin : g_pipe
    ray_cylinder #(`DF_SAME) pipe (.clk_i, .a_i, .b_i(b), .f_o, .t_o, .cp_o, .latency_o);
    assign n_o = '0;
  end else if (PAIR == int'(pairs_pkg::PAIR_SPHERE_SPHERE)) begin : g_pipe
    sphere_sphere #(`DF_SAME) pipe (.clk_i, .a_i, .b_i(b), .f_o, .t_o, .cp_o, .n_o, .latency_o);
  end else if (PAIR == int'(pairs_pkg::PAIR_OBB_OBB)) begin : g_pipe
    obb_obb #(`DF_SAME, .SAT_II(SAT_II)) pipe (
        .clk_i, .enter_i, .a_i, .b_i(b), .f_o, .t_o, .cp_o, .n_o, .latency_o);
  end else if (PAIR == int'(pairs_pkg::PAIR_OBB_PLANE)) begin : g_pipe
    obb_plane #(`DF_SAME, .HALF_SPACE(HALF_SPACE != 0)) pipe (
        .clk_i, .a_i, .b_i(b), .f_o, .t_o, .cp_o, .n_o, .latency_o);
  end else if (PAIR == int'(pairs_pkg::PAIR_SPHERE_PLANE)) begin : g_pipe
    sphere_plane #(`DF_SAME, .HALF_SPACE(HALF_SPACE != 0)) pipe (
        .clk_i, .a_i, .b_i(b), .f_o, .t_o, .cp_o, .n_o, .latency_o);
  end else if (PAIR == int'(pairs_pkg::PAIR_SPHERE_OBB)) begin : g_pipe
    sphere_obb #(`DF_SAME) pipe (.clk_i, .a_i, .b_i(b), .f_o, .t_o, .cp_o, .n_o, .latency_o);
  end else if (PAIR == int'(pairs_pkg::PAIR_TRIANGLE_SPHERE)) begin : g_pipe
    triangle_sphere #(`DF_SAME) pipe (.clk_i, .a_i, .b_i(b), .f_o, .t_o, .cp_o, .n_o, .latency_o);
  end else if (PAIR == int'(pairs_pkg::PAIR_TRIANGLE_TRIANGLE)) begin : g_pipe
    triangle_triangle #(`DF_SAME) pipe (.clk_i, .a_i, .b_i(b), .f_o, .t_o, .cp_o, .n_o, .latency_o);
  end else if (PAIR == int'(pairs_pkg::PAIR_TRIANGLE_OBB)) begin : g_pipe
    triangle_obb #(`DF_SAME, .SAT_II(SAT_II)) pipe (
        .clk_i, .enter_i, .a_i, .b_i(b), .f_o, .t_o, .cp_o, .n_o, .latency_o);
  end else if (PAIR == int'(pairs_pkg::PAIR_TRIANGLE_AABB)) begin : g_pipe
    triangle_aabb #(`DF_SAME, .SAT_II(SAT_II)) pipe (
        .clk_i, .enter_i, .a_i, .b_i(b), .f_o, .t_o, .cp_o, .n_o, .latency_o);
  end else begin : g_illegal
    $error("pair_pipe: no pipe for this pair and algorithm");
  end
endmodule
