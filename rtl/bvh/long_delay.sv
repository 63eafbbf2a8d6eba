// SPDX-License-Identifier: Apache-2.0
// Delay line for many bits: from 18 cycles on, which need two LUT memories per bit (pipe_delay.sv), a block memory.
// Latency: DEPTH cycles.
// Throughput: one value per cycle.
// Stall: none.
module long_delay #(
    parameter int W = 1,  // >= 1
    parameter int DEPTH = 1
) (
    input logic clk_i,
    input logic [W-1:0] d_i,
    output logic [W-1:0] q_o
);
  /*verilator inline_module*/
  if (DEPTH >= 18) begin : g_block
    // The oldest word is read while another slot is written. A block memory is slow, so its output has a second
    // register.
    localparam int SLOTS = DEPTH - 1;
    localparam int AW = $clog2(SLOTS);
    (* ram_style = "block" *) logic [W-1:0] mem[SLOTS];
    logic [W-1:0] q;
    logic [AW-1:0] slot_q, next;
    assign next = (slot_q >= AW'(SLOTS - 1)) ? '0 : slot_q + 1;
    always_ff @(posedge clk_i) begin
      q <= mem[next];
      q_o <= q;
      mem[slot_q] <= d_i;
      slot_q <= next;
    end
  end else begin : g_short
    pipe_delay #(.W(W), .TO(DEPTH), .MEMORY(5)) delay (.clk_i, .d_i, .q_o);
  end
endmodule
