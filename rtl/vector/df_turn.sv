// SPDX-License-Identifier: Apache-2.0
// Operand of a datapath's unit (dataflow.svh) that TURNS users share: the phase selects the operand of user 0, 1 or 2.
// Operands are stable in all phases. With PASSING they are valid in phase 0 only, so b and c are delayed by 1 and 2
// cycles. With TURNS = 1 the unit has one user.
// Latency: 0.
// Throughput: one operand per cycle.
// Stall: none.
module df_turn #(
    parameter int W = 1,
    parameter int TURNS = 1,    // 1 or 3
    parameter int USER = 0,     // with TURNS = 1
    parameter int PASSING = 0,
    parameter int T_PHASE = 0,  // stage times, all equal
    parameter int T_A = 0,
    parameter int T_B = 0,
    parameter int T_C = 0,
    parameter ARITH = "rtl"
) (
    input logic clk_i,
    input logic [1:0] phase_i,  // 0, 1, 2
    input logic [W-1:0] a_i,
    input logic [W-1:0] b_i,
    input logic [W-1:0] c_i,
    output logic [W-1:0] r_o
);
  /*verilator inline_module*/
  if (T_A != T_PHASE || T_B != T_PHASE || T_C != T_PHASE) $error("df_turn: stage times differ");
  if (TURNS == 3) begin : g_shared
    logic [W-1:0] b, c;
    pipe_delay #(.W(W), .FROM(0), .TO((PASSING != 0) ? 1 : 0), .ARITH(ARITH)) delay_b (.clk_i, .d_i(b_i), .q_o(b));
    pipe_delay #(.W(W), .FROM(0), .TO((PASSING != 0) ? 2 : 0), .ARITH(ARITH)) delay_c (.clk_i, .d_i(c_i), .q_o(c));
    assign r_o = phase_i[1] ? c : phase_i[0] ? b : a_i;
  end else if (TURNS == 1) begin : g_own
    logic unused;
    assign unused = &{1'b0, clk_i, phase_i, a_i, b_i, c_i};
    assign r_o = (USER == 0) ? a_i : (USER == 1) ? b_i : c_i;
  end else begin : g_illegal
    $error("df_turn: TURNS must be 1 or 3");
  end
endmodule
