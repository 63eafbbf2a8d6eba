// Sign of a word, free of gates: "abs" |a|, "neg" -a, "cpy" |a| with the sign of b, "xor" a times the sign of b. NaN is
// not special.
// Latency: 0. Throughput: one result a lane a clock. Stall: none.
module fp_sign #(
    parameter  int EXP   = 8,
    parameter  int MAN   = 23,
    parameter  int LANES = 1,
    parameter  int B_LANES = LANES,  // 1: b is one value for all lanes
    parameter      OP    = "abs",
    parameter      ARITH = "rtl",
    localparam int CW    = (1 + EXP + MAN <= 32) ? 32 : 64
) (
    input  logic [LANES-1:0][CW-1:0] a_i,
    input  logic [B_LANES-1:0][CW-1:0] b_i,  // "cpy" and "xor"
    output logic [LANES-1:0][CW-1:0] r_o
);
  /*verilator inline_module*/
  if (OP != "abs" && OP != "neg" && OP != "cpy" && OP != "xor") $error("fp_sign: OP must be abs, neg, cpy or xor");
  localparam logic [CW-1:0] SIGN = CW'(1) << (EXP + MAN);
  localparam int CODE = (OP == "abs") ? 0 : (OP == "neg") ? 1 : (OP == "cpy") ? 2 : 3;
  logic [LANES-1:0][CW-1:0] r;
  if (CODE < 2) begin : g_one_operand
    logic unused_b;
    assign unused_b = &{1'b0, b_i};
  end
`ifdef VERILATOR
  // A call a lane, as the arithmetic around it: Verilator would join bit operations of neighbouring lanes, which then
  // vectorise no more.
  if (ARITH != "rtl" && CW == 32) begin : g_32
    always_comb begin
      r = '0;
      for (int l = 0; l < LANES; l++)
        if (CODE < 2) r[l] = $c32("host_fp::sign<", CODE, ",", EXP, ",", MAN, ">(", a_i[l], ")");
        else r[l] = $c32("host_fp::sign<", CODE, ",", EXP, ",", MAN, ">(", a_i[l], ",", b_i[l%B_LANES], ")");
    end
  end else
`endif
  if (1) begin : g_gates
    always_comb begin
      r = '0;
      for (int l = 0; l < LANES; l++)
        if (CODE == 0) r[l] = a_i[l] & ~SIGN;
        else if (CODE == 1) r[l] = a_i[l] ^ SIGN;
        else if (CODE == 2) r[l] = (a_i[l] & ~SIGN) | (b_i[l%B_LANES] & SIGN);
        else r[l] = a_i[l] ^ (b_i[l%B_LANES] & SIGN);
    end
  end
  assign r_o = r;
endmodule
