// Glitch-free clock gate (BUFGCE or an integrated clock-gating cell): the enable is sampled while the clock is low.
// Idle logic behind it costs neither power nor simulation time.
module clock_gate (
    input logic clk_i,
    input logic enable_i,
    output logic clk_o
);
  logic enable_l;
  always_latch if (!clk_i) enable_l = enable_i;
  assign clk_o = clk_i & enable_l;
endmodule
