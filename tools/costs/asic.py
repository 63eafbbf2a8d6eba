# SPDX-License-Identifier: Apache-2.0
"""Standard cells: commands of Yosys and OpenSTA, readers of their reports, and ratios to the fp32 adder of a lane."""
import json
import re

from contract import Bad

CELLS = "cells.lib"     # the library's liberty file, beside the netlist
PERIOD = 100.0          # ns, of the clock whose slack OpenSTA reports
UNPLACED = "unplaced"   # the key of the clock in a row, where rows of FPGAs have their seeds
BOXES = ("memory_d", "memory_q")

# ABC's file of constraints: what drives a net from a register (ABC knows no registers), and the load at the input of one, in fF.
CONSTRAINTS = "set_driving_cell BUFX2\nset_load 10\n"

# A memory that the RTL marks with ram_style becomes cells without area and timing, one per bit of its ports.
MEMORY = """(* techmap_celltype = "$mem_v2" *)
module memory_apart (RD_CLK, RD_EN, RD_ARST, RD_SRST, RD_ADDR, RD_DATA, WR_CLK, WR_EN, WR_ADDR, WR_DATA);
  parameter MEMID = "", SIZE = 1, OFFSET = 0, ABITS = 1, WIDTH = 1, INIT = 0, RD_PORTS = 1, RD_CLK_ENABLE = 0, RD_CLK_POLARITY = 0;
  parameter RD_TRANSPARENCY_MASK = 0, RD_COLLISION_X_MASK = 0, RD_WIDE_CONTINUATION = 0, RD_CE_OVER_SRST = 0, RD_ARST_VALUE = 0;
  parameter RD_SRST_VALUE = 0, RD_INIT_VALUE = 0, WR_PORTS = 1, WR_CLK_ENABLE = 0, WR_CLK_POLARITY = 0, WR_PRIORITY_MASK = 0;
  parameter WR_WIDE_CONTINUATION = 0;
  input [RD_PORTS-1:0] RD_CLK, RD_EN, RD_ARST, RD_SRST;
  input [RD_PORTS*ABITS-1:0] RD_ADDR;
  output [RD_PORTS*WIDTH-1:0] RD_DATA;
  input [WR_PORTS-1:0] WR_CLK;
  input [WR_PORTS*WIDTH-1:0] WR_EN, WR_DATA;
  input [WR_PORTS*ABITS-1:0] WR_ADDR;
  wire _TECHMAP_FAIL_ = RD_CLK_ENABLE != 0;  // -nordff keeps the registers at read ports outside
  genvar i;
  for (i = 0; i < RD_PORTS*WIDTH; i = i + 1) (* keep *) memory_q q (.Q(RD_DATA[i]));
  for (i = 0; i < WR_PORTS*WIDTH; i = i + 1) (* keep *) memory_d d (.D(WR_DATA[i]));
  for (i = 0; i < WR_PORTS*WIDTH; i = i + 1) (* keep *) memory_d e (.D(WR_EN[i]));
  for (i = 0; i < RD_PORTS*ABITS; i = i + 1) (* keep *) memory_d ra (.D(RD_ADDR[i]));
  for (i = 0; i < WR_PORTS*ABITS; i = i + 1) (* keep *) memory_d wa (.D(WR_ADDR[i]));
endmodule
"""

# The clock is ideal. The library has no wire loads, so a net is the sum of the pins that it drives.
TIMING = f"""read_liberty {CELLS}
read_verilog netlist.v
link_design bench
create_clock -name clk -period {PERIOD:g} [get_ports clk_i]
check_setup -verbose -no_clock -loops
report_checks -path_delay max -format full -digits 4
"""

# File name -> text, of the files that the tools read beside the sources.
FILES = {"abc.constr": CONSTRAINTS, "memory_apart.v": MEMORY, "timing.tcl": TIMING}


