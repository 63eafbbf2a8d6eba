// SPDX-License-Identifier: Apache-2.0
// Front of a pass between a box or a triangle and a cylinder: the unit normal that the pass evaluates (front() of
// reference/pipes/cylinder/search.hpp). Phases exclude each other and share operators:
//
//   vertex    x = b x w, radial = x x b, with w = vertex - d      |x|^2, b.w     b (+-above |x|) + radial (|x| - r)
//   side      q = e x b                                          |q|^2
//
//   sample    w = e x u, c = e x q                               q.w, q.u       one end of the arc (1 - tau) +
//                                                                               other end tau
//
//   refine    w = e x next, c = w x e
//   frame     e1 x e2 (triangle)                                 |e1 x e2|^2, e1.e1
//
// Operators (box): 29 add, 31 mul, 1 div, 2 sqrt, 6 compare.
// Operators (triangle): 25 add, 36 mul, 1 div, 2 sqrt, 11 compare.
// Latency: LATENCY_FRONT cycles; 0 with ARITH = "host".
// Throughput: one normal per lane per cycle.
// Stall: none, runs free.
`include "cylinder.svh"
module polyhedron_front #(
    `DF_PARAMETERS,
    parameter int BODY = `BODY_BOX
) (
    input logic clk_i,
    input logic [`PASS_W-1:0] pass_i,
    input logic [7:0] samples_i,  // M: 4, 8 or 16; constant while a row is in flight
    input logic [2:0][2:0][LANES-1:0][CW-1:0] axis_i,  // axes of the box, or edges of the triangle, of unit length
    input logic [2:0][2:0][LANES-1:0][CW-1:0] reach_i,  // half extents times axes; v1 - v0, v2 - v0, v2 - v1
    input logic [2:0][LANES-1:0][CW-1:0] face_i,  // unit normal of the triangle
    input logic [2:0][LANES-1:0][CW-1:0] frame_i,  // box: the axis of this pass, not yet of unit length
    input logic [2:0][LANES-1:0][CW-1:0] d_i,  // B: centre, axis, half height, radius
    input logic [2:0][LANES-1:0][CW-1:0] b_i,
    input logic [LANES-1:0][CW-1:0] b_half_i,
    input logic [LANES-1:0][CW-1:0] b_radius_i,
    input logic [2:0][LANES-1:0][CW-1:0] q_i,  // the pair's state, with the following inputs
    input logic [2:0][LANES-1:0][CW-1:0] next_i,
    input logic [2:0][LANES-1:0][CW-1:0] best_n_i,
    output logic [2:0][LANES-1:0][CW-1:0] n_o
);
  /*verilator inline_module*/
  // n/8, for n from 1 to 7.
  function automatic logic [CW-1:0] eighths(input logic [2:0] n);
    case (n)
      1: eighths = CW'(`DF_POWER_OF_TWO(-3));
      2: eighths = CW'(`DF_POWER_OF_TWO(-2));
      3: eighths = CW'(`DF_POWER_OF_TWO(-2)) | CW'(1) << (MAN - 1);
      4: eighths = CW'(`DF_POWER_OF_TWO(-1));
      5: eighths = CW'(`DF_POWER_OF_TWO(-1)) | CW'(1) << (MAN - 2);
      6: eighths = CW'(`DF_POWER_OF_TWO(-1)) | CW'(1) << (MAN - 1);
      default: eighths = CW'(`DF_POWER_OF_TWO(-1)) | CW'(3) << (MAN - 2);
    endcase
  endfunction

  // ---- Decoded pass ----
  logic [3:0] phase;
  logic [1:0] track, arc_now;
  logic [7:0] index;
  logic [3:0] m;
  logic [2:0] tau_now;
  assign phase = `PASS_PHASE(pass_i);
  assign track = `PASS_TRACK(pass_i);
  assign index = `PASS_INDEX(pass_i);
  assign m = (index == samples_i) ? '0 : index[3:0];
  assign arc_now = samples_i[4] ? m[3:2] : samples_i[3] ? m[2:1] : m[1:0];
  assign tau_now = samples_i[4] ? {m[1:0], 1'b1} : samples_i[3] ? {m[0], 2'b10} : 3'd4;
  `DF_CONTROL(frame, phase == `PHASE_FRAME, 0)
  `DF_CONTROL(vertex, phase == `PHASE_VERTEX, 0)
  `DF_CONTROL(side, phase == `PHASE_SIDE, 0)
  `DF_CONTROL(sample, phase == `PHASE_SAMPLE, 0)
  `DF_CONTROL(refine, phase == `PHASE_REFINE, 0)
  `DF_CONTROL(twice, vertex || refine, 0)
  `DF_CONTROL(combined, vertex || sample, 0)
  `DF_CONTROL(reverse, index == samples_i, 0)
  `DF_CONTROL(arc0, arc_now == 0, 0)
  `DF_CONTROL(arc1, arc_now == 1, 0)
  `DF_CONTROL(arc2, arc_now == 2, 0)
  `DF_CONTROL(witness, phase == `PHASE_TOUCH || (phase == `PHASE_PROJECT && !`PASS_TRIAL(pass_i)), 0)
  `DF_VIN(e, axis_i[track], 0)
  `DF_VIN(q, q_i, 0)
  `DF_VIN(d, d_i, 0)
  `DF_VIN(b, b_i, 0)
  `DF_IN(b_half, b_half_i, 0)
  `DF_IN(b_radius, b_radius_i, 0)
  `DF_VIN(best_n, best_n_i, 0)
  `DF_IN(tau, {LANES{eighths(tau_now)}}, 0)
  `DF_IN(rest, {LANES{eighths(3'd0 - tau_now)}}, 0)
  `DF_CONST(zero, 0)
  `DF_CONST(tiny, `DF_POWER_OF_TWO(2 * (3 - MAN)))  // (16 u)^2
  localparam int T_u = 0, T_plain = 0, T_v = (BODY == `BODY_BOX) ? 2 * LAT.add : 0;
  `DF_VECTOR u, plain, v;
  if (BODY == `BODY_BOX) begin : g_box
    logic unused;
    assign unused = &{1'b0, face_i};
    `DF_MATRIX_IN(reach, reach_i[0], reach_i[1], reach_i[2], 0)
    `DF_MNEG(minus, reach)
    `DF_VIN(x, index[0] ? minus[0] : reach[0], 0)
    `DF_VIN(y, index[1] ? minus[1] : reach[1], 0)
    `DF_VIN(z, index[2] ? minus[2] : reach[2], 0)
    `DF_VADD(yz, y, z)
    `DF_VADD(corner, x, yz)
    assign v = corner;
    assign u = (track == 0) ? axis_i[1] : (track == 1) ? axis_i[2] : axis_i[0];
    assign plain = frame ? frame_i : (phase == `PHASE_AXIS) ? b_i : next_i;
  end else begin : g_triangle
    logic unused;
    assign unused = &{1'b0, frame_i};
    assign v = (index == 0) ? '0 : (index == 1) ? reach_i[0] : reach_i[1];
    assign u = face_i;
    assign plain = frame ? ((index == 1) ? reach_i[0] : (index == 2) ? reach_i[2] : reach_i[1]) : (phase == `PHASE_AXIS)
        ? b_i : next_i;
  end

  // ---- Shared products ----
  logic searching;
  assign searching = phase != `PHASE_TOUCH && (phase != `PHASE_PROJECT || `PASS_TRIAL(pass_i));
  `undef DF_EN
  `define DF_EN searching
  `DF_VSUB(w, v, d)
  `DF_VIN(x_a0, vertex ? b : frame ? reach_i[0] : e, 0)
  `DF_VIN(x_b0, side ? b : frame ? reach_i[1] : refine ? next_i : u, 0)
  `DF_VCHOOSE(x_b, vertex, w, x_b0)
  `DF_CROSS(x, x_a0, x_b)
  `DF_VCHOOSE(c_a, twice, x, e)
  `DF_VIN(c_b, vertex ? b : refine ? e : q, 0)
  `DF_CROSS(c, c_a, c_b)
  `DF_VCHOOSE(xx_b, sample, q, x)
  `DF_DOT(xx, x, xx_b)
  `DF_VIN(z_a, vertex ? b : sample ? q : reach_i[0], 0)
  `DF_VIN(z_b0, sample ? u : reach_i[0], 0)
  `DF_VCHOOSE(z_b, vertex, w, z_b0)
  `DF_DOT(z, z_a, z_b)

  // ---- Normal from a vertex ----
  `undef DF_EN
  `define DF_EN (phase == `PHASE_VERTEX)
  `DF_SQRT(rho, xx)
  `DF_ABS(z_size, z)
  `DF_SUB(above, z_size, b_half)
  `DF_SUB(beyond, rho, b_radius)
  `DF_LT(over_cap, zero, above)
  `DF_LT(off_side, zero, beyond)
  `DF_AND(at_rim, over_cap, off_side)
  `DF_MUL(axial_size, above, rho)
  `DF_MOVE_SIGN(axial, z, axial_size)

  // ---- A sample. The ends of the arcs are u, f, w, f2, -u. f is the one of +-q, +-c between u and w, or else the
  // middle ----
  `DF_NEGATIVE(qu_negative, z)
  `DF_NEGATIVE(qw_negative, xx)
  `DF_LOGIC(differ, qu_negative, qw_negative, formats_pkg::WIRE_XOR)
  `DF_VNEG(minus_q, q)
  `DF_VNEG(minus_u, u)
  `DF_VSELECT(f_plus, differ, c, q)
  `DF_VSELECT(f2_plus, differ, minus_q, c)
  `DF_VFLIP(f_kink, z, f_plus)
  `DF_VFLIP(f2_kink, z, f2_plus)
  `undef DF_EN
  `define DF_EN (phase == `PHASE_SAMPLE)
  `DF_CONST(narrow, `DF_POWER_OF_TWO(-15))
  `DF_ABS(qu_size, z)
  `DF_ABS(qw_size, xx)
  `DF_LE(at_w, qu_size, narrow)
  `DF_LE(at_u, qw_size, narrow)
  `DF_OR(no_width, at_w, at_u)
  `DF_CONTROL(ahead, arc_now < 2, 0)
  `DF_VCHOOSE(aside, ahead, u, minus_u)
  `DF_VADD(middle, x, aside)
  `DF_VSELECT(f, no_width, middle, f_kink)
  `DF_VSELECT(f2, no_width, middle, f2_kink)
  `DF_VCHOOSE(from2, arc2, x, f2)
  `DF_VCHOOSE(from1, arc1, f, from2)
  `DF_VCHOOSE(from, arc0, u, from1)
  `DF_VCHOOSE(to2, arc2, f2, minus_u)
  `DF_VCHOOSE(to1, arc1, x, to2)
  `DF_VCHOOSE(to, arc0, f, to1)

  // ---- Two scaled vectors ----
  `undef DF_EN
  `define DF_EN (phase == `PHASE_VERTEX || phase == `PHASE_SAMPLE)
  `DF_VCHOOSE(sum_a, vertex, b, from)
  `DF_CHOOSE(sum_a_by, vertex, axial, rest)
  `DF_VSCALE(part_a, sum_a, sum_a_by)
  `DF_VCHOOSE(sum_b, vertex, c, to)
  `DF_CHOOSE(sum_b_by, vertex, beyond, tau)
  `DF_VSCALE(part_b, sum_b, sum_b_by)
  `DF_VADD(sum, part_a, part_b)
  `DF_VNEG(minus_sum, sum)
  `DF_VSELECT(vertex_n, at_rim, sum, c)
  `DF_VCHOOSE(sample_n, reverse, minus_sum, sum)
  `DF_VCHOOSE(combined_n, vertex, vertex_n, sample_n)

  // ---- Cross products that may be zero ----
  `undef DF_EN
  `define DF_EN searching
  localparam int T_vanish = `DF_MAX2(T_xx, T_z + 2 * LAT.mul) + LAT.cmp, T_framed = `LATENCY_POLYHEDRON_RAW;
  `DF_SCALAR vanish;
  `DF_VECTOR framed;
  `DF_VSELECT(side_n, vanish, u, x)
  `DF_VCHOOSE(plain_or_step, refine, c, plain)
  `DF_VCHOOSE(side_or_plain, side, side_n, plain_or_step)
  `DF_VCHOOSE(raw_n, combined, combined_n, side_or_plain)
  if (BODY == `BODY_BOX) begin : g_no_face
    `DF_LE(drowned, xx, tiny)
    `DF_AT(drowned_late, drowned, T_vanish)
    `DF_VAT(late, raw_n, T_framed)
    assign vanish = drowned_late;
    assign framed = late;
  end else begin : g_face
    // A triangle is flat if its normal is lost in rounding: (e1 x e2)^2 <= tiny e1^2 e2^2.
    `DF_CONTROL(first, frame && index == 0, 0)
    `DF_VIN(e1, reach_i[0], 0)
    `DF_VIN(e2, reach_i[1], 0)
    `DF_DOT(e22, e2, e2)
    `DF_MUL(ee, z, e22)
    `DF_MUL(ee_tiny, tiny, ee)
    `DF_CHOOSE(bound, frame, ee_tiny, tiny)
    `DF_LE(drowned, xx, bound)
    `DF_LT(shorter, z, e22)
    `DF_VSELECT(longer, shorter, e2, e1)
    // A triangle that is a point has no edge, and needs a normal of B's axis.
    `DF_CONST(least, CW'(3) << MAN)
    `DF_LT(e1_none, z, least)
    `DF_LT(e2_none, e22, least)
    `DF_AND(point, e1_none, e2_none)
    `DF_VSELECT(longer_or_b, point, b, longer)
    `DF_ACROSS(other, longer_or_b)
    `DF_VSELECT(face_n, vanish, other, x)
    `DF_VCHOOSE(framed_n, first, face_n, raw_n)
    `DF_AT(drowned_late, drowned, T_vanish)
    `DF_VAT(late, framed_n, T_framed)
    assign vanish = drowned_late;
    assign framed = late;
  end

  `DF_NORMALISE(unit, framed)
  // A direction between witness points that are too near each other is not tried.
  `DF_CONTROL(trial, phase == `PHASE_PROJECT && `PASS_TRIAL(pass_i), 0)
  `DF_VSELECT(tried, unit_usable, unit, best_n)
  `DF_VCHOOSE(unit_or_best, trial, tried, unit)
  `DF_VCHOOSE(n, witness, best_n, unit_or_best)
  `DF_VAT(n_end, n, `LATENCY_FRONT)
  assign n_o = n_end;
  `undef DF_EN
  `define DF_EN 1'b1
endmodule
