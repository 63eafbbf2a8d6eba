// Output FIFO of the streaming result modes (all, hits): takes a row of results, gives one record a clock, lanes in ascending order.
// Room is promised ahead by credits: `credit_o` counts the rows that have left, so the pipe mouth never overfills it.
// Latency: 1 clock. Throughput: one row in, one record out a clock. Stall: holds while ready_i is low.
module record_fifo #(
    parameter int LANES = 16,
    parameter int CW = 32,
    parameter int ROW_W = 4,
    parameter int DEPTH = 32,  // power of two
    localparam int LANE_W = (LANES > 1) ? $clog2(LANES) : 1
) (
    input logic clk_i,
    input logic rst_i,
    input logic hits_only_i,
    input logic push_i,
    input logic [ROW_W-1:0] row_i,
    input logic [31:0] index_i,
    input logic [LANES-1:0] unmasked_i,
    input logic [LANES-1:0][CW-1:0] f_i,
    input logic [LANES-1:0][CW-1:0] bad_i,
    input logic [LANES-1:0][CW-1:0] t_i,
    input logic [2:0][LANES-1:0][CW-1:0] cp_i,
    output logic [1:0] credit_o,  // rows given back this clock
    output logic empty_o,

    output logic valid_o,
    input logic ready_i,
    output logic [ROW_W-1:0] row_o,
    output logic [LANE_W-1:0] lane_o,
    output logic [31:0] index_o,
    output logic f_o,
    output logic bad_o,
    output logic [CW-1:0] t_o,
    output logic [2:0][CW-1:0] cp_o
);
  localparam int AW = $clog2(DEPTH);
  logic [AW:0] write_q, read_q;
  logic [ROW_W-1:0] row_mem[DEPTH];
  logic [31:0] index_mem[DEPTH];
  logic [LANES-1:0] want_mem[DEPTH], f_mem[DEPTH], bad_mem[DEPTH];
  logic [LANES-1:0][CW-1:0] t_mem[DEPTH], cp_x_mem[DEPTH], cp_y_mem[DEPTH], cp_z_mem[DEPTH];

  logic [LANES-1:0] f, bad, want, done_q, pending, lowest;
  always_comb begin
    f = '0;
    bad = '0;
    if (push_i) begin
      for (int l = 0; l < LANES; l++) begin
        f[l] = f_i[l][0];
        bad[l] = bad_i[l][0];
      end
    end
    want = hits_only_i ? unmasked_i & f : unmasked_i;
  end

  logic keep, emit, leave;
  logic [AW-1:0] head;
  assign keep = push_i && |want;
  assign head = read_q[AW-1:0];
  assign empty_o = write_q == read_q;
  assign pending = want_mem[head] & ~done_q;
  first_set #(.N(LANES)) first (.set_i(pending), .first_o(lowest), .index_o(lane_o));
  assign valid_o = !empty_o;
  assign emit = valid_o && ready_i;
  assign leave = emit && (pending & ~lowest) == 0;
  assign credit_o = 2'(leave) + 2'(push_i && !keep);
  assign row_o = row_mem[head];
  assign index_o = index_mem[head];
  assign f_o = f_mem[head][lane_o];
  assign bad_o = bad_mem[head][lane_o];
  assign t_o = t_mem[head][lane_o];
  assign cp_o = {cp_z_mem[head][lane_o], cp_y_mem[head][lane_o], cp_x_mem[head][lane_o]};

  always_ff @(posedge clk_i) begin
    if (keep) begin
      row_mem[write_q[AW-1:0]] <= row_i;
      index_mem[write_q[AW-1:0]] <= index_i;
      want_mem[write_q[AW-1:0]] <= want;
      f_mem[write_q[AW-1:0]] <= f;
      bad_mem[write_q[AW-1:0]] <= bad;
      t_mem[write_q[AW-1:0]] <= t_i;
      cp_x_mem[write_q[AW-1:0]] <= cp_i[0];
      cp_y_mem[write_q[AW-1:0]] <= cp_i[1];
      cp_z_mem[write_q[AW-1:0]] <= cp_i[2];
      write_q <= write_q + 1;
    end
    if (emit) done_q <= leave ? '0 : done_q | lowest;
    if (leave) read_q <= read_q + 1;
    if (rst_i) begin
      {write_q, read_q} <= '0;
      done_q <= '0;
    end
  end

`ifndef SYNTHESIS
  always_ff @(posedge clk_i)
    if (!rst_i) assert (!(keep && write_q - read_q == (AW + 1)'(DEPTH))) else $error("record_fifo: overfilled despite credits");
`endif
endmodule
