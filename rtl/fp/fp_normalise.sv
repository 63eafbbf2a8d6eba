// SPDX-License-Identifier: Apache-2.0
// Magnitude to a significand with its leading one at the top of the word and the biased exponent less one, which goes
// below zero for subnormals. COUNT = 0: subnormals stay as they are. Combinational.
module fp_normalise #(
    parameter int EXP   = 8,
    parameter int MAN   = 23,
    parameter bit COUNT = 1,
    localparam int CW   = (1 + EXP + MAN <= 32 && MAN <= 23) ? 32 : 64
) (
    input  logic [CW-1:0] mag_i,
    output logic [CW-1:0] s_o,
    output logic [CW-1:0] e_o
);
  /*verilator inline_module*/
`include "fp_mask.svh"
  logic [CW-1:0] e, hidden, s, n;
  always_comb begin
    e = mag_i >> MAN;
    hidden = (e + EMAX) >> EXP;  // 1 unless e is 0
    s = ((mag_i & FRAC) | (hidden << MAN)) << (CW - 1 - MAN);
  end
  if (COUNT) begin : g_count
    always_comb begin
      n = lzc(s);
      s_o = s << n[AB-1:0];
      e_o = e - hidden - n;
    end
  end else begin : g_as_is
    assign n = '0;
    assign s_o = s;
    assign e_o = e - hidden - n;
  end
endmodule
