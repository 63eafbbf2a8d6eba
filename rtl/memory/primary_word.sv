// One word of the primary register file for all primaries: ROWS rows of LANES lanes (a block RAM a lane in hardware,
// replicated for every read port).
// Latency: 0 (reads are combinational, the operators behind register them). Throughput: one write and PORTS rows a clock.
module primary_word #(
    parameter int LANES = 1,
    parameter int ROWS = 256,
    parameter int CW = 32,
    parameter int PORTS = 1,
    localparam int ROW_W = (ROWS > 1) ? $clog2(ROWS) : 1,
    localparam int LANE_W = (LANES > 1) ? $clog2(LANES) : 1
) (
    input logic clk_i,
    input logic write_i,
    input logic [ROW_W-1:0] write_row_i,
    input logic [LANE_W-1:0] write_lane_i,
    input logic [CW-1:0] write_data_i,
    input logic [PORTS-1:0][ROW_W-1:0] row_i,
    output logic [PORTS-1:0][LANES-1:0][CW-1:0] data_o
);
  logic [LANES-1:0][CW-1:0] mem[ROWS];
  always_ff @(posedge clk_i) if (write_i) mem[write_row_i][write_lane_i] <= write_data_i;
  for (genvar p = 0; p < PORTS; p++) begin : port
    assign data_o[p] = mem[row_i[p]];
  end
endmodule
