// Host back end of every unit: one call of host_fp.h a lane, for simulation only. The register is at the output, not at the
// input as in the gates: the same timing from outside, and fewer stores.
// Latency: LAT clocks. Throughput: one result a lane a clock. Stall: none.
module fp_host #(
    parameter int OP = 0,      // code of host_fp.h: 0 add, 1 sub, 2 mul, 3 div, 4 sqrt, 5 lt, 6 le, 7 eq
    parameter int EXP = 8,
    parameter int MAN = 23,
    parameter int LANES = 1,
    parameter  int B_LANES = LANES,  // 1: b is one value for all lanes
    parameter int LAT = 1,
    parameter  bit CANON = 1,    // 0: the host back end may give any NaN; for results that only arithmetic reads
    parameter bit FLAGS = 0,
    localparam int CW = (1 + EXP + MAN <= 32) ? 32 : 64
) (
    input  logic                     clk_i,
    input  logic [LANES-1:0][CW-1:0] a_i,
    input  logic [B_LANES-1:0][CW-1:0] b_i,
    output logic [LANES-1:0][CW-1:0] r_o,
    output logic [LANES-1:0][CW-1:0] flags_o
);
  /*verilator inline_module*/
  if (!(EXP <= 10 && MAN <= 24) && !(EXP == 11 && MAN == 52)) $error("fp: the host back end has fp64 and formats up to e10m24");
`ifdef VERILATOR
  logic [LANES-1:0][CW-1:0] r_q;
  for (genvar l = 0; l < LANES; l++) begin : g_lane
    if (CW == 32) begin : g_32
      always_ff @(posedge clk_i) r_q[l] <= $c32("host_fp::op<", OP, ",", EXP, ",", MAN, ",", CANON, ">(", a_i[l], ",", b_i[l%B_LANES], ")");
    end else begin : g_64
      always_ff @(posedge clk_i) r_q[l] <= $c64("host_fp::op<", OP, ",", EXP, ",", MAN, ",", CANON, ">(", a_i[l], ",", b_i[l%B_LANES], ")");
    end
  end
  fp_delay #(.LANES(LANES), .W(CW), .DEPTH(LAT - 1)) delay_r (.clk_i, .d_i(r_q), .q_o(r_o));
  if (FLAGS) begin : g_flags
    logic [LANES-1:0][CW-1:0] f_q;
    for (genvar l = 0; l < LANES; l++) begin : g_lane
      if (CW == 32) begin : g_32
        always_ff @(posedge clk_i) f_q[l] <= $c32("host_fp::flags<", OP, ",", EXP, ",", MAN, ">(", a_i[l], ",", b_i[l%B_LANES], ")");
      end else begin : g_64
        always_ff @(posedge clk_i) f_q[l] <= $c64("host_fp::flags<", OP, ",", EXP, ",", MAN, ">(", a_i[l], ",", b_i[l%B_LANES], ")");
      end
    end
    fp_delay #(.LANES(LANES), .W(CW), .DEPTH(LAT - 1)) delay_f (.clk_i, .d_i(f_q), .q_o(flags_o));
  end else begin : g_no_flags
    assign flags_o = '0;
  end
`else
  $error("fp_host: ARITH = \"host\" exists only under Verilator");
`endif
endmodule
