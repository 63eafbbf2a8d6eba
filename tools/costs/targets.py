# SPDX-License-Identifier: Apache-2.0
"""Devices and libraries of cells: synthesis and placement for each, its kinds of cells, and their numbers."""
import dataclasses
import re

from contract import Bad, listed

# Kinds of cells that a table counts.
COLUMNS = ("lut", "carry", "ff", "dsp", "ram", "lutram", "mux")
# Further columns of standard cells. Areas are in the library's unit.
CELL_COLUMNS = ("gates", "area", "ff_area", "memory_bits")
ROUTABLE = 0.85
NO_CELL = r"\$scopeinfo|VCC|GND"


@dataclasses.dataclass(frozen=True)
class Target:
    name: str
    device: str             # name by its maker
    synthesis: str          # Yosys command
    cells: dict             # column -> pattern of cell names
    router: str = ""        # tool for place and route, "" for area only
    route: tuple = ()       # its options, without seed and files
    has: dict = dataclasses.field(default_factory=dict)  # capacity of the device, by key of `used`
    library: str = ""       # library of standard cells, "" for an FPGA
    timer: str = ""         # tool for the timing of standard cells

    def count(self, types):
        """Cells by column. A type without a column is an error."""
        counted = dict.fromkeys(COLUMNS + (CELL_COLUMNS if self.library else ()), 0)
        for name, number in types.items():
            if re.fullmatch(NO_CELL, name):
                continue
            column = next((c for c, pattern in self.cells.items() if re.fullmatch(pattern, name)), None)
            if column is None:
                raise Bad(f"{self.name}: cell {name} has no column in tools/costs/targets.py")
            counted[column] += number
        return counted

    def used(self, row):
        """Resources that a design uses. On ECP5 a carry cell takes two LUTs, and a LUT as RAM takes six."""
        logic = row["lut"] + 2 * row["carry"] + 6 * row["lutram"] if self.cells is ECP5 else row["lut"]
        return {"logic": logic, "ff": row["ff"], "dsp": row["dsp"], "ram": row["ram"]}

    def lanes(self, row):
        """The number of lanes that fit, and the resource that limits it. A part of logic is left to the router and to the rest of a card."""
        copies = {what: (ROUTABLE if what in ("logic", "ff") else 1) * has / used
                for what, used in self.used(row).items() for has in (self.has.get(what, 0),) if used}
        least = min(copies, key=copies.get)
        return int(copies[least]) * row["lanes"], least


XILINX = {"lut": r"LUT[1-6]|INV", "carry": r"CARRY4|MUXCY", "ff": r"FD[A-Z]+(_1)?", "dsp": r"DSP48E1|MULT18X18S?",
          "ram": r"RAMB.*", "lutram": r"RAM(16|32|64|128|256)X.*|RAM(16|32|64)M.*|SRL.*", "mux": r"MUXF[5-9]|XORCY"}

ECP5 = {"lut": r"LUT4", "carry": r"CCU2C", "ff": r"TRELLIS_FF", "dsp": r"MULT18X18D|ALU54B", "ram": r"DP16KD|PDPW16KD",
        "lutram": r"TRELLIS_DPR16X4", "mux": r"PFUMX|L6MUX21"}
LFE5U_85 = {"logic": 83640, "ff": 83640, "dsp": 156, "ram": 208}

TARGETS = {t.name: t for t in (
    Target("ecp5-85", "Lattice LFE5U-85F, speed grade 6", "synth_ecp5", ECP5,
           "nextpnr-ecp5", ("--85k", "--package", "CABGA756", "--speed", "6", "--freq", "200", "--lpf-allow-unconstrained"), LFE5U_85),
    # Without LUT multiplexers, which make a design faster and larger.
    Target("ecp5-area", "Lattice LFE5U-85F, for few LUTs", "synth_ecp5 -nowidelut", ECP5, has=LFE5U_85),
    # Without -dsp: it gives wrong products, and the device has no multipliers.
    Target("hx8k", "Lattice iCE40 HX8K", "synth_ice40",
           {"lut": r"SB_LUT4", "carry": r"SB_CARRY", "ff": r"SB_DFF[A-Z]*", "ram": r"SB_RAM40_4K.*"},
           "nextpnr-ice40", ("--hx8k", "--package", "ct256", "--freq", "100"),
           {"logic": 7680, "ff": 7680, "ram": 32}),
    Target("xc7", "AMD 7 series", "synth_xilinx -family xc7 -flatten -nowidelut -noiopad -noclkbuf", XILINX),
    Target("virtex2p", "AMD Virtex-II Pro", "synth_xilinx -family xc2vp -flatten -nowidelut -noiopad -noclkbuf", XILINX),
    # The cells of `memory_bits` are ports of memories (asic.py); the row has the bits of the memories instead.
    Target("osu018", "OSU standard cells, 0.18 µm, typical", "synth -flatten",
           {"ff": r"DFF(POSX1|NEGX1|SR)", "gates": r"(AND|AOI|BUF|FA|HA|INV|MUX|NAND|NOR|OAI|OR|XNOR|XOR)\d*X\d|CLKBUF\d", "memory_bits": r"memory_[dq]"},
           library="osu018", timer="sta"),
)}


def target(name):
    if name not in TARGETS:
        raise Bad(f"{name} is not a target; expected {listed(TARGETS)}")
    return TARGETS[name]
