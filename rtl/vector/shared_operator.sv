// SPDX-License-Identifier: Apache-2.0
// Up to eight operations of a datapath that takes a row per TURNS cycles. TURNS of them share an operator. Operation k
// starts at stage time TIMES[k]. Operations that share an operator start in different turns (shared.svh).
// Latency: LAT cycles.
// Throughput: one result per operation per TURNS cycles.
// Stall: none.
module shared_operator #(
    parameter int EXP = 8,
    parameter int MAN = 23,
    parameter int OP = formats_pkg::FP_SUB,
    parameter logic [7:0] ADDS = '0,  // FP_SUB, bit k: operation k adds
    parameter int N = 8,              // operations
    parameter logic [7:0][31:0] TIMES = '0,
    parameter int LAT = 1,
    parameter int TURNS = 4,
    parameter ARITH = "rtl",  // "host": nothing is computed, and outputs are zeros
    localparam int CW = (1 + EXP + MAN <= 32) ? 32 : 64,
    localparam int AW = (TURNS > 1) ? $clog2(TURNS) : 1
) (
    input logic clk_i,
    input logic [2:0] turn_i,
    input logic [7:0][CW-1:0] a_i,  // with the operation's start
    input logic [7:0][CW-1:0] b_i,
    output logic [7:0][CW-1:0] r_o
);
  /*verilator inline_module*/
  localparam logic [CW-1:0] SIGN = CW'(1) << (EXP + MAN);
  // The operation of an operator that starts in a turn, else its first.
  function automatic int started(input int operator, input int turn);
    started = operator * TURNS;
    for (int k = operator * TURNS; k < N && k < (operator + 1) * TURNS; k++)
      if ((int'(TIMES[k]) + 1) % TURNS == turn) started = k;
  endfunction
  logic [7:0][CW-1:0] b;
  for (genvar k = 0; k < 8; k++) begin : operand
    assign b[k] = ADDS[k] ? b_i[k] ^ SIGN : b_i[k];
  end
  for (genvar u = 0; u < 8 / TURNS; u++) begin : unit
    if (ARITH == "rtl" && u * TURNS < N) begin : g_present
      logic [CW-1:0] a_now, b_now, r, unused_flags;
      // The turn in which the first operation's operands are there.
      localparam int FIRST = (int'(TIMES[u*TURNS]) + 1) % TURNS;
      if (N == 1 || TURNS == 1) begin : g_one
        assign {a_now, b_now} = {a_i[u*TURNS], b[u*TURNS]};
      end else begin : g_turns
        // Turns since the first operation started. Few operators share the register, so wires are short.
        logic [AW-1:0] since_q;
        logic [TURNS-1:0][CW-1:0] a_of, b_of;
        always_ff @(posedge clk_i) since_q <= turn_i[AW-1:0] + AW'(TURNS + 1 - FIRST);
        for (genvar t = 0; t < TURNS; t++) begin : turn
          assign a_of[t] = a_i[started(u, (FIRST + t) % TURNS)];
          assign b_of[t] = b[started(u, (FIRST + t) % TURNS)];
        end
        assign {a_now, b_now} = {a_of[since_q], b_of[since_q]};
      end
      if (OP == formats_pkg::FP_DIV && TURNS > 1 && LAT > MAN + 8) begin : g_div_turns
        fp_div_turns #(.EXP(EXP), .MAN(MAN), .LAT(LAT), .TURNS(TURNS)) operator (
            .clk_i, .take_i(32'(turn_i) == FIRST), .a_i(a_now), .b_i(b_now), .r_o(r));
        assign unused_flags = '0;
      end else begin : g_each_cycle
        fp_lanes #(.OP(OP), .EXP(EXP), .MAN(MAN), .LAT(LAT), .CANON(0)) operator (
            .clk_i, .en_i(1'b1), .a_i(a_now), .b_i(b_now), .r_o(r), .flags_o(unused_flags));
      end
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
