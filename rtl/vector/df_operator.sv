// One operator of a datapath (dataflow.svh): delays the early operand, then computes.
// Latency: LAT clocks from the later operand; 0 with ARITH = "host". Throughput: one result a lane a clock. Stall: none.
module df_operator #(
    parameter int EXP = 8,
    parameter int MAN = 23,
    parameter int LANES = 1,
    parameter OP = "add",  // add, sub, mul, div, sqr (of a_i), min, max, clt, cle, ceq
    parameter int T_A = 0,
    parameter int T_B = 0,
    parameter int LAT = 1,
    parameter ARITH = "rtl",
    localparam int CW = (1 + EXP + MAN <= 32) ? 32 : 64
) (
    input logic clk_i,
    input logic [LANES-1:0][CW-1:0] a_i,
    input logic [LANES-1:0][CW-1:0] b_i,
    output logic [LANES-1:0][CW-1:0] r_o
);
  /*verilator inline_module*/
  localparam int T = (T_A > T_B) ? T_A : T_B;
  logic [LANES-1:0][CW-1:0] a, b;
  df_align #(.W(LANES * CW), .T_A(T_A), .T(T), .ARITH(ARITH)) align_a (.clk_i, .a_i, .r_o(a));
  df_align #(.W(LANES * CW), .T_A(T_B), .T(T), .ARITH(ARITH)) align_b (.clk_i, .a_i(b_i), .r_o(b));
  if (OP == "add") begin : g_add
    fp_add #(.EXP(EXP), .MAN(MAN), .LANES(LANES), .LAT(LAT), .ARITH(ARITH)) cell_u (.clk_i, .a_i(a), .b_i(b), .r_o, .flags_o());
  end else if (OP == "sub") begin : g_sub
    fp_add #(.EXP(EXP), .MAN(MAN), .LANES(LANES), .LAT(LAT), .SUB(1), .ARITH(ARITH)) cell_u (.clk_i, .a_i(a), .b_i(b), .r_o, .flags_o());
  end else if (OP == "mul") begin : g_mul
    fp_mul #(.EXP(EXP), .MAN(MAN), .LANES(LANES), .LAT(LAT), .ARITH(ARITH)) cell_u (.clk_i, .a_i(a), .b_i(b), .r_o, .flags_o());
  end else if (OP == "div") begin : g_div
    fp_div #(.EXP(EXP), .MAN(MAN), .LANES(LANES), .LAT(LAT), .ARITH(ARITH)) cell_u (.clk_i, .a_i(a), .b_i(b), .r_o, .flags_o());
  end else if (OP == "sqr") begin : g_sqrt
    logic unused_b;
    assign unused_b = &{1'b0, b};
    fp_sqrt #(.EXP(EXP), .MAN(MAN), .LANES(LANES), .LAT(LAT), .ARITH(ARITH)) cell_u (.clk_i, .a_i(a), .r_o, .flags_o());
  end else if (OP == "min") begin : g_min
    fp_minmax #(.EXP(EXP), .MAN(MAN), .LANES(LANES), .LAT(LAT), .MAX(0), .ARITH(ARITH)) cell_u (.clk_i, .a_i(a), .b_i(b), .r_o, .flags_o());
  end else if (OP == "max") begin : g_max
    fp_minmax #(.EXP(EXP), .MAN(MAN), .LANES(LANES), .LAT(LAT), .MAX(1), .ARITH(ARITH)) cell_u (.clk_i, .a_i(a), .b_i(b), .r_o, .flags_o());
  end else if (OP == "clt") begin : g_lt
    fp_cmp #(.EXP(EXP), .MAN(MAN), .LANES(LANES), .LAT(LAT), .OP("lt"), .ARITH(ARITH)) cell_u (.clk_i, .a_i(a), .b_i(b), .m_o(r_o), .flags_o());
  end else if (OP == "cle") begin : g_le
    fp_cmp #(.EXP(EXP), .MAN(MAN), .LANES(LANES), .LAT(LAT), .OP("le"), .ARITH(ARITH)) cell_u (.clk_i, .a_i(a), .b_i(b), .m_o(r_o), .flags_o());
  end else if (OP == "ceq") begin : g_eq
    fp_cmp #(.EXP(EXP), .MAN(MAN), .LANES(LANES), .LAT(LAT), .OP("eq"), .ARITH(ARITH)) cell_u (.clk_i, .a_i(a), .b_i(b), .m_o(r_o), .flags_o());
  end else begin : g_illegal
    $error("df_operator: unknown OP");
  end
endmodule
