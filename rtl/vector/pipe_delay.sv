// SPDX-License-Identifier: Apache-2.0
// Delay line of a datapath: carries a value from stage time FROM to stage time TO, so the depth is derived, not
// counted. The host back end has no stages: there it is a wire.
// Latency: TO - FROM cycles; 0 with ARITH = "host".
// Throughput: one value per cycle.
// Stall: none.
module pipe_delay #(
    parameter int W = 1,     // >= 1
    parameter int FROM = 0,  // stage time of d_i
    parameter int TO = 0,    // stage time of q_o, >= FROM
    parameter ARITH = "rtl",
`ifdef SYNTHESIS
    parameter int MEMORY = 5  // from this depth on the line is a memory: 4 bits take 6 LUTs instead of 4 FFs per cycle
`else
    parameter int MEMORY = 0  // never
`endif
) (
    input logic clk_i,
    input logic [W-1:0] d_i,
    output logic [W-1:0] q_o
);
  /*verilator inline_module*/
  localparam int DEPTH = (ARITH != "rtl") ? 0 : TO - FROM;
  localparam int MOST = 17;  // depth of one memory: 16 slots and a register
  if (TO < FROM) begin : g_illegal
    $error("pipe_delay: TO must not be before FROM");
  end
  if (DEPTH <= 0) begin : g_wire
    logic unused_clk;
    assign unused_clk = clk_i;
    assign q_o = d_i;
  end else if (MEMORY != 0 && DEPTH > MOST) begin : g_memories
    logic [W-1:0] q;
    pipe_delay #(.W(W), .TO(MOST), .MEMORY(MEMORY)) first (.clk_i, .d_i, .q_o(q));
    pipe_delay #(.W(W), .TO(DEPTH - MOST), .MEMORY(MEMORY)) others (.clk_i, .d_i(q), .q_o);
  end else if (MEMORY != 0 && DEPTH >= MEMORY) begin : g_memory
    // A slot is read, then written. So its word leaves after as many cycles as there are slots, through a register.
    localparam int SLOTS = DEPTH - 1;
    localparam int AW = $clog2(SLOTS);
    (* ram_style = "distributed" *) logic [W-1:0] mem[SLOTS];
    logic [W-1:0] q;
    logic [AW-1:0] slot_q;
    always_ff @(posedge clk_i) begin
      q <= mem[slot_q];
      mem[slot_q] <= d_i;
      slot_q <= (slot_q >= AW'(SLOTS - 1)) ? '0 : slot_q + 1;
    end
    assign q_o = q;
  end else begin : g_delay
    for (genvar s = 0; s < DEPTH; s++) begin : stage
      logic [W-1:0] d, q;
      always_ff @(posedge clk_i) q <= d;
    end
    assign stage[0].d = d_i;
    for (genvar s = 1; s < DEPTH; s++) begin : link
      assign stage[s].d = stage[s-1].q;
    end
    assign q_o = stage[DEPTH-1].q;
  end
endmodule
