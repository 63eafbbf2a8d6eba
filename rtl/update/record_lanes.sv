// SPDX-License-Identifier: Apache-2.0
// Data of record_fifo in one lane group: T, CP and, with normals, n of the rows in the FIFO.
// Latency: 2 cycles: a row that is written is not read in the same cycle.
// Throughput: one row written and one lane read per cycle.
// Stall: none.
module record_lanes #(
    parameter int CW = 32,
    parameter int LANES = 16,
    parameter int DEPTH = 32,
    parameter int POINTS = 3,  // words beside T
    localparam int AW = $clog2(DEPTH),
    localparam int LANE_W = (LANES > 1) ? $clog2(LANES) : 1
) (
    input logic clk_i,
    input logic push_i,
    input logic [AW-1:0] write_i,
    input logic [LANES-1:0][CW-1:0] t_i,
    input logic [POINTS-1:0][LANES-1:0][CW-1:0] point_i,
    input logic read_i,  // low: outputs are zeros
    input logic [AW-1:0] head_i,
    input logic [LANE_W-1:0] lane_i,
    output logic [CW-1:0] t_o,
    output logic [POINTS-1:0][CW-1:0] point_o
);
  /*verilator inline_module*/
  (* no_rw_check *) logic [LANES-1:0][CW-1:0] t_mem[DEPTH];
  always_ff @(posedge clk_i) if (push_i) t_mem[write_i] <= t_i;
  always_comb begin  // not a ternary, so that simulation reads the row only if needed
    t_o = '0;
    if (read_i) t_o = t_mem[head_i][lane_i];
  end
  for (genvar k = 0; k < POINTS; k++) begin : point
    (* no_rw_check *) logic [LANES-1:0][CW-1:0] mem[DEPTH];
    always_ff @(posedge clk_i) if (push_i) mem[write_i] <= point_i[k];
    always_comb begin
      point_o[k] = '0;
      if (read_i) point_o[k] = mem[head_i][lane_i];
    end
  end
endmodule
