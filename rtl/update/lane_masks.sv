// SPDX-License-Identifier: Apache-2.0
// Memory of one bit per lane and row, read as lane masks. It holds masks, so that no lane of a wide row is widened in
// simulation. With one lane it holds the bit.
// Latency: 0 from row_i, 1 cycle from a write.
// Throughput: one row read and one written per cycle.
// Stall: none.
module lane_masks #(
    parameter int CW = 32,
    parameter int LANES = 16,
    parameter int ROWS = 16,
    localparam int ROW_W = (ROWS > 1) ? $clog2(ROWS) : 1
) (
    input logic clk_i,
    input logic write_i,
    input logic [ROW_W-1:0] write_row_i,
    input logic [LANES-1:0] bits_i,
    input logic [ROW_W-1:0] row_i,
    output logic [LANES-1:0][CW-1:0] masks_o
);
  /*verilator inline_module*/
  localparam int STORED = (LANES == 1) ? 1 : CW;  // bits per lane
  logic [LANES-1:0][STORED-1:0] mem[ROWS], stored;
  always_comb begin
    stored = '0;
    if (write_i) for (int l = 0; l < LANES; l++) stored[l] = {STORED{bits_i[l]}};
  end
  always_ff @(posedge clk_i) if (write_i) mem[write_row_i] <= stored;
  assign masks_o = {(CW / STORED) {mem[row_i]}};
endmodule
