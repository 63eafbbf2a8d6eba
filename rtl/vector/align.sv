// SPDX-License-Identifier: Apache-2.0
// Carries a value from stage time FROM to stage time TO: the delay line of a datapath, with its depth derived, not
// counted. Datapaths of the host back end have no stages, so there it is a wire.
// Latency: TO - FROM clocks; 0 with ARITH = "host". Throughput: one value a clock. Stall: none.
module align #(
    parameter int W = 1,     // >= 1
    parameter int FROM = 0,  // stage time of d_i
    parameter int TO = 0,    // stage time of q_o, >= FROM
    parameter ARITH = "rtl"
) (
    input logic clk_i,
    input logic [W-1:0] d_i,
    output logic [W-1:0] q_o
);
  /*verilator inline_module*/
  localparam int DEPTH = (ARITH != "rtl") ? 0 : TO - FROM;
  if (TO < FROM) begin : g_illegal
    $error("align: TO must not be before FROM");
  end
  if (DEPTH <= 0) begin : g_wire
    logic unused_clk;
    assign unused_clk = clk_i;
    assign q_o = d_i;
  end else begin : g_delay
    for (genvar s = 0; s < DEPTH; s++) begin : stage
      logic [W-1:0] d, q;
      always_ff @(posedge clk_i) q <= d;
    end
    assign stage[0].d = d_i;
    for (genvar s = 1; s < DEPTH; s++) begin : link
      assign stage[s].d = stage[s-1].q;
    end
    assign q_o = stage[DEPTH-1].q;
  end
endmodule
