// SPDX-License-Identifier: Apache-2.0
// Results of one pair of a pass in one lane group. Bad input gets F = 0 and NaN. The update engine keeps the best
// record per primary, and the output FIFO gets the row.
// Latency: 0 to the FIFO, update_lanes's to the update buffers.
// Throughput: one row per cycle.
// Stall: none.
module lane_results #(
    parameter int EXP = 8,
    parameter int MAN = 23,
    parameter int LANES = 8,
    parameter int ROWS = 32,
    parameter int NORMALS = 0,
    parameter int SPACING = 1,  // as in update_lanes.sv
    localparam int CW = (1 + EXP + MAN <= 32) ? 32 : 64,
    localparam int POINTS = (NORMALS != 0) ? 6 : 3,
    localparam int ROW_W = (ROWS > 1) ? $clog2(ROWS) : 1,
    localparam int LANE_W = (LANES > 1) ? $clog2(LANES) : 1,
    localparam int HITS_W = $clog2(LANES + 1)
) (
    input logic clk_i,
    input logic clear_i,
    input logic [ROW_W-1:0] clear_row_i,
    input logic [LANES-1:0] clear_mask_i,
    input logic [LANES-1:0] clear_bad_i,  // primaries out of contract
    input logic solid_i,                  // a pair of solids: T is the size of a signed distance
    input logic [2:0] mode_i,
    input logic streaming_i,

    input logic valid_i,
    input logic [ROW_W-1:0] row_i,
    input logic parity_i,
    input logic [31:0] index_i,
    input logic secondary_bad_i,
    input logic [LANES-1:0][CW-1:0] f_i,
    input logic [LANES-1:0][CW-1:0] t_i,
    input logic [2:0][LANES-1:0][CW-1:0] cp_i,
    input logic [2:0][LANES-1:0][CW-1:0] n_i,
    output logic [HITS_W-1:0] new_hits_o,

    output logic [LANES-1:0] f_o,  // in the streaming modes
    output logic [LANES-1:0] bad_o,
    output logic [LANES-1:0] unmasked_o,
    output logic [LANES-1:0][CW-1:0] t_o,
    output logic [POINTS-1:0][LANES-1:0][CW-1:0] point_o,  // CP and, with normals, n

    input logic result_i,  // low: outputs are zeros
    input logic [ROW_W-1:0] result_row_i,
    input logic [LANE_W-1:0] result_lane_i,
    input logic result_parity_i,
    output logic result_f_o,
    output logic [31:0] result_index_o,
    output logic [CW-1:0] result_t_o,
    output logic [POINTS-1:0][CW-1:0] result_point_o
);
  /*verilator inline_module*/
  localparam logic [CW-1:0] QNAN = (((CW'(1) << EXP) - 1) << MAN) | (CW'(1) << (MAN - 1));

  logic [LANES-1:0] unmasked_mem[ROWS];  // bits, for the streaming modes
  always_ff @(posedge clk_i) if (clear_i) unmasked_mem[clear_row_i] <= ~clear_mask_i;
  logic [LANES-1:0][CW-1:0] bad_row, bad_secondary, bad, f;
  lane_masks #(.CW(CW), .LANES(LANES), .ROWS(ROWS)) bad_primaries (
      .clk_i, .write_i(clear_i), .write_row_i(clear_row_i), .bits_i(clear_bad_i), .row_i, .masks_o(bad_row));
  assign bad_secondary = {(LANES * CW) {secondary_bad_i}};
  assign bad = bad_row | bad_secondary;
  assign f = f_i & ~bad;
  lane_select #(.CW(CW), .LANES(LANES)) select_t (.m_i(bad), .a_i({LANES{QNAN}}), .b_i(t_i), .r_o(t_o));
  logic [POINTS-1:0][LANES-1:0][CW-1:0] point_pipe;
  if (NORMALS != 0) begin : g_normals
    assign point_pipe = {n_i, cp_i};
  end else begin : g_no_normals
    logic unused_n;
    assign unused_n = &{1'b0, n_i};
    assign point_pipe = cp_i;
  end
  for (genvar k = 0; k < POINTS; k++) begin : axis
    logic [LANES-1:0][CW-1:0] masked;
    lane_select #(.CW(CW), .LANES(LANES)) select_point (.m_i(bad), .a_i({LANES{QNAN}}), .b_i(point_pipe[k]),
        .r_o(masked));
    assign point_o[k] = masked;
  end

  update_lanes #(.EXP(EXP), .MAN(MAN), .LANES(LANES), .ROWS(ROWS), .POINTS(POINTS), .SPACING(SPACING)) update (
      .clk_i, .mode_i, .solid_i, .clear_i, .clear_row_i, .clear_mask_i, .valid_i(valid_i && !streaming_i), .row_i,
      .parity_i, .index_i, .f_i(f), .bad_i(bad), .t_i, .point_i(point_pipe), .new_hits_o, .result_i, .result_row_i,
      .result_lane_i, .result_parity_i, .result_f_o, .result_index_o, .result_t_o, .result_point_o);
  always_comb begin
    f_o = '0;
    bad_o = '0;
    unmasked_o = '0;
    if (valid_i && streaming_i) begin
      unmasked_o = unmasked_mem[row_i];
      for (int l = 0; l < LANES; l++) begin
        f_o[l] = f[l][0];
        bad_o[l] = bad[l][0];
      end
    end
  end
endmodule
