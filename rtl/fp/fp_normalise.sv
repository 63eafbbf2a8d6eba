// SPDX-License-Identifier: Apache-2.0
// Magnitude to a significand with its leading one at the top of the word: count | shift. The output e_o is the biased
// exponent less one; it is negative for subnormals. COUNT = 0 leaves subnormals unnormalised.
// Latency: CUT cycles, 0..1.
// Throughput: one result per cycle.
// Stall: none.
module fp_normalise #(
    parameter int EXP   = 8,
    parameter int MAN   = 23,
    parameter bit LEAST = 0,
    parameter bit COUNT = 1,
    parameter int CUT   = 0,
    localparam int CW   = formats_pkg::lane_word(EXP, MAN, LEAST),
    localparam int EW   = formats_pkg::lane_exponent(EXP, MAN, LEAST)
) (
    input  logic          clk_i,
    input  logic [CW-1:0] mag_i,
    output logic [CW-1:0] s_o,
    output logic [EW-1:0] e_o
);
  /*verilator inline_module*/
`include "fp_mask.svh"
  logic [EW-1:0] e_c, hidden_c, e;
  logic [CW-1:0] s_c, s, n_c, n;
  always_comb begin
    e_c = EW'(mag_i >> MAN);
    hidden_c = hidden(e_c);
    s_c = ((mag_i & FRAC) | (CW'(hidden_c) << MAN)) << (CW - 1 - MAN);
  end
  pipe_reg #(CW, CUT) reg_s (.clk_i, .d_i(s_c), .q_o(s));
  pipe_reg #(EW, CUT) reg_e (.clk_i, .d_i(e_c - hidden_c), .q_o(e));
  logic unused_bits;
  assign unused_bits = &{1'b0, n};
  if (COUNT) begin : g_count
    assign n_c = lzc(s_c);
    pipe_reg #(CW, CUT) reg_n (.clk_i, .d_i(n_c), .q_o(n));
    assign s_o = s << n[AB-1:0];
    assign e_o = e - EW'(n);
  end else begin : g_as_is
    assign n_c = '0;
    assign n = n_c;
    assign s_o = s;
    assign e_o = e - EW'(n);
  end
endmodule
