// SPDX-License-Identifier: Apache-2.0
// One operation on LANES lanes, with the back end that ARITH names. fp_add, fp_mul and the other units are built on it.
// Latency: LAT cycles; 0 with ARITH = "host".
// Throughput: one result per lane per cycle.
// Stall: none, runs free.
module fp_lanes #(
    parameter  int OP    = formats_pkg::FP_ADD,  // FP_* up to FP_MAX
    parameter  int EXP   = 8,      // 3..11
    parameter  int MAN   = 23,     // 2..52
    parameter  int LANES = 1,      // >= 1
    parameter  int B_LANES = LANES,  // LANES, or 1: b is one value for all lanes
    // >= 1; register cuts while the operation has stages to cut, then delay at the output
    parameter  int LAT   = 1,
    parameter      ARITH = "rtl",  // "rtl", or "host": combinational for any LAT
    parameter  bit CANON = 1,    // 0: the host back end may give any NaN; for results that only arithmetic reads
    parameter  bit FLAGS = 0,
    parameter  bit LEAST = formats_pkg::LEAST_WORDS,  // gates only, 1: words no wider than the format needs
    localparam int CW    = (1 + EXP + MAN <= 32) ? 32 : 64
) (
    input  logic                     clk_i,
    input  logic                     en_i,   // 0: no reader uses the result, so host arithmetic may skip it
    input  logic [LANES-1:0][CW-1:0] a_i,
    input  logic [B_LANES-1:0][CW-1:0] b_i,
    output logic [LANES-1:0][CW-1:0] r_o,
    output logic [LANES-1:0][CW-1:0] flags_o
);
  /*verilator inline_module*/
  if (EXP < 3 || EXP > 11 || MAN < 2 || MAN > 52) $error("fp: EXP must be 3..11 and MAN 2..52");
  if (LANES < 1 || LAT < 1 || (B_LANES != LANES && B_LANES != 1)) $error("fp: LANES, LAT >= 1; B_LANES is LANES or 1");
  if (ARITH == "rtl") begin : g_rtl
    logic unused_en;
    assign unused_en = en_i;
    // comparisons have no places for cuts
    localparam int MOST = (OP <= formats_pkg::FP_SUB) ? 7 : (OP == formats_pkg::FP_MUL) ? 10 :
        (OP == formats_pkg::FP_DIV) ? MAN + 8 : (OP == formats_pkg::FP_SQRT) ? MAN + 6 : 0;
    localparam int CUTS = (LAT - 1 > MOST) ? MOST : LAT - 1;
    localparam int LW = formats_pkg::lane_word(EXP, MAN, LEAST);
    logic [LANES-1:0][CW-1:0] r, flags;
    logic [LANES-1:0][LW-1:0] a_lane, r_lane, flags_lane;
    logic [B_LANES-1:0][LW-1:0] b_lane;
    if (LW == CW) begin : g_same
      assign a_lane = a_i;
      assign b_lane = b_i;
      assign r = r_lane;
      assign flags = flags_lane;
    end else if (LW < CW) begin : g_narrower
      localparam bit MASKS = OP >= formats_pkg::FP_LT && OP <= formats_pkg::FP_EQ;  // results are all ones or all zeros
      logic unused_high;
      assign unused_high = &{1'b0, a_i, b_i};
      for (genvar l = 0; l < LANES; l++) begin : g_lane
        assign a_lane[l] = a_i[l][LW-1:0];
        assign r[l] = {{CW - LW{MASKS & r_lane[l][LW-1]}}, r_lane[l]};
        assign flags[l] = {{CW - LW{1'b0}}, flags_lane[l]};
      end
      for (genvar l = 0; l < B_LANES; l++) begin : g_b
        assign b_lane[l] = b_i[l][LW-1:0];
      end
    end else begin : g_wider
      for (genvar l = 0; l < LANES; l++) begin : g_lane
        assign a_lane[l] = {{LW - CW{1'b0}}, a_i[l]};
        assign r[l] = r_lane[l][CW-1:0];
        assign flags[l] = flags_lane[l][CW-1:0];
      end
      for (genvar l = 0; l < B_LANES; l++) begin : g_b
        assign b_lane[l] = {{LW - CW{1'b0}}, b_i[l]};
      end
      logic unused_high;
      assign unused_high = &{1'b0, r_lane, flags_lane};
    end
    // At most 32 lanes in one object: wider objects spill registers in simulation.
    localparam int GROUP = (LANES % 32 == 0) ? 32 : LANES;
    localparam int B_GROUP = (B_LANES == 1) ? 1 : GROUP;
    for (genvar g = 0; g < LANES / GROUP; g++) begin : group
      fp_gates #(.OP(OP), .EXP(EXP), .MAN(MAN), .LANES(GROUP), .B_LANES(B_GROUP), .LEAST(LEAST), .CUTS(CUTS),
          .FLAGS(FLAGS)) gates (
          .clk_i, .a_i(a_lane[g*GROUP+:GROUP]), .b_i(b_lane[((B_LANES==1)?0:g*GROUP)+:B_GROUP]),
          .r_o(r_lane[g*GROUP+:GROUP]), .flags_o(flags_lane[g*GROUP+:GROUP]));
    end
    fp_delay #(.LANES(LANES), .W(CW), .DEPTH(LAT - 1 - CUTS)) delay_r (.clk_i, .d_i(r), .q_o(r_o));
    if (FLAGS) begin : g_flags
      fp_delay #(.LANES(LANES), .W(CW), .DEPTH(LAT - 1 - CUTS)) delay_f (.clk_i, .d_i(flags), .q_o(flags_o));
    end else begin : g_no_flags
      logic unused_flags;
      assign unused_flags = &{1'b0, flags};
      assign flags_o = '0;
    end
  end else begin : g_host
    fp_host #(.OP(OP), .EXP(EXP), .MAN(MAN), .LANES(LANES), .B_LANES(B_LANES), .CANON(CANON), .FLAGS(FLAGS)) host (
        .en_i, .a_i, .b_i, .r_o, .flags_o);
    logic unused_clk;
    assign unused_clk = clk_i;
  end
`ifdef CDE_TAP
  operator_tap #(.OP(OP), .CW(CW), .LAT(ARITH == "rtl" ? LAT : 0)) tap (
      .clk_i, .en_i(ARITH == "rtl" || en_i), .a_i(a_i[0]), .b_i(b_i[0]), .r_i(r_o[0]));
`endif
endmodule
