# SPDX-License-Identifier: Apache-2.0
"""A whole card on one FPGA: rtl/fpga_card.sv with the parameters of a device of docs/devices.json."""
import functools
import json

from contract import ROOT

WHAT = "card"
DEVICE = "ecp5-85"
# Ports of fpga_card.sv: direction, bits, name.
PORTS = (("input", 1, "clk_i"), ("input", 1, "rst_i"), ("input", 1, "bus_valid_i"), ("input", 1, "bus_write_i"), ("input", 3, "bus_space_i"),
         ("input", 32, "bus_addr_i"), ("input", 64, "bus_wdata_i"), ("output", 1, "bus_ready_o"), ("output", 1, "bus_rvalid_o"),
         ("output", 64, "bus_rdata_o"), ("output", 1, "irq_o"), ("output", 1, "memory_access_o"), ("output", 1, "memory_write_o"),
         ("output", 32, "memory_addr_o"), ("output", 16, "memory_data_o"), ("input", 1, "memory_ready_i"), ("input", 1, "memory_valid_i"),
         ("input", 16, "memory_data_i"))
# Parameters that no device of the table names: memories that fit on the FPGA, and 8 MB behind the port.
SIZES = {"PRIMARIES": 64, "SRAM_RECORDS": 512, "NODES": 65536, "DDR_SLOTS": 233016}
KEYS = {"NODE_CYCLES": "node_cycles", "NODE_CACHE": "node_cache", "NODE_WAYS": "node_ways", "PINNED_NODES": "pinned_nodes", "CONTEXTS": "contexts",
        "SHARED_LANE": "shared_lane", "RAY_PLACES": "ray_places", "TRAVERSAL_UNITS": "traversal_units", "LANES": "lanes"}


@functools.lru_cache(maxsize=None)
def device():
    rows = json.loads((ROOT / "docs" / "devices.json").read_text())["devices"]
    return next(row for row in rows if row["name"] == DEVICE)


def parameters(lat):
    """NAME -> value of the card's parameters, with these cycles of add, mul, div, sqrt and compare."""
    found = {name: device()[key] for name, key in KEYS.items()}
    cycles = {f"LAT_{kind.upper()}": cycles for kind, cycles in zip(("add", "mul", "div", "sqrt", "cmp"), lat)}
    return {"BOX": 1, **found, **SIZES, **cycles}


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
