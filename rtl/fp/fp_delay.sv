// SPDX-License-Identifier: Apache-2.0
// Delay line of lane words.
// Latency: DEPTH cycles; 0 is a wire.
// Throughput: one word per lane per cycle.
// Stall: none.
module fp_delay #(
    parameter  int LANES = 1,
    parameter  int W     = 32,
    parameter  int DEPTH = 0   // 0..1023
) (
    input  logic                    clk_i,
    input  logic [LANES-1:0][W-1:0] d_i,
    output logic [LANES-1:0][W-1:0] q_o
);
  /*verilator inline_module*/
  if (DEPTH < 0 || DEPTH > 1023) $error("fp_delay: DEPTH must be 0..1023");
  if (DEPTH == 0) begin : g_wire
    logic unused_clk;
    assign unused_clk = clk_i;
    assign q_o = d_i;
  end else begin : g_regs
    logic [LANES*W-1:0] q[DEPTH];
    always_ff @(posedge clk_i) begin
      q[0] <= d_i;
      for (int i = 1; i < DEPTH; i++) q[i] <= q[i-1];
    end
    assign q_o = q[DEPTH-1];
  end
endmodule
