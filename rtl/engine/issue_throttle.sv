// SPDX-License-Identifier: Apache-2.0
// Admits at most one row per INTERVAL cycles.
// Latency: none.
// Throughput: one row per INTERVAL cycles.
// Stall: ready_o, low for INTERVAL - 1 cycles after a row was taken.
module issue_throttle #(
    parameter int INTERVAL = 1  // >= 1
) (
    input logic clk_i,
    input logic rst_i,
    input logic take_i,  // a row is taken while ready_o is high
    output logic ready_o
);
  if (INTERVAL <= 1) begin : g_always
    logic unused;
    assign unused = &{1'b0, clk_i, rst_i, take_i};
    assign ready_o = 1'b1;
  end else begin : g_count
    logic [INTERVAL-2:0] taken_q;  // taken in the last cycle, in the one before, ...
    always_ff @(posedge clk_i) taken_q <= rst_i ? '0 : (INTERVAL - 1)'({taken_q, take_i});
    assign ready_o = taken_q == '0;
`ifndef SYNTHESIS
    always_ff @(posedge clk_i) if (!rst_i) assert (!take_i ||
        ready_o) else $error("issue_throttle: a row came too early");
`endif
  end
endmodule
