formats_pkg.sv
pairs_pkg.sv
records_pkg.sv
registers_pkg.sv
pci_pkg.sv
config_pkg.sv
card_pkg.sv
hierarchy_pkg.sv
