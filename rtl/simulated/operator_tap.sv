// SPDX-License-Identifier: Apache-2.0
// Reports the operands and results of an operator, lane 0, to the model's harness in each cycle. It exists if CDE_TAP
// is defined (TAP=1 of the builder). r_i is the result of the operands of LAT cycles before. Where en_i is 0 no reader
// uses the result, and all reported words are ones.
// Latency: none.
// Throughput: one operation per cycle.
// Stall: none.
module operator_tap #(
    parameter int OP = formats_pkg::FP_ADD,
    parameter int CW = 32,
    parameter int LAT = 1  // 0: combinational
) (
    input logic clk_i,
    input logic en_i,
    input logic [CW-1:0] a_i,
    input logic [CW-1:0] b_i,
    input logic [CW-1:0] r_i
);
`ifdef CDE_TAP
  import "DPI-C" function int cde_tap_open(input string path, input int op, input int latency);
  import "DPI-C" function void cde_tap(input int index, input longint unsigned a, input longint unsigned b,
                                       input longint unsigned r);
  int index;
  string path;
  initial begin
    path = $sformatf("%m");
    index = cde_tap_open(path, OP, LAT);
  end
  always @(posedge clk_i) cde_tap(index, en_i ? 64'(a_i) : '1, en_i ? 64'(b_i) : '1, en_i ? 64'(r_i) : '1);
`else
  logic unused;
  assign unused = &{1'b0, clk_i, en_i, a_i, b_i, r_i, OP != LAT};
`endif
endmodule
