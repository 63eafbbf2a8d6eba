// SPDX-License-Identifier: Apache-2.0
// Adder in the ordinary style, to compare areas. Its result equals rtl/fp/fp_add.sv bit by bit, without flags.
// Every word is as wide as its content: the significand has MAN+4 bits with carry, guard, round and sticky.
// Latency: 1 cycle, the input registers. Throughput: one per cycle. Stall: none.
module ordinary_add #(
    parameter  int EXP = 8,   // 3..11
    parameter  int MAN = 23,  // 2..52
    localparam int W   = 1 + EXP + MAN
) (
    input  logic         clk_i,
    input  logic [W-1:0] a_i,
    input  logic [W-1:0] b_i,
    output logic [W-1:0] r_o
);
  localparam int S = MAN + 4;        // hidden bit, fraction, guard, round, sticky
  localparam int KB = $clog2(S + 1);
  localparam logic [EXP-1:0] EMAX = '1;
  logic [W-1:0] a_q, b_q;
  always_ff @(posedge clk_i) begin
    a_q <= a_i;
    b_q <= b_i;
  end

  // x is the operand of larger magnitude.
  logic swap, sign_x, subtract, x_nan, y_nan, x_inf, y_inf;
  logic [EXP+MAN-1:0] x, y;
  logic [EXP-1:0] ex, ey, distance;
  always_comb begin
    swap = a_q[W-2:0] < b_q[W-2:0];
    x = swap ? b_q[W-2:0] : a_q[W-2:0];
    y = swap ? a_q[W-2:0] : b_q[W-2:0];
    sign_x = swap ? b_q[W-1] : a_q[W-1];
    subtract = a_q[W-1] ^ b_q[W-1];
    x_nan = x[MAN+:EXP] == EMAX && x[MAN-1:0] != 0;
    y_nan = y[MAN+:EXP] == EMAX && y[MAN-1:0] != 0;
    x_inf = x[MAN+:EXP] == EMAX && x[MAN-1:0] == 0;
    y_inf = y[MAN+:EXP] == EMAX && y[MAN-1:0] == 0;
    ex = (x[MAN+:EXP] == 0) ? EXP'(1) : x[MAN+:EXP];
    ey = (y[MAN+:EXP] == 0) ? EXP'(1) : y[MAN+:EXP];
    distance = ex - ey;
  end

  // Aligns, with the shifted-out bits as a sticky bit, and adds.
  logic [S-1:0] sx, sy;
  logic [S:0] sum;
  logic unused_carry;
  always_comb begin
    sx = {x[MAN+:EXP] != 0, x[MAN-1:0], 3'b0};
    sy = {y[MAN+:EXP] != 0, y[MAN-1:0], 3'b0};
    for (int i = 0; i < EXP; i++)
      if (distance[i]) begin
        if ((1 << i) < S) sy = (sy >> (1 << i)) | S'((sy << (S - (1 << i))) != S'(0));
        else sy = S'(sy != 0);
      end
    {sum, unused_carry} = {1'b0, sx, 1'b1} + ({1'b0, sy, 1'b0} ^ {S + 2{subtract}});
  end

  // Leading zeros below the carry, and no more than the exponent allows.
  logic [KB-1:0] zeros, shift;
  logic [EXP-1:0] e_less;
  logic [EXP:0] e;
  logic [S-1:0] norm;
  always_comb begin
    zeros = KB'(S);
    for (int i = 0; i < S; i++) if (sum[i]) zeros = KB'(S - 1 - i);
    e_less = ex - 1'b1;
    shift = (32'(zeros) <= 32'(e_less)) ? zeros : KB'(e_less);
    norm = sum[S] ? {sum[S:2], sum[1] | sum[0]} : sum[S-1:0] << shift;
    e = {1'b0, e_less} + (EXP + 1)'(sum[S]) - (sum[S] ? '0 : (EXP + 1)'(shift)) + (EXP + 1)'(norm[S-1]);
  end

  // Round to nearest even; a carry runs into the exponent.
  logic up;
  logic [EXP+MAN:0] rounded;
  always_comb begin
    up = norm[2] && (norm[3] || norm[1:0] != 0);
    rounded = {e, norm[S-2:3]} + (EXP + MAN + 1)'(up);
    if (x_nan || y_nan || (x_inf && y_inf && subtract)) r_o = {1'b0, EMAX, 1'b1, {MAN - 1{1'b0}}};
    else if (x_inf) r_o = {sign_x, EMAX, {MAN{1'b0}}};
    else if (sum == 0) r_o = {sign_x && !subtract, {W - 1{1'b0}}};
    else if (rounded[MAN+:EXP+1] >= {1'b0, EMAX}) r_o = {sign_x, EMAX, {MAN{1'b0}}};
    else r_o = {sign_x, rounded[EXP+MAN-1:0]};
  end
endmodule
