// SPDX-License-Identifier: Apache-2.0
// A lane with words, a byte, 64 bits, a memory, functions that are called twice, and an operation without a vector
// form.
module lane_steps (
    input logic clk_i,
    input logic [31:0] a_i,
    input logic [31:0] b_i,
    output logic [31:0] r_o
);
  /*verilator inline_module*/
  function automatic logic [31:0] neg(input logic [31:0] v);
    return -(v >> 31);
  endfunction
  function automatic logic [31:0] shifted(input logic [31:0] v, input logic [4:0] by);
    return (v << by) ^ (v - 32'd1);
  endfunction
  logic [31:0] x_q, y_q, z_q, line_q[3];
  logic [4:0] n_q;
  logic [6:0] m_q;
  logic [47:0] product_q;
  logic parity_q;
  always_ff @(posedge clk_i) begin
    x_q <= neg(a_i - b_i);
    y_q <= neg(b_i) & a_i;
    n_q <= a_i[4:0] ^ b_i[9:5];
    m_q <= 7'(n_q) + 7'(a_i[11:8]);
    z_q <= shifted(x_q ^ a_i, n_q) + shifted(y_q, b_i[4:0]);
    product_q <= 48'(a_i[23:0]) * 48'(b_i[23:0]);
    parity_q <= ^a_i;
    line_q[0] <= z_q * b_i;
    for (int i = 1; i < 3; i++) line_q[i] <= line_q[i-1];
  end
  assign r_o = line_q[2] ^ 32'(product_q >> 16) ^ {31'(m_q), parity_q};
endmodule
