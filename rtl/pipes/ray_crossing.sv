// SPDX-License-Identifier: Apache-2.0
// Output stage of a ray pipe against a solid. T is where the ray enters the solid if that is in [tmin, tmax], else
// where it leaves it. CP = o + t d. 3 mul, 3 add, 4 compare.
// Latency: T_ENTER_LEAVE + LAT.cmp + LAT.mul + LAT.add + 1, latency_o; 0 with ARITH = "host".
// Throughput: LANES pairs per cycle.
// Stall: none.
`include "pipe.svh"
module ray_crossing #(
    `DF_PARAMETERS,
    parameter int T_RAY = 0,  // stage times of the inputs
    parameter int T_ENTER_LEAVE = 0,
    parameter int T_MEETS = 0
) (
    input logic clk_i,
    input logic [7:0][LANES-1:0][CW-1:0] ray_i,  // o x y z, d x y z, tmin, tmax
    input logic [LANES-1:0][CW-1:0] enter_i,     // ray parameters
    input logic [LANES-1:0][CW-1:0] leave_i,
    input logic [LANES-1:0][CW-1:0] meets_i,  // lane mask: the ray's line meets the solid
    `RAY_OUTPUTS
);
  /*verilator inline_module*/
  `undef DF_CANON
  `define DF_CANON 0
  `DF_VIN(o, ray_i[2:0], T_RAY)
  `DF_VIN(d, ray_i[5:3], T_RAY)
  `DF_IN(tmin, ray_i[6], T_RAY)
  `DF_IN(tmax, ray_i[7], T_RAY)
  `DF_IN(enter, enter_i, T_ENTER_LEAVE)
  `DF_IN(leave, leave_i, T_ENTER_LEAVE)
  `DF_IN(meets, meets_i, T_MEETS)

  `DF_AT(tmin_late, tmin, T_ENTER_LEAVE)
  `DF_AT(tmax_late, tmax, T_ENTER_LEAVE)
  `DF_BETWEEN(enter_in, tmin_late, enter, tmax_late)
  `DF_BETWEEN(leave_in, tmin_late, leave, tmax_late)
  `DF_OR(in, enter_in, leave_in)
  `DF_AND(hit, meets, in)
  `DF_SELECT(t, enter_in, enter, leave)
  `DF_VSCALE(td, d, t)
  `DF_VADD(cp, o, td)

  `RAY_RESULT(hit, t, cp, 1)
  `undef DF_CANON
  `define DF_CANON 1
endmodule
