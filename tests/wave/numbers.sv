// SPDX-License-Identifier: Apache-2.0
module numbers(input logic clk, input logic [7:0] v);
  integer total, at, first, acc, j;
  int count, k;
  logic [7:0] mem [0:1];
  logic [7:0] turned;
  logic low;
  always @(posedge clk) begin
    count <= count + 1;
    at <= 1 - at;
    mem[at] <= v;
    total <= total + mem[at[0]];
    if (count < 0) low <= v[0];
    else low <= v[7];
  end
  always @* begin
    first = -1;
    for (j = 7; j >= 0; j = j - 1)
      if (v[j] && first == -1) first = j;
    acc = 0;
    if (acc == 0) acc = count;
    acc = acc + 2;
  end
  always @* begin
    k = -4;
    while (k < 4) begin
      turned[k + 4] = v[3 - k];
      k = k + 1;
    end
  end
endmodule
