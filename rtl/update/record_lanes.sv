// What record_fifo keeps of one lane group: T and CP of the rows in the FIFO.
// Latency: 1 clock. Throughput: one row written, one lane read a clock. Stall: none.
module record_lanes #(
    parameter int CW = 32,
    parameter int LANES = 16,
    parameter int DEPTH = 32,
    localparam int AW = $clog2(DEPTH),
    localparam int LANE_W = (LANES > 1) ? $clog2(LANES) : 1
) (
    input logic clk_i,
    input logic push_i,
    input logic [AW-1:0] write_i,
    input logic [LANES-1:0][CW-1:0] t_i,
    input logic [LANES-1:0][CW-1:0] cp_x_i,
    input logic [LANES-1:0][CW-1:0] cp_y_i,
    input logic [LANES-1:0][CW-1:0] cp_z_i,
    input logic read_i,  // zeros while low
    input logic [AW-1:0] head_i,
    input logic [LANE_W-1:0] lane_i,
    output logic [CW-1:0] t_o,
    output logic [2:0][CW-1:0] cp_o
);
  /*verilator inline_module*/
  logic [3:0][LANES-1:0][CW-1:0] mem[DEPTH];  // T, CP
  always_ff @(posedge clk_i)
    if (push_i) mem[write_i] <= {cp_z_i, cp_y_i, cp_x_i, t_i};
  always_comb begin
    t_o = '0;
    cp_o = '0;
    if (read_i) begin
      t_o = mem[head_i][0][lane_i];
      for (int k = 0; k < 3; k++) cp_o[k] = mem[head_i][1+k][lane_i];
    end
  end
endmodule
