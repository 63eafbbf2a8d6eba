// SPDX-License-Identifier: Apache-2.0
// Which children of a node a ray meets, and in what order they are visited: by near, or by far downwards; ties by
// number. Comparisons are of whole numbers, as words in order.
// Latency: NODE_T_UNIT clocks (hierarchy.svh). Throughput: a node a clock. Stall: none, runs free.
`include "hierarchy.svh"
module node_unit #(
    parameter int EXP = 8,
    parameter int MAN = 23,
    parameter int LAT_ADD = 1,
    parameter int LAT_MUL = 1,
    parameter int LAT_CMP = 1,
    parameter ARITH = "rtl",
    localparam int CHILDREN = hierarchy_pkg::CHILDREN
) (
    input logic clk_i,
    input logic [8:0][31:0] ray_i,    // of ray_front.sv
    input logic [31:0] floor_i,       // T that counts: from here
    input logic [31:0] limit_i,       // to here
    input logic farthest_i,
    input logic [hierarchy_pkg::NODE_WORDS-1:0][31:0] node_i,
    output hierarchy_pkg::group_t group_o
);
  /*verilator inline_module*/
  import hierarchy_pkg::*;
  localparam int T_BOXES = `NODE_T_BOXES;
  localparam int T_MET = T_BOXES + 1;
  if (`NODE_T_UNIT != T_MET + 1) $error("node_unit: NODE_T_UNIT is another");

  // ---- Boxes. Datapaths of the host back end have no stages, so what comes out of them is delayed here ----
  logic [CHILDREN-1:0][31:0] near_now, far_now, near, far;
  node_boxes #(
      .EXP(EXP), .MAN(MAN), .LAT_ADD(LAT_ADD), .LAT_MUL(LAT_MUL), .LAT_CMP(LAT_CMP), .ARITH(ARITH)
  ) boxes (
      .clk_i, .ray_i, .node_i, .near_o(near_now), .far_o(far_now));
  align #(.W(2 * CHILDREN * 32), .FROM(ARITH == "rtl" ? T_BOXES : 0), .TO(T_BOXES)) align_boxes (
      .clk_i, .d_i({far_now, near_now}), .q_o({far, near}));
  logic [2*PLACE+15:0] places, places_met;  // and kinds
  logic [31:0] from, to;
  logic down;
  assign places = {node_i[4][PLACE-1:0], node_i[5][PLACE-1:0], node_i[5][31:28], node_i[4][31:28], node_i[3][31:24]};
  align #(.W(2 * PLACE + 16), .TO(T_MET)) align_places (.clk_i, .d_i(places), .q_o(places_met));
  align #(.W(65), .TO(T_BOXES)) align_interval (
      .clk_i, .d_i({farthest_i, ordered(limit_i), ordered(floor_i)}), .q_o({down, to, from}));

  // ---- Met: the ray is in the box somewhere, and where it counts ----
  logic [CHILDREN-1:0] meets, met_q;
  logic [CHILDREN-1:0][31:0] key, key_q;
  logic [CHILDREN-1:0][15:0] half_key, half_q;
  logic [CHILDREN-1:0][1:0] kinds;
  align #(.W(2 * CHILDREN), .TO(T_BOXES)) align_kinds (
      .clk_i, .d_i({node_i[5][31:28], node_i[4][31:28], node_i[3][31:24]}), .q_o(kinds));
  for (genvar i = 0; i < CHILDREN; i++) begin : child
    logic [31:0] n, f;
    assign n = ordered(near[i]);
    assign f = ordered(far[i]);
    assign meets[i] = kinds[i] != KIND_NONE && n <= f && f >= from && n <= to;
    // The one that comes first is the least.
    assign key[i] = down ? ~f : n;
    assign half_key[i] = half(down ? far[i] : near[i], down);
  end
  always_ff @(posedge clk_i) {met_q, key_q, half_q} <= {meets, key, half_key};

  // ---- Order: how many come before each ----
  group_t group;
  always_comb begin
    group = '0;
    group.node = places_met[16+PLACE+:PLACE];
    group.slot = places_met[16+:PLACE];
    group.kinds = places_met[15:0];
    for (int i = 0; i < CHILDREN; i++) begin
      logic [2:0] rank;
      rank = 0;
      for (int k = 0; k < CHILDREN; k++)
        if (k != i && met_q[k] && (k < i ? key_q[k] <= key_q[i] : key_q[k] < key_q[i])) rank = rank + 1;
      group.count = group.count + 4'(met_q[i]);
      if (met_q[i]) begin
        group.order[rank] = 3'(i);
        group.keys[rank] = half_q[i];
      end
    end
  end
  always_ff @(posedge clk_i) group_o <= group;
endmodule
