// SPDX-License-Identifier: Apache-2.0
// Memory of the record ring on chip, in place of SRAM chips.
// Latency: 1 cycle.
// Throughput: one record written and one read per cycle.
// Stall: none.
module record_memory #(
    parameter int W = 224,
    parameter int RECORDS = 512,  // power of two
    localparam int AW = $clog2(RECORDS)
) (
    input logic clk_i,
    input logic write_i,
    input logic [AW-1:0] write_addr_i,
    input logic [W-1:0] write_data_i,
    input logic read_i,
    input logic [AW-1:0] read_addr_i,
    output logic [W-1:0] read_data_o  // held until the next read
);
  (* no_rw_check *) logic [W-1:0] records[RECORDS];  // no record is read before it is written
  always_ff @(posedge clk_i) begin
    if (write_i) records[write_addr_i] <= write_data_i;
    if (read_i) read_data_o <= records[read_addr_i];
  end
`ifndef SYNTHESIS
  always_ff @(posedge clk_i)
    assert (!(write_i && read_i && write_addr_i == read_addr_i)) else $error("record_memory: read and written at once");
`endif
endmodule
