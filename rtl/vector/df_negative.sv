// SPDX-License-Identifier: Apache-2.0
// The sign bit of a word as a lane mask. Combinational.
module df_negative #(
    parameter int EXP = 8,
    parameter int MAN = 23,
    parameter int LANES = 1,
    parameter ARITH = "rtl",
    localparam int CW = (1 + EXP + MAN <= 32) ? 32 : 64
) (
    input logic [LANES-1:0][CW-1:0] a_i,
    output logic [LANES-1:0][CW-1:0] m_o
);
  /*verilator inline_module*/
  logic [LANES-1:0][CW-1:0] m;
`ifdef VERILATOR
  if (ARITH != "rtl" && CW == 32) begin : g_32
    always_comb begin
      m = '0;
      for (int l = 0; l < LANES; l++) m[l] = $c32("host_fp::negative<", EXP, ",", MAN, ">(", a_i[l], ")");
    end
  end else
`endif
  if (1) begin : g_gates
    always_comb begin
      m = '0;
      for (int l = 0; l < LANES; l++) m[l] = {CW{a_i[l][EXP+MAN]}};
    end
  end
  assign m_o = m;
endmodule
