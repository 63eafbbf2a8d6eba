// SPDX-License-Identifier: Apache-2.0
typedef struct packed { logic v; logic [2:0] d; } s_t;
module part #(parameter int W = 4) (input logic clk, input logic [W-1:0] a, output logic [W-1:0] q);
  always_ff @(posedge clk) q <= a;
endmodule
module rich (input logic clk, input logic rst, input logic en, input logic [3:0] x,
             output logic [3:0] y);
  typedef enum logic [1:0] {IDLE, RUN, STOP} state_t;
  state_t state;
  s_t s;
  logic [3:0] mem [4];
  logic [3:0] sum, pick;
  function automatic logic [3:0] twice(input logic [3:0] v); return v + v; endfunction
  always_ff @(posedge clk or posedge rst)
    if (rst) s <= '0;
    else if (en) s <= s_t'(x);
  always_ff @(posedge clk)
    case (state)
      IDLE: if (s.v) state <= RUN;
      RUN: state <= STOP;
      default: state <= IDLE;
    endcase
  always_ff @(posedge clk) if (en) mem[x[1:0]] <= x;
  assign sum = twice({1'b0, s.d});
  always_comb begin
    pick = sum;
    if (en) pick = mem[2];
  end
  for (genvar g = 0; g < 2; g++) begin : half
    part #(2) part (.clk, .a(pick[2*g+:2]), .q(y[2*g+:2]));
  end
endmodule
