// Class of a word as a lane mask, without arithmetic: "fin" finite, "nan" a NaN, "pos" a number above zero (+inf too),
// "nze" not a zero.
// Latency: 0. Throughput: one result a lane a clock. Stall: none.
module fp_class #(
    parameter int EXP = 8,
    parameter int MAN = 23,
    parameter int LANES = 1,
    parameter OP = "fin",
    parameter ARITH = "rtl",
    localparam int CW = (1 + EXP + MAN <= 32) ? 32 : 64
) (
    input logic [LANES-1:0][CW-1:0] a_i,
    output logic [LANES-1:0][CW-1:0] m_o
);
  /*verilator inline_module*/
  localparam int CODE = (OP == "fin") ? 0 : (OP == "nan") ? 1 : (OP == "pos") ? 2 : 3;
  localparam logic [CW-1:0] SIGN = CW'(1) << (EXP + MAN);
  localparam logic [CW-1:0] INF = ((CW'(1) << EXP) - 1) << MAN;
  logic [LANES-1:0][CW-1:0] m;
`ifdef VERILATOR
  if (ARITH != "rtl" && CW == 32) begin : g_32
    always_comb begin
      m = '0;
      for (int l = 0; l < LANES; l++) m[l] = $c32("host_fp::classify<", CODE, ",", EXP, ",", MAN, ">(", a_i[l], ")");
    end
  end else
`endif
  if (1) begin : g_gates
    always_comb begin
      m = '0;
      for (int l = 0; l < LANES; l++)
        if (CODE == 0) m[l] = {CW{(a_i[l] & ~SIGN) < INF}};
        else if (CODE == 1) m[l] = {CW{(a_i[l] & ~SIGN) > INF}};
        else if (CODE == 2) m[l] = {CW{a_i[l] != '0 && a_i[l] <= INF}};
        else m[l] = {CW{(a_i[l] & ~SIGN) != '0}};
    end
  end
  assign m_o = m;
endmodule
