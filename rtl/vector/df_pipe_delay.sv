// SPDX-License-Identifier: Apache-2.0
// Delays a value from stage time T_A to stage time T, as pipe_delay does. Constants (T_A < 0) fit any time.
// Latency: T - T_A cycles; 0 for constants and with ARITH = "host".
// Throughput: one value per cycle.
// Stall: none.
module df_pipe_delay #(
    parameter int W = 1,
    parameter int T_A = 0,
    parameter int T = 0,
    parameter ARITH = "rtl"
) (
    input logic clk_i,
    input logic [W-1:0] a_i,
    output logic [W-1:0] r_o
);
  /*verilator inline_module*/
  pipe_delay #(.W(W), .FROM(T_A < 0 ? (T < 0 ? 0 : T) : T_A), .TO(T < 0 ? 0 : T), .ARITH(ARITH))
      delay (.clk_i, .d_i(a_i), .q_o(r_o));
endmodule
