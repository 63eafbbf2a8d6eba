// SPDX-License-Identifier: Apache-2.0
// Update engine of one lane group: keeps the best record per primary (paper section 3.3). For a row, it reads the old T
// from one stencil-T buffer. Within one cycle it writes the better of old and new to the other buffer. `parity_i`
// selects the buffers and alternates with every secondary. F, index and CP change only if a new hit is better. Masked
// primaries are never updated.
// Mode nearest keeps the smallest (T, index), farthest the largest T, then the smallest index, any the first hit in
// stream order. For rays, only hits count.
// For solids (`solid_i`), every pair has a signed distance s, which is -T if they meet. Mode nearest keeps the smallest
// s and farthest the largest. The T buffers hold s.
// Latency: 1 cycle; in one lane with rows at least four cycles apart 2.
// Throughput: one row per cycle.
// Stall: none.
module update_lanes #(
    parameter int EXP = 8,
    parameter int MAN = 23,
    parameter int LANES = 16,
    parameter int ROWS = 16,
    parameter int POINTS = 3,  // words stored beside T: CP and, with normals, n
    parameter int SPACING = 1,  // rows come so many cycles apart; above 1, row_i and parity_i also a cycle before
    localparam int CW = (1 + EXP + MAN <= 32) ? 32 : 64,
    localparam int ROW_W = (ROWS > 1) ? $clog2(ROWS) : 1,
    localparam int LANE_W = (LANES > 1) ? $clog2(LANES) : 1,
    localparam int HITS_W = $clog2(LANES + 1)
) (
    input logic clk_i,
    input logic [2:0] mode_i,
    input logic solid_i,
    input logic clear_i,  // reset one row and load its mask
    input logic [ROW_W-1:0] clear_row_i,
    input logic [LANES-1:0] clear_mask_i,  // stencil: 1 masks the lane

    input logic valid_i,
    input logic [ROW_W-1:0] row_i,
    input logic parity_i,
    input logic [31:0] index_i,
    input logic [LANES-1:0][CW-1:0] f_i,  // lane masks
    input logic [LANES-1:0][CW-1:0] bad_i,  // of these nothing is kept
    input logic [LANES-1:0][CW-1:0] t_i,
    input logic [POINTS-1:0][LANES-1:0][CW-1:0] point_i,
    output logic [HITS_W-1:0] new_hits_o,  // primaries with their first hit in this row

    input logic result_i,  // combinational read after the stream; low: zeros
    input logic [ROW_W-1:0] result_row_i,
    input logic [LANE_W-1:0] result_lane_i,
    input logic result_parity_i,
    output logic result_f_o,  // F of the result: its index is not all ones
    output logic [31:0] result_index_o,
    output logic [CW-1:0] result_t_o,  // with solid_i the signed distance
    output logic [POINTS-1:0][CW-1:0] result_point_o
);
  /*verilator inline_module*/
  localparam int W = 1 + EXP + MAN;
  localparam logic [CW-1:0] INF = ((CW'(1) << EXP) - 1) << MAN;
  localparam logic [CW-1:0] SIGN = CW'(1) << (W - 1);

  logic [LANES-1:0][CW-1:0] stencil_t0[ROWS], stencil_t1[ROWS];  // the two T buffers
  logic [LANES-1:0][31:0] f_index[ROWS];                          // F-index buffer: all ones means F = 0

  // {a < b, a == b} of numbers in sign and magnitude. Both zeros are equal. The comparisons of the magnitudes are the
  // critical path: nothing comes before them, and b has the same side of both, so that it is never inverted.
  function automatic logic [1:0] order_of(input logic [CW-1:0] a, b);
    logic above, below, alike;
    above = (b & ~SIGN) < (a & ~SIGN);
    below = {b & ~SIGN, 1'b0} >= {a & ~SIGN, 1'b1};
    alike = ((a ^ b) & SIGN) == 0;
    order_of[0] = !above && !below && (alike || (a & ~SIGN) == 0);
    order_of[1] = below ? ((a & SIGN) != 0) != alike : (a & SIGN) != 0;
  endfunction

  logic [LANES-1:0][CW-1:0] hit, t_value, t_old, t_new, better, mask, candidate;
  logic [LANES-1:0] first_hit;
  logic any_hit, keep_now, keep;
  logic [1:0] order;
  // A row is written back after the last row of the pass, and cleared before the first. So each buffer has one port.
  logic [ROW_W-1:0] read_row, write_row;
  logic read_parity;
  assign read_row = result_i ? result_row_i : row_i;
  assign read_parity = result_i ? result_parity_i : parity_i;
  lane_masks #(.CW(CW), .LANES(LANES), .ROWS(ROWS)) unmasked (
      .clk_i, .write_i(clear_i), .write_row_i(clear_row_i), .bits_i(~clear_mask_i), .row_i, .masks_o(mask));
  // Candidates: hits; for solids, except in mode any, every pair.
  assign candidate = f_i | ~(bad_i | {(LANES * CW) {!solid_i || mode_i == registers_pkg::MODE_ANY}});
  assign hit = candidate & mask;
  always_comb begin
    t_value = t_i;
    if (solid_i) for (int l = 0; l < LANES; l++) t_value[l] = t_i[l] | (f_i[l] & SIGN);
  end
  assign any_hit = valid_i && |hit;
  logic [LANES-1:0][CW-1:0] t0, t1;
  logic [LANES-1:0][31:0] index_old;
  assign t0 = stencil_t0[read_row];
  assign t1 = stencil_t1[read_row];
  assign index_old = f_index[read_row];
  assign t_old = read_parity ? t1 : t0;

  // F beside its index, in cards of one lane: the comparison of 32 bits would be in the path of every record.
  localparam bit ALONE = LANES == 1;
  logic f_old;
  if (ALONE) begin : g_f
    logic f_mem[ROWS];
    assign f_old = f_mem[read_row];
    always_ff @(posedge clk_i) if (clear_i || keep) f_mem[write_row] <= !clear_i;
  end else begin : g_no_f
    assign f_old = 1'b0;
  end

  // What is compared: with rows apart, it is read one cycle before.
  logic [LANES-1:0][CW-1:0] t_kept;
  logic [LANES-1:0][31:0] index_kept;
  logic f_kept;
  if (SPACING > 1) begin : g_registers
    always_ff @(posedge clk_i) {t_kept, index_kept, f_kept} <= {t_old, index_old, f_old};
  end else begin : g_at_once
    assign {t_kept, index_kept, f_kept} = {t_old, index_old, f_old};
  end

  // Most rows have no hit, and need no comparison in simulation.
  always_comb begin
    better = '0;
    first_hit = '0;
    order = '0;
    t_new = t_kept;
    if (any_hit) begin
      for (int l = 0; l < LANES; l++) begin
        first_hit[l] = hit[l][0] && (ALONE ? !f_kept : index_kept[l] == '1);
        if (hit[l][0]) begin
          order = order_of(t_value[l], t_kept[l]);
          if (mode_i == registers_pkg::MODE_ANY) better[l] = {CW{first_hit[l]}};
          else if (first_hit[l]) better[l] = '1;
          else if (order[0]) better[l] = {CW{index_i < index_kept[l]}};
          else better[l] = {CW{order[1] == (mode_i == registers_pkg::MODE_NEAREST)}};
        end
        if (better[l][0]) t_new[l] = t_value[l];
      end
    end
  end
  assign new_hits_o = any_hit ? HITS_W'($countones(first_hit)) : '0;

  // One lane alone is written only if it changes, so nothing old is written back.
  assign keep_now = ALONE ? better[0][0] : any_hit;
  logic [LANES-1:0][31:0] index_new;
  always_comb begin
    index_new = {LANES{index_i}};
    if (!ALONE && any_hit)
      for (int l = 0; l < LANES; l++) index_new[l] = better[l][0] ? index_i : index_kept[l];
  end

  // What is written. The buffers' enables are wide, and the comparison is long: rows apart leave a cycle between them.
  logic [LANES-1:0][CW-1:0] t_write, better_write;
  logic [LANES-1:0][31:0] index_write;
  logic [POINTS-1:0][LANES-1:0][CW-1:0] point_write;
  logic [ROW_W-1:0] row_write;
  logic valid_write, parity_write;
  if (ALONE && SPACING >= 4) begin : g_late
    always_ff @(posedge clk_i) begin
      {valid_write, parity_write, row_write, keep} <= {valid_i, parity_i, row_i, keep_now};
      {t_write, better_write, index_write, point_write} <= {t_new, better, index_new, point_i};
    end
  end else begin : g_now
    assign {valid_write, parity_write, row_write, keep} = {valid_i, parity_i, row_i, keep_now};
    assign {t_write, better_write, index_write, point_write} = {t_new, better, index_new, point_i};
  end
  assign write_row = clear_i ? clear_row_i : row_write;
  always_ff @(posedge clk_i) begin
    if (clear_i || (valid_write && parity_write)) stencil_t0[write_row] <= clear_i ? {LANES{INF}} : t_write;
    if (clear_i || (valid_write && !parity_write)) stencil_t1[write_row] <= clear_i ? {LANES{INF}} : t_write;
    if (clear_i || keep) f_index[write_row] <= clear_i ? '1 : index_write;
  end

  always_comb begin
    result_f_o = 1'b0;
    result_index_o = '0;
    result_t_o = '0;
    if (result_i) begin
      result_f_o = ALONE ? f_old : index_old[result_lane_i] != '1;
      result_index_o = index_old[result_lane_i];
      result_t_o = t_old[result_lane_i];
    end
  end
  for (genvar k = 0; k < POINTS; k++) begin : point
    logic [LANES-1:0][CW-1:0] kept[ROWS], old;  // undefined while nothing is stored
    assign old = kept[read_row];
    always_ff @(posedge clk_i)
      if (keep) kept[row_write] <= ALONE ? point_write[k] : (old & ~better_write) | (point_write[k] & better_write);
    always_comb begin
      result_point_o[k] = '0;
      if (result_f_o) result_point_o[k] = old[result_lane_i];
    end
  end
endmodule
