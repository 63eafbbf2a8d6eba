// SPDX-License-Identifier: Apache-2.0
// The results of ray_front.sv for rays that meet triangles, with one adder, one multiplier and one divider. They serve
// the three axes in turn. Each operation has its own phases, of FRONT_CYCLES. A ray waits for phase 0, and the next one
// can enter after it.
// The adder takes phases 1 to 6 for the distances from o to the root's corners, and one later for the sum of the
// margin's parts. The divider takes phases 1, 3 and 5. The multiplier takes two phases for the margin's parts, and
// three, with one between them, for M' |1 / d|.
// Latency: FRONT_T_SHARED cycles (bvh.svh).
// Throughput: one ray per FRONT_CYCLES cycles.
// Stall: none, runs free.
`include "bvh.svh"
module ray_front_shared #(
    parameter latency_pkg::latency_t LAT = latency_pkg::ONES,
    localparam int EXP = 8,
    localparam int MAN = 23
) (
    input logic clk_i,
    input logic rst_i,
    input logic [$clog2(`FRONT_CYCLES)-1:0] phase_i,
    input logic enter_i,  // a ray's words
    input logic leave_i,  // FRONT_T_SHARED cycles after the next phase 0
    input logic [5:0][31:0] ray_i,   // o x y z, d x y z
    input logic [6:0][31:0] root_i,  // as in ray_front.sv; constant
    output logic [8:0][31:0] r_o     // o x y z, mt, 1 / d with the sign of d; with leave_i
);
  localparam int PW = $clog2(`FRONT_CYCLES);
  localparam int T_REACH = `FRONT_T_REACH;
  localparam int T_SUM = `FRONT_T_SUM;
  localparam int T_MARGIN = `FRONT_T_MARGIN;
  localparam int T_TIMES = `FRONT_T_TIMES;
  localparam int T_INVERSE = 1 + LAT.div;
  localparam int T_OUT = T_TIMES + `NODE_LAT_MUL;
  localparam logic [30:0] LEAST = 31'(`DF_POWER_OF_TWO(-80));
  localparam logic [31:0] ONE = 32'(`DF_POWER_OF_TWO(0));
  // 13/16 2^-16, and 13/16.
  localparam logic [31:0] SHARE = 32'(`DF_POWER_OF_TWO(-17)) | (32'd5 << (MAN - 3));
  localparam logic [31:0] WORLD_SHARE = 32'(`DF_POWER_OF_TWO(-1)) | (32'd5 << (MAN - 3));
  // The phase of a time.
  `define CDE_AT(TIME) (phase_i == PW'(TIME))

  logic [5:0][31:0] next_q, ray_q;
  always_ff @(posedge clk_i) begin
    if (enter_i) next_q <= ray_i;
    if (`CDE_AT(0)) ray_q <= next_q;
  end

  // ---- Distance to the far end of the root's box. Words without sign compare as numbers ----
  logic summing;
  logic [31:0] corner, origin, difference, part_q, world_q, unused_flags;
  logic [30:0] reach_q;
  assign summing = `CDE_AT(T_SUM);
  always_comb begin
    corner = root_i[0];
    for (int k = 1; k < 6; k++) if (`CDE_AT(1 + k)) corner = root_i[k];
    origin = ray_q[0];
    for (int k = 1; k < 3; k++) if (`CDE_AT(1 + k) || `CDE_AT(4 + k)) origin = ray_q[k];
  end
  // part - (-world part)
  fp_lanes #(.OP(formats_pkg::FP_SUB), .EXP(EXP), .MAN(MAN), .LAT(LAT.add)) adder (
      .clk_i, .en_i(1'b1), .a_i(summing ? part_q : corner), .b_i(summing ? {~world_q[31], world_q[30:0]} : origin),
      .r_o(difference), .flags_o(unused_flags));
  always_ff @(posedge clk_i)
    if (`CDE_AT(1 + LAT.add) || difference[30:0] > reach_q) reach_q <= difference[30:0];

  // ---- 1 / d ----
  logic [31:0] component, divisor, inverse, inverse_now, inverse_out;
  always_comb begin
    component = ray_q[3];
    for (int k = 1; k < 3; k++) if (`CDE_AT(1 + `FRONT_AXIS * k)) component = ray_q[3+k];
  end
  assign divisor = {component[31], (component[30:0] > LEAST) ? component[30:0] : LEAST};
  if (LAT.div > MAN + 8) begin : g_div_turns
    fp_div_turns #(.EXP(EXP), .MAN(MAN), .LAT(LAT.div), .TURNS(`FRONT_AXIS)) divider (
        .clk_i, .take_i(phase_i % PW'(`FRONT_AXIS) == PW'(1 % `FRONT_AXIS)), .a_i(ONE), .b_i(divisor), .r_o(inverse));
  end else begin : g_div
    logic [31:0] unused_div_flags;
    fp_lanes #(.OP(formats_pkg::FP_DIV), .EXP(EXP), .MAN(MAN), .LAT(LAT.div)) divider (
        .clk_i, .en_i(1'b1), .a_i(ONE), .b_i(divisor), .r_o(inverse), .flags_o(unused_div_flags));
  end
  pipe_delay #(.W(32), .FROM(T_INVERSE), .TO(T_TIMES)) delay_inverse (.clk_i, .d_i(inverse), .q_o(inverse_now));
  pipe_delay #(.W(32), .FROM(T_TIMES), .TO(T_OUT)) delay_out (.clk_i, .d_i(inverse_now), .q_o(inverse_out));

  // ---- Products ----
  logic [31:0] product, margin_late, margin_q, unused_mul_flags;
  logic of_reach, of_world;
  assign of_reach = `CDE_AT(T_REACH);
  assign of_world = `CDE_AT(T_REACH + 1);
  fp_lanes #(.OP(formats_pkg::FP_MUL), .EXP(EXP), .MAN(MAN), .LAT(`NODE_LAT_MUL)) multiplier (
      .clk_i, .en_i(1'b1),
      .a_i(of_reach ? {1'b0, reach_q} : of_world ? root_i[6] : {1'b0, inverse_now[30:0]}),
      .b_i(of_reach ? SHARE : of_world ? WORLD_SHARE : margin_q),
      .r_o(product), .flags_o(unused_mul_flags));
  pipe_delay #(.W(32), .FROM(T_SUM + LAT.add), .TO(T_MARGIN)) delay_margin (
      .clk_i, .d_i(difference), .q_o(margin_late));
  always_ff @(posedge clk_i) begin
    if (`CDE_AT(T_REACH + `NODE_LAT_MUL)) part_q <= product;
    if (`CDE_AT(T_REACH + 1 + `NODE_LAT_MUL)) world_q <= product;
    if (`CDE_AT(T_MARGIN)) margin_q <= margin_late;
  end

  // ---- Results ----
  logic [2:0][31:0] origin_out, times_q, inverse_q;
  always_ff @(posedge clk_i)
    for (int k = 0; k < 3; k++)
      if (`CDE_AT(T_OUT + `FRONT_AXIS * k)) {times_q[k], inverse_q[k]} <= {product, inverse_out};
  localparam int INSIDE = 1 << $clog2(`FRONT_T_SHARED / `FRONT_CYCLES + 2);
  sync_fifo #(.W(96), .DEPTH(INSIDE)) origins (
      .clk_i, .rst_i, .write_i(enter_i), .wdata_i(ray_i[2:0]), .free_o(), .count_o(), .some_o(), .rdata_o(origin_out),
      .read_i(leave_i));
  assign r_o = {inverse_q, times_q, origin_out};
  `undef CDE_AT
endmodule
