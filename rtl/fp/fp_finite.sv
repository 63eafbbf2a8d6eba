// SPDX-License-Identifier: Apache-2.0
// Lane mask: all three components of a vector are finite. No arithmetic.
// Latency: 0.
// Throughput: one result per lane per cycle.
// Stall: none.
module fp_finite #(
    parameter int EXP = 8,
    parameter int MAN = 23,
    parameter int LANES = 1,
    parameter ARITH = "rtl",
    localparam int CW = (1 + EXP + MAN <= 32) ? 32 : 64
) (
    input logic [2:0][LANES-1:0][CW-1:0] a_i,
    output logic [LANES-1:0][CW-1:0] m_o
);
  /*verilator inline_module*/
  logic [LANES-1:0][CW-1:0] m;
`ifdef VERILATOR
  if (ARITH != "rtl" && CW == 32) begin : g_32
    always_comb begin
      m = '0;
      for (int l = 0; l < LANES; l++)
        m[l] = $c32("host_fp::all_finite<", EXP, ",", MAN, ">(", a_i[0][l], ",", a_i[1][l], ",", a_i[2][l], ")");
    end
  end else
`endif
  if (1) begin : g_gates
    always_comb begin
      m = '0;
      for (int l = 0; l < LANES; l++)
        m[l] = {CW{!(&a_i[0][l][EXP+MAN-1:MAN] || &a_i[1][l][EXP+MAN-1:MAN] || &a_i[2][l][EXP+MAN-1:MAN])}};
    end
  end
  assign m_o = m;
endmodule
