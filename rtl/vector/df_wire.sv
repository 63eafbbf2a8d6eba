// SPDX-License-Identifier: Apache-2.0
// Bit operation of a datapath (dataflow.svh): moves a sign or combines masks, formats_pkg::WIRE_*.
// Latency: 0 from the later operand.
// Throughput: one result per lane per cycle.
// Stall: none.
module df_wire #(
    parameter int EXP = 8,
    parameter int MAN = 23,
    parameter int LANES = 1,
    parameter int OP = formats_pkg::WIRE_AND,
    parameter int T_A = 0,
    parameter int T_B = 0,
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
  df_pipe_delay #(.W(LANES * CW), .T_A(T_A), .T(T), .ARITH(ARITH)) delay_a (.clk_i, .a_i, .r_o(a));
  df_pipe_delay #(.W(LANES * CW), .T_A(T_B), .T(T), .ARITH(ARITH)) delay_b (.clk_i, .a_i(b_i), .r_o(b));
  if (OP == formats_pkg::WIRE_SIGN) begin : g_sign
    fp_sign #(.EXP(EXP), .MAN(MAN), .LANES(LANES), .OP(formats_pkg::SIGN_XOR), .ARITH(ARITH))
        sign (.a_i(a), .b_i(b), .r_o);
  end else if (OP == formats_pkg::WIRE_AND) begin : g_and
    assign r_o = a & b;
  end else if (OP == formats_pkg::WIRE_XOR) begin : g_exclusive
    assign r_o = a ^ b;
  end else if (OP == formats_pkg::WIRE_OR) begin : g_or
    assign r_o = a | b;
  end else begin : g_illegal
    $error("df_wire: unknown OP");
  end
endmodule
