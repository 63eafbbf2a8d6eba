// SPDX-License-Identifier: Apache-2.0
// The largest key that counts for the best T so far of a ray (key_limit() of
// host/src/reference/integer_node.cpp). A child with a larger key has no hit with a smaller T. If farthest_i, it has
// none with a larger T.
// Latency: NODE_T_LIMIT cycles (bvh.svh).
// Throughput: one key per cycle.
// Stall: none, runs free.
`include "bvh.svh"
module key_limit #(
    parameter ARITH = "rtl",
    parameter int STEP_BITS = 6,  // as in node_boxes_int.sv
    localparam int KEY = bvh_pkg::RAY_KEY
) (
    input logic clk_i,
    // There is a T. Must come from a register: with host arithmetic it drives the enable of a clock gate.
    input logic valid_i,
    input logic [31:0] time_i,       // T; may be infinite
    input logic [31:0] reference_i,  // T_ref of the keys
    input logic [7:0] scale_i,       // biased exponent of a step
    input logic farthest_i,          // changes only between passes
    output logic [KEY-1:0] limit_o
);
  /*verilator inline_module*/
  // Keys count quarters of the least unit.
  logic [7:0] quarter;
  assign quarter = scale_i + 8'(STEP_BITS - 2);
`ifdef VERILATOR
  if (ARITH != "rtl") begin : g_host
    logic clk;
    logic [31:0] first_q;
    clock_gate gate (.clk_i, .enable_i(valid_i), .clk_o(clk));
    always_ff @(posedge clk)
      first_q <= $c32("host_fp::key_limit(", time_i, ",", reference_i, ",", quarter, ",", farthest_i, ")");
    logic unused;
    assign unused = &{1'b0, first_q[31:KEY]};
    pipe_delay #(.W(KEY), .FROM(1), .TO(`NODE_T_LIMIT)) delay_limit (.clk_i, .d_i(first_q[KEY-1:0]), .q_o(limit_o));
  end
`endif
  if (ARITH == "rtl") begin : g_gates
    logic unused;
    assign unused = valid_i;
    localparam int SW = KEY + 1;
    logic [SW-1:0] steps;
    logic inexact;
    logic [31:0] time_q, reference_q;  // the inputs come from block memories
    logic [7:0] quarter_q;
    always_ff @(posedge clk_i) {time_q, reference_q, quarter_q} <= {time_i, reference_i, quarter};
    time_steps #(.BITS(SW)) in_quarters (
        .clk_i, .time_i(time_q), .reference_i(reference_q), .step_i(quarter_q), .steps_o(steps),
        .inexact_o(inexact));
    logic [SW:0] first;
    assign first = farthest_i ? -({steps[SW-1], steps} + (SW + 1)'(inexact)) : {steps[SW-1], steps};
    // Limited to signed KEY bits. The sign is inverted: keys are unsigned.
    always_ff @(posedge clk_i)
      limit_o <= (first[SW:KEY-1] != {(SW - KEY + 2) {first[SW]}}) ? {KEY{!first[SW]}} :
          {!first[KEY-1], first[KEY-2:0]};
  end
endmodule
