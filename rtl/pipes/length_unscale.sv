// SPDX-License-Identifier: Apache-2.0
// Scales a pair's result back to the pair's own size (length_scale.sv): T and CP times 2^k. A ray's T is multiplied by
// 2^(k - kd) and rounded once. A ray whose T or CP overflows misses. Solids touch (F = 1) if T, at size one, is below
// the normal numbers. No other T becomes zero, so F and T agree.
// Latency: LAT.cmp, with a ray the larger of LAT.cmp and LAT.mul; 0 with ARITH = "host".
// Throughput: LANES pairs per cycle.
// Stall: none.
`include "dataflow.svh"
module length_unscale #(
    `DF_PARAMETERS,
    parameter bit RAY = 0
) (
    input logic clk_i,
    input logic en_i,  // 0: no reader uses the result
    input logic [LANES-1:0][CW-1:0] back_i,  // from length_scale.sv, together with the result
    input logic [LANES-1:0][CW-1:0] t_back_i,
    input logic [LANES-1:0][CW-1:0] f_i,
    input logic [LANES-1:0][CW-1:0] t_i,
    input logic [2:0][LANES-1:0][CW-1:0] cp_i,
    input logic [2:0][LANES-1:0][CW-1:0] n_i,
    output logic [LANES-1:0][CW-1:0] f_o,
    output logic [LANES-1:0][CW-1:0] t_o,
    output logic [2:0][LANES-1:0][CW-1:0] cp_o,
    output logic [2:0][LANES-1:0][CW-1:0] n_o
);
  /*verilator inline_module*/
  localparam int LATENCY = pairs_pkg::unscale_latency(RAY, LAT.mul, LAT.cmp);
  localparam int LW = LANES * CW;
  // Lengths are moved two cycles after the shift left its memory, so one register can merge into the memory.
  localparam int MOVE = (LATENCY > 2) ? 2 : LATENCY - 1;
  logic [LANES-1:0][CW-1:0] f, t, back;
  logic [2:0][LANES-1:0][CW-1:0] cp_in, cp, cp_late;
  pipe_delay #(.W(4 * LW), .FROM(0), .TO(MOVE), .ARITH(ARITH)) delay_in (
      .clk_i, .d_i({cp_i, back_i}), .q_o({cp_in, back}));
  pipe_delay #(.W(LW), .FROM(0), .TO(LATENCY), .ARITH(ARITH)) delay_f (.clk_i, .d_i(f_i), .q_o(f));
  pipe_delay #(.W(3 * LW), .FROM(0), .TO(LATENCY), .ARITH(ARITH)) delay_n (.clk_i, .d_i(n_i), .q_o(n_o));
  for (genvar k = 0; k < 3; k++) begin : axis
    fp_exponent #(.EXP(EXP), .MAN(MAN), .LANES(LANES), .OP(formats_pkg::EXPONENT_MOVE), .ARITH(ARITH))
        move (.en_i, .a_i(cp_in[k]), .b_i(back), .r_o(cp[k]));
  end
  pipe_delay #(.W(3 * LW), .FROM(MOVE), .TO(LATENCY), .ARITH(ARITH)) delay_cp (.clk_i, .d_i(cp), .q_o(cp_late));
  if (RAY) begin : g_ray
    localparam logic [CW-1:0] INF = ((CW'(1) << EXP) - 1) << MAN;
    logic [LANES-1:0][CW-1:0] finite, t_late, near_late;
    logic [2:0][LANES-1:0][CW-1:0] near;
    fp_mul #(.EXP(EXP), .MAN(MAN), .LANES(LANES), .LAT(LAT.mul), .ARITH(ARITH)) multiply (
        .clk_i, .a_i(t_i), .b_i(t_back_i), .r_o(t), .flags_o());
    pipe_delay #(.W(LW), .FROM(LAT.mul), .TO(LATENCY), .ARITH(ARITH)) delay_t (.clk_i, .d_i(t), .q_o(t_late));
    fp_class #(.EXP(EXP), .MAN(MAN), .LANES(LANES), .OP(formats_pkg::CLASS_FINITE), .ARITH(ARITH))
        is_finite (.a_i(t_late), .m_o(finite));
    for (genvar k = 0; k < 3; k++) begin : axis
      fp_class #(.EXP(EXP), .MAN(MAN), .LANES(LANES), .OP(formats_pkg::CLASS_FINITE), .ARITH(ARITH))
          is_finite (.a_i(cp_i[k]), .m_o(near[k]));
    end
    pipe_delay #(.W(LW), .FROM(0), .TO(LATENCY), .ARITH(ARITH)) delay_near (.clk_i, .d_i(near[0] & near[1] & near[2]),
        .q_o(near_late));
    assign f_o = f & finite & near_late;
    assign t_o = (t_late & f_o) | ({LANES{INF}} & ~f_o);
    assign cp_o = cp_late & {3{f_o}};
  end else begin : g_solid
    logic unused;
    assign unused = &{1'b0, t_back_i};
    logic [LANES-1:0][CW-1:0] t_in, apart, touches;
    pipe_delay #(.W(LW), .FROM(0), .TO(MOVE), .ARITH(ARITH)) delay_t_in (.clk_i, .d_i(t_i), .q_o(t_in));
    fp_exponent #(.EXP(EXP), .MAN(MAN), .LANES(LANES), .OP(formats_pkg::EXPONENT_MOVE), .KEEP(1),
        .ARITH(ARITH)) move_t (.en_i, .a_i(t_in), .b_i(back), .r_o(t));
    pipe_delay #(.W(LW), .FROM(MOVE), .TO(LATENCY), .ARITH(ARITH)) delay_t (.clk_i, .d_i(t), .q_o(t_o));
    fp_class #(.EXP(EXP), .MAN(MAN), .LANES(LANES), .OP(formats_pkg::CLASS_NONZERO), .ARITH(ARITH))
        is_apart (.a_i(t), .m_o(apart));
    pipe_delay #(.W(LW), .FROM(MOVE), .TO(LATENCY), .ARITH(ARITH)) delay_touches (.clk_i, .d_i(~apart), .q_o(touches));
    assign f_o = f | touches;
    assign cp_o = cp_late;
  end
endmodule
