// SPDX-License-Identifier: Apache-2.0
// Signed distance of a pair from its COUNT candidate axes (SAT), before polishing.
// `s` is the largest distance on any axis. `witness` is the axis whose vector v is nearest to s n. There n is the axis'
// own normal if its distance ties with the largest, else the normal of the largest. If the bodies penetrate, n, v and p
// of `witness` belong to s. Distances within tie are ties; where normals are opposite, within wide_tie.
// `start` is the axis whose point is nearest the origin, with v perpendicular to the edge that it ends on. If the
// bodies are apart, it is the point of B - A to polish. The tree over axes carries only used results. 5 COUNT + 7 add,
// 6 COUNT + 7 mul, 4 COUNT - 1 compare. With SAT_II = 3, three axes share one unit for the witness key.
// Latency: s and witness LATENCY_WITNESS(COUNT) cycles, start LATENCY_NEAREST(COUNT); 0 with ARITH = "host".
// Throughput: one pair per lane per SAT_II cycles.
// Stall: none.
`include "convex.svh"
module axis_choice #(
    `DF_PARAMETERS,
    parameter int COUNT = 2,     // >= 2
    parameter int SAT_II = 1  // 1 or 3
) (
    input logic clk_i,
    input logic [1:0] phase_i,  // axes and tie are valid in phase 0
    input logic [COUNT-1:0][LANES-1:0][CW-1:0] separation_i,
    input logic [COUNT-1:0][2:0][LANES-1:0][CW-1:0] n_i,
    input logic [COUNT-1:0][2:0][LANES-1:0][CW-1:0] v_i,
    input logic [COUNT-1:0][2:0][LANES-1:0][CW-1:0] p_i,
    input logic [COUNT-1:0][LANES-1:0][CW-1:0] d2_i,
    input logic [COUNT-1:0][2:0][LANES-1:0][CW-1:0] f_i,  // edge of B, and 1 / f.f or 0
    input logic [COUNT-1:0][LANES-1:0][CW-1:0] inverse_ff_i,
    input logic [LANES-1:0][CW-1:0] tie_i,
    input logic [LANES-1:0][CW-1:0] wide_tie_i,
    output logic [LANES-1:0][CW-1:0] s_o,
    output logic [2:0][LANES-1:0][CW-1:0] witness_n_o,
    output logic [2:0][LANES-1:0][CW-1:0] witness_v_o,
    output logic [2:0][LANES-1:0][CW-1:0] witness_p_o,
    output logic [2:0][LANES-1:0][CW-1:0] start_v_o,
    output logic [2:0][LANES-1:0][CW-1:0] start_p_o
);
  /*verilator inline_module*/
  localparam int TURNS = `SAT_TURNS;
  localparam int T_TREE = `LATENCY_LEAST(COUNT);

  // ---- The largest distance ----
  logic [COUNT-1:0][LANES-1:0][CW-1:0] minus_separation;
  logic [LANES-1:0][CW-1:0] minus_largest;
  logic [2:0][LANES-1:0][CW-1:0] largest_normal;
  for (genvar i = 0; i < COUNT; i++) begin : g_key
    fp_sign #(`DF_FORMAT, .OP(formats_pkg::SIGN_NEG)) sign (
        .a_i(separation_i[i]), .b_i(separation_i[i]), .r_o(minus_separation[i]));
  end
  least_tree #(`DF_FORMAT, .COUNT(COUNT), .WORDS(3), .LAT(LAT)) by_separation (
      .clk_i, .key_i(minus_separation), .payload_i(n_i), .key_o(minus_largest), .payload_o(largest_normal));
  `DF_IN(minus_s, minus_largest, T_TREE)
  `DF_VIN(largest_n, largest_normal, T_TREE)
  `DF_IN(tie, tie_i, 0)
  `DF_NEG(s, minus_s)
  `DF_SUB(tied, s, tie)
  `DF_IN(wide_tie, wide_tie_i, 0)
  `DF_SUB(nearly, s, wide_tie)
  `DF_LEADING(leading, largest_n)
  `DF_LEAD(lead, leading, largest_n)

  // ---- The axis of the witness points ----
  localparam int T_OFF2 = T_TREE + `DF_MAX2(LAT.add, LAT.cmp) + LAT.cmp + LAT.mul + LAT.add + `DF_LAT_DOT;
  logic [COUNT-1:0][LANES-1:0][CW-1:0] off2;
  logic [COUNT-1:0][8:0][LANES-1:0][CW-1:0] candidate;  // n, v, p
  `DF_PHASE_IN(phase, phase_i, 0)
  `DF_PHASE_AT(phase_s, phase, T_TREE)
  `DF_PHASE_AT(phase_tied, phase_s, T_tied)
  `DF_HOLD(s_held, phase_s, s)
  `DF_VHOLD(largest_n_held, phase_s, largest_n)
  `DF_PHASE_AT(phase_leading, phase_s, T_lead)
  `DF_HOLD(tied_held, phase_tied, tied)
  `DF_HOLD(nearly_held, phase_tied, nearly)
  `DF_HOLD(leading_held_x, phase_leading, leading_x)
  `DF_HOLD(leading_held_y, phase_leading, leading_y)
  `DF_HOLD(lead_held, phase_leading, lead)
  for (genvar i = 0; i < COUNT; i += TURNS) begin : g_witness
    localparam int USERS = (TURNS < COUNT - i) ? TURNS : COUNT - i;
    localparam int SECOND = (USERS > 1) ? i + 1 : i, THIRD = (USERS > 2) ? i + 2 : i;
    `DF_IN(separation0, separation_i[i], 0)
    `DF_IN(separation1, separation_i[SECOND], 0)
    `DF_IN(separation2, separation_i[THIRD], 0)
    `DF_VIN(own_n0, n_i[i], 0)
    `DF_VIN(own_n1, n_i[SECOND], 0)
    `DF_VIN(own_n2, n_i[THIRD], 0)
    `DF_VIN(v0, v_i[i], 0)
    `DF_VIN(v1, v_i[SECOND], 0)
    `DF_VIN(v2, v_i[THIRD], 0)
    `DF_VIN(p0, p_i[i], 0)
    `DF_VIN(p1, p_i[SECOND], 0)
    `DF_VIN(p2, p_i[THIRD], 0)
    `DF_TURN_PASSING(separation, 0, phase, separation0, separation1, separation2)
    `DF_VTURN_PASSING(own_n, 0, phase, own_n0, own_n1, own_n2)
    `DF_VTURN_PASSING(v, 0, phase, v0, v1, v2)
    `DF_VTURN_PASSING(p, 0, phase, p0, p1, p2)
    `DF_LEAD(own_lead, leading_held, own_n)
    `DF_MOVE_SIGN(agree, lead_held, own_lead)
    `DF_NEGATIVE(opposite, agree)
    `DF_SELECT(least_separation, opposite, nearly_held, tied_held)
    `DF_LE(ties, least_separation, separation)
    `DF_VSELECT(n, ties, own_n, largest_n_held)
    `DF_VSCALE(ideal, n, s_held)
    `DF_VSUB(off, v, ideal)
    `DF_DOT(square, off, off)
    if (T_square != T_OFF2) $error("axis_choice: stage time");
    `DF_VAT(n_key, n, T_OFF2)
    `DF_VAT(v_key, v, T_OFF2)
    `DF_VAT(p_key, p, T_OFF2)
    logic [USERS-1:0][LANES-1:0][CW-1:0] squares;
    logic [USERS-1:0][2:0][LANES-1:0][CW-1:0] n_keys, v_keys, p_keys;
    serial_to_parallel #(.W(LANES * CW), .TURNS(TURNS), .USERS(USERS), .ARITH(ARITH))
        after_square (.clk_i, .d_i(square), .q_o(squares));
    serial_to_parallel #(.W(3 * LANES * CW), .TURNS(TURNS), .USERS(USERS), .ARITH(ARITH))
        after_n (.clk_i, .d_i(n_key), .q_o(n_keys));
    serial_to_parallel #(.W(3 * LANES * CW), .TURNS(TURNS), .USERS(USERS), .ARITH(ARITH))
        after_v (.clk_i, .d_i(v_key), .q_o(v_keys));
    serial_to_parallel #(.W(3 * LANES * CW), .TURNS(TURNS), .USERS(USERS), .ARITH(ARITH))
        after_p (.clk_i, .d_i(p_key), .q_o(p_keys));
    for (genvar k = 0; k < USERS; k++) begin : g_user
      assign off2[i+k] = squares[k];
      assign candidate[i+k] = {p_keys[k], v_keys[k], n_keys[k]};
    end
  end
  least_tree #(`DF_FORMAT, .COUNT(COUNT), .WORDS(9), .LAT(LAT)) by_witness (
      .clk_i, .key_i(off2), .payload_i(candidate), .key_o(), .payload_o({witness_p_o, witness_v_o, witness_n_o}));
  if (T_OFF2 + `SAT_WAIT + T_TREE != `LATENCY_WITNESS(COUNT)) $error("axis_choice: latency of the witness");
  `DF_AT(s_out, s, `LATENCY_WITNESS(COUNT))
  assign s_o = s_out;

  // ---- The axis nearest the origin ----
  logic [COUNT-1:0][9:0][LANES-1:0][CW-1:0] nearest;  // v, p, f, 1 / f.f
  logic [2:0][LANES-1:0][CW-1:0] nearest_v, nearest_p, nearest_f;
  logic [LANES-1:0][CW-1:0] nearest_inverse;
  for (genvar i = 0; i < COUNT; i++) begin : g_nearest
    assign nearest[i] = {inverse_ff_i[i], f_i[i], p_i[i], v_i[i]};
  end
  least_tree #(`DF_FORMAT, .COUNT(COUNT), .WORDS(10), .LAT(LAT)) by_distance (
      .clk_i, .key_i(d2_i), .payload_i(nearest), .key_o(), .payload_o({nearest_inverse, nearest_f, nearest_p,
      nearest_v}));
  `DF_VIN(near_v, nearest_v, T_TREE)
  `DF_VIN(near_p, nearest_p, T_TREE)
  `DF_VIN(near_f, nearest_f, T_TREE)
  `DF_IN(near_inverse, nearest_inverse, T_TREE)
  `DF_PERPENDICULAR(start_v, near_v, near_f, near_inverse)
  if (T_start_v != `LATENCY_NEAREST(COUNT)) $error("axis_choice: latency of the start");
  `DF_VAT(start_p, near_p, T_start_v)
  assign start_v_o = start_v;
  assign start_p_o = start_p;
endmodule
