// SPDX-License-Identifier: Apache-2.0
// The lane of ray_triangle_moller.sv with the box rule, for rows that come once per TURNS cycles. Its operations share
// operators, in the same order and with the same bits. Host arithmetic computes as ray_triangle_moller.sv.
// Operators with four turns: 11 mul, 1 div, 14 add, 29 compare; with two turns 22, 1, 28 and 29.
// Latency: LATENCY cycles; 0 with ARITH = "host".
// Throughput: one row per TURNS cycles. A row enters in turn 0.
// Stall: none, runs free.
`include "ray_box.svh"
`include "shared.svh"
module ray_triangle_shared #(
    parameter int TURNS = 4,  // 1, 2 or 4
    parameter latency_pkg::latency_t LAT = latency_pkg::ONES,
    parameter ARITH = "rtl",
    localparam int EXP = 8,
    localparam int MAN = 23,
    localparam int CW = 32
) (
    input logic clk_i,
    input logic [1:0] turn_i,
    input logic [7:0][31:0] a_i,  // ray: o x y z, d x y z, tmin, tmax; in turn 0
    input logic [8:0][31:0] b_i,  // triangle: v0 x y z, v1, v2
    output logic [31:0] f_o,      // LATENCY cycles after turn 0, for one cycle
    output logic [31:0] t_o,
    output logic [2:0][31:0] cp_o,
    output logic [15:0] latency_o  // constant: LATENCY, also with ARITH = "host"
);
  localparam logic [31:0] INF = 32'h7f80_0000, MINUS_INF = 32'hff80_0000;
  if (TURNS != 1 && TURNS != 2 && TURNS != 4) $error("ray_triangle_shared: TURNS must be 1, 2 or 4");

  `SH_FUNCTIONS
  // ---- Operands, and constants ----
  logic [7:0][31:0] ray;
  logic [8:0][31:0] triangle;
  if (ARITH == "rtl") begin : g_gates
    always_ff @(posedge clk_i) if (turn_i == '0) {ray, triangle} <= {a_i, b_i};
  end else begin : g_host
    assign {ray, triangle} = '0;
    logic unused_clk;
    assign unused_clk = &{1'b0, clk_i, turn_i};
  end
  `SH_CONST(zero, 0)
  `SH_CONST(one_half, `DF_POWER_OF_TWO(-1))
  `SH_CONST(world_share, `DF_POWER_OF_TWO(2 - MAN))
  `SH_CONST(rounding, `DF_POWER_OF_TWO(1 - MAN))
  `SH_CONST(least, CW'(1) << MAN)
  `SH_CONST(part, `DF_POWER_OF_TWO(5 - MAN))
  `define CDE_EACH(DO) `DO(x, 0) `DO(y, 1) `DO(z, 2)
  `define CDE_OPERANDS(K, I) `SH_IN(o_``K, ray[I], 0) `SH_IN(d_``K, ray[3+I], 0) `SH_IN(v0_``K, triangle[I], 0) \
    `SH_IN(v1_``K, triangle[3+I], 0) `SH_IN(v2_``K, triangle[6+I], 0)
  `CDE_EACH(CDE_OPERANDS)
  `SH_IN(tmin, ray[6], 0)
  `SH_IN(tmax, ray[7], 0)

  // ---- Edges, o - v0, and the sum of the box's ends ----
  `define CDE_EDGES(K, I) \
    `SH_MIN(low_01_``K, v0_``K, v1_``K) `SH_MIN(low_``K, low_01_``K, v2_``K) \
    `SH_MAX(high_01_``K, v0_``K, v1_``K) `SH_MAX(high_``K, high_01_``K, v2_``K) \
    `SH_SUMS4(4'b1000, e1_``K, v1_``K, v0_``K, e2_``K, v2_``K, v0_``K, s_``K, o_``K, v0_``K, \
        ends_``K, low_``K, high_``K)
  `CDE_EACH(CDE_EDGES)

  // ---- P = D x E2, Q = S x E1; the box's centre and size, and how far it reaches ----
  `define CDE_CROSS(K, I, J) \
    `SH_MULS4(p1_``K, d_``I, e2_``J, p2_``K, d_``J, e2_``I, q1_``K, s_``I, e1_``J, q2_``K, s_``J, e1_``I)
  `CDE_CROSS(x, y, z)
  `CDE_CROSS(y, z, x)
  `CDE_CROSS(z, x, y)
  `SH_START(centre_x, 0, LAT.mul, ends_x, one_half, 0, 0, 0)
  `SH_START(centre_y, 1, LAT.mul, ends_y, one_half, N_centre_x, 0, 0)
  `SH_START(centre_z, 2, LAT.mul, ends_z, one_half, N_centre_x, N_centre_y, 0)
  `define CDE_DIFFERENCES(K, I) \
    `SH_ABS(away_``K, centre_``K) \
    `SH_SUMS4(4'b1000, p_``K, p1_``K, p2_``K, q_``K, q1_``K, q2_``K, size_``K, high_``K, centre_``K, \
        reach_``K, away_``K, size_``K)
  `CDE_EACH(CDE_DIFFERENCES)
  `SH_MAX(reach_xy, reach_x, reach_y)
  `SH_MAX(reach_most, reach_xy, reach_z)
  `SH_START(margin, 3, LAT.mul, reach_most, world_share, N_centre_x, N_centre_y, N_centre_z)
  `SH_GROUP(centre_x, formats_pkg::FP_MUL, 4'b0000, 4, LAT.mul, centre_x, centre_y, centre_z, margin)
  assign {margin, centre_z, centre_y, centre_x} = group_centre_x;

  // ---- det = P.E1, u = P.S, v = Q.D, tn = Q.E2 ----
  `define CDE_PRODUCTS(K, I) \
    `SH_MULS4(det_``K, p_``K, e1_``K, u_``K, p_``K, s_``K, v_``K, q_``K, d_``K, tn_``K, q_``K, e2_``K)
  `CDE_EACH(CDE_PRODUCTS)
  `SH_SUMS4(4'b1111, det_xy, det_x, det_y, u_xy, u_x, u_y, v_xy, v_x, v_y, tn_xy, tn_x, tn_y)
  `SH_SUMS4(4'b1111, det, det_xy, det_z, u, u_xy, u_z, v, v_xy, v_z, tn, tn_xy, tn_z)

  // ---- Distance and point; u + v ----
  `SH_OP(t, formats_pkg::FP_DIV, LAT.div, tn, det)
  `SH_MULS3(td_x, d_x, t, td_y, d_y, t, td_z, d_z, t)
  `SH_SUMS4(4'b1111, uv, u, v, cp_x, o_x, td_x, cp_y, o_y, td_y, cp_z, o_z, td_z)

  // ---- Inside test against |det| ----
  `SH_ABS(whole, det)
  `SH_MOVE_SIGN(u_side, det, u)
  `SH_MOVE_SIGN(v_side, det, v)
  `SH_MOVE_SIGN(uv_side, det, uv)
  `SH_LE(u_low, zero, u_side)
  `SH_LE(u_high, u_side, whole)
  `SH_LE(v_low, zero, v_side)
  `SH_LE(v_high, v_side, whole)
  `SH_LT(not_flat, zero, whole)
  `SH_LE(uv_high, uv_side, whole)
  `SH_LE(t_low, tmin, t)
  `SH_LE(t_high, t, tmax)
  `SH_BOTH(in_u, u_low, u_high)
  `SH_BOTH(in_v, v_low, v_high)
  `SH_BOTH(in_sides, in_u, in_v)
  `SH_BOTH(in_edges, in_sides, not_flat)
  `SH_BOTH(in_triangle, in_edges, uv_high)
  `SH_BOTH(in_range, t_low, t_high)
  `SH_BOTH(met, in_triangle, in_range)

  // ---- Box rule, as triangle_bounds.sv and ray_box.sv: E1 x E2 against its rounding, and the box's margin ----
  `SH_MULS3(n1_x, e1_y, e2_z, n1_y, e1_z, e2_x, n1_z, e1_x, e2_y)
  `SH_MULS3(n2_x, e1_z, e2_y, n2_y, e1_x, e2_z, n2_z, e1_y, e2_x)
  `define CDE_NORMAL(K, I) \
    `SH_ABS(n1_size_``K, n1_``K) `SH_ABS(n2_size_``K, n2_``K) \
    `SH_SUMS4(4'b1110, n_``K, n1_``K, n2_``K, floor_``K, n1_size_``K, least, terms_``K, floor_``K, n2_size_``K, \
        wide_``K, size_``K, margin) \
    `SH_ABS(n_size_``K, n_``K) `SH_ABS(td_size_``K, td_``K)
  `CDE_EACH(CDE_NORMAL)
  `SH_SUMS4(4'b1100, from_x, cp_x, centre_x, from_y, cp_y, centre_y, td_xy, td_size_x, td_size_y,
      td_sum, td_xy, td_size_z)
  `SH_FOUR(formats_pkg::FP_MUL, 4'b0000, LAT.mul, noise_x, terms_x, rounding, noise_y, terms_y, rounding,
      noise_z, terms_z, rounding, scaled, td_sum, part)
  `define CDE_NOTHING(K, I) `SH_LE(nothing_``K, n_size_``K, noise_``K)
  `CDE_EACH(CDE_NOTHING)
  `SH_BOTH(nothing_xy, nothing_x, nothing_y)
  `SH_BOTH(flat, nothing_xy, nothing_z)
  `define CDE_HALF(K, I) \
    localparam int T_half_``K = `DF_MAX2(T_flat, T_wide_``K); \
    `SH_TEST_AT(flat_``K, flat, T_half_``K) `SH_AT(wide_late_``K, wide_``K, T_half_``K) \
    `SH_SCALAR half_``K; \
    assign half_``K = flat_``K ? MINUS_INF : wide_late_``K;
  `CDE_EACH(CDE_HALF)
  `SH_ABS(outside_x, from_x)
  `SH_ABS(outside_y, from_y)
  `SH_START(from_z, 0, LAT.add, cp_z, centre_z, 0, 0, 0)
  `SH_ABS(outside_z, from_z)
  `SH_START(beyond_x, 1, LAT.add, outside_x, half_x, N_from_z, 0, 0)
  `SH_START(beyond_y, 2, LAT.add, outside_y, half_y, N_from_z, N_beyond_x, 0)
  `SH_START(beyond_z, 3, LAT.add, outside_z, half_z, N_from_z, N_beyond_x, N_beyond_y)
  `SH_GROUP(from_z, formats_pkg::FP_SUB, 4'b0000, 4, LAT.add, from_z, beyond_x, beyond_y, beyond_z)
  assign {beyond_z, beyond_y, beyond_x, from_z} = group_from_z;
  `SH_IN(allowed, (scaled[30:MAN] == '1) ? '0 : scaled, T_scaled)
  `SH_LT(in_x, beyond_x, allowed)
  `SH_LT(in_y, beyond_y, allowed)
  `SH_LT(in_z, beyond_z, allowed)
  `SH_BOTH(in_xy, in_x, in_y)
  `SH_BOTH(in_box, in_xy, in_z)
  `SH_BOTH(hit, met, in_box)
  `undef CDE_EACH

  // ---- Result, as ray_result.sv: a hit has a finite point, and its T is never -0 ----
  localparam int T_SELECT = `DF_MAX2(`DF_MAX2(T_hit, T_t), `DF_MAX3(T_cp_x, T_cp_y, T_cp_z));
  localparam int LATENCY = T_SELECT + 2;  // from the cycle of turn 0
  assign latency_o = 16'(LATENCY);
  `SH_TEST_AT(f_late, hit, T_SELECT)
  `SH_AT(t_late, t, T_SELECT)
  `SH_AT(x_late, cp_x, T_SELECT)
  `SH_AT(y_late, cp_y, T_SELECT)
  `SH_AT(z_late, cp_z, T_SELECT)
  if (ARITH == "rtl") begin : g_result
    always_ff @(posedge clk_i) begin
      f_o <= {32{f_late}};
      t_o <= !f_late ? INF : (t_late[30:0] == '0) ? '0 : t_late;
      cp_o <= f_late ? {z_late, y_late, x_late} : '0;
    end
  end else begin : g_result_of_host
    logic [15:0] unused_latency;
    logic [8:0][0:0][31:0] b;
    assign b = b_i;
    ray_triangle_moller #(.BOX(1), .LAT(LAT), .ARITH(ARITH)) lane (
        .clk_i, .a_i(a_i), .b_i(b), .f_o, .t_o, .cp_o, .latency_o(unused_latency));
    logic unused;
    assign unused = &{1'b0, unused_latency, f_late, t_late, x_late, y_late, z_late};
  end
endmodule
