// A witness pass of a cylinder pair (reference/cylinder/witness.hpp): the point q of A that is, moved by s n, a point of B, by
// alternating projection, between the features that n touches (track 0), then between the solids. Touch starts from that body's
// support point which is nearer to the other body; project goes to B moved by -s n and back to A, every second time on to where
// flat faces would cross. Both share the projections. w is the best point so far, off how far it is from B, squared.
// 67 add, 66 mul, 3 div, 2 sqrt, 6 compare, 6 min/max (cylinder); 64 add, 66 mul, 2 div, 1 sqrt, 8 compare, 9 min/max (box);
// 126 add, 126 mul, 5 div, 1 sqrt, 16 compare, 10 min/max (triangle).
// Latency: LATENCY_CYLINDER_WITNESS clocks; 0 with ARITH = "host". Throughput: one pass a lane a clock. Stall: none, runs free.
`include "cylinder.svh"
module cylinder_witness #(
    parameter int BODY = `BODY_CYLINDER,
    parameter int EXP = 8,
    parameter int MAN = 23,
    parameter int LANES = 1,
    parameter int LAT_ADD = 1,
    parameter int LAT_MUL = 1,
    parameter int LAT_DIV = 1,
    parameter int LAT_SQRT = 1,
    parameter int LAT_CMP = 1,
    parameter ARITH = "rtl",
    localparam int CW = (1 + EXP + MAN <= 32) ? 32 : 64
) (
    input logic clk_i,
    input logic [`PASS_W-1:0] pass_i,
    input logic [2:0][2:0][LANES-1:0][CW-1:0] axis_i,  // A: axes, half height or half extents, radius, edges, face
    input logic [2:0][LANES-1:0][CW-1:0] half_i,
    input logic [LANES-1:0][CW-1:0] radius_i,
    input logic [2:0][2:0][LANES-1:0][CW-1:0] edge_i,
    input logic [2:0][LANES-1:0][CW-1:0] face_i,
    input logic [2:0][LANES-1:0][CW-1:0] d_i,  // B: centre, axis, half height, radius
    input logic [2:0][LANES-1:0][CW-1:0] b_i,
    input logic [LANES-1:0][CW-1:0] b_half_i,
    input logic [LANES-1:0][CW-1:0] b_radius_i,
    input logic [LANES-1:0][CW-1:0] g_i,  // s and n
    input logic [2:0][LANES-1:0][CW-1:0] n_i,
    input logic [2:0][LANES-1:0][CW-1:0] y_i,  // the evaluation of n
    input logic [2:0][LANES-1:0][CW-1:0] a_side_i,
    input logic [2:0][LANES-1:0][CW-1:0] b_side_i,
    input logic [LANES-1:0][CW-1:0] b_along_i,
    input logic [2:0][LANES-1:0][CW-1:0] pa_i,
    input logic [2:0][LANES-1:0][CW-1:0] q_i,  // state
    input logic [2:0][LANES-1:0][CW-1:0] w_i,
    input logic [LANES-1:0][CW-1:0] off_i,
    output logic [2:0][LANES-1:0][CW-1:0] q_o,
    output logic [2:0][LANES-1:0][CW-1:0] w_o,
    output logic [LANES-1:0][CW-1:0] off_o
);
  /*verilator inline_module*/
  logic on;
  assign on = `PASS_PHASE(pass_i) == `PHASE_TOUCH || `PASS_PHASE(pass_i) == `PHASE_PROJECT;
  `undef DF_ON
  `define DF_ON on
  // A normal this far from perpendicular to the axis, 16 u radian, still touches the whole length of a cylinder's side.
  localparam int ALONGSIDE = 3 - MAN;
  logic [7:0] index;
  logic [1:0] track;
  logic touching;
  assign track = `PASS_TRACK(pass_i);
  assign index = `PASS_INDEX(pass_i);
  assign touching = `PASS_PHASE(pass_i) == `PHASE_TOUCH;
  `DF_CONTROL(touch, touching, 0)
  `DF_CONTROL(lines, track == 0 || (!touching && index < 5), 0)  // the last two projections see the round side
  `DF_CONTROL(start, touching && track == 0, 0)
  `DF_CONTROL(even, index[0] == track[0], 0)
  `DF_VIN(n, n_i, 0)
  `DF_IN(g, g_i, 0)
  `DF_VIN(y, y_i, 0)
  `DF_VIN(d, d_i, 0)
  `DF_VIN(pa, pa_i, 0)
  `DF_VIN(b_side, b_side_i, 0)
  `DF_IN(b_along, b_along_i, 0)
  `DF_VIN(q, q_i, 0)
  `DF_VIN(old_w, w_i, 0)
  `DF_IN(old_off, off_i, 0)
  `DF_CONST(one, `DF_POWER_OF_TWO(0))
  `DF_CONST(flat, `DF_POWER_OF_TWO(ALONGSIDE))
  `DF_CONST(most, `DF_POWER_OF_TWO(-ALONGSIDE))
  `DF_FILL(lines_all, lines)
  `DF_FILL(even_all, even)

  // ---- B moved by -s n ----
  `DF_VSCALE(shift, n, g)
  `DF_VSUB(b_centre, d, shift)
  `DF_VNEG(b_line, b_side)
  `DF_ABS(b_tilt, b_along)
  `DF_LE(b_flat, b_tilt, flat)
  `DF_AND(b_alongside, b_flat, lines_all)

  // ---- To B from pa or q, to A from B's support point or from there ----
  `DF_VIN(to_b, touching ? pa_i : q_i, 0)
  `DF_PROJECT_CYLINDER(on_b, to_b, b_centre, b_i, b_half_i, b_radius_i, b_line, b_alongside)
  `DF_VSUB(y_moved, y, shift)
  `DF_VADD(of_b, pa, y_moved)
  `DF_VCHOOSE(to_a, touch, of_b, on_b)
  localparam int T_on_a = T_to_a + `LATENCY_PROJECT;
  `DF_VECTOR on_a;
  if (BODY == `BODY_CYLINDER) begin : g_cylinder
    logic unused;
    assign unused = &{1'b0, axis_i[2:1], half_i[2:1], edge_i, face_i};
    `DF_VIN(a, axis_i[0], 0)
    `DF_VIN(a_line, a_side_i, 0)
    `DF_VCONST(origin, 0, 0, 0)
    `DF_DOT(a_along, a, n)
    `DF_ABS(a_tilt, a_along)
    `DF_LE(a_flat, a_tilt, flat)
    `DF_AND(a_alongside, a_flat, lines_all)
    `DF_PROJECT_CYLINDER(point, to_a, origin, a, half_i[0], radius_i, a_line, a_alongside)
    assign on_a = point;
  end else begin : g_polyhedron
    logic unused;
    assign unused = &{1'b0, radius_i, a_side_i};
    project_polyhedron #(`DF_FORMAT, .BODY(BODY), .T_X(T_to_a), .LAT_ADD(LAT_ADD), .LAT_MUL(LAT_MUL), .LAT_DIV(LAT_DIV), .LAT_SQRT(LAT_SQRT),
        .LAT_CMP(LAT_CMP)) project (
        .clk_i, .on_i(`DF_ON), .x_i(to_a), .axis_i, .half_i, .edge_i, .face_i, .feature_i(track == 0), .n_i, .r_o(on_a));
  end

  // ---- How far each is from where it came; the best; how far to go on ----
  `DF_VSUB(away, on_b, to_b)
  `DF_DOT(away2, away, away)
  `DF_VSUB(apart, on_a, to_a)
  `DF_DOT(apart2, apart, apart)
  `DF_LT(b_first, apart2, away2)
  `DF_VSELECT(touched, b_first, on_a, pa)
  `DF_SELECT(touched_off, b_first, apart2, away2)
  `DF_VCHOOSE(found, touch, touched, on_a)
  `DF_CHOOSE(found_off, touch, touched_off, apart2)
  `DF_LT(nearer, found_off, old_off)
  `DF_FILL(start_all, start)
  `DF_OR(take, nearer, start_all)
  `DF_VSELECT(best, take, found, old_w)
  `DF_SELECT(best_off, take, found_off, old_off)
  `DF_VSUB(move, on_a, to_b)
  `DF_DOT(move2, away, move)
  `DF_DIV(gain, away2, move2)
  `DF_LT(more, one, gain)
  `DF_LT(bounded, gain, most)
  `DF_AND(crossing, more, bounded)
  `DF_AND(further, crossing, even_all)
  `DF_VSCALE(stride, move, gain)
  `DF_VADD(beyond, q, stride)
  `DF_VSELECT(projected, further, beyond, on_a)
  `DF_VCHOOSE(point, touch, touched, projected)
  `DF_VAT(point_end, point, `LATENCY_CYLINDER_WITNESS)
  `DF_VAT(best_end, best, `LATENCY_CYLINDER_WITNESS)
  `DF_AT(best_off_end, best_off, `LATENCY_CYLINDER_WITNESS)
  assign {q_o, w_o, off_o} = {point_end, best_end, best_off_end};
  `undef DF_ON
  `define DF_ON 1'b1
endmodule
