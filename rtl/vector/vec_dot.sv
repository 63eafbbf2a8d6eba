// SPDX-License-Identifier: Apache-2.0
// Dot product (x*u + y*v) + z*w, one rounding per operation (3 multipliers, 2 adders).
// Latency: LAT.mul + 2*LAT.add cycles; 0 with ARITH = "host".
// Throughput: one value per lane per cycle.
// Stall: none.
module vec_dot #(
    parameter int EXP = 8,
    parameter int MAN = 23,
    parameter int LANES = 1,
    parameter int B_LANES = LANES,  // 1: b is one vector for all lanes
    parameter latency_pkg::latency_t LAT = latency_pkg::ONES,
    parameter ARITH = "rtl",
    parameter bit CANON = 1,  // as in fp_lanes, for the result
    localparam int CW = (1 + EXP + MAN <= 32) ? 32 : 64
) (
    input logic clk_i,
    input logic en_i,
    input logic [2:0][LANES-1:0][CW-1:0] a_i,
    input logic [2:0][B_LANES-1:0][CW-1:0] b_i,
    output logic [LANES-1:0][CW-1:0] r_o
);
  /*verilator inline_module*/
  for (genvar k = 0; k < 3; k++) begin : axis
    logic [LANES-1:0][CW-1:0] p;
    fp_lanes #(.OP(formats_pkg::FP_MUL), .EXP(EXP), .MAN(MAN), .LANES(LANES), .B_LANES(B_LANES), .LAT(LAT.mul),
        .ARITH(ARITH), .CANON(0)) mul (
        .clk_i, .en_i, .a_i(a_i[k]), .b_i(b_i[k]), .r_o(p), .flags_o());
  end
  logic [LANES-1:0][CW-1:0] xy, z;
  fp_lanes #(.OP(formats_pkg::FP_ADD), .EXP(EXP), .MAN(MAN), .LANES(LANES), .LAT(LAT.add), .ARITH(ARITH), .CANON(0))
      add_xy (
      .clk_i, .en_i, .a_i(axis[0].p), .b_i(axis[1].p), .r_o(xy), .flags_o());
  pipe_delay #(.W(LANES * CW), .FROM(LAT.mul), .TO(LAT.mul + LAT.add), .ARITH(ARITH))
      delay_z (.clk_i, .d_i(axis[2].p), .q_o(z));
  fp_lanes #(.OP(formats_pkg::FP_ADD), .EXP(EXP), .MAN(MAN), .LANES(LANES), .LAT(LAT.add), .ARITH(ARITH), .CANON(CANON))
      add_xyz (
      .clk_i, .en_i, .a_i(xy), .b_i(z), .r_o(r_o), .flags_o());
endmodule
