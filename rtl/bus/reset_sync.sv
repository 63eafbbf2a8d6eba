// SPDX-License-Identifier: Apache-2.0
// Reset of one clock domain from an asynchronous reset. It begins at once, with or without a clock. It ends with this
// domain's clock, so all registers leave reset at the same edge. `rst_i` must not glitch.
// Without STAGES it is a wire, for a reset that is already synchronous to the domain, as in simulation.
// Latency: 0 cycles into reset, STAGES cycles out of it.
// Throughput: not applicable.
// Stall: none.
module reset_sync #(
    parameter int STAGES = 0  // 0, or 2 and more
) (
    input logic clk_i,
    input logic rst_i,
    output logic rst_o
);
  if (STAGES != 0 && STAGES < 2) begin : g_illegal
    $error("reset_sync: STAGES must be 0, or at least 2");
  end
  if (STAGES == 0) begin : g_wire
    logic unused_clk;
    assign unused_clk = clk_i;
    assign rst_o = rst_i;
  end else begin : g_stages
    (* ASYNC_REG = "TRUE" *) logic [STAGES-1:0] reset_meta_q;
    always_ff @(posedge clk_i or posedge rst_i)
      if (rst_i) reset_meta_q <= '1;
      else reset_meta_q <= {reset_meta_q[STAGES-2:0], 1'b0};
    assign rst_o = reset_meta_q[STAGES-1];
  end
endmodule
