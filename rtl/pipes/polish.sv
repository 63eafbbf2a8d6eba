// SPDX-License-Identifier: Apache-2.0
// One polishing step. `near` is about the point of B - A nearest the origin, `far` the point least in its direction.
// The distance along near.v is near.v.far.v / |near.v|. If that is less than |near.v| - `tie`, the result is the point
// nearest the origin on the segment between them, else near. In a point, v is the point of B - A, and p the point of A
// behind it.
// The slack is near's: |near.v| (|near.v| - the distance).
// Operators: 16 add, 13 mul, 1 div, 1 compare, 3 min/max.
// Latency: LATENCY_POLISH cycles from the latest input; 0 with ARITH = "host".
// Throughput: one point per lane per cycle.
// Stall: none.
`include "convex.svh"
module polish #(
    `DF_PARAMETERS,
    parameter int T_NEAR_V = 0,  // stage times of the inputs
    parameter int T_NEAR_P = 0,
    parameter int T_FAR_V = 0,
    parameter int T_FAR_P = 0,
    parameter int T_TIE = 0
) (
    input logic clk_i,
    input logic [2:0][LANES-1:0][CW-1:0] near_v_i,
    input logic [2:0][LANES-1:0][CW-1:0] near_p_i,
    input logic [2:0][LANES-1:0][CW-1:0] far_v_i,
    input logic [2:0][LANES-1:0][CW-1:0] far_p_i,
    input logic [LANES-1:0][CW-1:0] tie_i,
    output logic [2:0][LANES-1:0][CW-1:0] v_o,
    output logic [2:0][LANES-1:0][CW-1:0] p_o,
    output logic [LANES-1:0][CW-1:0] slack_o
);
  /*verilator inline_module*/
  localparam logic [CW-1:0] ONE = ((CW'(1) << (EXP - 1)) - 1) << MAN;
  `DF_VIN(near_v, near_v_i, T_NEAR_V)
  `DF_VIN(near_p, near_p_i, T_NEAR_P)
  `DF_VIN(far_v, far_v_i, T_FAR_V)
  `DF_VIN(far_p, far_p_i, T_FAR_P)
  `DF_IN(tie, tie_i, T_TIE)
  `DF_CONST(zero, 0)
  `DF_CONST(one, ONE)

  `DF_VSUB(e, far_v, near_v)
  `DF_DOT(near_e, near_v, e)
  `DF_NEG(along, near_e)
  `DF_VABS(sizes, near_v)
  `DF_PICK(size_x, sizes, 0)
  `DF_PICK(size_y, sizes, 1)
  `DF_PICK(size_z, sizes, 2)
  `DF_MAX(size_yz, size_y, size_z)
  `DF_MAX(size, size_x, size_yz)
  `DF_MUL(least, tie, size)
  `DF_LT(moves, least, along)
  `DF_DOT(ee, e, e)
  `DF_DIV(quotient, along, ee)
  `DF_MIN(limited, quotient, one)
  `DF_SELECT(step, moves, limited, zero)
  `DF_VSCALE(move_v, e, step)
  `DF_VADD(v, near_v, move_v)
  `DF_VSUB(e_p, far_p, near_p)
  `DF_VSCALE(move_p, e_p, step)
  `DF_VADD(p, near_p, move_p)

  localparam int T_OUT = `DF_MAX2(`DF_MAX3(T_NEAR_V, T_NEAR_P, T_TIE), `DF_MAX2(T_FAR_V, T_FAR_P)) + `LATENCY_POLISH;
  `DF_VAT(v_out, v, T_OUT)
  `DF_VAT(p_out, p, T_OUT)
  `DF_AT(slack, along, T_OUT)
  assign v_o = v_out;
  assign p_o = p_out;
  assign slack_o = slack;
endmodule
