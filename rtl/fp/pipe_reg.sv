// SPDX-License-Identifier: Apache-2.0
// Pipeline register between two stages of a lane. DEPTH 1 is a register and DEPTH 0 a wire. Signals that pass several
// registers take a larger DEPTH.
// Latency: DEPTH cycles.
module pipe_reg #(
    parameter int W     = 32,
    parameter int DEPTH = 0
) (
    input  logic         clk_i,
    input  logic [W-1:0] d_i,
    output logic [W-1:0] q_o
);
  /*verilator inline_module*/
  if (DEPTH == 0) begin : g_wire
    logic unused_clk;
    assign unused_clk = clk_i;
    assign q_o = d_i;
  end else if (DEPTH == 1) begin : g_register
    logic [W-1:0] d_q;
    always_ff @(posedge clk_i) d_q <= d_i;
    assign q_o = d_q;
  end else begin : g_registers
    logic [W-1:0] d_q[DEPTH];
    always_ff @(posedge clk_i) begin
      d_q[0] <= d_i;
      for (int i = 1; i < DEPTH; i++) d_q[i] <= d_q[i-1];
    end
    assign q_o = d_q[DEPTH-1];
  end
endmodule
