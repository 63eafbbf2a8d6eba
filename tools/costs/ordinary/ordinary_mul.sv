// SPDX-License-Identifier: Apache-2.0
// Multiplier in the ordinary style, to compare areas. Its result equals rtl/fp/fp_mul.sv bit by bit, without flags.
// A subnormal significand is normalised before the multiplier. If two subnormals always give zero, only the smaller
// operand is normalised. A result below the normal range is shifted back after the multiplier.
// Latency: 1 cycle, the input registers. Throughput: one per cycle. Stall: none.
module ordinary_mul #(
    parameter  int EXP = 8,   // 3..11
    parameter  int MAN = 23,  // 2..52
    localparam int W   = 1 + EXP + MAN
) (
    input  logic         clk_i,
    input  logic [W-1:0] a_i,
    input  logic [W-1:0] b_i,
    output logic [W-1:0] r_o
);
  localparam int BIAS = (1 << (EXP - 1)) - 1;
  localparam bit BOTH = BIAS < MAN + 2;  // a product of two subnormals can be more than half of the smallest one
  localparam int EB = ((1 << EXP) > MAN ? EXP : $clog2(MAN + 1)) + 2;  // bits of a signed exponent
  localparam int KB = $clog2(MAN + 1);
  localparam int S = MAN + 4;
  localparam logic [EXP-1:0] EMAX = '1;
  logic [W-1:0] a_q, b_q;
  always_ff @(posedge clk_i) begin
    a_q <= a_i;
    b_q <= b_i;
  end

  // x is the operand of larger magnitude.
  logic swap, sign, x_nan, y_nan, x_inf;
  logic [EXP+MAN-1:0] x, y;
  always_comb begin
    swap = a_q[W-2:0] < b_q[W-2:0];
    x = swap ? b_q[W-2:0] : a_q[W-2:0];
    y = swap ? a_q[W-2:0] : b_q[W-2:0];
    sign = a_q[W-1] ^ b_q[W-1];
    x_nan = x[MAN+:EXP] == EMAX && x[MAN-1:0] != 0;
    y_nan = y[MAN+:EXP] == EMAX && y[MAN-1:0] != 0;
    x_inf = x[MAN+:EXP] == EMAX && x[MAN-1:0] == 0;
  end

  // Leading zeros of a subnormal's fraction.
  function automatic logic [KB-1:0] zeros(input logic [MAN-1:0] v);
    zeros = KB'(MAN);
    for (int i = 0; i < MAN; i++) if (v[i]) zeros = KB'(MAN - 1 - i);
  endfunction
  logic [KB-1:0] kx, ky;
  logic [MAN:0] sx, sy;
  logic [2*MAN+1:0] product;
  logic [EB-1:0] e;
  always_comb begin
    kx = (BOTH && x[MAN+:EXP] == 0) ? zeros(x[MAN-1:0]) : '0;
    ky = (y[MAN+:EXP] == 0) ? zeros(y[MAN-1:0]) : '0;
    sx = (BOTH && x[MAN+:EXP] == 0) ? {x[MAN-1:0], 1'b0} << kx : {x[MAN+:EXP] != 0, x[MAN-1:0]};
    sy = (y[MAN+:EXP] == 0) ? {y[MAN-1:0], 1'b0} << ky : {1'b1, y[MAN-1:0]};
    product = sx * sy;
    // biased exponent of a product in [1, 2), two's complement
    e = EB'(x[MAN+:EXP]) + EB'(y[MAN+:EXP]) - EB'(kx) - EB'(ky) - EB'(BIAS);
  end

  // Hidden bit on top, guard, round and sticky below. Then shifts back if the exponent is below the normal range.
  logic [2*MAN+1:0] top;
  logic [S-1:0] norm;
  logic [EB-1:0] e_norm, down;
  logic [EXP:0] e_r;
  logic tiny;
  always_comb begin
    top = product[2*MAN+1] ? product : product << 1;
    e_norm = e + EB'(product[2*MAN+1]);
    tiny = e_norm[EB-1] || e_norm == 0;
    down = tiny ? EB'(1) - e_norm : '0;
    e_r = tiny ? '0 : e_norm[EXP:0];
    norm = {top[2*MAN+1-:MAN+3], |top[MAN-2:0]};
    for (int i = 0; i < EB; i++)
      if (down[i]) begin
        if ((1 << i) < S) norm = (norm >> (1 << i)) | S'((norm << (S - (1 << i))) != S'(0));
        else norm = S'(norm != 0);
      end
  end

  // Round to nearest even; a carry runs into the exponent.
  logic up;
  logic [EXP+MAN:0] rounded;
  always_comb begin
    up = norm[2] && (norm[3] || norm[1:0] != 0);
    rounded = {e_r, norm[S-2:3]} + (EXP + MAN + 1)'(up);
    if (x_nan || y_nan || (x_inf && y == 0)) r_o = {1'b0, EMAX, 1'b1, {MAN - 1{1'b0}}};
    else if (x_inf) r_o = {sign, EMAX, {MAN{1'b0}}};
    else if (y == 0) r_o = {sign, {W - 1{1'b0}}};
    else if (rounded[MAN+:EXP+1] >= {1'b0, EMAX}) r_o = {sign, EMAX, {MAN{1'b0}}};
    else r_o = {sign, rounded[EXP+MAN-1:0]};
  end
endmodule