def commands(synthesis):
    """Commands for Yosys after the sources are read. `synthesis` is the command of the target."""
    return (f"{synthesis} -nordff -run begin:fine -top bench; select -set apart t:$mem_v2 a:ram_style %i; tee -q -o memories.txt dump @apart; "
            f"techmap -map memory_apart.v @apart; {synthesis} -run fine:check -noabc -top bench; dfflibmap -liberty {CELLS}; "
            f"abc -liberty {CELLS} -constr abc.constr; setundef -zero; opt_clean -purge; tee -q -o cells.json stat -json -liberty {CELLS}; "
            "splitnets; opt_clean -purge; write_verilog -noattr -noexpr -simple-lhs netlist.v")


def memory_bits(dumped):
    """Bits of the memories that are counted apart, in the output of `dump`."""
    sizes = re.findall(r"^ *parameter \\SIZE (?:signed )?(\S+)$", dumped, re.M)
    widths = re.findall(r"^ *parameter \\WIDTH (?:signed )?(\S+)$", dumped, re.M)
    cells = len(re.findall(r"^ *cell \$mem_v2 ", dumped, re.M))
    wrong = [word for word in sizes + widths if not word.isdigit()]
    if wrong or len(sizes) != cells or len(widths) != cells:
        raise Bad(f"the dump of {cells} memories has {len(sizes)} sizes and {len(widths)} widths" + (f"; {wrong[0]} is not a number" if wrong else ""))
    return sum(int(size) * int(width) for size, width in zip(sizes, widths))


def area_in(report):
    """Area of the module `measured` and of its registers in the library's unit, in the output of `stat -json -liberty`."""
    try:
        modules = json.loads(report)["modules"]
        found = [m for name, m in modules.items() if re.match(r"\\?measured(\$|$)", name)]
    except (ValueError, KeyError, TypeError, AttributeError) as wrong:
        raise Bad(f"the report of stat is damaged: {type(wrong).__name__}: {wrong}") from wrong
    if len(found) != 1:
        raise Bad(f"the report of stat has {len(found)} modules `measured`; expected 1")
    area, registers = (found[0].get(key) for key in ("area", "sequential_area"))
    for name, value in (("area", area), ("sequential_area", registers)):
        if not isinstance(value, (int, float)):
            raise Bad(f"the report of stat has no number {name}; expected one, of Yosys with -liberty")
    if not 0 < registers < area:
        raise Bad(f"the report of stat has area {area:g} and sequential_area {registers:g}; expected 0 < sequential_area < area")
    return area, registers


def period_in(report):
    """Shortest clock period in ns, and the ends of the critical path, in the output of OpenSTA for TIMING. OpenSTA exits with 0 after an error."""
    for line in report.splitlines():
        missing = re.search(r"module (\S+) not found", line)
        if line.startswith("Error") or (missing and missing.group(1) not in BOXES) or (line.startswith("Warning") and not missing):
            raise Bad(f"OpenSTA says: {line}")
    slacks = re.findall(r"^ *(-?\d+\.\d+) +slack \((?:MET|VIOLATED)\)$", report, re.M)
    ends = [re.findall(rf"^{end}: (\S+)", report, re.M) for end in ("Startpoint", "Endpoint")]
    if len(slacks) != 1 or any(len(end) != 1 for end in ends):
        raise Bad(f"the report of OpenSTA has {len(slacks)} slacks, {len(ends[0])} startpoints and {len(ends[1])} endpoints; expected 1 each")
    period = PERIOD - float(slacks[0])
    if period <= 0:
        raise Bad(f"the report of OpenSTA has a slack of {slacks[0]} ns; expected less than the clock period, {PERIOD:g} ns")
    return period, (ends[0][0], ends[1][0])


def megahertz(period):
    return round(1000 / period, 2)


# ---- Ratios ----
REFERENCE = {"what": "add", "style": "cde", "format": "fp32", "lat": "9"}  # the adder of a lane


def reference(rows):
    """The row that ratios refer to, or None."""
    return next((row for row in rows if all(row[key] == value for key, value in REFERENCE.items()) and row["fmax"]), None)


def ratios(row, to):
    """Area and clock period of a row in those of the row `to`, registers' share of its area, and the area of its memory bits as bare registers."""
    per_register = to["ff_area"] / to["ff"]
    return {"area": row["area"] / to["area"], "registers": row["ff_area"] / row["area"], "memory": row["memory_bits"] * per_register / to["area"],
            "period": to["fmax"][UNPLACED] / row["fmax"][UNPLACED]}
