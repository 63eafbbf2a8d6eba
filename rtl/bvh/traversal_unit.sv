// SPDX-License-Identifier: Apache-2.0
// Finds which children of a node a ray hits, and the order of visits (node_boxes.sv, node_order.sv). For a solid,
// node_distances.sv replaces near, and no child is behind it.
// Latency: NODE_T_UNIT cycles (bvh.svh).
// Throughput: one node per cycle.
// Stall: none, runs free.
`include "bvh.svh"
module traversal_unit #(
    parameter int EXP = 8,
    parameter int MAN = 23,
    parameter latency_pkg::latency_t LAT = latency_pkg::ONES,
    parameter ARITH = "rtl",
    parameter int SOLIDS = 1,  // 0: only rays
    localparam int CHILDREN = bvh_pkg::CHILDREN
) (
    input logic clk_i,
    input logic [8:0][31:0] ray_i,    // from ray_front.sv or solid_front.sv
    input logic [31:0] floor_i,       // lowest T that counts
    input logic [31:0] limit_i,       // highest T that counts
    input logic farthest_i,
    input logic solid_i,  // limit_i is a key of node_distances.sv
    input logic [bvh_pkg::NODE_WORDS-1:0][31:0] node_i,
    output bvh_pkg::group_t group_o
);
  /*verilator inline_module*/
  import bvh_pkg::*;
  localparam int T_UNIT = `NODE_T_UNIT(SOLIDS);
  localparam int T_BOXES = T_UNIT - 2;

  // A group holds the node's words (places and kinds) and the result: the number of hit children, their order and keys.
  localparam int LINKS = 2 * PLACE + 2 * CHILDREN;
  localparam int FOUND = $bits(group_t) - LINKS;
  logic [LINKS-1:0] links;
  logic [FOUND-1:0] found;
  assign links = {node_i[4][PLACE-1:0], node_i[5][PLACE-1:0], node_i[5][31:28], node_i[4][31:28], node_i[3][31:24]};
`ifdef VERILATOR
  if (ARITH != "rtl") begin : g_host
    // All three results call one function with equal operands, so the compiler computes it once. Its operands are local
    // variables of the model, since they are short and are first written as a whole. The result is delayed, not the
    // operands.
    logic [7:0][31:0] w, x, y;
    logic [5:0][31:0] z;
    always_comb begin
      w = '0;
      x = '0;
      y = '0;
      z = '0;
      for (int k = 0; k < 8; k++) w[k] = node_i[k];
      for (int k = 0; k < 8; k++) x[k] = node_i[8+k];
      for (int k = 0; k < 8; k++) y[k] = ray_i[k];
      z[0] = node_i[16];
      z[1] = node_i[17];
      z[2] = ray_i[8];
      z[3] = floor_i;
      z[4] = limit_i;
      z[5] = {30'd0, solid_i, farthest_i};
    end
    `define CDE_EIGHT(X) X[0], ",", X[1], ",", X[2], ",", X[3], ",", X[4], ",", X[5], ",", X[6], ",", X[7]
    `define CDE_VISIT(C, WHAT) C("host_fp::node_visit({", `CDE_EIGHT(w), ",", `CDE_EIGHT(x), ",", z[0], ",", z[1], \
        "},{", `CDE_EIGHT(y), ",", z[2], "},", z[3], ",", z[4], ",", z[5], ").", WHAT)
    logic [31:0] order;
    logic [63:0] low, high;
    logic [3:0] unused;
    assign order = `CDE_VISIT($c32, "order");
    assign low = `CDE_VISIT($c64, "low");
    assign high = `CDE_VISIT($c64, "high");
    assign {unused, found} = {order, high, low};
    pipe_delay #(.W($bits(group_t)), .TO(T_UNIT), .MEMORY(5)) delay_group (.clk_i, .d_i({links, found}), .q_o(group_o));
    `undef CDE_EIGHT
    `undef CDE_VISIT
  end
`endif
  if (ARITH == "rtl") begin : g_gates
    logic [CHILDREN-1:0][31:0] near, far, near_late, far_late;
    logic [2:0][CHILDREN-1:0][31:0] near_axis, far_axis;
    logic is_solid;
    node_boxes #(
        .EXP(EXP), .MAN(MAN), .LAT(LAT), .ARITH(ARITH)
    ) boxes (
        .clk_i, .ray_i, .node_i, .near_axis_o(near_axis), .far_axis_o(far_axis), .near_o(near), .far_o(far));
    if (SOLIDS != 0) begin : g_solids
      localparam logic [31:0] INFINITE = 32'h7f80_0000;
      logic [CHILDREN-1:0][31:0] key, near_then, far_then;
      node_distances #(
          .EXP(EXP), .MAN(MAN), .LANES(CHILDREN), .LAT(LAT),
          .ARITH(ARITH)
      ) solid_keys (
          .clk_i, .near_i(near_axis), .far_i(far_axis), .key_o(key));
      pipe_delay #(.W(2 * CHILDREN * 32), .FROM(`NODE_T_BOXES), .TO(T_BOXES)) delay_near (
          .clk_i, .d_i({near, far}), .q_o({near_then, far_then}));
      assign near_late = is_solid ? key : near_then;
      assign far_late = is_solid ? {CHILDREN{INFINITE}} : far_then;
    end else begin : g_rays
      assign {near_late, far_late} = {near, far};
      logic unused_axes;
      assign unused_axes = &{1'b0, near_axis, far_axis, is_solid};
    end
    logic [LINKS-1:0] links_boxes, links_late;
    logic [FOUND-1:0] found_q;
    logic [31:0] from, to;
    logic down;
    pipe_delay #(.W(LINKS), .TO(T_BOXES)) delay_links (.clk_i, .d_i(links), .q_o(links_boxes));
    pipe_delay #(.W(LINKS), .FROM(T_BOXES), .TO(T_UNIT)) delay_late (.clk_i, .d_i(links_boxes), .q_o(links_late));
    pipe_delay #(.W(66), .TO(T_BOXES)) delay_interval (
        .clk_i, .d_i({solid_i, farthest_i, limit_i, floor_i}), .q_o({is_solid, down, to, from}));
    node_order ordering (
        .clk_i, .near_i(near_late), .far_i(far_late), .kinds_i(links_boxes[2*CHILDREN-1:0]), .floor_i(from),
        .limit_i(to), .farthest_i(down), .found_o(found));
    always_ff @(posedge clk_i) found_q <= found;
    assign group_o = {links_late, found_q};
  end
endmodule
