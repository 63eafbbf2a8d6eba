// SPDX-License-Identifier: Apache-2.0
// Pairs of leaves: a primary enters with the one or two secondaries of a leaf, and goes through the pipe of its pair.
// Pipes of several pairs are side by side, and a pass uses one of them.
// With SERIAL a leaf's secondaries enter one after the other (leaf_queue.sv), and so do its results leave.
// With gates the pipe is then the engine's lane, outside.
// Latency: one cycle more than the pass's pipe, for any ARITH.
// Throughput: one leaf per cycle; with SERIAL one secondary per SERIAL cycles.
// Stall: none.
`include "bvh.svh"
`include "ray_box.svh"
module leaf_pairs #(
    parameter bvh_pkg::traversals_t TRAVERSALS = 1,  // bvh_pkg::card_traversals
    parameter int SERIAL = 0,     // 0, or cycles per secondary of one lane, only of rays that meet triangles
    parameter int ALGORITHM = 0,  // ray-triangle: pairs_pkg::ALGORITHM_*
    parameter int NORMALS = 0,    // 1: solids have normals
    parameter int AT = 1,         // bits that accompany a leaf through the pipe
    parameter latency_pkg::latency_t LAT = latency_pkg::ONES,
    parameter ARITH = "rtl",
    localparam int EXP = 8,
    localparam int MAN = 23,
    localparam int CW = 32,
    localparam int MOST = 2,  // secondaries of a leaf
    localparam int LANES = (SERIAL != 0) ? 1 : MOST,
    localparam int WORDS = bvh_pkg::traverser_words(TRAVERSALS),
    localparam int LEAF = bvh_pkg::leaf_words(TRAVERSALS),
    localparam int POINTS = (NORMALS != 0) ? 6 : 3
) (
    input logic clk_i,
    input logic rst_i,
    input logic [bvh_pkg::TRAVERSAL_BITS-1:0] traversal_i,  // traversal kind of the pass
    input logic valid_i,       // registered, because it drives the enable of a clock gate
    input logic last_i,        // with SERIAL, the leaf's last secondary
    input logic [AT-1:0] at_i,
    input logic two_i,
    input logic [WORDS-1:0][31:0] primary_i,
    input logic [MOST-1:0][LEAF-1:0][31:0] secondaries_i,  // with SERIAL [0]
    input logic [MOST-1:0][31:0] index_i,
    output card_pkg::lane_operands_t lane_o,
    input card_pkg::lane_results_t lane_i,
    output logic [1:0] tested_o,  // secondaries tested in this cycle
    output logic [AT-1:0] next_o,  // at_o of the next cycle
    output logic valid_o,
    output logic last_o,  // with SERIAL, of the leaf's last secondary
    output logic [AT-1:0] at_o,
    output logic [LANES-1:0] f_o,  // of the secondaries present
    output logic [LANES-1:0] present_o,
    // solids: the signed distance; key_o is what nodes compare it by (node_distances.sv)
    output logic [LANES-1:0][31:0] t_o,
    output logic [LANES-1:0][31:0] key_o,
    output logic [POINTS-1:0][LANES-1:0][31:0] point_o,  // CP and, with normals, n
    output logic [LANES-1:0][31:0] index_o
);
  /*verilator inline_module*/
  localparam bit ONE = (TRAVERSALS & (TRAVERSALS - 1)) == 0;
  pairs_pkg::pair_t pass_pair;
  assign pass_pair = traversal_i[bvh_pkg::TRAVERSAL_BITS-1:1];
  logic unused_role;  // some cards have one role of each pair
  assign unused_role = traversal_i[0];
  logic taken_q, last_q, two_q, two;  // two: not with SERIAL
  logic [AT-1:0] at_q;
  logic [LANES-1:0][31:0] index_q, f;
  always_ff @(posedge clk_i) begin
    taken_q <= valid_i && !rst_i;
    last_q <= SERIAL == 0 || last_i;
    {at_q, two_q, index_q} <= {at_i, two_i, index_i[LANES-1:0]};
  end
  assign tested_o = !taken_q ? 2'd0 : (two_q && SERIAL == 0) ? 2'd2 : 2'd1;

  // ---- Pipes. Each has its own clock, so an idle pipe computes nothing ----
  logic [pairs_pkg::PAIRS-1:0][LANES-1:0][31:0] f_of, t_of, key_of;
  logic [pairs_pkg::PAIRS-1:0][5:0][LANES-1:0][31:0] point_of;
  logic [pairs_pkg::PAIRS-1:0][15:0] latency_of;
  logic unused;  // a sphere has few words
  assign unused = &{1'b0, primary_i, secondaries_i, index_i, last_i, last_q, lane_i, point_of, key_of};
  for (genvar p = 0; p < pairs_pkg::PAIRS; p++) begin : pair
    // Roles in the card's traversals: one, or both.
    localparam bit AS_IS = bvh_pkg::has_traversal(TRAVERSALS, 2 * p);
    localparam bit SWAPPED = bvh_pkg::has_traversal(TRAVERSALS, 2 * p + 1);
    if (AS_IS || SWAPPED) begin : g_present
      localparam int A_WORDS = pairs_pkg::primary_words(p);
      localparam int B_WORDS = pairs_pkg::secondary_words(p);
      logic clk, selected;
      logic [A_WORDS-1:0][LANES-1:0][31:0] a_now, a;
      logic [B_WORDS-1:0][LANES-1:0][31:0] b_now, b;
      logic [LANES-1:0][31:0] t_pipe;
      assign selected = valid_i && (ONE || pass_pair == pairs_pkg::PAIR_BITS'(p));
      clock_gate gate (.clk_i, .enable_i(selected), .clk_o(clk));
      always_ff @(posedge clk) {a, b} <= {a_now, b_now};
      for (genvar l = 0; l < LANES; l++) begin : lane
        for (genvar w = 0; w < A_WORDS; w++) begin : a_word
          if (!SWAPPED) begin : g_primary
            assign a_now[w][l] = primary_i[w];
          end else if (!AS_IS) begin : g_secondary
            assign a_now[w][l] = secondaries_i[l][w];
          end else begin : g_either
            assign a_now[w][l] = traversal_i[0] ? secondaries_i[l][w] : primary_i[w];
          end
        end
        for (genvar w = 0; w < B_WORDS; w++) begin : b_word
          if (!SWAPPED) begin : g_secondary
            assign b_now[w][l] = secondaries_i[l][w];
          end else if (!AS_IS) begin : g_primary
            assign b_now[w][l] = primary_i[w];
          end else begin : g_either
            assign b_now[w][l] = traversal_i[0] ? primary_i[w] : secondaries_i[l][w];
          end
        end
      end
      if (pairs_pkg::primary_shape(p) != pairs_pkg::SHAPE_RAY) begin : g_solid
        localparam logic [31:0] SIGN = 32'h8000_0000;
        logic [LANES-1:0][31:0] f_pipe;
        logic [5:0][LANES-1:0][31:0] point_pipe;
        logic [15:0] latency;
        bounded_pipe #(`DF_SAME, .PAIR(p), .BOUND(int'(pairs_pkg::has(config_pkg::BOUND_PAIRS, p)))) pipe (
            .clk_i, .enter_i(taken_q), .a_i(a), .b_i(b), .f_o(f_pipe), .t_o(t_pipe), .cp_o(point_pipe[2:0]),
            .n_o(point_pipe[5:3]), .latency_o(latency));
        `DF_IN(meets, f_pipe, 0)
        `DF_IN(distance, t_pipe | (f_pipe & {LANES{SIGN}}), 0)
        `DF_VIN(cp, point_pipe[2:0], 0)
        `DF_VIN(n, point_pipe[5:3], 0)
        `DF_MUL(square, distance, distance)
        `DF_AT(meets_late, meets, LAT.mul)
        `DF_AT(distance_late, distance, LAT.mul)
        `DF_VAT(cp_late, cp, LAT.mul)
        `DF_VAT(n_late, n, LAT.mul)
        `DF_SELECT(key, meets_late, distance_late, square)
        assign f_of[p] = meets_late;
        assign t_of[p] = distance_late;
        assign key_of[p] = key;
        assign point_of[p] = {n_late, cp_late};
        assign latency_of[p] = latency + 16'(LAT.mul);
      end else begin : g_ray
        localparam int BOX = int'(pairs_pkg::has(pairs_pkg::BOX_PAIRS, p));
        if (SERIAL != 0 && ARITH == "rtl") begin : g_outside
          assign {f_of[p], t_pipe, point_of[p][2:0], latency_of[p]} = lane_i;
          assign point_of[p][5:3] = '0;
        end else if (SERIAL != 0) begin : g_alone
          ray_triangle_shared #(.TURNS(SERIAL), .LAT(LAT), .ARITH(ARITH)) pipe (
              .clk_i, .turn_i('0), .a_i(a), .b_i(b), .f_o(f_of[p]), .t_o(t_pipe), .cp_o(point_of[p][2:0]),
              .latency_o(latency_of[p]));
          assign point_of[p][5:3] = '0;
        end else begin : g_own
          pair_pipe #(`DF_SAME, .PAIR(p), .ALGORITHM(ALGORITHM), .BOX(BOX)) pipe (
              .clk_i, .enter_i(taken_q), .a_i(a), .b_i(b), .f_o(f_of[p]), .t_o(t_pipe),
              .cp_o(point_of[p][2:0]), .n_o(point_of[p][5:3]), .latency_o(latency_of[p]));
        end
        assign t_of[p] = t_pipe;
        assign key_of[p] = '0;
      end
    end else begin : g_absent
      assign {f_of[p], t_of[p], key_of[p], point_of[p], latency_of[p]} = '0;
    end
  end

  if (SERIAL != 0 && ARITH == "rtl") begin : g_lane
    localparam int RAY = int'(pairs_pkg::PAIR_RAY_TRIANGLE);
    if (TRAVERSALS != 1) $error("leaf_pairs: SERIAL is for rays that meet triangles");
    assign lane_o = '{valid: !rst_i, ray: pair[RAY].g_present.a, triangle: pair[RAY].g_present.b};
  end else begin : g_no_lane
    assign lane_o = '0;
  end

  if (TRAVERSALS == 1 && SERIAL == 0) begin : g_rays  // only rays that meet triangles
    // Stage time of o + t d. Badouel's t takes one more addition, and the watertight algorithm shears first.
    localparam int RAY = int'(pairs_pkg::PAIR_RAY_TRIANGLE);
    localparam int T_POINT = 5 * LAT.add + 3 * LAT.mul + LAT.div +
        ((ALGORITHM == int'(pairs_pkg::ALGORITHM_BADOUEL)) ? LAT.add :
         (ALGORITHM == int'(pairs_pkg::ALGORITHM_WATERTIGHT)) ?
         `DF_MAX2(2 * LAT.cmp + LAT.div + LAT.mul, LAT.add) + 2 * LAT.mul : 0);
    // The box rule is last, except for Badouel's inside test, which needs the same point.
    localparam int T_IN_BOX = `RAY_T_IN_BOX(T_POINT - LAT.add, T_POINT);
    localparam int T_INSIDE = `DF_MAX2(2 * LAT.add + LAT.mul + 2 * LAT.cmp, T_POINT) + 3 * LAT.add + LAT.mul + LAT.cmp;
    // The pipe's latency, as the pipe reports it: asserted below.
    localparam int T_PAIR =
        ((ALGORITHM == int'(pairs_pkg::ALGORITHM_BADOUEL)) ? `DF_MAX2(T_IN_BOX, T_INSIDE) : T_IN_BOX) + 1;
    pipe_delay #(.W(5 * LANES * 32), .FROM(ARITH == "rtl" ? T_PAIR : 0), .TO(T_PAIR), .MEMORY(5)) delay_pair (
        .clk_i, .d_i({f_of[RAY], t_of[RAY], point_of[RAY][2:0]}), .q_o({f, t_o, point_o[2:0]}));
    if (NORMALS != 0) begin : g_no_normals
      assign point_o[POINTS-1:POINTS-3] = '0;
    end
    assign key_o = '0;
    pipe_delay #(.W(AT), .TO(T_PAIR - 1)) delay_next (.clk_i, .d_i(at_q), .q_o(next_o));
    pipe_delay #(.W(AT), .TO(1)) delay_at (.clk_i, .d_i(next_o), .q_o(at_o));
    pipe_delay #(.W(1 + LANES * 32), .TO(T_PAIR), .MEMORY(5)) delay_index (
        .clk_i, .d_i({two_q, index_q}), .q_o({two, index_o}));
    pipe_delay_valid #(.TO(T_PAIR)) delay_valid (.clk_i, .rst_i, .valid_i(taken_q), .valid_o(valid_o));
    assign last_o = 1'b1;
    logic unused_pair;
    assign unused_pair = &{1'b0, traversal_i, pass_pair};
`ifndef SYNTHESIS
    always_ff @(posedge clk_i)
      if (!rst_i)
        assert (latency_of[RAY] == 16'(T_PAIR)) else
          $error("leaf_pairs: the pipe takes %0d cycles; expected %0d", latency_of[RAY], T_PAIR);
`endif
  end else begin : g_several
    // The pipe's latency is a port value. Gates answer after it, the host back end at once.
    localparam int SLOWEST = latency_pkg::mean(LAT);
    localparam int DEPTH = ((SERIAL != 0) ? 64 : 256) << $clog2(SLOWEST);
    localparam int INSIDE = (SERIAL != 0) ? DEPTH / SERIAL : 1;  // most secondaries in the pipe
    localparam int RESULT = (3 + POINTS) * LANES * 32;
    logic [pairs_pkg::PAIR_INDEX-1:0] of_pair;
    assign of_pair = (TRAVERSALS == 1) ? pairs_pkg::PAIR_INDEX'(pairs_pkg::PAIR_RAY_TRIANGLE) :
        pass_pair[pairs_pkg::PAIR_INDEX-1:0];
    logic [RESULT-1:0] result;
    logic [LANES-1:0][31:0] key;
    if (SERIAL != 0) begin : g_serial
      assign key_o = '0;
      logic unused_key;
      assign unused_key = &{1'b0, key};
    end else begin : g_keys
      assign key_o = key;
    end
    assign result = {f_of[of_pair], t_of[of_pair], key_of[of_pair], point_of[of_pair][POINTS-1:0]};
    logic [15:0] rest;  // cycles until the one before the result
    logic next_valid;
    logic [AT+1+32*LANES:0] entry, next_entry;
    assign entry = {at_q, last_q, two_q, index_q};
    assign rest = latency_of[of_pair] - 1;
    if (SERIAL != 0) begin : g_in_order
      logic unused_bit;
      row_history #(.W(1), .DEPTH(DEPTH), .REGISTERS(2)) history (
          .clk_i, .rst_i, .latency_i(rest), .valid_i(taken_q), .d_i(1'b0), .valid_o(next_valid), .q_o(unused_bit));
      sync_fifo #(.W($bits(entry)), .DEPTH(INSIDE), .LATE(1)) entries (
          .clk_i, .rst_i, .write_i(taken_q), .wdata_i(entry), .free_o(), .count_o(), .some_o(), .rdata_o(next_entry),
          .read_i(next_valid));
    end else begin : g_late_entry
      row_history #(.W($bits(entry)), .DEPTH(DEPTH)) history (
          .clk_i, .rst_i, .latency_i(rest), .valid_i(taken_q), .d_i(entry), .valid_o(next_valid), .q_o(next_entry));
    end
    assign next_o = next_entry[AT+1+32*LANES-:AT];
    always_ff @(posedge clk_i) begin
      valid_o <= next_valid && !rst_i;
      {at_o, last_o, two, index_o} <= next_entry;
    end
    if (ARITH == "rtl") begin : g_late
      assign {f, t_o, key, point_o} = result;
    end else begin : g_early
      logic [RESULT-1:0] next_result;
      logic unused_valid;
      row_history #(.W(RESULT), .DEPTH(DEPTH)) results (
          .clk_i, .rst_i, .latency_i(rest), .valid_i(taken_q), .d_i(result), .valid_o(unused_valid),
          .q_o(next_result));
      always_ff @(posedge clk_i) {f, t_o, key, point_o} <= next_result;
    end
  end

  for (genvar l = 0; l < LANES; l++) begin : lane
    assign present_o[l] = l == 0 || two;
    assign f_o[l] = f[l][0] && present_o[l];
  end
endmodule
