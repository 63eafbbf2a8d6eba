// SPDX-License-Identifier: Apache-2.0
// Clock gate: passes the clock while it is enabled, without glitches. The enable comes from registers of `clk_i` and
// counts for the next rising edge. Logic behind it costs neither power nor simulation time while it is idle.
//   "latch"   a latch that is open while the clock is low, and an AND. For simulation. ASIC flows put the library's
//             integrated clock gate (ICG) here, as for the same form where they infer it.
//   "bufgce"  AMD's clock buffer with enable. For FPGAs, for the few gates of whole units.
//   "enable"  an AND with the attribute `gated_clock`. For FPGAs: the tool makes it the enable of the registers behind
//             it (Vivado: synth_design -gated_clock_conversion auto; Synplify: fix_gated_and_generated_clocks).
//   "open"    a wire, for gates in FPGAs with few clock trees. Registers then change while their unit is idle. Models
//             of fpga_card.sv have it, and tests compare their records.
// GATE is chosen once per chip, by the macro CDE_CLOCK_GATE, which every tool can define, or at an instance.
// Latency: none.
// Throughput: not applicable.
// Stall: none.
`ifndef CDE_CLOCK_GATE
`define CDE_CLOCK_GATE "latch"
`endif
module clock_gate #(
    parameter GATE = `CDE_CLOCK_GATE
) (
    input logic clk_i,
    input logic enable_i,
    output logic clk_o
);
  if (GATE == "latch") begin : g_latch
    logic enable_l;
    always_latch if (!clk_i) enable_l = enable_i;
    assign clk_o = clk_i & enable_l;
  end else if (GATE == "bufgce") begin : g_bufgce
    BUFGCE buffer (.I(clk_i), .CE(enable_i), .O(clk_o));
  end else if (GATE == "enable") begin : g_enable
    (* gated_clock = "true" *) logic gated;
    assign gated = clk_i & enable_i;
    assign clk_o = gated;
  end else if (GATE == "open") begin : g_open
    logic unused_enable;
    assign unused_enable = enable_i;
    assign clk_o = clk_i;
  end else begin : g_illegal
    $error("clock_gate: GATE must be latch, bufgce, enable or open");
  end
endmodule
