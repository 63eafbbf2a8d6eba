// Input contract of a ray: o and d finite, d not zero, tmin and tmax not NaN (they may be infinite). Combinational.
module ray_check #(
    parameter int EXP = 8,
    parameter int MAN = 23,
    localparam int CW = (1 + EXP + MAN <= 32) ? 32 : 64
) (
    input logic [7:0][CW-1:0] word_i,  // o x y z, d x y z, tmin, tmax
    output logic bad_o
);
  logic [7:0] special;
  logic [1:0] nan;
  logic [2:0] moves;
  for (genvar k = 0; k < 8; k++) begin : word
    assign special[k] = &word_i[k][MAN+:EXP];
  end
  for (genvar k = 0; k < 3; k++) begin : direction
    assign moves[k] = |word_i[3+k][EXP+MAN-1:0];
  end
  assign nan = {special[7] & (|word_i[7][MAN-1:0]), special[6] & (|word_i[6][MAN-1:0])};
  assign bad_o = (|special[5:0]) | ~(|moves) | (|nan);
endmodule
