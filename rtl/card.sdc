# SPDX-License-Identifier: Apache-2.0
# Timing constraints of card.sv: its clocks, and every path between them. SDC as OpenSTA, Vivado (as XDC) and others read it; the
# periods are the driver's defaults, other boards change them here. `tools/lint lines` holds the names against the RTL.

create_clock -name pci  -period 15.0 [get_ports clk_pci_i]
create_clock -name core -period 10.0 [get_ports clk_i]

# Clock gates (clock_gate.sv) pass these clocks on; a tool that does not look through an AND or a BUFGCE gets them as generated clocks.

# The reset is one line of neither domain. reset_sync.sv, RESET_STAGES >= 2, lets each domain leave it by its own clock, so the pin
# has no timing; what leaves the last stage is timed as any register is.
set_false_path -from [get_ports rst_i]

# The two FIFOs of pci_bridge.sv are all that crosses (async_fifo.sv).
# Gray pointers: bits of one pointer may not arrive further apart than the writer's next change, a clock of where they come from;
# the registers they arrive in are synchronisers, so nothing is asked of setup or hold there. Vivado: add -datapath_only, which stands
# for the line below each.
set_max_delay 15.0 -from [get_cells -hierarchical *requests*wgray_q*] -to [get_cells -hierarchical *requests*wgray_r1_q*]
set_max_delay 10.0 -from [get_cells -hierarchical *requests*rgray_q*] -to [get_cells -hierarchical *requests*rgray_w1_q*]
set_max_delay 10.0 -from [get_cells -hierarchical *responses*wgray_q*] -to [get_cells -hierarchical *responses*wgray_r1_q*]
set_max_delay 15.0 -from [get_cells -hierarchical *responses*rgray_q*] -to [get_cells -hierarchical *responses*rgray_w1_q*]
set_false_path -hold -to [get_cells -hierarchical *wgray_r1_q*]
set_false_path -hold -to [get_cells -hierarchical *rgray_w1_q*]

# Entries: written a clock of the writer before their pointer moves, read no sooner than two clocks of the reader after it did, and
# so at rest when they are looked at. A path from clock to clock other than those above is one of these.
set_max_delay 20.0 -from [get_clocks pci] -through [get_cells -hierarchical *requests*memory*] -to [get_clocks core]
set_max_delay 30.0 -from [get_clocks core] -through [get_cells -hierarchical *responses*memory*] -to [get_clocks pci]
set_false_path -hold -from [get_clocks pci] -to [get_clocks core]
set_false_path -hold -from [get_clocks core] -to [get_clocks pci]
