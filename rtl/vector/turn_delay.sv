// SPDX-License-Identifier: Apache-2.0
// Delay line of a value that comes once per TURNS cycles, from stage time FROM to TO. A register keeps it for TURNS
// cycles, so the line has few registers. A long line is a memory, as in pipe_delay.sv. With one turn it is
// pipe_delay.sv.
// Latency: TO - FROM cycles.
// Throughput: one value per TURNS cycles.
// Stall: none.
module turn_delay #(
    parameter int W = 1,
    parameter int FROM = 0,
    parameter int TO = 0,     // >= FROM; a value FROM = -1 is a constant
    parameter int TURNS = 4,  // 1, 2, 4 or 8
    parameter ARITH = "rtl",  // "host": nothing is computed, and outputs are zeros
`ifdef SYNTHESIS
    parameter int MEMORY = 6  // from this depth on the line is a memory
`else
    parameter int MEMORY = 0  // never
`endif
) (
    input logic clk_i,
    input logic take_i,  // stage time FROM
    input logic [W-1:0] d_i,
    output logic [W-1:0] q_o
);
  /*verilator inline_module*/
  localparam int DEPTH = (FROM < 0) ? 0 : (TO - FROM + TURNS - 1) / TURNS;
  localparam int MOST = 17;  // depth of one memory: 16 slots and a register
  if (ARITH != "rtl") begin : g_nothing
    logic unused;
    assign unused = &{1'b0, clk_i, take_i, d_i};
    assign q_o = '0;
  end else if (TURNS == 1 || DEPTH == 0) begin : g_plain
    logic unused_take;
    assign unused_take = take_i;
    pipe_delay #(.W(W), .FROM((FROM < 0) ? TO : FROM), .TO(TO)) line (.clk_i, .d_i, .q_o);
  end else if (MEMORY != 0 && DEPTH >= MEMORY && DEPTH <= MOST) begin : g_memory
    localparam int SLOTS = DEPTH - 1;
    localparam int AW = $clog2(SLOTS);
    (* ram_style = "distributed" *) logic [W-1:0] mem[SLOTS];
    logic [W-1:0] q;
    logic [AW-1:0] slot_q;
    always_ff @(posedge clk_i)
      if (take_i) begin
        q <= mem[slot_q];
        mem[slot_q] <= d_i;
        slot_q <= (slot_q >= AW'(SLOTS - 1)) ? '0 : slot_q + 1;
      end
    assign q_o = q;
  end else begin : g_kept
    logic [DEPTH-1:0][W-1:0] kept_q;
    always_ff @(posedge clk_i)
      if (take_i)
        for (int k = 0; k < DEPTH; k++) kept_q[k] <= (k == 0) ? d_i : kept_q[(k==0)?0:k-1];
    assign q_o = kept_q[DEPTH-1];
  end
endmodule
