// SPDX-License-Identifier: Apache-2.0
// Nodes of a hierarchy, in memory of their own beside the units that read them: chips, or the device's. One port a
// reader, which in hardware is a copy each; what is written goes into all.
// Node n on the bus: its words 0 to 15 at byte 64 n, words 16 and 17 at 64 NODES + 8 n, so that no address is divided.
// Latency: 1 clock; what is read in the clock of a write is as it was. Throughput: a beat or a node written, and a node
// a reader, a clock. Stall: none.
module node_memory #(
    parameter int NODES = 4096,  // power of two
    parameter int READERS = 2,
    localparam int NW = $clog2(NODES)
) (
    input logic clk_write_i,  // runs for writes, and while nodes are refitted
    input logic write_i,
    input logic [31:0] addr_i,
    input logic [63:0] data_i,
    input logic refit_i,  // a whole node; not at the time of the other
    input logic [NW-1:0] refit_at_i,
    input logic [hierarchy_pkg::NODE_WORDS-1:0][31:0] refit_node_i,

    input logic clk_i,
    input logic [READERS-1:0][NW-1:0] at_i,
    output logic [READERS-1:0][hierarchy_pkg::NODE_WORDS-1:0][31:0] node_o
);
  localparam int WORDS = hierarchy_pkg::NODE_WORDS;
  if ((NODES & (NODES - 1)) != 0 || NODES > hierarchy_pkg::MOST_NODES) begin : g_nodes
    $error("node_memory: NODES must be a power of two, at most %0d", hierarchy_pkg::MOST_NODES);
  end
  logic [WORDS-1:0][31:0] nodes[NODES];
  logic last;
  assign last = addr_i[6+NW];
  logic unused;
  assign unused = &{1'b0, addr_i};
  always_ff @(posedge clk_write_i)
    if (refit_i) nodes[refit_at_i] <= refit_node_i;
    else if (write_i) begin
      if (last) nodes[addr_i[3+:NW]][WORDS-1:WORDS-2] <= data_i;
      else nodes[addr_i[6+:NW]][{addr_i[5:3], 1'b0}+:2] <= data_i;
    end
  for (genvar r = 0; r < READERS; r++) begin : reader
    always_ff @(posedge clk_i) node_o[r] <= nodes[at_i[r]];
`ifdef VERILATOR
    // The simulator has the node on its way before the clock that reads it.
    always_comb $c("host_fp::expect(", nodes, "[", at_i[r], "]);");
`endif
  end
endmodule
