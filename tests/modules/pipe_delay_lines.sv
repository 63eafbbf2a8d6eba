// SPDX-License-Identifier: Apache-2.0
// Delay lines in memories, as in synthesis, next to the register delay lines that all other simulations use.
module pipe_delay_lines (
    input logic clk_i,
    input logic [36:0] d_i,
    output logic [6:0] differ_o  // after each of CYCLES cycles: the shortest, one memory, and several memories
);
  localparam logic [6:0][31:0] CYCLES = {32'd61, 32'd22, 32'd18, 32'd17, 32'd9, 32'd6, 32'd5};
  for (genvar i = 0; i < 7; i++) begin : line
    logic [36:0] memory, registers;
    pipe_delay #(.W(37), .TO(CYCLES[i]), .MEMORY(5)) delay_memory (.clk_i, .d_i, .q_o(memory));
    pipe_delay #(.W(37), .TO(CYCLES[i]), .MEMORY(0)) delay_registers (.clk_i, .d_i, .q_o(registers));
    assign differ_o[i] = memory != registers;
  end
endmodule
