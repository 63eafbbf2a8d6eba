// LANES lanes of the collision detection engine with all that belongs to them alone: their part of the primary register file, the
// pipe, of the update engine and of the output FIFO. Nothing wider than a control bit or one record leaves a group, in silicon as
// in simulation; not inlined, so that the groups are one function over objects that fit the first-level cache.
// Latency: that of the pipe. Throughput: one row a clock. Stall: none.
module lane_group #(
    parameter int EXP = 8,
    parameter int MAN = 23,
    parameter int LANES = 8,
    parameter int ROWS = 32,
    parameter int FIFO_DEPTH = 128,
    parameter int LAT_ADD = 1,
    parameter int LAT_MUL = 1,
    parameter int LAT_DIV = 1,
    parameter int LAT_CMP = 1,
    parameter ARITH = "rtl",
    localparam int CW = (1 + EXP + MAN <= 32) ? 32 : 64,
    localparam int PRIM_WORDS = cde_pkg::PRIM_WORDS,
    localparam int SEC_WORDS = cde_pkg::SEC_WORDS,
    localparam int ROW_W = (ROWS > 1) ? $clog2(ROWS) : 1,
    localparam int LANE_W = (LANES > 1) ? $clog2(LANES) : 1,
    localparam int FIFO_W = $clog2(FIFO_DEPTH),
    localparam int HITS_W = $clog2(LANES + 1)
) (
    input logic clk_i,
    input logic clk_prim_i,  // runs while a primary is written

    input logic prim_write_i /*verilator public_flat_rd*/,
    input logic [ROW_W-1:0] prim_row_i,
    input logic [LANE_W-1:0] prim_lane_i,
    input logic [PRIM_WORDS-1:0][CW-1:0] prim_slot_i,

    input logic clear_i,
    input logic [ROW_W-1:0] clear_row_i,
    input logic [LANES-1:0] clear_mask_i /*verilator public_flat_rd*/,
    input logic [LANES-1:0] clear_bad_i /*verilator public_flat_rd*/,  // primaries out of contract

    input logic [ROW_W-1:0] row_i,  // row and secondary that enter the datapath
    input logic [SEC_WORDS-1:0][CW-1:0] secondary_i,
    output logic [15:0] latency_o,

    input logic valid_i,  // the row whose results leave it
    input logic [ROW_W-1:0] row_out_i,
    input logic parity_i,
    input logic [31:0] index_i,
    input logic secondary_bad_i,
    input logic [2:0] mode_i,
    input logic streaming_i,
    output logic [HITS_W-1:0] new_hits_o,
    output logic [LANES-1:0] f_o,  // in the streaming modes
    output logic [LANES-1:0] bad_o,
    output logic [LANES-1:0] unmasked_o,

    input logic push_i,
    input logic [FIFO_W-1:0] write_i,
    input logic read_i /*verilator public_flat_rd*/,  // lane lane_i of FIFO row head_i, else of row result_row_i of the update buffers
    input logic [FIFO_W-1:0] head_i,
    input logic result_i /*verilator public_flat_rd*/,
    input logic [ROW_W-1:0] result_row_i,
    input logic result_parity_i,
    input logic [LANE_W-1:0] lane_i,
    output logic [31:0] result_index_o,  // the group's part of an OR: zeros when it is not asked
    output logic [CW-1:0] result_t_o,
    output logic [2:0][CW-1:0] result_cp_o
);
  /*verilator no_inline_module*/
  localparam logic [CW-1:0] QNAN = (((CW'(1) << EXP) - 1) << MAN) | (CW'(1) << (MAN - 1));

  logic [PRIM_WORDS-1:0][LANES-1:0][CW-1:0] a;
  primary_lanes #(.CW(CW), .LANES(LANES), .ROWS(ROWS), .WORDS(PRIM_WORDS)) primaries (
      .clk_i(clk_prim_i), .write_i(prim_write_i), .write_row_i(prim_row_i), .write_lane_i(prim_lane_i), .slot_i(prim_slot_i), .row_i, .a_o(a));

  logic [LANES-1:0][CW-1:0] f_pipe, t_pipe;
  logic [2:0][LANES-1:0][CW-1:0] cp_pipe;
  ray_triangle_moller #(
      .EXP(EXP), .MAN(MAN), .LANES(LANES), .B_LANES(1), .LAT_ADD(LAT_ADD), .LAT_MUL(LAT_MUL), .LAT_DIV(LAT_DIV), .LAT_CMP(LAT_CMP), .ARITH(ARITH)
  ) ray_triangle (.clk_i, .a_i(a), .b_i(secondary_i), .f_o(f_pipe), .t_o(t_pipe), .cp_o(cp_pipe), .latency_o);

  // ---- Bad input: F = 0, T and CP are NaN ----
  logic [LANES-1:0] unmasked_mem[ROWS];  // for the streaming modes, as bits
  logic [LANES-1:0][CW-1:0] bad_mem[ROWS], clear_bad, bad, f, t;
  always_comb begin
    clear_bad = '0;
    if (clear_i) for (int l = 0; l < LANES; l++) clear_bad[l] = {CW{clear_bad_i[l]}};
  end
  always_ff @(posedge clk_i)
    if (clear_i) begin
      bad_mem[clear_row_i] <= clear_bad;
      unmasked_mem[clear_row_i] <= ~clear_mask_i;
    end
  logic [LANES-1:0][CW-1:0] bad_row, bad_secondary;
  assign bad_row = bad_mem[row_out_i];
  assign bad_secondary = {(LANES * CW) {secondary_bad_i}};
  assign bad = bad_row | bad_secondary;
  assign f = f_pipe & ~bad;
  lane_select #(.CW(CW), .LANES(LANES)) select_t (.m_i(bad), .a_i({LANES{QNAN}}), .b_i(t_pipe), .r_o(t));
  for (genvar k = 0; k < 3; k++) begin : axis
    logic [LANES-1:0][CW-1:0] cp;
    lane_select #(.CW(CW), .LANES(LANES)) select_cp (.m_i(bad), .a_i({LANES{QNAN}}), .b_i(cp_pipe[k]), .r_o(cp));
  end

  // ---- Results ----
  logic [31:0] kept_index;
  logic [CW-1:0] kept_t, fifo_t;
  logic [2:0][CW-1:0] kept_cp, fifo_cp;
  update_lanes #(.EXP(EXP), .MAN(MAN), .LANES(LANES), .ROWS(ROWS)) update (
      .clk_i, .mode_i, .clear_i, .clear_row_i, .clear_mask_i, .valid_i(valid_i && !streaming_i), .row_i(row_out_i), .parity_i, .index_i,
      .f_i(f), .t_i(t), .cp_x_i(axis[0].cp), .cp_y_i(axis[1].cp), .cp_z_i(axis[2].cp), .new_hits_o, .result_i, .result_row_i, .result_lane_i(lane_i), .result_parity_i,
      .result_index_o(kept_index), .result_t_o(kept_t), .result_cp_o(kept_cp));
  record_lanes #(.CW(CW), .LANES(LANES), .DEPTH(FIFO_DEPTH)) records (
      .clk_i, .push_i, .write_i, .t_i(t), .cp_x_i(axis[0].cp), .cp_y_i(axis[1].cp), .cp_z_i(axis[2].cp), .read_i, .head_i, .lane_i, .t_o(fifo_t), .cp_o(fifo_cp));
  assign result_index_o = kept_index;
  assign result_t_o = kept_t | fifo_t;
  assign result_cp_o = kept_cp | fifo_cp;
  always_comb begin
    f_o = '0;
    bad_o = '0;
    unmasked_o = '0;
    if (valid_i && streaming_i) begin
      unmasked_o = unmasked_mem[row_out_i];
      for (int l = 0; l < LANES; l++) begin
        f_o[l] = f[l][0];
        bad_o[l] = bad[l][0];
      end
    end
  end
endmodule
