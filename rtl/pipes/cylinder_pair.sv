// SPDX-License-Identifier: Apache-2.0
// Cylinder, box or triangle against a cylinder (host/include/cde/reference/pipes/cylinder/).
// It computes s_K, the largest signed distance g(n) over the normals that the iterations allow. s_K is at most the
// signed distance s, so F = 0 is a proof. F = (s_K <= 0), T = |s_K|, n is the normal, CP is halfway between the witness
// points. The module is an iterative pipeline: a row of pairs circulates once per pass. A pass makes a normal (front),
// evaluates g for it and its opposite (evaluator) and updates the pair's state (circle, free). The last passes find
// witness points.
// SLOTS rows are in flight, one per stage. A row's state lies in memories with one slot per row, at the stages that use
// it.
// Operators (cylinder): 257 add, 321 mul, 9 div, 8 sqrt, 34 compare, 18 min/max.
// Operators (box): 203 add, 215 mul, 5 div, 4 sqrt, 35 compare, 16 min/max.
// Operators (triangle): 260 add, 269 mul, 8 div, 4 sqrt, 54 compare, 21 min/max.
// SLOTS and latency at one cycle per operator and the default iterations, in this order: 64, 4,298; 64, 5,066; 70,
// 5,260.
// Latency: ENTRY + passes * SLOTS + FINISH cycles, latency_o. iterations_i sets the number of passes (schedule.hpp).
// Throughput: SLOTS rows per passes * SLOTS cycles; one row per cycle while slots are free.
// Stall: ready_o is low unless the slot at the input port is about to be free. Results leave in the order of entry.
// With ARITH = "host", a whole pass is computed in the cycle in which its row could leave, on the same schedule.
`include "cylinder.svh"
module cylinder_pair #(
    `DF_PARAMETERS,
    parameter int BODY = `BODY_CYLINDER,
    parameter int AHEAD = 0,  // 0 or 1: cycles from valid_i and ready_o to the row's operands
    // cycles from a row's entry to its first pass: at least scale_latency, and at least LAT.add and LAT.mul
    parameter int ENTRY = 5,
    localparam int A_WORDS = (BODY == `BODY_CYLINDER) ? 8 : (BODY == `BODY_BOX) ? 15 : 9
) (
    input logic clk_i,
    input logic rst_i,
    // {K2, K1, M}, one byte each: M is 4, 8 or 16, K1 and K2 are at most 64. Constant while a row is in flight, and
    // from the cycle before a row enters.
    input logic [23:0] iterations_i,
    input logic valid_i,
    output logic ready_o,
    input logic [31:0] tag_i,
    input logic [A_WORDS-1:0][LANES-1:0][CW-1:0] a_i,  // cylinder, box or triangle
    input logic [7:0][LANES-1:0][CW-1:0] b_i,  // cylinder: c x y z, axis x y z, half height, radius
    // the row's lane mask, ENTRY cycles after the row; with the row if ARITH = "host"
    input logic [LANES-1:0][CW-1:0] bad_i,
    output logic valid_o,
    output logic [31:0] tag_o,
    output logic [LANES-1:0][CW-1:0] bad_o,
    output logic [LANES-1:0][CW-1:0] f_o,  // lane mask
    output logic [LANES-1:0][CW-1:0] t_o,
    output logic [2:0][LANES-1:0][CW-1:0] cp_o,
    output logic [2:0][LANES-1:0][CW-1:0] n_o,
    output logic [31:0] latency_o
);
  /*verilator inline_module*/
  localparam bit GATES = ARITH == "rtl";
  localparam int LW = LANES * CW;
  localparam int T_EVALUATE = `LATENCY_FRONT;
  localparam int T_EVALUATED = T_EVALUATE + `LATENCY_EVALUATOR;
  localparam int T_BETTER = T_EVALUATED + LAT.cmp;
  localparam int T_STEPPED = T_BETTER + `LATENCY_STEP;
  localparam int T_SLOPE = T_BETTER + `LATENCY_SLOPE;
  localparam int T_END = formats_pkg::larger(T_STEPPED, T_EVALUATED + `LATENCY_CYLINDER_WITNESS);
  localparam int SLOTS = T_END + 1;
  localparam int RESULT = formats_pkg::larger(2 * LAT.mul + 2 * LAT.add, LAT.cmp);
  localparam int FINISH = RESULT + pairs_pkg::unscale_latency(0, LAT.mul, LAT.cmp);
  // passes for M = K1 = K2 = 8
  localparam int INTERVAL = (BODY == `BODY_CYLINDER) ? 67 : (BODY == `BODY_BOX) ? 79 : 75;
  localparam int LATENCY = AHEAD + ENTRY + INTERVAL * SLOTS + FINISH;
  localparam int AW = $clog2(SLOTS);
  localparam logic [CW-1:0] QNAN = (((CW'(1) << EXP) - 1) << MAN) | (CW'(1) << (MAN - 1));
  localparam logic [CW-1:0] INFINITY = ((CW'(1) << EXP) - 1) << MAN;
  localparam logic [CW-1:0] MINUS_INFINITY = ((CW'(2) << EXP) - 1) << MAN;

  // ---- Slots: now_q is the slot at the end of its pass. The slot at stage t arrives there T_END - t cycles later ----
  logic [AW-1:0] now_q;
  function automatic logic [AW-1:0] after(input logic [AW-1:0] now, input logic [AW:0] clocks);
    logic [AW:0] sum;
    sum = (AW + 1)'(now) + clocks;
    after = AW'((sum >= (AW + 1)'(SLOTS)) ? sum - (AW + 1)'(SLOTS) : sum);
  endfunction
  // avoids a call in every cycle
  `define SLOT(TIME) (GATES ? after(now_q, (AW + 1)'(GATES ? T_END - (TIME) : 0)) : now_q)
  localparam int INPUT_DELAY = (GATES ? ENTRY : 0) + AHEAD;  // cycles from ready_o to the begin of the first pass

  // ---- Control: which pass each slot is in ----
  logic [SLOTS-1:0] valid_q;
  logic [`PASS_W-1:0] pass_mem[SLOTS];
  logic [31:0] tag_mem[SLOTS];
  logic [3:0] phase_end;
  logic witness_end;
  assign phase_end = `PASS_PHASE(pass_mem[now_q]);
  assign witness_end = phase_end == `PHASE_TOUCH || phase_end == `PHASE_PROJECT;
  logic [LANES-1:0][CW-1:0] bad_mem[SLOTS];
  logic enter, entered, leave, last, next_last;
  logic [15:0] passes;
  logic [`PASS_W-1:0] first_pass, next_pass, unused_first, unused_next;
  logic [15:0] unused_passes;
  logic [31:0] entered_tag;
  // A register, because Verilator evaluates logic on inputs at both clock edges.
  logic [23:0] iterations_q;
  always_ff @(posedge clk_i) iterations_q <= iterations_i;
  cylinder_schedule #(.BODY(BODY)) schedule (
      .iterations_i(iterations_q), .pass_i(pass_mem[now_q]), .first_o(first_pass), .next_o(next_pass), .last_o(last),
      .passes_o(passes));
  cylinder_schedule #(.BODY(BODY)) schedule_next (
      .iterations_i(iterations_q), .pass_i(pass_mem[after(now_q, (AW + 1)'(INPUT_DELAY))]), .first_o(unused_first),
      .next_o(unused_next), .last_o(next_last),
      .passes_o(unused_passes));
  logic unused;
  assign unused = &{1'b0, unused_first, unused_next, unused_passes};
  assign ready_o = !valid_q[after(now_q, (AW + 1)'(INPUT_DELAY))] || next_last;
  if (AHEAD != 0) begin : g_ahead
    always_ff @(posedge clk_i) enter <= valid_i && ready_o && !rst_i;
  end else begin : g_now
    assign enter = valid_i && ready_o;
  end
  if (GATES) begin : g_entry
    pipe_delay_valid #(.FROM(0), .TO(ENTRY)) delay_enter (.clk_i, .rst_i, .valid_i(enter), .valid_o(entered));
  end else begin : g_entry
    assign entered = enter;
  end
  pipe_delay #(.W(32), .FROM(0), .TO(ENTRY), .ARITH(ARITH)) delay_tag (.clk_i, .d_i(tag_i), .q_o(entered_tag));
  assign leave = valid_q[now_q] && last;
  assign latency_o = 32'(AHEAD + ENTRY + FINISH) + 32'(passes) * 32'(SLOTS);
  always_ff @(posedge clk_i) begin
    now_q <= (now_q == AW'(SLOTS - 1)) ? '0 : now_q + 1;
    if (entered) begin
      pass_mem[now_q] <= first_pass;
      tag_mem[now_q] <= entered_tag;
      bad_mem[now_q] <= bad_i;
    end else begin
      pass_mem[now_q] <= next_pass;
    end
    valid_q[now_q] <= entered || (valid_q[now_q] && !last);
    if (rst_i) begin
      now_q <= '0;
      valid_q <= '0;
    end
  end

  // ---- Operands, scaled to the size of one and relative to A's origin ----
  localparam int SHAPE_A = (BODY == `BODY_CYLINDER) ? pairs_pkg::SHAPE_CYLINDER : (BODY == `BODY_BOX) ?
      pairs_pkg::SHAPE_OBB : pairs_pkg::SHAPE_TRIANGLE;
  localparam int T_SCALED = pairs_pkg::scale_latency(0, LAT.mul, LAT.cmp);
  logic [A_WORDS-1:0][LANES-1:0][CW-1:0] a;
  logic [7:0][LANES-1:0][CW-1:0] b;
  logic [LANES-1:0][CW-1:0] back, back_in, unused_t_back, back_mem[SLOTS];
  length_scale #(`DF_SAME, .SHAPE_A(SHAPE_A), .SHAPE_B(pairs_pkg::SHAPE_CYLINDER)) scale (
      .clk_i, .en_i(entered), .a_i, .b_i, .a_o(a), .b_o(b), .back_o(back), .t_back_o(unused_t_back));
  pipe_delay #(.W(LW), .FROM(T_SCALED), .TO(ENTRY), .ARITH(ARITH)) delay_back (.clk_i, .d_i(back), .q_o(back_in));
  always_ff @(posedge clk_i) if (entered) back_mem[now_q] <= back_in;
  `undef DF_EN
  `define DF_EN entered
  localparam int ORIGIN = 0, D = 3, B = 6, B_REACH = 9, B_HALF = 12, B_RADIUS = 13, A_REACH = 14, A_HALF = 23,
      A_RADIUS = 26, A_AXIS = 27;
  localparam int OPERANDS = 36;
  logic [OPERANDS-1:0][LANES-1:0][CW-1:0] operands, operand_mem[SLOTS];
  `DF_VIN(a_origin, a[2:0], T_SCALED)
  `DF_VIN(b_centre, b[2:0], T_SCALED)
  `DF_VIN(b_axis, b[5:3], T_SCALED)
  `DF_IN(b_half, b[6], T_SCALED)
  `DF_VSUB(b_from_a, b_centre, a_origin)
  `DF_VSCALE(b_reach, b_axis, b_half)
  `DF_VAT(b_from_a_in, b_from_a, ENTRY)
  `DF_VAT(b_reach_in, b_reach, ENTRY)
  logic [7:3][LANES-1:0][CW-1:0] b_in;
  logic [A_WORDS-1:0][LANES-1:0][CW-1:0] a_in;
  pipe_delay #(.W(5 * LW), .FROM(T_SCALED), .TO(ENTRY), .ARITH(ARITH)) delay_b (.clk_i, .d_i(b[7:3]), .q_o(b_in));
  pipe_delay #(.W(A_WORDS * LW), .FROM(T_SCALED), .TO(ENTRY), .ARITH(ARITH)) delay_a (.clk_i, .d_i(a), .q_o(a_in));
  assign operands[ORIGIN+:3] = a_in[2:0];
  assign operands[D+:3] = b_from_a_in;
  assign operands[B+:3] = b_in[5:3];
  assign operands[B_REACH+:3] = b_reach_in;
  assign operands[B_HALF] = b_in[6];
  assign operands[B_RADIUS] = b_in[7];
  if (BODY == `BODY_CYLINDER) begin : g_operands
    `DF_VIN(axis, a[5:3], T_SCALED)
    `DF_IN(half, a[6], T_SCALED)
    `DF_VSCALE(reach, axis, half)
    `DF_VAT(reach_in, reach, ENTRY)
    assign operands[A_REACH+:9] = {{(6 * LW) {1'b0}}, reach_in};
    assign operands[A_HALF+:3] = {{(2 * LW) {1'b0}}, a_in[6]};
    assign operands[A_RADIUS] = a_in[7];
    assign operands[A_AXIS+:9] = {{(6 * LW) {1'b0}}, a_in[5:3]};
  end else if (BODY == `BODY_BOX) begin : g_operands
    `DF_MATRIX_IN(rotation, a[8:6], a[11:9], a[14:12], T_SCALED)  // by rows; the columns are the axes
    `DF_VIN(half, a[5:3], T_SCALED)
    `DF_TRANSPOSE(axes, rotation)
    `DF_MSCALE(reach, axes, half)
    for (genvar k = 0; k < 3; k++) begin : axis
      df_pipe_delay #(.W(3 * LW), .T_A(T_reach), .T(ENTRY), .ARITH(ARITH))
          delay_reach (.clk_i, .a_i(reach[k]), .r_o(operands[A_REACH+3*k+:3]));
      assign operands[A_AXIS+3*k+:3] = {a_in[12+k], a_in[9+k], a_in[6+k]};
    end
    assign operands[A_HALF+:3] = a_in[5:3];
    assign operands[A_RADIUS] = '0;
  end else begin : g_operands
    `DF_MATRIX_IN(tails, a[2:0], a[2:0], a[5:3], T_SCALED)
    `DF_MATRIX_IN(heads, a[5:3], a[8:6], a[8:6], T_SCALED)
    `DF_MSUB(edges, heads, tails)
    df_pipe_delay #(.W(9 * LW), .T_A(T_edges), .T(ENTRY), .ARITH(ARITH))
        delay_edges (.clk_i, .a_i(edges), .r_o(operands[A_REACH+:9]));
    assign {operands[A_HALF+:3], operands[A_RADIUS], operands[A_AXIS+:9]} = '0;
    logic unused_a;
    assign unused_a = &{1'b0, a_in[A_WORDS-1:3]};
  end
  `undef DF_EN
  `define DF_EN 1'b1
  always_ff @(posedge clk_i) if (entered) operand_mem[now_q] <= operands;
  `define OPERAND(WORD, TIME) operand_mem[`SLOT(TIME)][WORD]
  `define OPERAND3(WORD, TIME) operand_mem[`SLOT(TIME)][WORD+:3]
  `define OPERAND9(WORD, TIME) operand_mem[`SLOT(TIME)][WORD+:9]

  // ---- State ----
  logic [LANES-1:0][CW-1:0] best_g_mem[SLOTS], best_slope_mem[SLOTS], score_mem[SLOTS], off_mem[SLOTS];
  logic [LANES-1:0][CW-1:0] last_g_mem[SLOTS], last_slope_mem[SLOTS], back_g_mem[SLOTS], back_slope_mem[SLOTS];
  logic [2:0][LANES-1:0][CW-1:0] best_n_mem[SLOTS], next_mem[SLOTS], q_mem[SLOTS], lo_n_mem[SLOTS], lo_y_mem[SLOTS],
      hi_n_mem[SLOTS];
  logic [2:0][LANES-1:0][CW-1:0] hi_y_mem[SLOTS], last_n_mem[SLOTS], last_y_mem[SLOTS], back_y_mem[SLOTS],
      witness_mem[SLOTS];
  // A's axes, or the triangle's edges, of unit length
  logic [2:0][2:0][LANES-1:0][CW-1:0] axes_start, axes_better, axes_witness;
  logic [2:0][LANES-1:0][CW-1:0] face_start, face_witness;  // normal of the triangle
  logic [2:0][LANES-1:0][CW-1:0] n;  // normal of this pass (front)
  logic [3:0] phase_evaluate;
  if (BODY == `BODY_CYLINDER) begin : g_axes
    assign axes_start = `OPERAND9(A_AXIS, 0);
    assign axes_better = `OPERAND9(A_AXIS, T_BETTER);
    assign axes_witness = `OPERAND9(A_AXIS, T_EVALUATED);
    assign {face_start, face_witness} = '0;
  end else begin : g_axes  // the first passes write them: the face is word 3
    logic [2:0][LANES-1:0][CW-1:0] axis_mem[4][SLOTS];
    logic [1:0] place;
    assign place = `PASS_INDEX_LOW(pass_mem[`SLOT(T_EVALUATE)]) - ((BODY == `BODY_TRIANGLE) ? 2'd1 : 2'd0);
    for (genvar k = 0; k < 3; k++) begin : axis
      assign axes_start[k] = axis_mem[k][`SLOT(0)];
      assign axes_better[k] = axis_mem[k][`SLOT(T_BETTER)];
      assign axes_witness[k] = axis_mem[k][`SLOT(T_EVALUATED)];
    end
    assign face_start = axis_mem[3][`SLOT(0)];
    assign face_witness = axis_mem[3][`SLOT(T_EVALUATED)];
    always_ff @(posedge clk_i)
      if (phase_evaluate == `PHASE_FRAME) axis_mem[place][`SLOT(T_EVALUATE)] <= n;
  end

  // ---- Front: the normal ----
  logic [`PASS_W-1:0] pass_start;
  assign pass_start = pass_mem[`SLOT(0)];
  if (BODY == `BODY_CYLINDER) begin : g_front
    logic unused_front;
    assign unused_front = &{1'b0, axes_start[2:1], face_start};
    cylinder_front #(`DF_SAME) front (
        .clk_i, .pass_i(pass_start), .a_i(axes_start[0]), .b_i(`OPERAND3(B, 0)), .d_i(`OPERAND3(D, 0)),
        .q_i(q_mem[`SLOT(0)]),
        .last_n_i(last_n_mem[`SLOT(0)]), .next_i(next_mem[`SLOT(0)]), .best_n_i(best_n_mem[`SLOT(0)]), .n_o(n));
  end else begin : g_front
    logic [2:0][LANES-1:0][CW-1:0] frame;
    assign frame = operand_mem[`SLOT(0)][A_AXIS+3*32'(`PASS_INDEX_LOW(pass_start))+:3];
    polyhedron_front #(`DF_SAME, .BODY(BODY)) front (
        .clk_i, .pass_i(pass_start), .samples_i(iterations_q[7:0]), .axis_i(axes_start),
        .reach_i(`OPERAND9(A_REACH, 0)), .face_i(face_start),
        .frame_i(frame), .d_i(`OPERAND3(D, 0)), .b_i(`OPERAND3(B, 0)), .b_half_i(`OPERAND(B_HALF, 0)),
        .b_radius_i(`OPERAND(B_RADIUS, 0)),
        .q_i(q_mem[`SLOT(0)]), .next_i(next_mem[`SLOT(0)]), .best_n_i(best_n_mem[`SLOT(0)]), .n_o(n));
  end

  // ---- Evaluation of n and -n ----
  logic [1:0] track_evaluate;
  logic pole;
  `DF_SCALAR plus_g_now, minus_g_now, a_kappa_now, b_kappa_now, b_along;
  `DF_VECTOR plus_y_now, minus_y_now, a_v_now, b_v_now, a_side, b_side, pa;
  assign phase_evaluate = `PASS_PHASE(pass_mem[`SLOT(T_EVALUATE)]);
  assign track_evaluate = `PASS_TRACK(pass_mem[`SLOT(T_EVALUATE)]);
  assign pole = phase_evaluate == `PHASE_POLE;
  cylinder_evaluator #(`DF_SAME, .BODY(BODY)) evaluator (
      .clk_i, .off_a_i(pole && track_evaluate == 0), .off_b_i(pole && track_evaluate == 1), .n_i(n),
      .a_i(`OPERAND3(A_AXIS, T_EVALUATE)), .radius_i(`OPERAND(A_RADIUS, T_EVALUATE)),
      .reach_i(`OPERAND9(A_REACH, T_EVALUATE)),
      .d_i(`OPERAND3(D, T_EVALUATE)), .b_i(`OPERAND3(B, T_EVALUATE)), .b_reach_i(`OPERAND3(B_REACH, T_EVALUATE)),
      .b_half_i(`OPERAND(B_HALF, T_EVALUATE)), .b_radius_i(`OPERAND(B_RADIUS, T_EVALUATE)), .plus_g_o(plus_g_now),
      .plus_y_o(plus_y_now),
      .minus_g_o(minus_g_now), .minus_y_o(minus_y_now), .a_kappa_o(a_kappa_now), .a_v_o(a_v_now), .a_side_o(a_side),
      .b_kappa_o(b_kappa_now),
      .b_v_o(b_v_now), .b_side_o(b_side), .b_along_o(b_along), .pa_o(pa));

  // ---- The better orientation ----
  `DF_VIN(plus_n_early, n, T_EVALUATE)
  `DF_VAT(evaluated_n, plus_n_early, T_EVALUATED)
  `DF_VAT(plus_n, evaluated_n, T_BETTER)
  `DF_IN(plus_g, plus_g_now, T_EVALUATED)
  `DF_VIN(plus_y, plus_y_now, T_EVALUATED)
  `DF_IN(minus_g, minus_g_now, T_EVALUATED)
  `DF_VIN(minus_y, minus_y_now, T_EVALUATED)
  `DF_VNEG(minus_n, plus_n)
  `DF_LT(turned, plus_g, minus_g)
  `DF_SELECT(better_g, turned, minus_g, plus_g)
  `DF_VSELECT(better_n, turned, minus_n, plus_n)
  `DF_VSELECT(better_y, turned, minus_y, plus_y)
  `DF_AT(late_g, plus_g, T_BETTER)
  `DF_VAT(late_y, plus_y, T_BETTER)
  `DF_AT(late_minus_g, minus_g, T_BETTER)
  `DF_VAT(late_minus_y, minus_y, T_BETTER)
  logic [`PASS_W-1:0] pass_better;
  assign pass_better = pass_mem[`SLOT(T_BETTER)];
  localparam bit CYLINDER = BODY == `BODY_CYLINDER;
  always_ff @(posedge clk_i)
    if (`PASS_PHASE(pass_better) == `PHASE_CAP || `PASS_PHASE(pass_better) == `PHASE_SAMPLE) begin
      last_g_mem[`SLOT(T_BETTER)] <= late_g;
      last_n_mem[`SLOT(T_BETTER)] <= CYLINDER ? better_n : plus_n;
      last_y_mem[`SLOT(T_BETTER)] <= CYLINDER ? better_y : late_y;
      back_g_mem[`SLOT(T_BETTER)] <= late_minus_g;
      back_y_mem[`SLOT(T_BETTER)] <= late_minus_y;
    end

  // ---- Best normal so far. Cylinders: the first of equals. Else: the least slope of those equal up to rounding ----
  `DF_SCALAR slope_now, minus_slope_now;
  `DF_IN(slope, slope_now, T_SLOPE)
  `DF_IN(minus_slope, minus_slope_now, T_SLOPE)
  logic [`PASS_W-1:0] pass_slope, pass_best;
  logic [3:0] phase_raised;
  localparam int T_RAISED = T_BETTER + LAT.cmp;
  localparam int T_BEST = CYLINDER ? T_RAISED : T_SLOPE + LAT.cmp;
  assign phase_raised = `PASS_PHASE(pass_mem[`SLOT(T_RAISED)]);
  assign pass_slope = pass_mem[`SLOT(T_SLOPE)];
  assign pass_best = pass_mem[`SLOT(T_BEST)];
  // The first pass has no best normal to beat.
  `DF_CONTROL(fresh, pass_better == first_pass, T_BETTER)
  `DF_CONTROL(fresh_slope, pass_slope == first_pass, T_SLOPE)
  `DF_CONTROL(fresh_best, pass_best == first_pass, T_BEST)
  `DF_CONST(nothing_g, MINUS_INFINITY)
  `DF_CONST(infinite, INFINITY)
  `DF_VCONST(nothing_n, QNAN, QNAN, QNAN)
  `DF_IN(kept_g, best_g_mem[`SLOT(T_BETTER)], T_BETTER)
  `DF_VIN(kept_n, best_n_mem[`SLOT(T_BEST)], T_BEST)
  `DF_CHOOSE(old_g, fresh, nothing_g, kept_g)
  `DF_VCHOOSE(old_n, fresh_best, nothing_n, kept_n)
  `DF_LT(raised, old_g, better_g)
  `DF_SELECT(best_g, raised, better_g, old_g)
  localparam int T_best_n = T_BEST, T_best_slope = T_BEST;
  `DF_VECTOR best_n;
  `DF_SCALAR best_slope;
  if (CYLINDER) begin : g_first
    logic unused_slope;
    assign unused_slope = &{1'b0, fresh_slope, infinite, slope, minus_slope, best_slope_mem[0], best_slope};
    `DF_VSELECT(first_n, raised, better_n, old_n)
    assign best_n = first_n;
    assign best_slope = '0;
  end else begin : g_least_slope
    logic [3:0] phase_slope;
    assign phase_slope = `PASS_PHASE(pass_slope);
    `DF_CONTROL(vertex, phase_slope == `PHASE_VERTEX, T_SLOPE)
    `DF_CONTROL(circling, phase_slope == `PHASE_SAMPLE || phase_slope == `PHASE_REFINE, T_SLOPE)
    `DF_CONST(zero, 0)
    `DF_CONST(two_u, `DF_POWER_OF_TWO(-MAN))
    `DF_IN(kept_slope, best_slope_mem[`SLOT(T_SLOPE)], T_SLOPE)
    `DF_CHOOSE(old_slope, fresh_slope, infinite, kept_slope)
    `DF_ABS(plus_steep, slope)
    `DF_ABS(minus_steep, minus_slope)
    `DF_SELECT(steep, turned, minus_steep, plus_steep)
    `DF_CHOOSE(exact_or_not, vertex, zero, infinite)
    `DF_CHOOSE(size, circling, steep, exact_or_not)
    `DF_ABS(plus_size, plus_g)
    `DF_ABS(minus_size, minus_g)
    `DF_ADD(sizes, plus_size, minus_size)
    `DF_MUL(near, sizes, two_u)
    `DF_SUB(higher, better_g, old_g)
    `DF_ABS(apart, higher)
    `DF_LE(equal, apart, near)
    `DF_NOT(unequal, equal)
    `DF_LT(flatter, size, old_slope)
    `DF_AND(take_flatter, equal, flatter)
    `DF_AND(take_raised, unequal, raised)
    `DF_OR(take, take_flatter, take_raised)
    `DF_VSELECT(new_n, take, better_n, old_n)
    `DF_SELECT(new_slope, take, size, old_slope)
    `DF_VAT(new_n_late, new_n, T_BEST)
    `DF_AT(new_slope_late, new_slope, T_BEST)
    assign best_n = new_n_late;
    assign best_slope = new_slope_late;
  end
  `DF_SCALAR ended_g;  // of the witness points, below
  `DF_VECTOR ended_n, ended_from, ended_move, ended_next;
  always_ff @(posedge clk_i) begin
    if (phase_raised != `PHASE_TOUCH && phase_raised != `PHASE_PROJECT)
      best_g_mem[`SLOT(T_RAISED)] <= best_g;
    if (`PASS_PHASE(pass_best) != `PHASE_TOUCH && `PASS_PHASE(pass_best) != `PHASE_PROJECT) begin
      best_n_mem[`SLOT(T_BEST)] <= best_n;
      best_slope_mem[`SLOT(T_BEST)] <= best_slope;
    end
    if (witness_end) begin
      best_g_mem[now_q] <= ended_g;
      best_n_mem[now_q] <= ended_n;
    end
    if (`PASS_PHASE(pass_slope) == `PHASE_SAMPLE) begin
      last_slope_mem[`SLOT(T_SLOPE)] <= slope;
      back_slope_mem[`SLOT(T_SLOPE)] <= minus_slope;
    end
  end

  // ---- Steps on circles and free tracks ----
  `DF_IN(a_kappa_early, a_kappa_now, T_EVALUATED)
  `DF_VIN(a_v_early, a_v_now, T_EVALUATED)
  `DF_IN(b_kappa_early, b_kappa_now, T_EVALUATED)
  `DF_VIN(b_v_early, b_v_now, T_EVALUATED)
  `DF_AT(a_kappa, a_kappa_early, T_BETTER)
  `DF_VAT(a_v, a_v_early, T_BETTER)
  `DF_AT(b_kappa, b_kappa_early, T_BETTER)
  `DF_VAT(b_v, b_v_early, T_BETTER)
  logic [1:0] track;
  logic [2:0][LANES-1:0][CW-1:0] e;
  assign track = `PASS_TRACK(pass_better);
  assign e = (BODY == `BODY_CYLINDER && track == 1) ? `OPERAND3(B, T_BETTER) : axes_better[track];
  `DF_VECTOR circle_lo_n, circle_lo_y, circle_hi_n, circle_hi_y, circle_next, new_lo_n, new_lo_y, new_next;
  `DF_SCALAR circle_score, new_score;
  cylinder_circle #(`DF_SAME, .BODY(BODY)) circle (
      .clk_i, .refine_next_i(`PASS_PHASE(next_pass) == `PHASE_REFINE), .pass_i(pass_better), .e_i(e), .g_i(late_g),
      .n_i(plus_n), .y_i(late_y), .a_kappa_i(a_kappa), .a_v_i(a_v), .b_kappa_i(b_kappa), .b_v_i(b_v),
      .minus_g_i(late_minus_g), .minus_y_i(late_minus_y), .best_n_i(better_n), .best_y_i(better_y),
      .lo_n_i(lo_n_mem[`SLOT(T_BETTER)]), .lo_y_i(lo_y_mem[`SLOT(T_BETTER)]), .hi_n_i(hi_n_mem[`SLOT(T_BETTER)]),
      .hi_y_i(hi_y_mem[`SLOT(T_BETTER)]), .score_i(score_mem[`SLOT(T_BETTER)]), .last_g_i(last_g_mem[`SLOT(T_BETTER)]),
      .last_n_i(last_n_mem[`SLOT(T_BETTER)]), .last_y_i(last_y_mem[`SLOT(T_BETTER)]),
      .last_slope_i(last_slope_mem[`SLOT(T_BETTER)]),
      .back_g_i(back_g_mem[`SLOT(T_BETTER)]), .back_y_i(back_y_mem[`SLOT(T_BETTER)]),
      .back_slope_i(back_slope_mem[`SLOT(T_BETTER)]),
      .slope_o(slope_now), .minus_slope_o(minus_slope_now), .lo_n_o(circle_lo_n), .lo_y_o(circle_lo_y),
      .hi_n_o(circle_hi_n),
      .hi_y_o(circle_hi_y), .score_o(circle_score), .next_o(circle_next));
  logic [3:0] phase_stepped;
  logic on_circle, off_circle;
  assign phase_stepped = `PASS_PHASE(pass_mem[`SLOT(T_STEPPED)]);
  assign on_circle = phase_stepped == `PHASE_BESIDE || phase_stepped == `PHASE_SAMPLE ||
      phase_stepped == `PHASE_REFINE;
  assign off_circle = BODY == `BODY_CYLINDER && (phase_stepped == `PHASE_START || phase_stepped == `PHASE_NEWTON);
  if (BODY == `BODY_CYLINDER) begin : g_free
    `DF_VECTOR free_lo_n, free_lo_y, free_next;
    `DF_SCALAR free_score;
    cylinder_free #(`DF_SAME) free (
        .clk_i, .pass_i(pass_better), .d_i(`OPERAND3(D, T_BETTER)), .a_i(`OPERAND3(A_AXIS, T_BETTER)),
        .b_i(`OPERAND3(B, T_BETTER)),
        .a_reach_i(`OPERAND3(A_REACH, T_BETTER)), .b_reach_i(`OPERAND3(B_REACH, T_BETTER)),
        .a_radius_i(`OPERAND(A_RADIUS, T_BETTER)),
        .b_radius_i(`OPERAND(B_RADIUS, T_BETTER)), .g_i(better_g), .n_i(better_n), .y_i(better_y), .a_kappa_i(a_kappa),
        .a_v_i(a_v), .b_kappa_i(b_kappa), .b_v_i(b_v),
        .lo_n_i(lo_n_mem[`SLOT(T_BETTER)]), .lo_y_i(lo_y_mem[`SLOT(T_BETTER)]), .score_i(score_mem[`SLOT(T_BETTER)]),
        .lo_n_o(free_lo_n),
        .lo_y_o(free_lo_y), .score_o(free_score), .next_o(free_next));
    logic unused_score;
    assign unused_score = &{1'b0, circle_score};
    assign {new_lo_n, new_lo_y, new_next} = on_circle ? {circle_lo_n, circle_lo_y, circle_next} :
        {free_lo_n, free_lo_y, free_next};
    assign new_score = free_score;
  end else begin : g_no_free
    assign {new_lo_n, new_lo_y, new_next, new_score} = {circle_lo_n, circle_lo_y, circle_next, circle_score};
  end
  always_ff @(posedge clk_i) begin
    if (on_circle || off_circle || phase_stepped == `PHASE_POLE) next_mem[`SLOT(T_STEPPED)] <= new_next;
    if (on_circle || off_circle) begin
      lo_n_mem[`SLOT(T_STEPPED)] <= new_lo_n;
      lo_y_mem[`SLOT(T_STEPPED)] <= new_lo_y;
    end
    if (witness_end) begin
      next_mem[now_q] <= ended_next;
      lo_n_mem[now_q] <= ended_from;
      lo_y_mem[now_q] <= ended_move;
    end
    if (on_circle) begin
      hi_n_mem[`SLOT(T_STEPPED)] <= circle_hi_n;
      hi_y_mem[`SLOT(T_STEPPED)] <= circle_hi_y;
    end
    if (off_circle || phase_stepped == `PHASE_SAMPLE) score_mem[`SLOT(T_STEPPED)] <= new_score;
  end

  // ---- Witness points ----
  localparam int T_WITNESS = T_EVALUATED + `LATENCY_CYLINDER_WITNESS;
  localparam int T_found_q = T_WITNESS, T_found_w = T_WITNESS, T_found_off = T_WITNESS, T_found_g = T_WITNESS,
      T_found_n = T_WITNESS;
  localparam int T_found_from = T_WITNESS, T_found_move = T_WITNESS, T_found_next = T_WITNESS;
  `DF_VECTOR found_q, found_w, found_n, found_from, found_move, found_next;
  `DF_SCALAR found_off, found_g;
  cylinder_witness #(`DF_SAME, .BODY(BODY)) witness (
      .clk_i, .pass_i(pass_mem[`SLOT(T_EVALUATED)]), .axis_i(axes_witness), .half_i(`OPERAND3(A_HALF, T_EVALUATED)),
      .radius_i(`OPERAND(A_RADIUS, T_EVALUATED)), .edge_i(`OPERAND9(A_REACH, T_EVALUATED)), .face_i(face_witness),
      .d_i(`OPERAND3(D, T_EVALUATED)), .b_i(`OPERAND3(B, T_EVALUATED)), .b_half_i(`OPERAND(B_HALF, T_EVALUATED)),
      .b_radius_i(`OPERAND(B_RADIUS, T_EVALUATED)), .a_reach_i(`OPERAND3(A_REACH, T_EVALUATED)),
      .b_reach_i(`OPERAND3(B_REACH, T_EVALUATED)),
      .tried_n_i(evaluated_n), .tried_g_i(plus_g_now), .minus_g_i(minus_g_now), .y_i(plus_y_now),
      .a_kappa_i(a_kappa_now), .a_side_i(a_side),
      .b_kappa_i(b_kappa_now), .b_side_i(b_side), .b_along_i(b_along), .pa_i(pa), .g_i(best_g_mem[`SLOT(T_EVALUATED)]),
      .n_i(best_n_mem[`SLOT(T_EVALUATED)]), .q_i(q_mem[`SLOT(T_EVALUATED)]), .w_i(witness_mem[`SLOT(T_EVALUATED)]),
      .off_i(off_mem[`SLOT(T_EVALUATED)]), .from_i(lo_n_mem[`SLOT(T_EVALUATED)]), .move_i(lo_y_mem[`SLOT(T_EVALUATED)]),
      .g_o(found_g),
      .n_o(found_n), .q_o(found_q), .w_o(found_w), .off_o(found_off), .from_o(found_from), .move_o(found_move),
      .next_o(found_next));
  `DF_VAT(witness_q, found_q, T_END)
  `DF_VAT(witness_w, found_w, T_END)
  `DF_AT(witness_off, found_off, T_END)
  `DF_AT(witness_g, found_g, T_END)
  `DF_VAT(witness_n, found_n, T_END)
  `DF_VAT(witness_from, found_from, T_END)
  `DF_VAT(witness_move, found_move, T_END)
  `DF_VAT(witness_next, found_next, T_END)
  assign ended_g = witness_g;
  assign ended_n = witness_n;
  assign ended_from = witness_from;
  assign ended_move = witness_move;
  assign ended_next = witness_next;
  `DF_VAT(side_q, better_n, T_END)
  always_ff @(posedge clk_i) begin
    if (phase_end == `PHASE_SIDE) q_mem[now_q] <= side_q;
    else if (witness_end) q_mem[now_q] <= witness_q;
    if (witness_end) begin
      witness_mem[now_q] <= witness_w;
      off_mem[now_q] <= witness_off;
    end
  end

  // ---- Result; its stage times begin at the end of the last pass ----
  `undef DF_EN
  `define DF_EN leave
  `DF_IN(s, witness_g, 0)
  `DF_VIN(s_n, witness_n, 0)
  `DF_VIN(q, witness_w, 0)
  `DF_VIN(origin, operand_mem[now_q][ORIGIN+:3], 0)
  `DF_CONST(one_half, `DF_POWER_OF_TWO(-1))
  `DF_MUL(s_half, s, one_half)
  `DF_VSCALE(to_middle, s_n, s_half)
  `DF_VADD(middle, q, to_middle)
  `DF_VADD(cp, origin, middle)
  `DF_SCALAR f_one, t_one, back_end, f_end, t_end, bad_end;
  `DF_VECTOR cp_one, n_one, cp_end, n_end;
  distance_result #(`DF_SAME, .T_S(T_s), .T_CP(T_cp), .T_N(T_s_n), .LATENCY(RESULT)) result (
      .clk_i, .s_i(s), .cp_i(cp), .n_i(s_n), .f_o(f_one), .t_o(t_one), .cp_o(cp_one), .n_o(n_one));
  pipe_delay #(.W(LW), .FROM(0), .TO(RESULT), .ARITH(ARITH)) delay_back_end (
      .clk_i, .d_i(back_mem[now_q]), .q_o(back_end));
  length_unscale #(`DF_SAME) unscale (
      .clk_i, .en_i(leave), .back_i(back_end), .t_back_i('0), .f_i(f_one), .t_i(t_one), .cp_i(cp_one), .n_i(n_one),
      .f_o(f_end), .t_o(t_end),
      .cp_o(cp_end), .n_o(n_end));
  assign bad_end = bad_mem[now_q];
  localparam int HISTORY = 1 << $clog2(ENTRY + FINISH + 1);
  if (GATES) begin : g_exit
    issue_history #(.W(32 + LW), .DEPTH(HISTORY)) history (
        .clk_i, .rst_i, .latency_i(16'(FINISH)), .valid_i(leave), .d_i({bad_end, tag_mem[now_q]}), .valid_o,
        .q_o({bad_o, tag_o}));
    assign {f_o, t_o, cp_o, n_o} = {f_end, t_end, cp_end, n_end};
  end else begin : g_exit  // results are present at once, and wait
    issue_history #(.W(32 + 9 * LW), .DEPTH(HISTORY)) history (
        .clk_i, .rst_i, .latency_i(16'(ENTRY + FINISH)), .valid_i(leave),
        .d_i({f_end, t_end, cp_end, n_end, bad_end, tag_mem[now_q]}), .valid_o,
        .q_o({f_o, t_o, cp_o, n_o, bad_o, tag_o}));
  end

`ifndef SYNTHESIS
  always_ff @(posedge clk_i) begin
    if (!rst_i) begin
      assert (valid_q == '0 || iterations_i == iterations_q)
          else $error("cylinder_pair: iterations changed with rows in flight");
      assert (iterations_q != 24'h080808 || latency_o == 32'(LATENCY))
          else $error("cylinder_pair: INTERVAL does not match the default iterations");
      assert (!(entered && valid_q[now_q] && !last)) else $error("cylinder_pair: a row entered a slot in use");
    end
  end
`endif
  `undef SLOT
  `undef OPERAND
  `undef OPERAND3
  `undef OPERAND9
  `undef DF_EN
  `define DF_EN 1'b1
endmodule
