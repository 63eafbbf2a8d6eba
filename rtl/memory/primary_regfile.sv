// Primary register file: PRIMARIES rays in rows of LANES, written by the local bus 64 bits a beat. The words of a slot gather in a
// staging register; the beat that brings the last word commits the slot with its verdict on the input contract. The pipe reads a
// row a port.
// Latency: 0 for reads. Throughput: one beat written, one row a port read a clock. Stall: none.
module primary_regfile #(
    parameter int EXP = 8,
    parameter int MAN = 23,
    parameter int LANES = 16,
    parameter int PRIMARIES = 256,
    localparam int CW = (1 + EXP + MAN <= 32) ? 32 : 64,
    localparam int ROWS = PRIMARIES / LANES,
    localparam int ROW_W = (ROWS > 1) ? $clog2(ROWS) : 1
) (
    input logic clk_i,
    input logic rst_i,
    input logic write_i,
    input logic [31:0] write_addr_i,  // byte offset, 8-byte aligned
    input logic [63:0] write_data_i,

    output logic [PRIMARIES-1:0] bad_o,  // primaries out of contract, or never written

    input logic engine_clk_i,
    input logic clear_i,  // at the start of a pass: load a row of lane masks from bad_o
    input logic [ROW_W-1:0] clear_row_i,

    input logic [ROW_W-1:0] row_o_edge_i,
    output logic [2:0][LANES-1:0][CW-1:0] o_edge_o,
    input logic [ROW_W-1:0] row_d_cross_i,
    output logic [2:0][LANES-1:0][CW-1:0] d_cross_o,
    input logic [ROW_W-1:0] row_d_dot_i,
    output logic [2:0][LANES-1:0][CW-1:0] d_dot_o,
    input logic [ROW_W-1:0] row_t_i,
    output logic [2:0][LANES-1:0][CW-1:0] d_t_o,
    output logic [LANES-1:0][CW-1:0] tmin_t_o,
    output logic [LANES-1:0][CW-1:0] tmax_t_o,
    input logic [ROW_W-1:0] row_o_cp_i,
    output logic [2:0][LANES-1:0][CW-1:0] o_cp_o,
    input logic [ROW_W-1:0] row_bad_i,
    output logic [LANES-1:0][CW-1:0] bad_mask_o
);
  localparam int WORDS = cde_pkg::PRIM_WORDS;
  localparam int BEATS = WORDS * CW / 64;
  localparam int LANE_W = (LANES > 1) ? $clog2(LANES) : 1;
  if (PRIMARIES % LANES != 0 || (LANES & (LANES - 1)) != 0) begin : g_illegal
    $error("primary_regfile: LANES must be a power of two that divides PRIMARIES");
  end

  logic [31:0] beat, slot;
  logic [ROW_W-1:0] row;
  logic [LANE_W-1:0] lane;
  logic [WORDS-1:0][CW-1:0] stage_q, stage;
  logic commit, bad;
  assign beat = write_addr_i >> 3;
  assign slot = beat / 32'(BEATS);
  assign row = ROW_W'(slot / 32'(LANES));
  assign lane = LANE_W'(slot % 32'(LANES));
  assign commit = write_i && beat % 32'(BEATS) == 32'(BEATS - 1);
  for (genvar b = 0; b < BEATS; b++) begin : gather
    assign stage[b*64/CW+:64/CW] = (beat % 32'(BEATS) == 32'(b)) ? write_data_i : stage_q[b*64/CW+:64/CW];
  end
  ray_check #(.EXP(EXP), .MAN(MAN)) check (.word_i(stage), .bad_o(bad));
  always_ff @(posedge clk_i) begin
    if (write_i) stage_q <= stage;
    if (commit) bad_o[$clog2(PRIMARIES)'(slot)] <= bad;
    if (rst_i) bad_o <= '1;
  end

  // o is read at the edge and point stages; d at cross, dot and point; tmin, tmax with the distance.
  for (genvar k = 0; k < 3; k++) begin : axis
    logic [1:0][LANES-1:0][CW-1:0] o;
    logic [2:0][LANES-1:0][CW-1:0] d;
    primary_word #(.LANES(LANES), .ROWS(ROWS), .CW(CW), .PORTS(2)) o_u (
        .clk_i, .write_i(commit), .write_row_i(row), .write_lane_i(lane), .write_data_i(stage[k]),
        .row_i({row_o_cp_i, row_o_edge_i}), .data_o(o));
    primary_word #(.LANES(LANES), .ROWS(ROWS), .CW(CW), .PORTS(3)) d_u (
        .clk_i, .write_i(commit), .write_row_i(row), .write_lane_i(lane), .write_data_i(stage[3+k]),
        .row_i({row_t_i, row_d_dot_i, row_d_cross_i}), .data_o(d));
    assign o_edge_o[k] = o[0];
    assign o_cp_o[k] = o[1];
    assign d_cross_o[k] = d[0];
    assign d_dot_o[k] = d[1];
    assign d_t_o[k] = d[2];
  end
  primary_word #(.LANES(LANES), .ROWS(ROWS), .CW(CW)) tmin_u (
      .clk_i, .write_i(commit), .write_row_i(row), .write_lane_i(lane), .write_data_i(stage[6]),
      .row_i(row_t_i), .data_o(tmin_t_o));
  primary_word #(.LANES(LANES), .ROWS(ROWS), .CW(CW)) tmax_u (
      .clk_i, .write_i(commit), .write_row_i(row), .write_lane_i(lane), .write_data_i(stage[7]),
      .row_i(row_t_i), .data_o(tmax_t_o));
  logic [LANES-1:0][CW-1:0] bad_mem[ROWS];
  logic [LANES-1:0][CW-1:0] bad_lanes;
  always_comb begin
    bad_lanes = '0;
    if (clear_i) for (int l = 0; l < LANES; l++) bad_lanes[l] = {CW{bad_o[32'(clear_row_i)*LANES+l]}};
  end
  always_ff @(posedge engine_clk_i) if (clear_i) bad_mem[clear_row_i] <= bad_lanes;
  assign bad_mask_o = bad_mem[row_bad_i];
endmodule
