// SPDX-License-Identifier: Apache-2.0
// Box rule of ray and triangle (reference/pipes/ray_box.hpp). A hit counts only if P = o + t d lies in the triangle's
// box: (|P_k - c_k| - h_k) < 64 u |t d|_1 on every axis. A NaN or an infinite P is outside. The box of a triangle
// without area holds no point. An infinite |t d|_1 gives no margin. The triangle's part is computed once for all lanes
// if the triangle is broadcast. Without BOX the module is a wire.
// Operators per ray: 1 mul, 2 add, 6 sub, 3 compare. Operators per triangle: see triangle_bounds.sv.
// Latency: to stage time RAY_T_IN_BOX (ray_box.svh); 0 with ARITH = "host".
// Throughput: LANES pairs per cycle.
// Stall: none.
`include "ray_box.svh"
module ray_box #(
    `DF_PARAMETERS,
    parameter int B_LANES = LANES,  // triangles per cycle: 1 (broadcast to all lanes) or LANES
    parameter int BOX = 0,          // 1: apply the rule
    parameter int T_MET = 0,        // stage times of the inputs; triangles have time 0
    parameter int T_TD = 0,
    parameter int T_P = 0
) (
    input logic clk_i,
    input logic [8:0][B_LANES-1:0][CW-1:0] b_i,   // triangle: v0 x y z, v1, v2
    input logic [LANES-1:0][CW-1:0] met_i,        // lane mask
    input logic [2:0][LANES-1:0][CW-1:0] td_i,    // t d
    input logic [2:0][LANES-1:0][CW-1:0] p_i,     // o + t d
    output logic [LANES-1:0][CW-1:0] hit_o        // lane mask
);
  /*verilator inline_module*/
  if (BOX != 0 && BOX != 1) $error("ray_box: BOX must be 0 or 1");
  if (BOX == 0) begin : g_none
    logic unused;
    assign unused = &{1'b0, clk_i, b_i, td_i, p_i};
    assign hit_o = met_i;
  end
`ifdef VERILATOR
  // Hits are rare, so simulation makes one call per lane that hits.
  else if (ARITH != "rtl") begin : g_host
    logic unused_clk;
    assign unused_clk = clk_i;
    logic [LANES-1:0][CW-1:0] hit;
    `define CDE_B(K) b_i[K][l%B_LANES]
    `define CDE_IN_BOX(C, BITS) C("host_fp::in_box<", EXP, ",", MAN, ",", BITS, ">(", met_i[l], \
        ",", td_i[0][l], ",", td_i[1][l], ",", td_i[2][l], ",", p_i[0][l], ",", p_i[1][l], ",", p_i[2][l], \
        ",", `CDE_B(0), ",", `CDE_B(1), ",", `CDE_B(2), ",", `CDE_B(3), ",", `CDE_B(4), ",", `CDE_B(5), \
        ",", `CDE_B(6), ",", `CDE_B(7), ",", `CDE_B(8), ")")
    if (CW == 32) begin : g_32
      always_comb begin
        hit = '0;
        if (met_i != '0) for (int l = 0; l < LANES; l++) hit[l] = `CDE_IN_BOX($c32, "uint32_t");
      end
    end else begin : g_64
      always_comb begin
        hit = '0;
        if (met_i != '0) for (int l = 0; l < LANES; l++) hit[l] = `CDE_IN_BOX($c64, "uint64_t");
      end
    end
    `undef CDE_IN_BOX
    `undef CDE_B
    assign hit_o = hit;
  end
`endif
  else begin : g_box
    `DF_IN(met, met_i, T_MET)
    `DF_VIN(td, td_i, T_TD)
    `DF_VIN(p, p_i, T_P)
    `DF_CONST(part, `DF_POWER_OF_TWO(5 - MAN))

    // ---- Margin of the ray ----
    `DF_VABS(td_size, td)
    `DF_PICK(td_x, td_size, 0)
    `DF_PICK(td_y, td_size, 1)
    `DF_PICK(td_z, td_size, 2)
    `DF_ADD(td_xy, td_x, td_y)
    `DF_ADD(td_sum, td_xy, td_z)
    `DF_MUL(scaled, td_sum, part)
    logic [LANES-1:0][CW-1:0] bounded;
    fp_class #(.EXP(EXP), .MAN(MAN), .LANES(LANES), .OP(formats_pkg::CLASS_FINITE), .ARITH(ARITH)) of_margin (
        .a_i(scaled), .m_o(bounded));
    `DF_IN(margin, scaled & bounded, T_scaled)

    // ---- Distance of the point outside; operators are named, since the triangle has 1 or LANES lanes ----
    localparam int T_AWAY = `RAY_T_AWAY(T_P);
    localparam int T_OUT = `RAY_T_OUT(T_P);
    logic [2:0][B_LANES-1:0][CW-1:0] centre, half, centre_p, half_p;
    logic [2:0][LANES-1:0][CW-1:0] from, beyond, accepted;
    triangle_bounds #(
        .EXP(EXP), .MAN(MAN), .LANES(B_LANES), .LAT(LAT), .ARITH(ARITH)
    ) bounds (
        .clk_i, .b_i, .centre_o(centre), .half_o(half));
    pipe_delay #(.W(3 * B_LANES * CW), .FROM(`RAY_T_CENTRE), .TO(T_AWAY - LAT.add), .ARITH(ARITH)) delay_c (
        .clk_i, .d_i(centre), .q_o(centre_p));
    pipe_delay #(.W(3 * B_LANES * CW), .FROM(`RAY_T_HALF), .TO(T_OUT - LAT.add), .ARITH(ARITH)) delay_h (
        .clk_i, .d_i(half), .q_o(half_p));
    `DF_VAT(p_late, p, T_AWAY - LAT.add)
    vec_add #(
        .EXP(EXP), .MAN(MAN), .LANES(LANES), .B_LANES(B_LANES), .LAT(LAT), .SUB(1), .ARITH(ARITH), .CANON(0)
    ) sub_c (
        .clk_i, .a_i(p_late), .b_i(centre_p), .r_o(from));
    `DF_VIN(away, from, T_AWAY)
    `DF_VABS(size, away)
    `DF_VAT(size_late, size, T_OUT - LAT.add)
    vec_add #(
        .EXP(EXP), .MAN(MAN), .LANES(LANES), .B_LANES(B_LANES), .LAT(LAT), .SUB(1), .ARITH(ARITH), .CANON(0)
    ) sub_h (
        .clk_i, .a_i(size_late), .b_i(half_p), .r_o(beyond));
    for (genvar k = 0; k < 3; k++) begin : axis
      `DF_IN(out, beyond[k], T_OUT)
      `DF_LT(in, out, margin)
      assign accepted[k] = in;
    end
    localparam int T_IN_BOX = `RAY_T_IN_BOX(T_TD, T_P);
    `DF_IN(in_box, accepted[0] & accepted[1] & accepted[2], T_IN_BOX)
    `DF_AND(hit, met, in_box)
    assign hit_o = hit;
  end
endmodule
