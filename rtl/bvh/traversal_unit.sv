// SPDX-License-Identifier: Apache-2.0
// Finds which children of a node a ray or a solid hits, and the order of visits. A ray's boxes are tested in whole
// numbers (node_boxes_int.sv), a solid's in fp32 (node_boxes.sv, node_distances.sv). node_order.sv is for both.
// Latency: NODE_T_RAY cycles, NODE_T_SOLID for a solid (bvh.svh). A unit without one kind has the latency of the other.
// Throughput: one node per CYCLES cycles. The inputs of a node stay for as long, or a node's halves follow each other
// (node_reader.sv).
// Stall: none, runs free.
`include "bvh.svh"
module traversal_unit #(
    parameter int EXP = 8,
    parameter int MAN = 23,
    parameter latency_pkg::latency_t LAT = latency_pkg::ONES,
    parameter ARITH = "rtl",
    parameter int RAYS = 1,    // 0: only solids
    parameter int SOLIDS = 1,  // 0: only rays
    parameter int CYCLES = 1,  // per node: 1, 2 or 4
    localparam int CHILDREN = bvh_pkg::CHILDREN,
    localparam int KEY = `NODE_KEY(SOLIDS)
) (
    input logic clk_i,
    // The first cycle of a node. Must come from a register: with host arithmetic it drives the enable of a clock gate.
    input logic valid_i,
    input logic [8:0][31:0] front_i,  // from ray_front.sv or solid_front.sv
    input logic [31:0] floor_i,       // lowest T that counts; not for a solid
    input logic [31:0] limit_i,       // highest T that counts; for a solid a key of node_distances.sv
    input logic farthest_i,           // not for a solid
    input logic solid_i,              // changes only between passes
    input logic [bvh_pkg::NODE_WORDS-1:0][31:0] node_i,
    output logic [`GROUP_BITS(KEY)-1:0] group_o
);
  /*verilator inline_module*/
  import bvh_pkg::*;
  localparam int T_RAY = (RAYS != 0) ? `NODE_T_RAY(CYCLES) : `NODE_T_SOLID;
  localparam int T_SOLID = (SOLIDS != 0) ? `NODE_T_SOLID : `NODE_T_RAY(CYCLES);

  // A group holds the scale of a ray's keys, the node's words (places and kinds) and the result: the number of hit
  // children, their order and keys.
  localparam int SCALE = 40;
  localparam int LINKS = 2 * PLACE + 2 * CHILDREN;
  localparam int FOUND = `GROUP_BITS(KEY) - SCALE - LINKS;
  logic [LINKS-1:0] links;
  logic [SCALE-1:0] scale;
  logic [FOUND-1:0] found;
  assign links = {first_node_of(node_i), first_slot_of(node_i), kinds_of(node_i)};
`ifdef VERILATOR
  if (ARITH != "rtl") begin : g_host
    // Computes in the first cycle, in a clock of its own, so without a node it computes nothing. All results call one
    // function with equal operands, so the compiler computes it once. Its operands are local variables of the model,
    // since they are short and are first written as a whole.
    logic clk;
    logic [31:0] order_q;
    logic [63:0] low_q, high_q, scale_q;
    clock_gate gate (.clk_i, .enable_i(valid_i), .clk_o(clk));
    `define CDE_EIGHT(X) X[0], ",", X[1], ",", X[2], ",", X[3], ",", X[4], ",", X[5], ",", X[6], ",", X[7]
    `define CDE_VISIT(C, WHAT) C("host_fp::node_visit<", KEY, ">({", `CDE_EIGHT(w), ",", `CDE_EIGHT(x), ",", z[0], \
        ",", z[1], "},{", `CDE_EIGHT(y), ",", z[2], "},", z[3], ",", z[4], ",", z[5], ").", WHAT)
    always_ff @(posedge clk) begin
      automatic logic [7:0][31:0] w = '0, x = '0, y = '0;
      automatic logic [5:0][31:0] z = '0;
      for (int k = 0; k < 8; k++) w[k] = node_i[k];
      for (int k = 0; k < 8; k++) x[k] = node_i[8+k];
      for (int k = 0; k < 8; k++) y[k] = front_i[k];
      z[0] = node_i[16];
      z[1] = node_i[17];
      z[2] = front_i[8];
      z[3] = floor_i;
      z[4] = limit_i;
      z[5] = {30'd0, SOLIDS != 0 && (RAYS == 0 || solid_i), farthest_i};
      order_q <= `CDE_VISIT($c32, "order");
      low_q <= `CDE_VISIT($c64, "low");
      high_q <= `CDE_VISIT($c64, "high");
      scale_q <= `CDE_VISIT($c64, "scale");
    end
    logic unused;
    assign unused = &{1'b0, order_q[31:28], low_q, high_q, scale_q[63:SCALE]};
    assign scale = scale_q[SCALE-1:0];
    assign found = {order_q[27:0], high_q[4*KEY-1:0], low_q[4*KEY-1:0]};
    logic [LINKS-1:0] links_q;
    always_ff @(posedge clk) links_q <= links;
    pass_delay #(.W(`GROUP_BITS(KEY)), .T_RAY(T_RAY - 1), .T_SOLID(T_SOLID - 1)) delay_group (
        .clk_i, .solid_i, .d_i({scale, links_q, found}), .q_o(group_o));
    `undef CDE_EIGHT
    `undef CDE_VISIT
  end
`endif
  if (ARITH == "rtl") begin : g_gates
    logic unused_valid;
    assign unused_valid = valid_i;
    // A solid's keys are compared as 32 bits, and the upper halves are stored.
    localparam int WHOLE = (SOLIDS != 0) ? 32 : RAY_KEY;
    logic [CHILDREN-1:0] met, ray_met, solid_met;
    logic [CHILDREN-1:0][WHOLE-1:0] key, ray_key, solid_key;
    logic [CHILDREN-1:0][KEY-1:0] stored, ray_stored, solid_stored;
    if (RAYS != 0) begin : g_rays
      localparam latency_pkg::latency_t LAT_NODE =
          latency_pkg::latencies(LAT.add, `NODE_LAT_MUL, LAT.div, LAT.sqrt, LAT.cmp);
      logic [CHILDREN-1:0][RAY_KEY-1:0] ray_keys;
      logic [31:0] t_ref;
      logic [7:0] step;
      node_boxes_int #(
          .EXP(EXP), .MAN(MAN), .LAT(LAT_NODE), .ARITH(ARITH), .CYCLES(CYCLES)
      ) boxes (
          .clk_i, .valid_i, .ray_i(front_i), .node_i, .floor_i, .limit_i, .farthest_i, .entered_o(ray_met),
          .key_o(ray_keys), .reference_o(t_ref), .scale_o(step));
      for (genvar c = 0; c < CHILDREN; c++) begin : child
        assign ray_key[c] = WHOLE'(ray_keys[c]);
        assign ray_stored[c] = KEY'(ray_keys[c]);
      end
      pipe_delay #(.W(SCALE), .TO(`NODE_T_ORDER)) delay_scale (.clk_i, .d_i({t_ref, step}), .q_o(scale));
    end else begin : g_no_rays
      assign {ray_met, ray_key, ray_stored, scale} = '0;
      logic unused_rays;
      assign unused_rays = &{1'b0, front_i[8:6], floor_i, farthest_i};
    end
    if (SOLIDS != 0) begin : g_solids
      localparam logic [31:0] INFINITE = 32'h7f80_0000;
      logic [2:0][CHILDREN-1:0][31:0] above, below;
      logic [CHILDREN-1:0][31:0] distance;
      logic [CHILDREN-1:0][1:0] kinds;
      logic [31:0] limit;
      node_boxes #(
          .EXP(EXP), .MAN(MAN), .LAT(LAT), .ARITH(ARITH)
      ) boxes (
          .clk_i, .solid_i(front_i[5:0]), .node_i, .above_o(above), .below_o(below));
      node_distances #(
          .EXP(EXP), .MAN(MAN), .LANES(CHILDREN), .LAT(LAT),
          .ARITH(ARITH)
      ) solid_distances (
          .clk_i, .above_i(above), .below_i(below), .key_o(distance));
      pipe_delay #(.W(2 * CHILDREN + 32), .TO(`NODE_T_DISTANCES)) delay_limit (
          .clk_i, .d_i({limit_i, links[2*CHILDREN-1:0]}), .q_o({limit, kinds}));
      for (genvar c = 0; c < CHILDREN; c++) begin : child
        logic [31:0] ordered_key;
        assign ordered_key = ordered(distance[c]);
        always_ff @(posedge clk_i) begin
          // No child is hit at a NaN.
          solid_met[c] <= kinds[c] != KIND_NONE && ordered_key <= ordered(INFINITE) && ordered_key <= ordered(limit);
          solid_key[c] <= ordered_key;
          solid_stored[c] <= half(distance[c]);
        end
      end
    end else begin : g_no_solids
      assign {solid_met, solid_key, solid_stored} = '0;
    end
    logic [LINKS-1:0] links_late;
    logic is_solid;
    assign is_solid = SOLIDS != 0 && (RAYS == 0 || solid_i);
    assign {met, key, stored} = is_solid ? {solid_met, solid_key, solid_stored} : {ray_met, ray_key, ray_stored};
    node_order #(
        .KEY(WHOLE), .STORED(KEY)
    ) ordering (
        .clk_i, .met_i(met), .key_i(key), .stored_i(stored), .found_o(found));
    // In the second half of a node. With solids, a node comes whole.
    localparam int T_LINKS = (SOLIDS != 0) ? 0 : `NODE_T_SECOND(CYCLES);
    pass_delay #(.W(LINKS), .T_RAY(T_RAY - T_LINKS), .T_SOLID(T_SOLID - T_LINKS)) delay_links (
        .clk_i, .solid_i, .d_i(links), .q_o(links_late));
    assign group_o = {scale, links_late, found};
  end
endmodule
