// SPDX-License-Identifier: Apache-2.0
// Quotient a / b for a datapath that takes one per TURNS cycles, with the bits and the latency of fp_div_lane.sv in
// fp_lanes.sv. TURNS steps of the division share a subtractor and its registers, which hold twice the rest.
// Latency: LAT cycles.
// Throughput: one result per TURNS cycles.
// Stall: none, runs free.
module fp_div_turns #(
    parameter  int EXP   = 8,          // 3..11
    parameter  int MAN   = 23,         // 2..52
    parameter  int LAT   = MAN + 9,    // >= MAN + 9
    parameter  int TURNS = 8,          // 2, 4 or 8
    parameter  bit LEAST = formats_pkg::LEAST_WORDS,
    localparam int WORD  = (1 + EXP + MAN <= 32) ? 32 : 64
) (
    input  logic            clk_i,
    input  logic            take_i,  // a_i and b_i may be there: one cycle of TURNS, always
    input  logic [WORD-1:0] a_i,
    input  logic [WORD-1:0] b_i,
    output logic [WORD-1:0] r_o
);
  /*verilator inline_module*/
  localparam int CW = formats_pkg::lane_word(EXP, MAN, LEAST);
  localparam int EW = formats_pkg::lane_exponent(EXP, MAN, LEAST);
`include "fp_mask.svh"
  localparam logic [EW-1:0] BIAS = EW'(EMAX >> 1);
  localparam int STEPS = MAN + 3;
  localparam int GROUPS = (STEPS + TURNS - 1) / TURNS;
  localparam int TOP = formats_pkg::round_top(EXP, MAN, LEAST);
  localparam int T_NORMAL = 2;  // stage times: the normalised operands, and the digits
  localparam int T_DIGITS = T_NORMAL + 1 + STEPS;
  localparam int T_ROUNDED = T_DIGITS + 3;
  if (LAT < T_ROUNDED) $error("fp_div_turns: LAT must be at least MAN + 9");

  // ---- Operands ----
  logic [CW-1:0] a_q, b_q, a_size, b_size, x, y;
  logic [EW-1:0] e_x, e_y, e_of_round;
  logic [T_NORMAL:1] take_q;
  always_ff @(posedge clk_i) begin
    {a_q, b_q} <= {CW'(a_i), CW'(b_i)};
    take_q <= {take_q[1], take_i};
  end
  assign a_size = a_q & MAG;
  assign b_size = b_q & MAG;
  fp_normalise #(.EXP(EXP), .MAN(MAN), .LEAST(LEAST), .CUT(1)) normalise_a (
      .clk_i, .mag_i(a_size), .s_o(x), .e_o(e_x));
  fp_normalise #(.EXP(EXP), .MAN(MAN), .LEAST(LEAST), .CUT(1)) normalise_b (
      .clk_i, .mag_i(b_size), .s_o(y), .e_o(e_y));
  turn_delay #(.W(EW), .FROM(T_NORMAL), .TO(T_DIGITS), .TURNS(TURNS)) delay_e (
      .clk_i, .take_i(take_q[T_NORMAL]), .d_i(e_x - e_y + BIAS - (E_ONE << 1)), .q_o(e_of_round));
  logic [CW-1:0] some_a, some_b, special_a, special_b, nan_a, nan_b;
  logic sign, zero, inf, nan, sign_late, zero_late, inf_late, nan_late, unused_masks;
  always_comb begin
    {some_a, some_b} = {some(a_size), some(b_size)};
    {special_a, special_b} = {special(a_size), special(b_size)};
    {nan_a, nan_b} = {is_nan(a_size), is_nan(b_size)};
    sign = a_q[EXP+MAN] ^ b_q[EXP+MAN];
    zero = !some_a[0] || special_b[0];
    inf = special_a[0] || !some_b[0];
    nan = nan_a[0] || nan_b[0] || (!some_a[0] && !some_b[0]) || (special_a[0] && special_b[0]);
    unused_masks = &{1'b0, some_a, some_b, special_a, special_b, nan_a, nan_b, x, y};
  end
  turn_delay #(.W(4), .FROM(1), .TO(T_DIGITS), .TURNS(TURNS)) delay_kind (
      .clk_i, .take_i(take_q[1]), .d_i({sign, zero, inf, nan}),
      .q_o({sign_late, zero_late, inf_late, nan_late}));

  // ---- Digits: a group takes TURNS steps, one per cycle, and the next one takes its rest ----
  for (genvar g = 0; g < GROUPS; g++) begin : group
    localparam int DIGITS = ((g + 1) * TURNS < STEPS) ? (g + 1) * TURNS : STEPS;
    logic [MAN+1:0] twice_q, twice_next, first_twice;
    logic [MAN:0] divisor_q, first_divisor;
    logic [DIGITS-1:0] digits_q, digits_next, first_digits;
    logic [MAN+2:0] trial;
    if (g == 0) begin : g_operands
      assign first_twice = {1'b0, x[CW-1-:MAN+1]};
      assign first_divisor = y[CW-1-:MAN+1];
      assign first_digits = '0;
    end else begin : g_rest
      assign first_twice = group[g-1].twice_next;
      assign first_divisor = group[g-1].divisor_q;
      assign first_digits = DIGITS'(group[g-1].digits_next);
    end
    assign trial = {1'b0, twice_q} - {2'b0, divisor_q};
    assign twice_next = {trial[MAN+2] ? twice_q[MAN:0] : trial[MAN:0], 1'b0};
    assign digits_next = DIGITS'({digits_q, !trial[MAN+2]});
    always_ff @(posedge clk_i)
      if (take_q[T_NORMAL]) {twice_q, divisor_q, digits_q} <= {first_twice, first_divisor, first_digits};
      else {twice_q, digits_q} <= {twice_next, digits_next};
  end
  logic [MAN+1:0] rest;
  logic [STEPS-1:0] digits;
  if (GROUPS * TURNS == STEPS) begin : g_next_word
    always_ff @(posedge clk_i)
      if (take_q[T_NORMAL]) {rest, digits} <= {group[GROUPS-1].twice_next, group[GROUPS-1].digits_next};
  end else begin : g_in_last
    assign {rest, digits} = {group[GROUPS-1].twice_q, group[GROUPS-1].digits_q};
  end

  // ---- Rounding ----
  logic [CW-1:0] quotient, r, unused_flags;
  assign quotient = (CW'(digits) << (TOP + 1 - STEPS)) | CW'(rest != '0);
  fp_round #(.EXP(EXP), .MAN(MAN), .LEAST(LEAST), .CUT_COUNT(1), .CUT(1), .CUT_PACK(1)) round (
      .clk_i, .m_i(quotient), .e_i(e_of_round), .sign_i({CW{sign_late}} & SIGN), .zero_i({CW{zero_late}}),
      .inf_i({CW{inf_late}}), .nan_i({CW{nan_late}}), .nv_i('0), .dz_i('0), .r_o(r), .flags_o(unused_flags));
  fp_delay #(.W(WORD), .DEPTH(LAT - T_ROUNDED)) delay_r (.clk_i, .d_i(WORD'(r)), .q_o(r_o));
`ifdef CDE_TAP
  operator_tap #(.OP(formats_pkg::FP_DIV), .CW(WORD), .LAT(LAT)) tap (.clk_i, .en_i(take_i), .a_i, .b_i, .r_i(r_o));
`endif
endmodule
