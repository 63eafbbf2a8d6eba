// SPDX-License-Identifier: Apache-2.0
// Output stage of a ray pipe: T and CP of a hit; T = +inf and CP = 0 for a miss. All outputs are registered together.
// A hit needs a finite T and CP. Its T is never -0.
// Latency: to stage time LATENCY; 0 with ARITH = "host".
// Throughput: LANES pairs per cycle.
// Stall: none.
`include "dataflow.svh"
module ray_result #(
    `DF_PARAMETERS,
    parameter int T_HIT = 0,  // stage times of the inputs
    parameter int T_T = 0,
    parameter int T_CP = 0,
    parameter int LATENCY = 1,  // stage time of the outputs: after all inputs
    parameter int FINITE = 1  // 0: hits are known to be finite; 1: cp is o + t d, and checked; 2: cp and t are checked
) (
    input logic clk_i,
    input logic [LANES-1:0][CW-1:0] hit_i,  // lane mask
    input logic [LANES-1:0][CW-1:0] t_i,
    input logic [2:0][LANES-1:0][CW-1:0] cp_i,
    output logic [LANES-1:0][CW-1:0] f_o,
    output logic [LANES-1:0][CW-1:0] t_o,
    output logic [2:0][LANES-1:0][CW-1:0] cp_o
);
  /*verilator inline_module*/
  localparam logic [CW-1:0] INF = ((CW'(1) << EXP) - 1) << MAN;
  localparam int T_SELECT = LATENCY - 1;

  `DF_IN(hit, hit_i, T_HIT)
  `DF_IN(t, t_i, T_T)
  `DF_VIN(cp, cp_i, T_CP)
  `DF_CONST(inf, INF)
  `DF_VCONST(origin, 0, 0, 0)

  `define CDE_CLASS(NAME, OPERATION, A, M) \
    fp_class #(.EXP(EXP), .MAN(MAN), .LANES(LANES), .OP(OPERATION), .ARITH(ARITH)) NAME (.a_i(A), .m_o(M));
  logic [3:0][LANES-1:0][CW-1:0] is_finite;
  logic [LANES-1:0][CW-1:0] not_zero;
  for (genvar k = 0; k < 4; k++) begin : word
    if (FINITE == 2 || (FINITE == 1 && k < 3)) begin : g_look
      logic [LANES-1:0][CW-1:0] x;
      assign x = (k < 3) ? cp[k%3] : t;
      `CDE_CLASS(finite, formats_pkg::CLASS_FINITE, x, is_finite[k])
    end else begin : g_known
      assign is_finite[k] = '1;
    end
  end
  `CDE_CLASS(t_zero, formats_pkg::CLASS_NONZERO, t, not_zero)
  `undef CDE_CLASS
  `DF_IN(finite_cp, is_finite[0] & is_finite[1] & is_finite[2], T_CP)
  `DF_IN(finite_t, is_finite[3], T_T)
  `DF_IN(t_signed, t & not_zero, T_T)
  `DF_AND(met, hit, finite_cp)
  `DF_AND(answered, met, finite_t)

  `DF_AT(f, answered, T_SELECT)
  `DF_SELECT(t_hit, f, t_signed, inf)
  `DF_VSELECT(cp_hit, f, cp, origin)
  `DF_AT(f_late, f, LATENCY)
  `DF_AT(t_late, t_hit, LATENCY)
  `DF_VAT(cp_late, cp_hit, LATENCY)
  assign {f_o, t_o, cp_o} = {f_late, t_late, cp_late};
endmodule
