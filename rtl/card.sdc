# SPDX-License-Identifier: Apache-2.0
# Timing constraints of card.sv: its clocks, and every path between them. OpenSTA, Vivado (as XDC) and other tools read this SDC. The
# periods are the driver's defaults; change them here for other boards. `tools/lint lines` checks the names against the RTL.

create_clock -name pci  -period 15.0 [get_ports clk_pci_i]
create_clock -name core -period 10.0 [get_ports clk_i]

# Clock gates (clock_gate.sv) forward these clocks. Define generated clocks for a tool that does not trace through an AND or a BUFGCE.

# The reset belongs to neither domain. With RESET_STAGES >= 2, each domain leaves it with its own clock (reset_sync.sv), so the pin
# has no timing. Paths from the last stage are timed as from any register.
set_false_path -from [get_ports rst_i]

# Only the two FIFOs of pci_bridge.sv cross between the domains (async_fifo.sv).
# Gray pointers: the skew between bits of a pointer must be less than one cycle of the source clock. They arrive in synchronisers, so
# setup and hold need no check there. In Vivado, add -datapath_only; it replaces the false path of each.
set_max_delay 15.0 -from [get_cells -hierarchical *requests*wgray_q*] -to [get_cells -hierarchical *requests*wgray_r1_q*]
set_max_delay 10.0 -from [get_cells -hierarchical *requests*rgray_q*] -to [get_cells -hierarchical *requests*rgray_w1_q*]
set_max_delay 10.0 -from [get_cells -hierarchical *responses*wgray_q*] -to [get_cells -hierarchical *responses*wgray_r1_q*]
set_max_delay 15.0 -from [get_cells -hierarchical *responses*rgray_q*] -to [get_cells -hierarchical *responses*rgray_w1_q*]
set_false_path -hold -to [get_cells -hierarchical *wgray_r1_q*]
set_false_path -hold -to [get_cells -hierarchical *rgray_w1_q*]

# Entries: the writer writes an entry one cycle before it moves the pointer. The reader reads it at least two of its cycles later, when
# the entry is stable. All other paths between the clocks are paths of entries.
set_max_delay 20.0 -from [get_clocks pci] -through [get_cells -hierarchical *requests*memory*] -to [get_clocks core]
set_max_delay 30.0 -from [get_clocks core] -through [get_cells -hierarchical *responses*memory*] -to [get_clocks pci]
set_false_path -hold -from [get_clocks pci] -to [get_clocks core]
set_false_path -hold -from [get_clocks core] -to [get_clocks pci]
