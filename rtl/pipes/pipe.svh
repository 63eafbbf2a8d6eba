// SPDX-License-Identifier: Apache-2.0
// Shared by the pipes of all pairs: inputs, outputs and the result stage.
`ifndef CDE_PIPE_SVH
`define CDE_PIPE_SVH
`include "dataflow.svh"

// ---- Rays ----
// F is a lane mask; latency_o is constant: LATENCY, also with ARITH = "host".
`define RAY_OUTPUTS \
    output logic [LANES-1:0][CW-1:0] f_o, \
    output logic [LANES-1:0][CW-1:0] t_o, \
    output logic [2:0][LANES-1:0][CW-1:0] cp_o, \
    output logic [15:0] latency_o
// B_LANES is the number of different triangles: LANES, or 1 if all lanes have the same. BOX = 1: a hit must lie in the
// triangle's box (ray_box.sv).
`define RAY_TRIANGLE_PARAMETERS \
    `DF_PARAMETERS, \
    parameter int B_LANES = LANES, \
    parameter int BOX = 0
// The ray's words: o x y z, d x y z, tmin, tmax.
`define RAY_IN `DF_VIN(o, a_i[2:0], 0) `DF_VIN(d, a_i[5:3], 0) `DF_IN(tmin, a_i[6], 0) `DF_IN(tmax, a_i[7], 0)
// Registered after the later of HIT and CP. ray_result.sv defines FINITE.
`define RAY_RESULT(HIT, T, CP, LOOK) \
  localparam int LATENCY = `DF_MAX2(T_``HIT, T_``CP) + 1; \
  assign latency_o = 16'(LATENCY); \
  ray_result #(`DF_SAME, .T_HIT(T_``HIT), .T_T(T_``T), .T_CP(T_``CP), .LATENCY(LATENCY), .FINITE(LOOK)) result ( \
      .clk_i, .hit_i(HIT), .t_i(T), .cp_i(CP), .f_o, .t_o, .cp_o);

// ---- Convex pairs ----
`define DISTANCE_OUTPUTS \
    output logic [LANES-1:0][CW-1:0] f_o, \
    output logic [LANES-1:0][CW-1:0] t_o, \
    output logic [2:0][LANES-1:0][CW-1:0] cp_o, \
    output logic [2:0][LANES-1:0][CW-1:0] n_o, \
    output logic [15:0] latency_o
// F and T of the signed distance S, registered with CP and N.
`define DISTANCE_RESULT(S, CP, N) \
  localparam int LATENCY = `DF_MAX3(T_``CP, T_``N, T_``S + LAT.cmp) + 1; \
  assign latency_o = 16'(LATENCY); \
  distance_result #(`DF_SAME, .T_S(T_``S), .T_CP(T_``CP), .T_N(T_``N), .LATENCY(LATENCY)) result ( \
      .clk_i, .s_i(S), .cp_i(CP), .n_i(N), .f_o, .t_o, .cp_o, .n_o);
`endif
