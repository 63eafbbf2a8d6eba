// SPDX-License-Identifier: Apache-2.0
// Sign operations on a word (formats_pkg::SIGN_*), without logic beyond the sign bit. NaN is not special.
// Latency: 0.
// Throughput: one result per lane per cycle.
// Stall: none.
module fp_sign #(
    parameter  int EXP   = 8,
    parameter  int MAN   = 23,
    parameter  int LANES = 1,
    parameter  int B_LANES = LANES,  // 1: b is one value for all lanes
    parameter  int OP    = formats_pkg::SIGN_ABS,
    parameter      ARITH = "rtl",
    localparam int CW    = (1 + EXP + MAN <= 32) ? 32 : 64
) (
    input  logic [LANES-1:0][CW-1:0] a_i,
    input  logic [B_LANES-1:0][CW-1:0] b_i,  // used by SIGN_COPY and SIGN_XOR
    output logic [LANES-1:0][CW-1:0] r_o
);
  /*verilator inline_module*/
  if (OP < 0 || OP > formats_pkg::SIGN_XOR) $error("fp_sign: OP must be one of formats_pkg::SIGN_*");
  localparam logic [CW-1:0] SIGN = CW'(1) << (EXP + MAN);
  logic [LANES-1:0][CW-1:0] r;
  if (OP <= formats_pkg::SIGN_NEG) begin : g_one_operand
    logic unused_b;
    assign unused_b = &{1'b0, b_i};
  end
`ifdef VERILATOR
  // One call per lane, like the arithmetic around it: Verilator would merge bit operations of neighbouring lanes, which
  // then do not vectorise.
  if (ARITH != "rtl" && CW == 32) begin : g_32
    always_comb begin
      r = '0;
      for (int l = 0; l < LANES; l++)
        if (OP <= formats_pkg::SIGN_NEG) r[l] = $c32("host_fp::sign<", OP, ",", EXP, ",", MAN, ">(", a_i[l], ")");
        else r[l] = $c32("host_fp::sign<", OP, ",", EXP, ",", MAN, ">(", a_i[l], ",", b_i[l%B_LANES], ")");
    end
  end else
`endif
  if (1) begin : g_gates
    always_comb begin
      r = '0;
      for (int l = 0; l < LANES; l++)
        if (OP == formats_pkg::SIGN_ABS) r[l] = a_i[l] & ~SIGN;
        else if (OP == formats_pkg::SIGN_NEG) r[l] = a_i[l] ^ SIGN;
        else if (OP == formats_pkg::SIGN_COPY) r[l] = (a_i[l] & ~SIGN) | (b_i[l%B_LANES] & SIGN);
        else r[l] = a_i[l] ^ (b_i[l%B_LANES] & SIGN);
    end
  end
  assign r_o = r;
endmodule
