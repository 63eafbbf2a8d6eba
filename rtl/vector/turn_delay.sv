// SPDX-License-Identifier: Apache-2.0
// Delay line of a value that comes once per TURNS cycles, from stage time FROM to TO. A register keeps it for TURNS
// cycles, so the line has few registers. With one turn it is pipe_delay.sv.
// A row enters in turn 0, and its stage time 0 is in the next cycle.
// Latency: TO - FROM cycles.
// Throughput: one value per TURNS cycles.
// Stall: none.
module turn_delay #(
    parameter int W = 1,
    parameter int FROM = 0,
    parameter int TO = 0,     // >= FROM; a value FROM = -1 is a constant
    parameter int TURNS = 4,  // 1, 2 or 4
    parameter ARITH = "rtl",  // "host": nothing is computed, and outputs are zeros
    localparam int TW = 2
) (
    input logic clk_i,
    input logic [TW-1:0] turn_i,
    input logic [W-1:0] d_i,
    output logic [W-1:0] q_o
);
  /*verilator inline_module*/
  localparam int DEPTH = (FROM < 0) ? 0 : (TO - FROM + TURNS - 1) / TURNS;
  if (ARITH != "rtl") begin : g_nothing
    logic unused;
    assign unused = &{1'b0, clk_i, turn_i, d_i};
    assign q_o = '0;
  end else if (TURNS == 1 || DEPTH == 0) begin : g_plain
    logic unused_turn;
    assign unused_turn = &{1'b0, turn_i};
    pipe_delay #(.W(W), .FROM((FROM < 0) ? TO : FROM), .TO(TO)) line (.clk_i, .d_i, .q_o);
  end else begin : g_kept
    logic [DEPTH-1:0][W-1:0] kept_q;
    always_ff @(posedge clk_i)
      if (turn_i == TW'((FROM + 1) % TURNS))
        for (int k = 0; k < DEPTH; k++) kept_q[k] <= (k == 0) ? d_i : kept_q[(k==0)?0:k-1];
    assign q_o = kept_q[DEPTH-1];
  end
endmodule
