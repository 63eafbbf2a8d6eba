# SPDX-License-Identifier: Apache-2.0
"""A whole card on one FPGA: rtl/fpga_card.sv."""

WHAT = "card"
TARGET = "ecp5-85"
# Place and route ask nextpnr for different clocks. Only paths beyond the clock have weight in the placement, so a low clock keeps wires short.
# If all paths meet the clock, router2 calls all of them critical, and critical paths hardly avoid wires that are used twice. So it is asked for more.
PLACE_MHZ, ROUTE_MHZ = 45, 62
# Settings of router2. The box of a net is larger, the cost of a wire that is used twice grows per round, and nets of paths that are too slow
# are routed again. The first three have no option.
ROUTER = {"router2/bbMargin/x": "12", "router2/bbMargin/y": "12", "router2/currCongWeightMult": "1.5", "router/tmg_ripup": f"{1:032b}"}
# Ports of fpga_card.sv: direction, bits, name.
PORTS = (("input", 1, "clk_i"), ("input", 1, "rst_i"), ("input", 1, "bus_valid_i"), ("input", 1, "bus_write_i"), ("input", 3, "bus_space_i"),
         ("input", 32, "bus_addr_i"), ("input", 64, "bus_wdata_i"), ("output", 1, "bus_ready_o"), ("output", 1, "bus_rvalid_o"),
         ("output", 64, "bus_rdata_o"), ("output", 1, "irq_o"), ("output", 1, "memory_access_o"), ("output", 1, "memory_write_o"),
         ("output", 32, "memory_addr_o"), ("output", 16, "memory_data_o"), ("input", 1, "memory_ready_i"), ("input", 1, "memory_valid_i"),
         ("input", 16, "memory_data_i"))
# A lane that takes a row per eight cycles, a traversal unit with the fewest contexts, memories that fit on the FPGA, and 8 MB behind the port.
PARAMETERS = {"BOX": 1, "NODE_CYCLES": 4, "NODE_CACHE": 512, "NODE_WAYS": 4, "PINNED_NODES": 512, "CONTEXTS": 16, "SHARED_LANE": 8, "RAY_PLACES": 512,
              "TRAVERSAL_UNITS": 1, "LANES": 1, "PRIMARIES": 64, "SRAM_RECORDS": 512, "NODES": 65536, "DDR_SLOTS": 233016}


def parameters(lat):
    """NAME -> value of the card's parameters, with these cycles of add, mul, div, sqrt and compare."""
    return PARAMETERS | {f"LAT_{kind}": cycles for kind, cycles in zip(("ADD", "MUL", "DIV", "SQRT", "CMP"), lat)}


def bench(lat):
    """The text that is synthesised: the card with its ports as pins."""
    ports = ", ".join(f"{way} logic [{bits - 1}:0] {name}" if bits > 1 else f"{way} logic {name}" for way, bits, name in PORTS)
    values = ", ".join(f".{name}({value})" for name, value in parameters(lat).items())
    return f"""module measured ({ports});
  fpga_card #({values}) card (.*);
endmodule

module bench ({ports});
  measured measured (.*);
endmodule
"""
