// SPDX-License-Identifier: Apache-2.0
// Box of a triangle for the box rule (reference/pipes/ray_box.hpp): centre c and half size h on every axis. In h is the
// margin 8 u max(|c| + h). If the triangle's normal is nothing but rounding, h is -infinity, which holds no point. The
// test for both products p, q of every component is |N_k| <= 4 u (|p| + e + |q|), with e the least normal number.
// Operators: 13 mul, 15 add, 12 sub, 3 compare, 14 min/max.
// Latency: RAY_T_CENTRE and RAY_T_HALF (ray_box.svh); 0 with ARITH = "host".
// Throughput: LANES triangles per cycle.
// Stall: none.
`include "ray_box.svh"
module triangle_bounds #(
    `DF_PARAMETERS
) (
    input logic clk_i,
    input logic [8:0][LANES-1:0][CW-1:0] b_i,  // v0 x y z, v1, v2
    output logic [2:0][LANES-1:0][CW-1:0] centre_o,
    output logic [2:0][LANES-1:0][CW-1:0] half_o
);
  /*verilator inline_module*/
  localparam logic [CW-1:0] MINUS_INF = ((CW'(1) << (EXP + 1)) - 1) << MAN;

  `DF_VIN(v0, b_i[2:0], 0)
  `DF_VIN(v1, b_i[5:3], 0)
  `DF_VIN(v2, b_i[8:6], 0)
  `DF_CONST(one_half, `DF_POWER_OF_TWO(-1))
  `DF_CONST(world, `DF_POWER_OF_TWO(2 - MAN))
  `DF_CONST(rounding, `DF_POWER_OF_TWO(1 - MAN))
  `DF_VCONST(least, CW'(1) << MAN, CW'(1) << MAN, CW'(1) << MAN)
  `DF_CONST(minus_inf, MINUS_INF)

  // ---- Box ----
  `DF_VMIN(low_01, v0, v1)
  `DF_VMIN(low, low_01, v2)
  `DF_VMAX(high_01, v0, v1)
  `DF_VMAX(high, high_01, v2)
  `DF_VADD(ends, low, high)
  `DF_VSCALE(centre, ends, one_half)
  `DF_VSUB(size, high, centre)
  `DF_VABS(away, centre)
  `DF_VADD(reach, away, size)
  `DF_PICK(reach_x, reach, 0)
  `DF_PICK(reach_y, reach, 1)
  `DF_PICK(reach_z, reach, 2)
  `DF_MAX(reach_xy, reach_x, reach_y)
  `DF_MAX(reach_most, reach_xy, reach_z)
  `DF_MUL(margin, reach_most, world)
  `DF_VEC(margins, margin, margin, margin)
  `DF_VADD(wide, size, margins)

  // ---- Normal: in component k the products of components k+1 and k+2 ----
  `DF_VSUB(e1, v1, v0)
  `DF_VSUB(e2, v2, v0)
  `DF_VIN(e1_i, {e1[0], e1[2], e1[1]}, T_e1)
  `DF_VIN(e1_j, {e1[1], e1[0], e1[2]}, T_e1)
  `DF_VIN(e2_i, {e2[0], e2[2], e2[1]}, T_e2)
  `DF_VIN(e2_j, {e2[1], e2[0], e2[2]}, T_e2)
  `DF_VMUL(p, e1_i, e2_j)
  `DF_VMUL(q, e1_j, e2_i)
  `DF_VSUB(n, p, q)
  `DF_VABS(n_size, n)
  `DF_VABS(p_size, p)
  `DF_VABS(q_size, q)
  `DF_VADD(p_least, p_size, least)
  `DF_VADD(terms, p_least, q_size)
  `DF_VSCALE(noise, terms, rounding)
  logic [2:0][LANES-1:0][CW-1:0] nothing;
  for (genvar k = 0; k < 3; k++) begin : component
    `DF_PICK(n_k, n_size, k)
    `DF_PICK(noise_k, noise, k)
    `DF_LE(nothing_k, n_k, noise_k)
    assign nothing[k] = nothing_k;
  end
  `DF_IN(flat, nothing[0] & nothing[1] & nothing[2], T_noise + LAT.cmp)

  `DF_VEC(none, minus_inf, minus_inf, minus_inf)
  `DF_VSELECT(half, flat, none, wide)
  if (T_centre != `RAY_T_CENTRE || T_half != `RAY_T_HALF) $error("triangle_bounds: ray_box.svh does not match");
  assign centre_o = centre;
  assign half_o = half;
endmodule
