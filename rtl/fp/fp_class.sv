// SPDX-License-Identifier: Apache-2.0
// Class of a word (formats_pkg::CLASS_*) as a lane mask, without arithmetic.
// Latency: 0.
// Throughput: one result per lane per cycle.
// Stall: none.
module fp_class #(
    parameter int EXP = 8,
    parameter int MAN = 23,
    parameter int LANES = 1,
    parameter int OP = formats_pkg::CLASS_FINITE,
    parameter ARITH = "rtl",
    localparam int CW = (1 + EXP + MAN <= 32) ? 32 : 64
) (
    input logic [LANES-1:0][CW-1:0] a_i,
    output logic [LANES-1:0][CW-1:0] m_o
);
  /*verilator inline_module*/
  localparam logic [CW-1:0] SIGN = CW'(1) << (EXP + MAN);
  localparam logic [CW-1:0] INF = ((CW'(1) << EXP) - 1) << MAN;
  logic [LANES-1:0][CW-1:0] m;
`ifdef VERILATOR
  if (ARITH != "rtl" && CW == 32) begin : g_32
    always_comb begin
      m = '0;
      for (int l = 0; l < LANES; l++) m[l] = $c32("host_fp::classify<", OP, ",", EXP, ",", MAN, ">(", a_i[l], ")");
    end
  end else
`endif
  if (1) begin : g_gates
    always_comb begin
      m = '0;
      for (int l = 0; l < LANES; l++)
        if (OP == formats_pkg::CLASS_FINITE) m[l] = {CW{(a_i[l] & ~SIGN) < INF}};
        else if (OP == formats_pkg::CLASS_NAN) m[l] = {CW{(a_i[l] & ~SIGN) > INF}};
        else if (OP == formats_pkg::CLASS_POSITIVE) m[l] = {CW{a_i[l] != '0 && a_i[l] <= INF}};
        else m[l] = {CW{(a_i[l] & ~SIGN) != '0}};
    end
  end
  assign m_o = m;
endmodule
