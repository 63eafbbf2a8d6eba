// Collision detection engine: the function selector and its pipes behind one mouth. Takes a row of LANES primaries against one
// secondary a clock and gives the row's results in order.
// Latency: that of the selected pipe. Throughput: one row a clock. Stall: none, the mouth is held by credits outside.
module cde #(
    parameter int EXP = 8,
    parameter int MAN = 23,
    parameter int LANES = 16,
    parameter int PRIMARIES = 256,
    parameter int LAT_ADD = 1,
    parameter int LAT_MUL = 1,
    parameter int LAT_DIV = 1,
    parameter int LAT_CMP = 1,
    parameter ARITH = "rtl",
    localparam int CW = (1 + EXP + MAN <= 32) ? 32 : 64,
    localparam int SEC_WORDS = cde_pkg::SEC_WORDS,
    localparam int ROWS = PRIMARIES / LANES,
    localparam int ROW_W = (ROWS > 1) ? $clog2(ROWS) : 1
) (
    input logic clk_i,  // may be gated while nothing is in flight
    input logic rst_i,
    input logic clk_bus_i,

    input logic prim_write_i,
    input logic [31:0] prim_addr_i,
    input logic [63:0] prim_data_i,
    output logic [PRIMARIES-1:0] prim_bad_o,
    input logic clear_i,  // start of a pass: one row a clock
    input logic [ROW_W-1:0] clear_row_i,

    input logic valid_i,
    input logic [ROW_W-1:0] row_i,
    input logic parity_i,
    input logic [31:0] index_i,
    input logic [SEC_WORDS-1:0][CW-1:0] secondary_i,
    input logic secondary_bad_i,

    output logic valid_o,
    output logic [ROW_W-1:0] row_o,
    output logic parity_o,
    output logic [31:0] index_o,
    output logic [LANES-1:0][CW-1:0] f_o,
    output logic [LANES-1:0][CW-1:0] bad_o,
    output logic [LANES-1:0][CW-1:0] t_o,
    output logic [2:0][LANES-1:0][CW-1:0] cp_o,
    output logic [15:0] latency_o
);
  logic [ROW_W-1:0] row_o_edge, row_d_cross, row_d_dot, row_t, row_o_cp, row_bad;
  logic [2:0][LANES-1:0][CW-1:0] o_edge, d_cross, d_dot, d_t, o_cp;
  logic [LANES-1:0][CW-1:0] tmin_t, tmax_t, ray_bad;

  primary_regfile #(.EXP(EXP), .MAN(MAN), .LANES(LANES), .PRIMARIES(PRIMARIES)) primaries (
      .clk_i(clk_bus_i), .rst_i, .engine_clk_i(clk_i), .clear_i, .clear_row_i, .write_i(prim_write_i), .write_addr_i(prim_addr_i), .write_data_i(prim_data_i), .bad_o(prim_bad_o),
      .row_o_edge_i(row_o_edge), .o_edge_o(o_edge), .row_d_cross_i(row_d_cross), .d_cross_o(d_cross),
      .row_d_dot_i(row_d_dot), .d_dot_o(d_dot), .row_t_i(row_t), .d_t_o(d_t), .tmin_t_o(tmin_t), .tmax_t_o(tmax_t),
      .row_o_cp_i(row_o_cp), .o_cp_o(o_cp), .row_bad_i(row_bad), .bad_mask_o(ray_bad));

  ray_triangle_moller #(
      .EXP(EXP), .MAN(MAN), .LANES(LANES), .SLANES(1), .ROW_W(ROW_W), .TAG_W(33),
      .LAT_ADD(LAT_ADD), .LAT_MUL(LAT_MUL), .LAT_DIV(LAT_DIV), .LAT_CMP(LAT_CMP), .ARITH(ARITH)
  ) ray_triangle (
      .clk_i, .rst_i, .valid_i, .row_i, .tag_i({parity_i, index_i}), .tri_i(secondary_i), .tri_bad_i({CW{secondary_bad_i}}),
      .row_o_edge_o(row_o_edge), .o_edge_i(o_edge), .row_d_cross_o(row_d_cross), .d_cross_i(d_cross),
      .row_d_dot_o(row_d_dot), .d_dot_i(d_dot), .row_t_o(row_t), .d_t_i(d_t), .tmin_t_i(tmin_t), .tmax_t_i(tmax_t),
      .row_o_cp_o(row_o_cp), .o_cp_i(o_cp), .row_bad_o(row_bad), .ray_bad_i(ray_bad),
      .valid_o, .row_o, .tag_o({parity_o, index_o}), .f_o, .bad_o, .t_o, .cp_o, .latency_o);
endmodule
