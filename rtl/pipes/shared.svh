// SPDX-License-Identifier: Apache-2.0
// Dataflow notation of a datapath that takes a row per TURNS cycles, beside dataflow.svh. A value is there in the cycle
// of its stage time T_x, once per row. SH_FOUR names four operations of one kind that share operators
// (shared_operator.sv). Each starts when its operands are there, or one of the next cycles, in a turn of its own.
// In scope: clk_i, turn_i, EXP, MAN, CW, LAT, TURNS and ARITH. Host arithmetic has the times alone.
`ifndef CDE_SHARED_SVH
`define CDE_SHARED_SVH
`include "dataflow.svh"

// A module with this notation declares it. The start of operation k of a group: the first time from `need` on in a turn
// that no operation before it has on the same operator. Those start at s0 to s2.
`define SH_FUNCTIONS \
  function automatic int start(input int need, input int turns, input int k, input int s0, input int s1, \
                               input int s2); \
    bit taken; \
    start = need; \
    for (int i = 0; i < turns; i++) begin \
      taken = 1'b0; \
      for (int j = 0; j < k; j++) \
        if (j / turns == k / turns && (((j == 0) ? s0 : (j == 1) ? s1 : s2) - start) % turns == 0) taken = 1'b1; \
      if (taken) start = start + 1; \
    end \
  endfunction
`define SH_SCALAR logic [CW-1:0]
`define SH_IN(R, EXPRESSION, TIME) localparam int T_``R = TIME; `SH_SCALAR R; assign R = EXPRESSION;
`define SH_CONST(R, WORD) localparam int T_``R = `DF_CONSTANT; `SH_SCALAR R; assign R = CW'(WORD);
// A, of WIDTH bits, until stage time TIME.
`define SH_DELAY(NAME, WIDTH, A, TIME, R) \
  turn_delay #(.W(WIDTH), .FROM(T_``A), .TO(TIME), .TURNS(TURNS), .ARITH(ARITH)) NAME ( \
      .clk_i, .turn_i, .d_i(A), .q_o(R));
`define SH_AT(R, A, TIME) localparam int T_``R = TIME; `SH_SCALAR R; \
  `SH_DELAY(delay_``R, CW, A, TIME, R)
// An operation with its own operator.
`define SH_OP(R, OPERATION, LATENCY, A, B) \
  localparam int N_``R = `DF_MAX3(T_``A, T_``B, 0), T_``R = N_``R + LATENCY; \
  `SH_SCALAR R, a_``R, b_``R; \
  `SH_DELAY(delay_a_``R, CW, A, N_``R, a_``R) \
  `SH_DELAY(delay_b_``R, CW, B, N_``R, b_``R) \
  logic [2:0][CW-1:0] unused_``R; \
  shared_operator #(.OP(OPERATION), .N(1), .EXP(EXP), .MAN(MAN), .T_0(N_``R), .LAT(LATENCY), .TURNS(TURNS), \
      .ARITH(ARITH)) op_``R (.clk_i, .turn_i, .a_i((4 * CW)'(a_``R)), .b_i((4 * CW)'(b_``R)), .r_o({unused_``R, R}));
`define SH_MIN(R, A, B) `SH_OP(R, formats_pkg::FP_MIN, LAT.cmp, A, B)
`define SH_MAX(R, A, B) `SH_OP(R, formats_pkg::FP_MAX, LAT.cmp, A, B)
// Tests, with one bit as result.
`define SH_TEST(R, OPERATION, A, B) `SH_OP(mask_``R, OPERATION, LAT.cmp, A, B) \
  localparam int T_``R = T_mask_``R; logic R, unused_``R; \
  assign {unused_``R, R} = {&{1'b0, mask_``R}, mask_``R[0]};
`define SH_LT(R, A, B) `SH_TEST(R, formats_pkg::FP_LT, A, B)
`define SH_LE(R, A, B) `SH_TEST(R, formats_pkg::FP_LE, A, B)
// Operation number K of a group: its start, after those before it in the group, and its delayed operands.
`define SH_START(R, K, LATENCY, A, B, S0, S1, S2) \
  localparam int N_``R = start(`DF_MAX3(T_``A, T_``B, 0), TURNS, K, S0, S1, S2); \
  localparam int T_``R = N_``R + LATENCY; \
  `SH_SCALAR R, a_``R, b_``R; \
  `SH_DELAY(delay_a_``R, CW, A, N_``R, a_``R) \
  `SH_DELAY(delay_b_``R, CW, B, N_``R, b_``R)
`define SH_GROUP(R, OPERATION, ADDING, COUNT, LATENCY, R0, R1, R2, R3) \
  logic [3:0][CW-1:0] group_``R; \
  shared_operator #(.OP(OPERATION), .ADDS(ADDING), .N(COUNT), .EXP(EXP), .MAN(MAN), .T_0(N_``R0), .T_1(N_``R1), \
      .T_2(N_``R2), .T_3(N_``R3), .LAT(LATENCY), .TURNS(TURNS), .ARITH(ARITH)) op_``R ( \
      .clk_i, .turn_i, .a_i({a_``R3, a_``R2, a_``R1, a_``R0}), .b_i({b_``R3, b_``R2, b_``R1, b_``R0}), \
      .r_o(group_``R));
`define SH_FOUR(OPERATION, ADDING, LATENCY, R0, A0, B0, R1, A1, B1, R2, A2, B2, R3, A3, B3) \
  `SH_START(R0, 0, LATENCY, A0, B0, 0, 0, 0) `SH_START(R1, 1, LATENCY, A1, B1, N_``R0, 0, 0) \
  `SH_START(R2, 2, LATENCY, A2, B2, N_``R0, N_``R1, 0) `SH_START(R3, 3, LATENCY, A3, B3, N_``R0, N_``R1, N_``R2) \
  `SH_GROUP(R0, OPERATION, ADDING, 4, LATENCY, R0, R1, R2, R3) \
  assign {R3, R2, R1, R0} = group_``R0;
`define SH_THREE(OPERATION, ADDING, LATENCY, R0, A0, B0, R1, A1, B1, R2, A2, B2) \
  `SH_START(R0, 0, LATENCY, A0, B0, 0, 0, 0) `SH_START(R1, 1, LATENCY, A1, B1, N_``R0, 0, 0) \
  `SH_START(R2, 2, LATENCY, A2, B2, N_``R0, N_``R1, 0) \
  `SH_GROUP(R0, OPERATION, ADDING, 3, LATENCY, R0, R1, R2, R2) \
  assign {R2, R1, R0} = group_``R0[2:0]; \
  logic unused_``R0; \
  assign unused_``R0 = &{1'b0, group_``R0[3]};
// Sums and differences, bit k of ADDING: result k is a sum. Products.
`define SH_SUMS4(ADDING, R0, A0, B0, R1, A1, B1, R2, A2, B2, R3, A3, B3) \
  `SH_FOUR(formats_pkg::FP_SUB, ADDING, LAT.add, R0, A0, B0, R1, A1, B1, R2, A2, B2, R3, A3, B3)
`define SH_MULS4(R0, A0, B0, R1, A1, B1, R2, A2, B2, R3, A3, B3) \
  `SH_FOUR(formats_pkg::FP_MUL, 4'b0000, LAT.mul, R0, A0, B0, R1, A1, B1, R2, A2, B2, R3, A3, B3)
`define SH_MULS3(R0, A0, B0, R1, A1, B1, R2, A2, B2) \
  `SH_THREE(formats_pkg::FP_MUL, 4'b0000, LAT.mul, R0, A0, B0, R1, A1, B1, R2, A2, B2)
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
