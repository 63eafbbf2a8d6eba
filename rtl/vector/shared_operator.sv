// SPDX-License-Identifier: Apache-2.0
// Up to four operations of a datapath that takes a row per TURNS cycles. With four turns they share one operator, with
// two turns two operators, and with one turn each has its own. Operation k starts at stage time T_k. Operations that
// share an operator start in different turns (shared.svh).
// Latency: LAT cycles.
// Throughput: one result per operation per TURNS cycles.
// Stall: none.
module shared_operator #(
    parameter int EXP = 8,
    parameter int MAN = 23,
    parameter int OP = formats_pkg::FP_SUB,
    parameter logic [3:0] ADDS = '0,  // FP_SUB, bit k: operation k adds
    parameter int N = 4,              // operations
    parameter int T_0 = 0,
    parameter int T_1 = 0,
    parameter int T_2 = 0,
    parameter int T_3 = 0,
    parameter int LAT = 1,
    parameter int TURNS = 4,
    parameter ARITH = "rtl",  // "host": nothing is computed, and outputs are zeros
    localparam int CW = (1 + EXP + MAN <= 32) ? 32 : 64,
    localparam int TW = 2
) (
    input logic clk_i,
    input logic [TW-1:0] turn_i,
    input logic [3:0][CW-1:0] a_i,  // with the operation's start
    input logic [3:0][CW-1:0] b_i,
    output logic [3:0][CW-1:0] r_o
);
  /*verilator inline_module*/
  localparam logic [CW-1:0] SIGN = CW'(1) << (EXP + MAN);
  function automatic logic [TW-1:0] turn_of(input int k);
    turn_of = TW'((((k == 0) ? T_0 : (k == 1) ? T_1 : (k == 2) ? T_2 : T_3) + 1) % TURNS);
  endfunction
  logic [3:0][CW-1:0] b;
  for (genvar k = 0; k < 4; k++) begin : operand
    assign b[k] = ADDS[k] ? b_i[k] ^ SIGN : b_i[k];
  end
  for (genvar u = 0; u < 4 / TURNS; u++) begin : unit
    if (ARITH == "rtl" && u * TURNS < N) begin : g_present
      logic [CW-1:0] a_now, b_now, r, unused_flags;
      always_comb begin
        {a_now, b_now} = {a_i[u*TURNS], b[u*TURNS]};
        for (int k = 1; k < TURNS; k++)
          if (u * TURNS + k < N && turn_i == turn_of(u * TURNS + k)) {a_now, b_now} = {a_i[u*TURNS+k], b[u*TURNS+k]};
      end
      fp_lanes #(.OP(OP), .EXP(EXP), .MAN(MAN), .LAT(LAT), .CANON(0)) operator (
          .clk_i, .en_i(1'b1), .a_i(a_now), .b_i(b_now), .r_o(r), .flags_o(unused_flags));
      for (genvar k = 0; k < TURNS; k++) begin : result
        assign r_o[u*TURNS+k] = r;
      end
    end else begin : g_absent
      for (genvar k = 0; k < TURNS; k++) begin : result
        assign r_o[u*TURNS+k] = '0;
      end
    end
  end
  logic unused;
  assign unused = &{1'b0, clk_i, turn_i, a_i, b};
endmodule
