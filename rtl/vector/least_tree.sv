// SPDX-License-Identifier: Apache-2.0
// The payload with the least key, by a balanced tree over neighbours (0,1), (2,3), ...; an odd last one goes up
// unchanged. Ties, and comparisons with a NaN key, go to the lower index. COUNT - 1 compare.
// Latency: $clog2(COUNT) * LAT.cmp cycles; 0 with ARITH = "host".
// Throughput: one choice per lane per cycle.
// Stall: none.
module least_tree #(
    parameter int EXP = 8,
    parameter int MAN = 23,
    parameter int LANES = 1,
    parameter int COUNT = 2,  // >= 2
    parameter int WORDS = 1,  // words of a payload, >= 1
    parameter latency_pkg::latency_t LAT = latency_pkg::ONES,
    parameter ARITH = "rtl",
    localparam int CW = (1 + EXP + MAN <= 32) ? 32 : 64
) (
    input logic clk_i,
    input logic [COUNT-1:0][LANES-1:0][CW-1:0] key_i,
    input logic [COUNT-1:0][WORDS-1:0][LANES-1:0][CW-1:0] payload_i,
    output logic [LANES-1:0][CW-1:0] key_o,
    output logic [WORDS-1:0][LANES-1:0][CW-1:0] payload_o
);
  /*verilator inline_module*/
  localparam int LEVELS = $clog2(COUNT);
  for (genvar level = 0; level <= LEVELS; level++) begin : g_level
    localparam int HERE = (COUNT + 2 ** level - 1) >> level;
    for (genvar k = 0; k < HERE; k++) begin : g_node
      logic [WORDS:0][LANES-1:0][CW-1:0] best;  // key, then payload
      if (level == 0) begin : g_leaf
        assign best = {payload_i[k], key_i[k]};
      end else begin : g_inner
        localparam int BELOW = (COUNT + 2 ** (level - 1) - 1) >> (level - 1);
        logic [WORDS:0][LANES-1:0][CW-1:0] low;
        pipe_delay #(.W((WORDS + 1) * LANES * CW), .FROM(0), .TO(LAT.cmp), .ARITH(ARITH)) delay_low (
            .clk_i, .d_i(g_level[level-1].g_node[2*k].best), .q_o(low));
        if (2 * k + 1 < BELOW) begin : g_choice
          logic [WORDS:0][LANES-1:0][CW-1:0] high;
          logic [LANES-1:0][CW-1:0] take;
          pipe_delay #(.W((WORDS + 1) * LANES * CW), .FROM(0), .TO(LAT.cmp), .ARITH(ARITH)) delay_high (
              .clk_i, .d_i(g_level[level-1].g_node[2*k+1].best), .q_o(high));
          fp_cmp #(.EXP(EXP), .MAN(MAN), .LANES(LANES), .LAT(LAT.cmp), .OP(formats_pkg::FP_LT), .ARITH(ARITH))
              cmp_keys (
              .clk_i, .a_i(g_level[level-1].g_node[2*k+1].best[0]), .b_i(g_level[level-1].g_node[2*k].best[0]),
              .m_o(take), .flags_o());
          lane_select #(.CW(CW), .LANES(LANES), .WORDS(WORDS + 1)) select (.m_i(take), .a_i(high), .b_i(low),
              .r_o(best));
        end else begin : g_odd
          assign best = low;
        end
      end
    end
  end
  assign {payload_o, key_o} = g_level[LEVELS].g_node[0].best;
endmodule
