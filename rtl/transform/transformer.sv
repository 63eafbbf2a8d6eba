// SPDX-License-Identifier: Apache-2.0
// Rigid transform of one slot, for any shape that the card's pairs need. Points become R p + t. Directions become R d
// without an addition, so -0 stays -0. A plane gets n' = R n and d' = d + n'.t. An OBB's rotation is multiplied by R.
// An AABB is only translated, and its entry has the identity as R. Sizes and intervals do not change. With `plain_i`,
// the whole slot does not change. All shapes share one set of vector units. There are as many as the largest shape
// needs: 4 for an OBB, 3 for a triangle, 2 for a ray or cylinder.
// Latency: pairs_pkg::transform_latency cycles; 0 with ARITH = "host".
// Throughput: one slot per cycle.
// Stall: none.
`include "dataflow.svh"
module transformer #(
    parameter config_pkg::config_t CONFIG,
    parameter int WORDS = 9,  // words of a slot, enough for every shape
    localparam int EXP = CONFIG.exp,
    localparam int MAN = CONFIG.man,
    localparam int PAIRS = CONFIG.pairs,
    localparam int SWAP = CONFIG.swap,
    localparam int TRANSFORM = CONFIG.transform,
    localparam latency_pkg::latency_t LAT = CONFIG.lat,
    localparam ARITH = config_pkg::arith(CONFIG.host),
    localparam int CW = formats_pkg::container(EXP, MAN)
) (
    input logic clk_i,
    input pairs_pkg::shape_t shape_i,
    input logic plain_i,
    input logic [8:0][CW-1:0] rotation_i,  // row by row
    input logic [2:0][CW-1:0] translation_i,
    input logic [WORDS-1:0][CW-1:0] slot_i,
    output logic [WORDS-1:0][CW-1:0] slot_o
);
  localparam int LANES = 1;
  localparam int SHAPES = pairs_pkg::SHAPES;
  localparam int MOST = pairs_pkg::SHAPE_MOST_WORDS;
  localparam int LATENCY = pairs_pkg::transform_latency(PAIRS, SWAP != 0, TRANSFORM, LAT.add, LAT.mul);
  localparam bit TRIANGLE = pairs_pkg::moves_shape(PAIRS, pairs_pkg::SHAPE_TRIANGLE, SWAP != 0, TRANSFORM);
  localparam bit AABB = pairs_pkg::moves_shape(PAIRS, pairs_pkg::SHAPE_AABB, SWAP != 0, TRANSFORM);
  localparam bit OBB = pairs_pkg::moves_shape(PAIRS, pairs_pkg::SHAPE_OBB, SWAP != 0, TRANSFORM);
  localparam bit PLANE = pairs_pkg::moves_shape(PAIRS, pairs_pkg::SHAPE_PLANE, SWAP != 0, TRANSFORM);
  // Whether a shape is a point and a direction or unit vector, like rays and cylinders.
  function automatic bit is_turned(input int shape);
    is_turned = pairs_pkg::word_kind(shape, 3) == pairs_pkg::WORD_DIRECTION ||
        pairs_pkg::word_kind(shape, 3) == pairs_pkg::WORD_PURE;
  endfunction
  function automatic bit moves_turned(input int pairs);
    moves_turned = 0;
    for (int k = 0; k < SHAPES; k++)
      if (is_turned(k) && pairs_pkg::moves_shape(pairs, k, SWAP != 0, TRANSFORM)) moves_turned = 1;
  endfunction
  localparam bit TURNED = moves_turned(PAIRS);
  localparam int UNITS = OBB ? 4 : TRIANGLE ? 3 : (TURNED || AABB) ? 2 : 1;
  localparam int POINTS = TRIANGLE ? 3 : AABB ? 2 : 1;
  localparam int T_ROTATED = LAT.mul + 2 * LAT.add;

  logic [MOST-1:0][CW-1:0] words;
  assign words = (MOST * CW)'(slot_i);
  `DF_MATRIX_IN(r, rotation_i[2:0], rotation_i[5:3], rotation_i[8:6], 0)
  `DF_VIN(t, translation_i, 0)
  `DF_VAT(t_late, t, T_ROTATED)

  logic plain_rotated, plain;
  pairs_pkg::shape_t rotated_shape;
  logic [pairs_pkg::SHAPE_INDEX-1:0] shape_late;
  pipe_delay #(.W(1 + pairs_pkg::SHAPE_BITS), .FROM(0), .TO(T_ROTATED), .ARITH(ARITH)) delay_rotated (
      .clk_i, .d_i({plain_i, shape_i}), .q_o({plain_rotated, rotated_shape}));
  pipe_delay #(.W(1 + pairs_pkg::SHAPE_INDEX), .FROM(T_ROTATED), .TO(LATENCY), .ARITH(ARITH)) delay_shape (
      .clk_i, .d_i({plain_rotated, rotated_shape[pairs_pkg::SHAPE_INDEX-1:0]}), .q_o({plain, shape_late}));

  logic unused_codes;  // bits that no shape of the card uses
  assign unused_codes = &{1'b0, shape_i, rotated_shape};

  // ---- Vector units, and the operands of each shape ----
  logic [UNITS-1:0][2:0][CW-1:0] rotated;  // R x
  logic [POINTS-1:0][2:0][CW-1:0] moved;   // R x + t
  for (genvar u = 0; u < UNITS; u++) begin : unit
    logic [2:0][CW-1:0] field;
    if (OBB && u > 0) begin : g_column
      assign field = (shape_i == pairs_pkg::SHAPE_BITS'(pairs_pkg::SHAPE_OBB)) ?
          {words[11+u], words[8+u], words[5+u]} : words[3*u+:3];
    end else begin : g_field
      assign field = words[3*u+:3];
    end
    `DF_VIN(x, field, 0)
    `DF_APPLY(rx, r, x)
    assign rotated[u] = rx;
    if (u < POINTS) begin : g_point
      // An AABB is not rotated, because its corners must not be exchanged or move apart.
      logic [2:0][CW-1:0] p;
      if (AABB) begin : g_box
        `DF_VAT(x_late, x, T_ROTATED)
        assign p = (rotated_shape == pairs_pkg::SHAPE_BITS'(pairs_pkg::SHAPE_AABB)) ? x_late : rx;
      end else begin : g_turned
        assign p = rx;
      end
      `DF_VIN(point, p, T_ROTATED)
      `DF_VADD(sum, point, t_late)
      assign moved[u] = sum;
    end
  end

  // ---- Distance of a plane ----
  localparam int T_MOVED = T_ROTATED + LAT.add;
  logic [CW-1:0] distance;
  if (PLANE) begin : g_plane
    `DF_VIN(n, rotated[0], T_ROTATED)
    `DF_IN(d, words[3], 0)
    `DF_DOT(along, n, t)
    `DF_ADD(sum, d, along)
    if (T_sum != LATENCY) begin : g_late
      $error("transformer: pairs_pkg::transform_latency does not match the plane");
    end
    assign distance = sum;
  end else begin : g_no_plane
    logic unused_distance;
    assign distance = '0;
    assign unused_distance = &{1'b0, distance};
    if (T_MOVED != LATENCY) begin : g_late
      $error("transformer: pairs_pkg::transform_latency does not match the points");
    end
  end

  // ---- Output slot of each shape ----
  logic [MOST-1:0][CW-1:0] late;
  logic [UNITS-1:0][2:0][CW-1:0] direction;
  logic [POINTS-1:0][2:0][CW-1:0] point;
  pipe_delay #(.W(MOST * CW), .FROM(0), .TO(LATENCY), .ARITH(ARITH)) delay_words (.clk_i, .d_i(words), .q_o(late));
  pipe_delay #(.W(UNITS * 3 * CW), .FROM(T_ROTATED), .TO(LATENCY), .ARITH(ARITH)) delay_direction (
      .clk_i, .d_i(rotated),
      .q_o(direction));
  pipe_delay #(.W(POINTS * 3 * CW), .FROM(T_MOVED), .TO(LATENCY), .ARITH(ARITH)) delay_point (.clk_i, .d_i(moved),
      .q_o(point));
  logic [SHAPES-1:0][MOST-1:0][CW-1:0] of;
  for (genvar k = 0; k < SHAPES; k++) begin : shape
    if (!pairs_pkg::moves_shape(PAIRS, k, SWAP != 0, TRANSFORM)) begin : g_absent
      assign of[k] = '0;
    end else if (k == pairs_pkg::SHAPE_TRIANGLE) begin : g_triangle
      assign of[k] = {late[14:9], point[2], point[1], point[0]};
    end else if (k == pairs_pkg::SHAPE_AABB) begin : g_aabb
      assign of[k] = {late[14:6], point[1], point[0]};
    end else if (k == pairs_pkg::SHAPE_SPHERE) begin : g_sphere
      assign of[k] = {late[14:3], point[0]};
    end else if (k == pairs_pkg::SHAPE_PLANE) begin : g_plane
      assign of[k] = {late[14:4], distance, direction[0]};
    end else if (k == pairs_pkg::SHAPE_OBB) begin : g_obb
      // Rows of the product. The units give its columns.
      assign of[k] = {direction[3][2], direction[2][2], direction[1][2], direction[3][1], direction[2][1],
          direction[1][1],
          direction[3][0], direction[2][0], direction[1][0], late[5:3], point[0]};
    end else if (is_turned(k)) begin : g_turned
      assign of[k] = {late[14:6], direction[1], point[0]};
    end else begin : g_none
      $error("transformer: no branch for shape %0d", k);
    end
  end
  logic [MOST-1:0][CW-1:0] chosen;
  assign chosen = plain ? late : of[shape_late];
  assign slot_o = chosen[WORDS-1:0];
  logic unused;
  assign unused = &{1'b0, chosen, direction};
endmodule
