// SPDX-License-Identifier: Apache-2.0
// Converts a number to another format in a datapath (dataflow.svh), rounded to nearest even.
// Latency: LAT cycles; 0 with ARITH = "host".
// Throughput: one result per lane per cycle.
// Stall: none.
module df_format #(
    parameter int EXP = 8,
    parameter int MAN = 23,
    parameter int TO_EXP = 5,
    parameter int TO_MAN = 10,
    parameter int LANES = 1,
    parameter int LAT = 1,
    parameter ARITH = "rtl",
    localparam int CW = formats_pkg::container(EXP, MAN),
    localparam int TO_CW = formats_pkg::container(TO_EXP, TO_MAN)
) (
    input logic clk_i,
    input logic [LANES-1:0][CW-1:0] a_i,
    output logic [LANES-1:0][TO_CW-1:0] r_o
);
  /*verilator inline_module*/
  if (ARITH == "rtl") begin : g_gates
    fp_convert #(.KIND(formats_pkg::CONVERT_FORMAT), .EXP(EXP), .MAN(MAN), .P(TO_EXP), .Q(TO_MAN), .CI(CW), .CO(TO_CW),
        .LANES(LANES), .LAT(LAT)) convert (.clk_i, .a_i, .r_o, .flags_o());
  end else begin : g_host
    logic unused_clk;
    assign unused_clk = clk_i;
`ifdef VERILATOR
    logic [LANES-1:0][TO_CW-1:0] r;
    always_comb begin
      r = '0;
      for (int l = 0; l < LANES; l++)
        if (TO_CW == 32) r[l] = TO_CW'($c32("host_fp::convert<", formats_pkg::CONVERT_FORMAT, ",", EXP, ",", MAN, ",",
            TO_EXP, ",", TO_MAN, ">(", a_i[l], ")"));
        else r[l] = TO_CW'($c64("host_fp::convert<", formats_pkg::CONVERT_FORMAT, ",", EXP, ",", MAN, ",", TO_EXP, ",",
            TO_MAN, ">(", a_i[l], ")"));
    end
    assign r_o = r;
`else
    $error("df_format: ARITH = \"host\" exists only under Verilator");
`endif
  end
endmodule
