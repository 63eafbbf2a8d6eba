// SPDX-License-Identifier: Apache-2.0
// Collects the results that a shared unit gave in TURNS successive cycles (df_turn.sv). The first USERS results appear
// together when the last turn is over.
// Latency: TURNS - 1 cycles from the first result; 0 with ARITH = "host".
// Throughput: one set per TURNS cycles.
// Stall: none.
module serial_to_parallel #(
    parameter int W = 1,
    parameter int TURNS = 1,
    parameter int USERS = TURNS,  // 1..TURNS
    parameter ARITH = "rtl"
) (
    input logic clk_i,
    input logic [W-1:0] d_i,
    output logic [USERS-1:0][W-1:0] q_o
);
  /*verilator inline_module*/
  for (genvar k = 0; k < USERS; k++) begin : g_user
    pipe_delay #(.W(W), .FROM(k), .TO(TURNS - 1), .ARITH(ARITH)) wait_for_last (.clk_i, .d_i, .q_o(q_o[k]));
  end
endmodule
