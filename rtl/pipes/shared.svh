// SPDX-License-Identifier: Apache-2.0
// Dataflow notation of a datapath that takes a row per TURNS cycles, beside dataflow.svh. A value is there in the cycle
// of its stage time T_x, once per row. Eight operations of one kind form a group, which shares operators
// (shared_operator.sv). Each names the operation before it in its group, or `none`. It starts when its operands are
// there, or one of the next cycles, in a turn of its own. In scope: clk_i, turn_i, in_turn (one bit per turn, from
// SH_TURNS), EXP, MAN, CW, LAT, TURNS and ARITH. Host arithmetic has the times alone.
`ifndef CDE_SHARED_SVH
`define CDE_SHARED_SVH
`include "dataflow.svh"

// A module with this notation declares it. The first time from `need` on in a turn that is not taken.
`define SH_FUNCTIONS \
  localparam int K_none = -1; \
  localparam logic [7:0] TAKEN_none = '0; \
  function automatic int start(input int need, input int turns, input logic [7:0] taken); \
    start = need; \
    for (int i = 1; i < turns; i++) if ((taken >> (start % turns)) % 2 != 0) start = start + 1; \
  endfunction
// A row enters in turn 0, and its stage time 0 is in the next cycle.
`define SH_TURNS \
  logic [TURNS-1:0] in_turn; \
  always_ff @(posedge clk_i) \
    for (int turn = 0; turn < TURNS; turn++) in_turn[turn] <= 32'(turn_i) == 32'((turn + TURNS - 1) % TURNS);
`define SH_SCALAR logic [CW-1:0]
`define SH_IN(R, EXPRESSION, TIME) localparam int T_``R = TIME; `SH_SCALAR R; assign R = EXPRESSION;
`define SH_CONST(R, WORD) localparam int T_``R = `DF_CONSTANT; `SH_SCALAR R; assign R = CW'(WORD);
// A, of WIDTH bits, until stage time TIME.
`define SH_DELAY(NAME, WIDTH, A, TIME, R) \
  turn_delay #(.W(WIDTH), .FROM(T_``A), .TO(TIME), .TURNS(TURNS), .ARITH(ARITH)) NAME ( \
      .clk_i, .take_i(in_turn[(T_``A + 1) % TURNS]), .d_i(A), .q_o(R));
