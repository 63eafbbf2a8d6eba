// SPDX-License-Identifier: Apache-2.0
// The lane of ray_triangle_moller.sv with the box rule, for rows that come once per TURNS cycles. Its operations share
// operators, in the same order and with the same bits. Host arithmetic computes as ray_triangle_moller.sv.
// Operators with eight turns: 6 mul, 1 div, 7 add, 29 compare. With four turns, 11 mul and 14 add; with two 21 and 28.
// Latency: LATENCY cycles; 0 with ARITH = "host".
// Throughput: one row per TURNS cycles. A row enters in turn 0.
// Stall: none, runs free.
`include "ray_box.svh"
`include "shared.svh"
module ray_triangle_shared #(
    parameter int TURNS = 4,  // 1, 2, 4 or 8
    parameter latency_pkg::latency_t LAT = latency_pkg::ONES,
    parameter ARITH = "rtl",
    localparam int EXP = 8,
    localparam int MAN = 23,
    localparam int CW = 32
) (
    input logic clk_i,
    input logic [2:0] turn_i,
    input logic [7:0][31:0] a_i,  // ray: o x y z, d x y z, tmin, tmax; in turn 0
    input logic [8:0][31:0] b_i,  // triangle: v0 x y z, v1, v2
    output logic [31:0] f_o,      // LATENCY cycles after turn 0, for one cycle
    output logic [31:0] t_o,
    output logic [2:0][31:0] cp_o,
    output logic [15:0] latency_o  // constant: LATENCY, also with ARITH = "host"
);
  localparam logic [31:0] INF = 32'h7f80_0000, MINUS_INF = 32'hff80_0000;
  if (TURNS != 1 && TURNS != 2 && TURNS != 4 && TURNS != 8)
    $error("ray_triangle_shared: TURNS must be 1, 2, 4 or 8");

  `SH_FUNCTIONS
  `SH_TURNS
  // ---- Operands, and constants ----
  logic [7:0][31:0] ray;
  logic [8:0][31:0] triangle;
  if (ARITH == "rtl") begin : g_gates
    always_ff @(posedge clk_i) if (in_turn[0]) {ray, triangle} <= {a_i, b_i};
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
  `define CDE_EDGES(K, P) \
    `SH_MIN(low_01_``K, v0_``K, v1_``K) `SH_MIN(low_``K, low_01_``K, v2_``K) \
    `SH_MAX(high_01_``K, v0_``K, v1_``K) `SH_MAX(high_``K, high_01_``K, v2_``K) \
    `SH_SUB(e1_``K, P, v1_``K, v0_``K) `SH_SUB(e2_``K, e1_``K, v2_``K, v0_``K)
  `CDE_EDGES(x, none)
  `CDE_EDGES(y, e2_x)
  `CDE_EDGES(z, e2_y)
  `SH_SUB(s_x, e2_z, o_x, v0_x)
  `SH_SUB(s_y, s_x, o_y, v0_y)
  `SH_SUMS(sums_edges, e1_x, e2_x, e1_y, e2_y, e1_z, e2_z, s_x, s_y)
  `SH_SUB(s_z, none, o_z, v0_z)
  `SH_ADD(ends_x, s_z, low_x, high_x)
  `SH_ADD(ends_y, ends_x, low_y, high_y)
  `SH_ADD(ends_z, ends_y, low_z, high_z)

  // ---- P = D x E2, Q = S x E1; the box's centre and size, and how far it reaches ----
  `define CDE_CROSS(K, I, J, PP, PQ) \
    `SH_MUL(p1_``K, PP, d_``I, e2_``J) `SH_MUL(p2_``K, p1_``K, d_``J, e2_``I) \
    `SH_MUL(q1_``K, PQ, s_``I, e1_``J) `SH_MUL(q2_``K, q1_``K, s_``J, e1_``I)
  `CDE_CROSS(x, y, z, none, none)
  `CDE_CROSS(y, z, x, p2_x, q2_x)
  `CDE_CROSS(z, x, y, p2_y, q2_y)
  `SH_MUL(centre_x, none, ends_x, one_half)
  `SH_MUL(centre_y, centre_x, ends_y, one_half)
  `SH_MUL(centre_z, centre_y, ends_z, one_half)
  `define CDE_DIFFERENCES(K, PP, PR) \
    `SH_ABS(away_``K, centre_``K) \
    `SH_SUB(p_``K, PP, p1_``K, p2_``K) `SH_SUB(q_``K, p_``K, q1_``K, q2_``K) \
    `SH_SUB(size_``K, PR, high_``K, centre_``K) `SH_ADD(reach_``K, size_``K, away_``K, size_``K)
  `CDE_DIFFERENCES(x, none, none)
  `CDE_DIFFERENCES(y, q_x, reach_x)
  `CDE_DIFFERENCES(z, q_y, reach_y)
  `SH_MAX(reach_xy, reach_x, reach_y)
  `SH_MAX(reach_most, reach_xy, reach_z)
  `SH_MUL(margin, centre_z, reach_most, world_share)

  // ---- det = P.E1, u = P.S, v = Q.D, tn = Q.E2 ----
  `define CDE_PRODUCTS(R, P, A, B) \
    `SH_MUL(R``_x, P, A``_x, B``_x) `SH_MUL(R``_y, R``_x, A``_y, B``_y) `SH_MUL(R``_z, R``_y, A``_z, B``_z)
  `CDE_PRODUCTS(det, margin, p, e1)
  `CDE_PRODUCTS(u, det_z, p, s)
  `CDE_PRODUCTS(v, u_z, q, d)
  `CDE_PRODUCTS(tn, v_z, q, e2)
  `SH_PRODUCTS(products_det, centre_x, centre_y, centre_z, margin, det_x, det_y, det_z, u_x)
  `SH_PRODUCTS(products_uv, u_y, u_z, v_x, v_y, v_z, tn_x, tn_y, tn_z)
  `SH_ADD(det_xy, ends_z, det_x, det_y)
  `SH_ADD(u_xy, det_xy, u_x, u_y)
  `SH_ADD(v_xy, u_xy, v_x, v_y)
  `SH_ADD(tn_xy, v_xy, tn_x, tn_y)
  `SH_SUMS(sums_ends, s_z, ends_x, ends_y, ends_z, det_xy, u_xy, v_xy, tn_xy)
  `SH_ADD(det, none, det_xy, det_z)
  `SH_ADD(u, det, u_xy, u_z)
  `SH_ADD(v, u, v_xy, v_z)
  `SH_ADD(tn, v, tn_xy, tn_z)
  `SH_ADD(uv, reach_z, u, v)

  // ---- Distance and point ----
  `SH_OP(t, formats_pkg::FP_DIV, LAT.div, tn, det)
  `SH_MUL(td_x, p2_z, d_x, t)
  `SH_MUL(td_y, td_x, d_y, t)
  `SH_MUL(td_z, q2_z, d_z, t)
  `SH_PRODUCTS(products_p, p1_x, p2_x, p1_y, p2_y, p1_z, p2_z, td_x, td_y)
  `SH_ADD(cp_x, none, o_x, td_x)
  `SH_ADD(cp_y, cp_x, o_y, td_y)
  `SH_ADD(cp_z, cp_y, o_z, td_z)

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
  `define CDE_NORMAL(K, I, J, PM, PS) \
    `SH_MUL(n1_``K, PM, e1_``I, e2_``J) `SH_MUL(n2_``K, n1_``K, e1_``J, e2_``I) \
    `SH_ABS(n1_size_``K, n1_``K) `SH_ABS(n2_size_``K, n2_``K) \
    `SH_SUB(n_``K, PS, n1_``K, n2_``K) `SH_ADD(floor_``K, n_``K, n1_size_``K, least) \
    `SH_ABS(n_size_``K, n_``K) `SH_ABS(td_size_``K, td_``K)
  `CDE_NORMAL(x, y, z, none, none)
  `CDE_NORMAL(y, z, x, n2_x, floor_x)
  `CDE_NORMAL(z, x, y, n2_y, floor_y)
  `SH_ADD(terms_x, floor_z, floor_x, n2_size_x)
  `SH_ADD(terms_y, terms_x, floor_y, n2_size_y)
  `SH_SUMS(sums_normal, n_x, floor_x, n_y, floor_y, n_z, floor_z, terms_x, terms_y)
  `SH_ADD(terms_z, tn, floor_z, n2_size_z)
  `SH_ADD(wide_x, terms_z, size_x, margin)
  `SH_ADD(wide_y, wide_x, size_y, margin)
  `SH_ADD(wide_z, wide_y, size_z, margin)
  `SH_SUMS(sums_det, det, u, v, tn, terms_z, wide_x, wide_y, wide_z)
  `SH_ADD(td_xy, q_z, td_size_x, td_size_y)
  `SH_ADD(td_sum, td_xy, td_xy, td_size_z)
  `SH_SUMS(sums_cross, p_x, q_x, p_y, q_y, p_z, q_z, td_xy, td_sum)
  `SH_MUL(noise_x, n2_z, terms_x, rounding)
  `SH_MUL(noise_y, noise_x, terms_y, rounding)
  `SH_PRODUCTS(products_normal, n1_x, n2_x, n1_y, n2_y, n1_z, n2_z, noise_x, noise_y)
  `SH_MUL(scaled, td_z, td_sum, part)
  `SH_PRODUCTS(products_q, q1_x, q2_x, q1_y, q2_y, q1_z, q2_z, td_z, scaled)
  `SH_OP(noise_z, formats_pkg::FP_MUL, LAT.mul, terms_z, rounding)
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
  `SH_SUB(from_z, uv, cp_z, centre_z)
  `SH_ABS(outside_z, from_z)
  `SH_SUB(from_x, cp_z, cp_x, centre_x)
  `SH_ABS(outside_x, from_x)
  `SH_SUB(from_y, from_x, cp_y, centre_y)
  `SH_ABS(outside_y, from_y)
  `SH_SUB(beyond_x, from_y, outside_x, half_x)
  `SH_SUB(beyond_y, beyond_x, outside_y, half_y)
  `SH_SUB(beyond_z, beyond_y, outside_z, half_z)
  `SH_SUMS(sums_size, size_x, reach_x, size_y, reach_y, size_z, reach_z, uv, from_z)
  `SH_SUMS(sums_point, cp_x, cp_y, cp_z, from_x, from_y, beyond_x, beyond_y, beyond_z)
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
