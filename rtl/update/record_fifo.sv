// SPDX-License-Identifier: Apache-2.0
// Output FIFO of the streaming result modes (all, hits). It takes a row of results and gives one record per cycle,
// lanes in ascending order. Credits reserve room: `credit_o` counts the rows that have left, so the input port never
// overfills the FIFO. The module record_lanes holds T and CP beside the lanes. This module has the control and one bit
// per lane.
// Latency: 2 cycles, so that no word is read as it is written.
// Throughput: one row in, one record out per cycle.
// Stall: holds its output while ready_i is low.
module record_fifo #(
    parameter int LANES = 16,
    parameter int ROW_W = 4,
    parameter int DEPTH = 32,  // power of two
    localparam int AW = $clog2(DEPTH),
    localparam int LANE_W = (LANES > 1) ? $clog2(LANES) : 1
) (
    input logic clk_i,
    input logic rst_i,
    input logic hits_only_i,
    input logic push_i,
    input logic [ROW_W-1:0] row_i,
    input logic [31:0] index_i,
    input logic [LANES-1:0] unmasked_i,
    input logic [LANES-1:0] f_i,
    input logic [LANES-1:0] bad_i,
    output logic keep_o,  // the row is stored, at write_o
    output logic [AW-1:0] write_o,
    output logic [1:0] credit_o,  // rows freed in this cycle
    output logic empty_o,

    input logic ready_i,
    output logic [AW-1:0] head_o,
    output card_pkg::streamed_t streamed_o
);
  logic [AW:0] write_q, written_q, read_q;  // written_q: rows that can be read
  logic [ROW_W-1:0] row_mem[DEPTH];
  (* no_rw_check *) logic [31:0] index_mem[DEPTH];
  logic [LANES-1:0] want_mem[DEPTH], f_mem[DEPTH], bad_mem[DEPTH];

  logic [LANES-1:0] want, done_q, pending, lowest;
  logic [LANE_W-1:0] lane;
  logic emit, leave;
  assign want = hits_only_i ? unmasked_i & f_i : unmasked_i;
  assign keep_o = push_i && |want;
  assign write_o = write_q[AW-1:0];
  assign head_o = read_q[AW-1:0];
  assign empty_o = write_q == read_q;
  assign pending = want_mem[head_o] & ~done_q;
  priority_encoder #(.N(LANES)) first (.set_i(pending), .first_o(lowest), .index_o(lane));
  assign emit = streamed_o.valid && ready_i;
  assign leave = emit && (pending & ~lowest) == 0;
  assign credit_o = 2'(leave) + 2'(push_i && !keep_o);
  assign streamed_o.valid = written_q != read_q;
  assign streamed_o.bad = bad_mem[head_o][lane];
  assign streamed_o.f = f_mem[head_o][lane];
  assign streamed_o.index = index_mem[head_o];
  assign streamed_o.row = 8'(row_mem[head_o]);
  assign streamed_o.lane = 8'(lane);

  always_ff @(posedge clk_i) begin
    if (keep_o) begin
      row_mem[write_o] <= row_i;
      index_mem[write_o] <= index_i;
      want_mem[write_o] <= want;
      f_mem[write_o] <= f_i;
      bad_mem[write_o] <= bad_i;
      write_q <= write_q + 1;
    end
    if (emit) done_q <= leave ? '0 : done_q | lowest;
    if (leave) read_q <= read_q + 1;
    written_q <= write_q;
    if (rst_i) begin
      {write_q, written_q, read_q} <= '0;
      done_q <= '0;
    end
  end

`ifndef SYNTHESIS
  always_ff @(posedge clk_i)
    if (!rst_i) assert (!(keep_o &&
        write_q - read_q == (AW + 1)'(DEPTH))) else $error("record_fifo: overfilled despite credits");
`endif
endmodule