`define SH_AT(R, A, TIME) localparam int T_``R = TIME; `SH_SCALAR R; \
  `SH_DELAY(delay_``R, CW, A, TIME, R)
// An operation's result, and its operands, delayed to its start N_x.
`define SH_OPERANDS(R, LATENCY, A, B) \
  localparam int T_``R = N_``R + LATENCY; \
  `SH_SCALAR R, a_``R, b_``R; \
  `SH_DELAY(delay_a_``R, CW, A, N_``R, a_``R) \
  `SH_DELAY(delay_b_``R, CW, B, N_``R, b_``R)
// Operation R of a group, after P: its number, the turns of its operator that are taken, and its start.
`define SH_START(R, P, LATENCY, A, B) \
  localparam int K_``R = K_``P + 1; \
  localparam logic [7:0] BEFORE_``R = (K_``R % TURNS == 0) ? '0 : TAKEN_``P; \
  localparam int N_``R = start(`DF_MAX3(T_``A, T_``B, 0), TURNS, BEFORE_``R); \
  localparam logic [7:0] TAKEN_``R = BEFORE_``R | 8'(1 << (N_``R % TURNS)); \
  `SH_OPERANDS(R, LATENCY, A, B)
`define SH_ADD(R, P, A, B) localparam bit ADDS_``R = 1'b1; `SH_START(R, P, LAT.add, A, B)
`define SH_SUB(R, P, A, B) localparam bit ADDS_``R = 1'b0; `SH_START(R, P, LAT.add, A, B)
`define SH_MUL(R, P, A, B) localparam bit ADDS_``R = 1'b0; `SH_START(R, P, LAT.mul, A, B)
// The operators of a group. Its operations follow each other in a chain, and each has a turn.
`define SH_GROUP(NAME, OPERATION, LATENCY, R0, R1, R2, R3, R4, R5, R6, R7) \
  if (K_``R7 % 8 != 7 || $countones(TAKEN_``R7) != TURNS) $error("NAME: turns"); \
  shared_operator #(.OP(OPERATION), .EXP(EXP), .MAN(MAN), .LAT(LATENCY), .TURNS(TURNS), .ARITH(ARITH), \
      .ADDS({ADDS_``R7, ADDS_``R6, ADDS_``R5, ADDS_``R4, ADDS_``R3, ADDS_``R2, ADDS_``R1, ADDS_``R0}), \
      .TIMES({N_``R7, N_``R6, N_``R5, N_``R4, N_``R3, N_``R2, N_``R1, N_``R0})) NAME ( \
      .clk_i, .turn_i, .a_i({a_``R7, a_``R6, a_``R5, a_``R4, a_``R3, a_``R2, a_``R1, a_``R0}), \
      .b_i({b_``R7, b_``R6, b_``R5, b_``R4, b_``R3, b_``R2, b_``R1, b_``R0}), .r_o({R7, R6, R5, R4, R3, R2, R1, R0}));
`define SH_SUMS(NAME, R0, R1, R2, R3, R4, R5, R6, R7) \
  `SH_GROUP(NAME, formats_pkg::FP_SUB, LAT.add, R0, R1, R2, R3, R4, R5, R6, R7)
`define SH_PRODUCTS(NAME, R0, R1, R2, R3, R4, R5, R6, R7) \
  `SH_GROUP(NAME, formats_pkg::FP_MUL, LAT.mul, R0, R1, R2, R3, R4, R5, R6, R7)
// An operation with its own operator.
`define SH_OP(R, OPERATION, LATENCY, A, B) \
  localparam int N_``R = `DF_MAX3(T_``A, T_``B, 0); \
  `SH_OPERANDS(R, LATENCY, A, B) \
  logic [6:0][CW-1:0] unused_``R; \
  shared_operator #(.OP(OPERATION), .N(1), .EXP(EXP), .MAN(MAN), .LAT(LATENCY), .TURNS(TURNS), .ARITH(ARITH), \
      .TIMES(256'(N_``R))) op_``R ( \
      .clk_i, .turn_i, .a_i((8 * CW)'(a_``R)), .b_i((8 * CW)'(b_``R)), .r_o({unused_``R, R}));
`define SH_MIN(R, A, B) `SH_OP(R, formats_pkg::FP_MIN, LAT.cmp, A, B)
`define SH_MAX(R, A, B) `SH_OP(R, formats_pkg::FP_MAX, LAT.cmp, A, B)
// Tests, with one bit as result.
`define SH_TEST(R, OPERATION, A, B) `SH_OP(mask_``R, OPERATION, LAT.cmp, A, B) \
  localparam int T_``R = T_mask_``R; logic R, unused_``R; \
  assign {unused_``R, R} = {&{1'b0, mask_``R}, mask_``R[0]};
`define SH_LT(R, A, B) `SH_TEST(R, formats_pkg::FP_LT, A, B)
`define SH_LE(R, A, B) `SH_TEST(R, formats_pkg::FP_LE, A, B)
// Sign and logic, without operators.
`define SH_ABS(R, A) localparam int T_``R = T_``A; `SH_SCALAR R; logic unused_``R; \
  assign R = {1'b0, A[CW-2:0]}; \
  assign unused_``R = A[CW-1];
`define SH_MOVE_SIGN(R, X, Y) localparam int T_``R = `DF_MAX2(T_``X, T_``Y); `SH_SCALAR R, x_``R, y_``R; \
  `SH_DELAY(delay_x_``R, CW, X, T_``R, x_``R) \
  `SH_DELAY(delay_y_``R, CW, Y, T_``R, y_``R) \
  assign R = {x_``R[CW-1] ^ y_``R[CW-1], y_``R[CW-2:0]};
// Both tests, at the later time; a test at stage time TIME.
`define SH_BOTH(R, A, B) localparam int T_``R = `DF_MAX2(T_``A, T_``B); logic R, a_``R, b_``R; \
  `SH_DELAY(delay_a_``R, 1, A, T_``R, a_``R) \
  `SH_DELAY(delay_b_``R, 1, B, T_``R, b_``R) \
  assign R = a_``R && b_``R;
`define SH_TEST_AT(R, A, TIME) localparam int T_``R = TIME; logic R; \
  `SH_DELAY(delay_``R, 1, A, TIME, R)
`endif
