// SPDX-License-Identifier: Apache-2.0
// Lane mask: 2^LOW <= |a| <= 2^HIGH, or with SIGNED 2^LOW <= a <= 2^HIGH. It is false for a NaN.
// Latency: 0.
// Throughput: one result per lane per cycle.
// Stall: none.
module fp_range #(
    parameter int EXP = 8,
    parameter int MAN = 23,
    parameter int LANES = 1,
    parameter bit SIGNED = 0,
    parameter bit ZERO = 0,  // 1: no lower limit
    parameter int LOW = 0,   // LOW and HIGH are exponents of normal numbers
    parameter int HIGH = 0,
    parameter ARITH = "rtl",
    localparam int CW = (1 + EXP + MAN <= 32) ? 32 : 64
) (
    input logic en_i,  // 0: no reader uses the result, so host arithmetic may skip it
    input logic [LANES-1:0][CW-1:0] a_i,
    output logic [LANES-1:0][CW-1:0] m_o
);
  /*verilator inline_module*/
  localparam int BIAS = (1 << (EXP - 1)) - 1;
  localparam int LEAST = ZERO ? 0 : LOW + BIAS;  // stored exponents
  localparam int MOST = HIGH + BIAS;
  if (LEAST < 0 || (!ZERO && LEAST == 0) || MOST > 2 * BIAS)
      $error("fp_range: LOW and HIGH must be exponents of normal numbers");
  localparam logic [CW-1:0] MASK = SIGNED ? '1 : (CW'(1) << (EXP + MAN)) - 1;
  logic [LANES-1:0][CW-1:0] m;
`ifdef VERILATOR
  if (ARITH != "rtl" && CW == 32) begin : g_32
    always_comb begin
      m = '0;
      if (en_i)
        for (int l = 0; l < LANES; l++)
        m[l] = $c32("host_fp::within<", EXP, ",", MAN, ",", 32'(SIGNED), ",", LEAST, ",", MOST, ">(", a_i[l], ")");
    end
  end else
`endif
  if (ZERO) begin : g_gates_below
    logic unused_en;
    assign unused_en = en_i;
    always_comb begin
      m = '0;
      for (int l = 0; l < LANES; l++) m[l] = {CW{(a_i[l] & MASK) <= (CW'(MOST) << MAN)}};
    end
  end else begin : g_gates
    logic unused_en;
    assign unused_en = en_i;
    always_comb begin
      m = '0;
      for (int l = 0; l < LANES; l++)
        m[l] = {CW{(a_i[l] & MASK) >= (CW'(LEAST) << MAN) && (a_i[l] & MASK) <= (CW'(MOST) << MAN)}};
    end
  end
  assign m_o = m;
endmodule
