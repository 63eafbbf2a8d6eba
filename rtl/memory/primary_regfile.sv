// Mouth of the primary register file: PRIMARIES slots written by the local bus 64 bits a beat. The words of a slot gather in a staging
// register; the beat that brings the last word commits the slot to its lane (primary_lanes) with the verdict on the input contract.
// Latency: 1 clock. Throughput: one beat a clock. Stall: none.
module primary_regfile #(
    parameter int EXP = 8,
    parameter int MAN = 23,
    parameter int LANES = 16,
    parameter int PRIMARIES = 256,
    localparam int CW = (1 + EXP + MAN <= 32) ? 32 : 64,
    localparam int ROWS = PRIMARIES / LANES,
    localparam int ROW_W = (ROWS > 1) ? $clog2(ROWS) : 1,
    localparam int LANE_W = (LANES > 1) ? $clog2(LANES) : 1,
    localparam int WORDS = cde_pkg::PRIM_WORDS
) (
    input logic clk_i,
    input logic rst_i,
    input logic write_i,
    input logic [31:0] write_addr_i,  // byte offset, 8-byte aligned
    input logic [63:0] write_data_i,

    output logic [PRIMARIES-1:0] bad_o,  // primaries out of contract, or never written
    output logic commit_o,  // a slot is complete: its lane takes it at the next clock
    output logic [ROW_W-1:0] row_o,
    output logic [LANE_W-1:0] lane_o,
    output logic [WORDS-1:0][CW-1:0] slot_o
);
  localparam int BEATS = WORDS * CW / 64;
  if (PRIMARIES % LANES != 0 || (LANES & (LANES - 1)) != 0) begin : g_illegal
    $error("primary_regfile: LANES must be a power of two that divides PRIMARIES");
  end

  logic [31:0] beat, number;
  logic [WORDS-1:0][CW-1:0] slot;
  logic commit, bad;
  assign beat = write_addr_i >> 3;
  assign number = beat / 32'(BEATS);
  assign commit = write_i && beat % 32'(BEATS) == 32'(BEATS - 1);
  for (genvar b = 0; b < BEATS; b++) begin : gather
    assign slot[b*64/CW+:64/CW] = (beat % 32'(BEATS) == 32'(b)) ? write_data_i : slot_o[b*64/CW+:64/CW];
  end
  ray_check #(.EXP(EXP), .MAN(MAN)) check (.word_i(slot), .bad_o(bad));
  always_ff @(posedge clk_i) begin
    commit_o <= commit && !rst_i;
    if (write_i) slot_o <= slot;
    if (commit) begin
      row_o <= ROW_W'(number / 32'(LANES));
      lane_o <= LANE_W'(number % 32'(LANES));
      bad_o[$clog2(PRIMARIES)'(number)] <= bad;
    end
    if (rst_i) bad_o <= '1;
  end
endmodule
