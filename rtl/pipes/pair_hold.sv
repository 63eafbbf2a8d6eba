// SPDX-License-Identifier: Apache-2.0
// Input port of a pipe whose candidate axes share units. With SAT_II = 3 it holds a pair's operands for three cycles
// and counts them. So every value computed from operands alone is stable for three cycles, at every stage.
// With SAT_II = 1 or ARITH = "host" it is wires.
// Latency: SAT_T_IN cycles (convex.svh); 0 with ARITH = "host".
// Throughput: one pair per lane per SAT_II cycles.
// Stall: none.
module pair_hold #(
    parameter int SAT_II = 1,  // 1 or 3
    parameter int A_BITS = 1,
    parameter int B_BITS = 1,
    parameter ARITH = "rtl"
) (
    input logic clk_i,
    input logic enter_i,  // at least SAT_II cycles after the previous pair
    input logic [A_BITS-1:0] a_i,
    input logic [B_BITS-1:0] b_i,
    output logic [A_BITS-1:0] a_o,
    output logic [B_BITS-1:0] b_o,
    output logic [1:0] phase_o  // 0, 1, 2, then stable until the next pair
);
  /*verilator inline_module*/
  if (SAT_II != 1 && SAT_II != 3) $error("pair_hold: SAT_II must be 1 or 3");
  if (SAT_II == 1 || ARITH != "rtl") begin : g_wire
    logic unused;
    assign unused = &{1'b0, clk_i, enter_i};
    assign a_o = a_i;
    assign b_o = b_i;
    assign phase_o = '0;
  end else begin : g_hold
    logic [A_BITS-1:0] a_q;
    logic [B_BITS-1:0] b_q;
    logic [1:0] phase_q;
    always_ff @(posedge clk_i) begin
      if (enter_i) begin
        a_q <= a_i;
        b_q <= b_i;
      end
      phase_q <= enter_i ? 2'd0 : phase_q[1] ? 2'd2 : phase_q + 2'd1;
    end
    assign a_o = a_q;
    assign b_o = b_q;
    assign phase_o = phase_q;
  end
endmodule
