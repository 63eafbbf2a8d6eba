// SPDX-License-Identifier: Apache-2.0
// Host back end of every unit: one call of host_fp.h per lane, for simulation only. It is combinational. With ARITH =
// "host" a pipe computes in the cycle in which its result leaves. The engine gives it its operands in that cycle. So
// the timing outside is the same as with gates, and nothing inside is stored from cycle to cycle
// (docs/background/architecture.md).
// Latency: 0.
// Throughput: one result per lane per cycle.
// Stall: none.
module fp_host #(
    parameter int OP = formats_pkg::FP_ADD,
    parameter int EXP = 8,
    parameter int MAN = 23,
    parameter int LANES = 1,
    parameter  int B_LANES = LANES,  // 1: b is one value for all lanes
    parameter  bit CANON = 1,    // 0: may give any NaN, for results that only arithmetic reads
    parameter bit FLAGS = 0,
    localparam int CW = (1 + EXP + MAN <= 32) ? 32 : 64
) (
    input  logic                     en_i,   // 0: no reader uses the result, and it is zero
    input  logic [LANES-1:0][CW-1:0] a_i,
    input  logic [B_LANES-1:0][CW-1:0] b_i,
    output logic [LANES-1:0][CW-1:0] r_o,
    output logic [LANES-1:0][CW-1:0] flags_o
);
  /*verilator inline_module*/
`ifdef VERILATOR
  // The whole vector is written first, so that Verilator keeps it in a local variable, not in the model.
  logic [LANES-1:0][CW-1:0] r, f;
  if (CW == 32) begin : g_32
    always_comb begin
      r = '0;
      if (en_i)
        for (int l = 0; l < LANES; l++) r[l] = $c32("host_fp::op<", OP, ",", EXP, ",", MAN, ",", CANON, ">(", a_i[l],
            ",", b_i[l%B_LANES], ")");
    end
  end else begin : g_64  // uint64_t is named, because Verilator writes constants as unsigned long long
    always_comb begin
      r = '0;
      if (en_i)
        for (int l = 0; l < LANES; l++) r[l] = $c64("host_fp::op<", OP, ",", EXP, ",", MAN, ",", CANON, ",uint64_t>(",
            a_i[l], ",", b_i[l%B_LANES], ")");
    end
  end
  if (!FLAGS) begin : g_no_flags
    assign f = '0;
  end else if (CW == 32) begin : g_f32
    always_comb begin
      f = '0;
      for (int l = 0; l < LANES; l++) f[l] = $c32("host_fp::flags<", OP, ",", EXP, ",", MAN, ">(", a_i[l], ",",
          b_i[l%B_LANES], ")");
    end
  end else begin : g_f64
    always_comb begin
      f = '0;
      for (int l = 0; l < LANES; l++) f[l] = $c64("host_fp::flags<", OP, ",", EXP, ",", MAN, ",uint64_t>(", a_i[l], ",",
          b_i[l%B_LANES], ")");
    end
  end
  assign r_o = r;
  assign flags_o = f;
`else
  $error("fp_host: ARITH = \"host\" exists only under Verilator");
`endif
endmodule
