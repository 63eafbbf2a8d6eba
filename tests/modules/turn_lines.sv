// SPDX-License-Identifier: Apache-2.0
// Modules for values that come once per 2, 4 or 8 cycles, next to those for values of every cycle: delay lines in
// registers and in memories, and dividers. Values are compared in the cycle in which they must be there.
module turn_lines (
    input logic clk_i,
    input logic [2:0] turn_i,  // counts cycles
    input logic [63:0] a_i,    // operands, and the values of the delay lines
    input logic [63:0] b_i,
    // Bit 0: memory lines, 1: register lines; 2, 3, 4: dividers of fp16, fp32 and fp64. For 2, 4 and 8 turns.
    output logic [2:0][4:0] differ_o
);
  localparam int LINES = 8;
  localparam logic [LINES-1:0][31:0] CYCLES = {32'd121, 32'd64, 32'd49, 32'd33, 32'd17, 32'd9, 32'd3, 32'd1};
  localparam int FORMATS = 3;
  localparam logic [FORMATS-1:0][31:0] EXP = {32'd11, 32'd8, 32'd5}, MAN = {32'd52, 32'd23, 32'd10};
  for (genvar t = 0; t < 3; t++) begin : turns
    localparam int TURNS = 2 << t;
    localparam int TURN = 1;  // in which a value comes
    logic take;
    assign take = 32'(turn_i) % TURNS == TURN;
    logic [LINES-1:0] memory_differs, kept_differs;
    for (genvar i = 0; i < LINES; i++) begin : line
      localparam int TO = int'(CYCLES[i]);
      logic [36:0] memory, kept, should;
      turn_delay #(.W(37), .TO(TO), .TURNS(TURNS), .MEMORY(3)) delay_memory (
          .clk_i, .take_i(take), .d_i(a_i[36:0]), .q_o(memory));
      turn_delay #(.W(37), .TO(TO), .TURNS(TURNS), .MEMORY(0)) delay_kept (
          .clk_i, .take_i(take), .d_i(a_i[36:0]), .q_o(kept));
      pipe_delay #(.W(37), .TO(TO)) delay_each (.clk_i, .d_i(a_i[36:0]), .q_o(should));
      logic due;
      assign due = (32'(turn_i) + 8 * 32 - TO) % TURNS == TURN;
      assign memory_differs[i] = due && memory != should;
      assign kept_differs[i] = due && kept != should;
    end
    assign differ_o[t][0] = |memory_differs;
    assign differ_o[t][1] = |kept_differs;
    for (genvar f = 0; f < FORMATS; f++) begin : format
      localparam int WORD = (f == 2) ? 64 : 32;
      localparam int LAT = int'(MAN[f]) + 9 + f;
      logic [WORD-1:0] a, b, shared, should, unused_flags;
      assign a = (f == 0) ? WORD'(a_i[15:0]) : a_i[WORD-1:0];
      assign b = (f == 0) ? WORD'(b_i[15:0]) : b_i[WORD-1:0];
      fp_div_turns #(.EXP(EXP[f]), .MAN(MAN[f]), .LAT(LAT), .TURNS(TURNS)) of_turns (
          .clk_i, .take_i(take), .a_i(a), .b_i(b), .r_o(shared));
      fp_lanes #(.OP(formats_pkg::FP_DIV), .EXP(EXP[f]), .MAN(MAN[f]), .LAT(LAT)) of_each (
          .clk_i, .en_i(1'b1), .a_i(a), .b_i(b), .r_o(should), .flags_o(unused_flags));
      assign differ_o[t][2+f] = (32'(turn_i) + 8 * 32 - LAT) % TURNS == TURN && shared != should;
    end
  end
endmodule
