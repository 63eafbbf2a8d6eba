// Ray against triangle, Möller and Trumbore 1997, the paper's equation (3): E1 = V1-V0, E2 = V2-V0, T = O-V0, P = D x E2,
// Q = T x E1, det = P.E1, u = P.T, v = Q.D, t = (Q.E2)/det, CP = O + t D. u, v and u+v are compared with det unscaled, so
// the one division is off the hit decision. Two-sided; det = 0 (parallel or degenerate) is a miss. 27 multipliers, 1 divider,
// 12 adders, 15 subtractors, 8 comparators.
//
// LANES primaries of one register-file row meet one secondary. The ray is not delayed through the pipe: the pipe asks for the
// row again at the stage that needs it (`row_*_o`, read combinationally), which costs a memory port instead of a delay line.
//
// Latency: LATENCY clocks (10 when every operator takes one). Throughput: LANES pairs a clock. Stall: none, runs free.
module ray_triangle_moller #(
    parameter int EXP = 8,
    parameter int MAN = 23,
    parameter int LANES = 1,
    parameter int SLANES = 1,  // secondaries a clock: 1 (broadcast to all lanes) or LANES
    parameter int ROW_W = 8,
    parameter int TAG_W = 32,
    parameter int LAT_ADD = 1,
    parameter int LAT_MUL = 1,
    parameter int LAT_DIV = 1,
    parameter int LAT_CMP = 1,
    parameter ARITH = "rtl",
    localparam int CW = (1 + EXP + MAN <= 32) ? 32 : 64
) (
    input logic clk_i,
    input logic rst_i,
    input logic valid_i,
    input logic [ROW_W-1:0] row_i,
    input logic [TAG_W-1:0] tag_i,
    input logic [8:0][SLANES-1:0][CW-1:0] tri_i,  // v0 x y z, v1, v2
    input logic [SLANES-1:0][CW-1:0] tri_bad_i,   // lane mask: operand out of contract

    output logic [ROW_W-1:0] row_o_edge_o,
    input logic [2:0][LANES-1:0][CW-1:0] o_edge_i,
    output logic [ROW_W-1:0] row_d_cross_o,
    input logic [2:0][LANES-1:0][CW-1:0] d_cross_i,
    output logic [ROW_W-1:0] row_d_dot_o,
    input logic [2:0][LANES-1:0][CW-1:0] d_dot_i,
    output logic [ROW_W-1:0] row_t_o,
    input logic [2:0][LANES-1:0][CW-1:0] d_t_i,
    input logic [LANES-1:0][CW-1:0] tmin_t_i,
    input logic [LANES-1:0][CW-1:0] tmax_t_i,
    output logic [ROW_W-1:0] row_o_cp_o,
    input logic [2:0][LANES-1:0][CW-1:0] o_cp_i,
    output logic [ROW_W-1:0] row_bad_o,
    input logic [LANES-1:0][CW-1:0] ray_bad_i,

    output logic valid_o,
    output logic [ROW_W-1:0] row_o,
    output logic [TAG_W-1:0] tag_o,
    output logic [LANES-1:0][CW-1:0] f_o,  // lane mask
    output logic [LANES-1:0][CW-1:0] bad_o,
    output logic [LANES-1:0][CW-1:0] t_o,
    output logic [2:0][LANES-1:0][CW-1:0] cp_o,
    output logic [15:0] latency_o  // constant: clocks from valid_i to valid_o
);
  localparam int W = 1 + EXP + MAN;
  localparam logic [CW-1:0] SIGN = CW'(1) << (W - 1);
  localparam logic [CW-1:0] INF = ((CW'(1) << EXP) - 1) << MAN;
  localparam logic [CW-1:0] QNAN = INF | (CW'(1) << (MAN - 1));

  localparam int T_EDGE = LAT_ADD;
  localparam int T_CROSS = T_EDGE + LAT_MUL + LAT_ADD;
  localparam int T_DOT = T_CROSS + LAT_MUL + 2 * LAT_ADD;
  localparam int T_UV = T_DOT + LAT_ADD;
  localparam int T_UV_IN = T_UV + LAT_CMP;
  localparam int T_T = T_DOT + LAT_DIV;
  localparam int T_RANGE = T_T + LAT_CMP;
  localparam int T_TD = T_T + LAT_MUL;
  localparam int T_CP = T_TD + LAT_ADD;
  localparam int T_IN = (T_UV_IN > T_RANGE) ? T_UV_IN : T_RANGE;
  localparam int T_SELECT = (T_CP > T_IN) ? T_CP : T_IN;
  localparam int LATENCY = T_SELECT + 1;

  assign latency_o = 16'(LATENCY);

  // ---- Valid, tag and the rows asked for at later stages ----
  align_valid #(.FROM(0), .TO(LATENCY)) align_valid_u (.clk_i, .rst_i, .valid_i, .valid_o);
  align #(.W(TAG_W), .FROM(0), .TO(LATENCY)) align_tag (.clk_i, .d_i(tag_i), .q_o(tag_o));
  assign row_o_edge_o = row_i;
  align #(.W(ROW_W), .FROM(0), .TO(T_EDGE)) align_row_cross (.clk_i, .d_i(row_o_edge_o), .q_o(row_d_cross_o));
  align #(.W(ROW_W), .FROM(T_EDGE), .TO(T_CROSS)) align_row_dot (.clk_i, .d_i(row_d_cross_o), .q_o(row_d_dot_o));
  align #(.W(ROW_W), .FROM(T_CROSS), .TO(T_T)) align_row_t (.clk_i, .d_i(row_d_dot_o), .q_o(row_t_o));
  align #(.W(ROW_W), .FROM(T_T), .TO(T_TD)) align_row_cp (.clk_i, .d_i(row_t_o), .q_o(row_o_cp_o));
  align #(.W(ROW_W), .FROM(T_TD), .TO(T_SELECT)) align_row_bad (.clk_i, .d_i(row_o_cp_o), .q_o(row_bad_o));
  align #(.W(ROW_W), .FROM(T_SELECT), .TO(LATENCY)) align_row (.clk_i, .d_i(row_bad_o), .q_o(row_o));

  // ---- Edges; the two of the triangle are computed once for all lanes when it is broadcast ----
  logic [2:0][SLANES-1:0][CW-1:0] e1, e2, e1_dot, e2_dot;
  vec_add #(.EXP(EXP), .MAN(MAN), .LANES(SLANES), .LAT_ADD(LAT_ADD), .SUB(1), .ARITH(ARITH), .CANON(0)) sub_e1 (
      .clk_i, .a_i(tri_i[5:3]), .b_i(tri_i[2:0]), .r_o(e1));
  vec_add #(.EXP(EXP), .MAN(MAN), .LANES(SLANES), .LAT_ADD(LAT_ADD), .SUB(1), .ARITH(ARITH), .CANON(0)) sub_e2 (
      .clk_i, .a_i(tri_i[8:6]), .b_i(tri_i[2:0]), .r_o(e2));
  align #(.W(3 * SLANES * CW), .FROM(T_EDGE), .TO(T_CROSS)) align_e1 (.clk_i, .d_i(e1), .q_o(e1_dot));
  align #(.W(3 * SLANES * CW), .FROM(T_EDGE), .TO(T_CROSS)) align_e2 (.clk_i, .d_i(e2), .q_o(e2_dot));

  logic [2:0][LANES-1:0][CW-1:0] tv, tv_dot, p, q;
  vec_add #(.EXP(EXP), .MAN(MAN), .LANES(LANES), .B_LANES(SLANES), .LAT_ADD(LAT_ADD), .SUB(1), .ARITH(ARITH), .CANON(0)) sub_t (
      .clk_i, .a_i(o_edge_i), .b_i(tri_i[2:0]), .r_o(tv));
  vec_cross #(.EXP(EXP), .MAN(MAN), .LANES(LANES), .B_LANES(SLANES), .LAT_ADD(LAT_ADD), .LAT_MUL(LAT_MUL), .ARITH(ARITH), .CANON(0)) cross_p (
      .clk_i, .a_i(d_cross_i), .b_i(e2), .r_o(p));
  vec_cross #(.EXP(EXP), .MAN(MAN), .LANES(LANES), .B_LANES(SLANES), .LAT_ADD(LAT_ADD), .LAT_MUL(LAT_MUL), .ARITH(ARITH), .CANON(0)) cross_q (
      .clk_i, .a_i(tv), .b_i(e1), .r_o(q));
  for (genvar k = 0; k < 3; k++) begin : hold
    align #(.W(LANES * CW), .FROM(T_EDGE), .TO(T_CROSS)) align_tv (.clk_i, .d_i(tv[k]), .q_o(tv_dot[k]));
  end

  logic [LANES-1:0][CW-1:0] det, u, v, tn;
  vec_dot #(.EXP(EXP), .MAN(MAN), .LANES(LANES), .B_LANES(SLANES), .LAT_ADD(LAT_ADD), .LAT_MUL(LAT_MUL), .ARITH(ARITH), .CANON(0)) dot_det (
      .clk_i, .a_i(p), .b_i(e1_dot), .r_o(det));
  vec_dot #(.EXP(EXP), .MAN(MAN), .LANES(LANES), .LAT_ADD(LAT_ADD), .LAT_MUL(LAT_MUL), .ARITH(ARITH), .CANON(0)) dot_u (
      .clk_i, .a_i(p), .b_i(tv_dot), .r_o(u));
  vec_dot #(.EXP(EXP), .MAN(MAN), .LANES(LANES), .LAT_ADD(LAT_ADD), .LAT_MUL(LAT_MUL), .ARITH(ARITH), .CANON(0)) dot_v (
      .clk_i, .a_i(q), .b_i(d_dot_i), .r_o(v));
  vec_dot #(.EXP(EXP), .MAN(MAN), .LANES(LANES), .B_LANES(SLANES), .LAT_ADD(LAT_ADD), .LAT_MUL(LAT_MUL), .ARITH(ARITH), .CANON(0)) dot_t (
      .clk_i, .a_i(q), .b_i(e2_dot), .r_o(tn));

  // ---- Inside test against |det|: the sign of det is moved to u, v and u+v ----
  logic [LANES-1:0][CW-1:0] uv, det_uv, det_abs, u_flip, v_flip, zero, det_abs_uv, uv_flip;
  fp_add #(.EXP(EXP), .MAN(MAN), .LANES(LANES), .LAT(LAT_ADD), .ARITH(ARITH), .CANON(0)) add_uv (
      .clk_i, .a_i(u), .b_i(v), .r_o(uv), .flags_o());
  align #(.W(LANES * CW), .FROM(T_DOT), .TO(T_UV)) align_det (.clk_i, .d_i(det), .q_o(det_uv));
  assign zero = '0;
  // Lane by lane in a loop: Verilator would substitute a whole-vector expression into each of its LANES readers.
  always_comb
    for (int l = 0; l < LANES; l++) begin
      det_abs[l] = det[l] & ~SIGN;
      u_flip[l] = u[l] ^ (det[l] & SIGN);
      v_flip[l] = v[l] ^ (det[l] & SIGN);
      det_abs_uv[l] = det_uv[l] & ~SIGN;
      uv_flip[l] = uv[l] ^ (det_uv[l] & SIGN);
    end

  logic [LANES-1:0][CW-1:0] u_lo, u_hi, v_lo, v_hi, det_nz, uv_hi, t_lo, t_hi;
  `define CDE_CMP(NAME, OPERATION, A, B, M) \
    fp_cmp #(.EXP(EXP), .MAN(MAN), .LANES(LANES), .LAT(LAT_CMP), .OP(OPERATION), .ARITH(ARITH)) NAME ( \
        .clk_i, .a_i(A), .b_i(B), .m_o(M), .flags_o());
  `CDE_CMP(cmp_u_lo, "le", zero, u_flip, u_lo)
  `CDE_CMP(cmp_u_hi, "le", u_flip, det_abs, u_hi)
  `CDE_CMP(cmp_v_lo, "le", zero, v_flip, v_lo)
  `CDE_CMP(cmp_v_hi, "le", v_flip, det_abs, v_hi)
  `CDE_CMP(cmp_det, "lt", zero, det_abs, det_nz)
  `CDE_CMP(cmp_uv, "le", uv_flip, det_abs_uv, uv_hi)

  // ---- Distance and point ----
  logic [LANES-1:0][CW-1:0] t, t_select;
  logic [2:0][LANES-1:0][CW-1:0] td, cp;
  fp_div #(.EXP(EXP), .MAN(MAN), .LANES(LANES), .LAT(LAT_DIV), .ARITH(ARITH)) div_t (
      .clk_i, .a_i(tn), .b_i(det), .r_o(t), .flags_o());
  `CDE_CMP(cmp_t_lo, "le", tmin_t_i, t, t_lo)
  `CDE_CMP(cmp_t_hi, "le", t, tmax_t_i, t_hi)
  vec_scale #(.EXP(EXP), .MAN(MAN), .LANES(LANES), .LAT_MUL(LAT_MUL), .ARITH(ARITH), .CANON(0)) scale_d (
      .clk_i, .a_i(d_t_i), .s_i(t), .r_o(td));
  vec_add #(.EXP(EXP), .MAN(MAN), .LANES(LANES), .LAT_ADD(LAT_ADD), .ARITH(ARITH)) add_cp (
      .clk_i, .a_i(o_cp_i), .b_i(td), .r_o(cp));
  align #(.W(LANES * CW), .FROM(T_T), .TO(T_SELECT)) align_t (.clk_i, .d_i(t), .q_o(t_select));

  // ---- Decision ----
  logic [LANES-1:0][CW-1:0] in_edges, in_edges_uv, in_uv, in_uv_all, in_range, in_range_all, hit, hit_select;
  always_comb for (int l = 0; l < LANES; l++) in_edges[l] = u_lo[l] & u_hi[l] & v_lo[l] & v_hi[l] & det_nz[l];
  align #(.W(LANES * CW), .FROM(T_DOT + LAT_CMP), .TO(T_UV_IN)) align_edges (.clk_i, .d_i(in_edges), .q_o(in_edges_uv));
  assign in_uv = in_edges_uv & uv_hi;
  align #(.W(LANES * CW), .FROM(T_UV_IN), .TO(T_IN)) align_uv (.clk_i, .d_i(in_uv), .q_o(in_uv_all));
  assign in_range = t_lo & t_hi;
  align #(.W(LANES * CW), .FROM(T_RANGE), .TO(T_IN)) align_range (.clk_i, .d_i(in_range), .q_o(in_range_all));
  assign hit = in_uv_all & in_range_all;
  align #(.W(LANES * CW), .FROM(T_IN), .TO(T_SELECT)) align_hit (.clk_i, .d_i(hit), .q_o(hit_select));

  logic [SLANES-1:0][CW-1:0] tri_bad_select;
  align #(.W(SLANES * CW), .FROM(0), .TO(T_SELECT)) align_bad (.clk_i, .d_i(tri_bad_i), .q_o(tri_bad_select));

  logic [LANES-1:0][CW-1:0] f, bad;
  always_comb
    for (int l = 0; l < LANES; l++) begin
      bad[l] = ray_bad_i[l] | tri_bad_select[l%SLANES];
      f[l] = hit_select[l] & ~bad[l];
    end
  for (genvar l = 0; l < LANES; l++) begin : result
    always_ff @(posedge clk_i) begin
      f_o[l] <= f[l];
      bad_o[l] <= bad[l];
      t_o[l] <= (f[l] & t_select[l]) | (~f[l] & INF) | (bad[l] & QNAN);
    end
  end
  for (genvar k = 0; k < 3; k++) begin : point
    logic [LANES-1:0][CW-1:0] cp_k;
    assign cp_k = cp[k];
    for (genvar l = 0; l < LANES; l++) begin : lane
      always_ff @(posedge clk_i) cp_o[k][l] <= (f[l] & cp_k[l]) | (bad[l] & QNAN);
    end
  end
  `undef CDE_CMP

`ifndef SYNTHESIS
  // A valid row leaves exactly LATENCY clocks after it entered.
  logic [31:0] in_count, out_count;
  logic [LATENCY:0] history;
  always_ff @(posedge clk_i) begin
    history <= rst_i ? '0 : (LATENCY + 1)'({history, valid_i});
    in_count <= rst_i ? '0 : in_count + 32'(valid_i);
    out_count <= rst_i ? '0 : out_count + 32'(valid_o);
    if (!rst_i) begin
      assert (valid_o == history[LATENCY-1]) else $error("ray_triangle_moller: latency is not %0d", LATENCY);
      assert (in_count - out_count <= 32'(LATENCY)) else $error("ray_triangle_moller: lost or doubled a row");
    end
  end
`endif
endmodule
