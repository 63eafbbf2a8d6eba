# SPDX-License-Identifier: Apache-2.0
"""Standard cells in tools/synthesis: readers of Yosys' and OpenSTA's reports, missing tools, ratios.   python3 -m unittest discover -s tests/synthesis -p '*_test.py'"""
import json
import os
import pathlib
import stat
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.dont_write_bytecode = True
sys.path.insert(0, str(ROOT / "tools" / "costs"))
# pylint: disable=wrong-import-position
from contract import Bad  # noqa: E402
import asic  # noqa: E402
import designs  # noqa: E402
import flow  # noqa: E402
import pages  # noqa: E402
import table  # noqa: E402
import targets  # noqa: E402

TIMING = """Warning: netlist.v, line 9 module memory_q not found.  Creating black box for \\one.mem .
Startpoint: measured/_5_ (rising edge-triggered flip-flop clocked by clk)
Endpoint: measured/_9_ (rising edge-triggered flip-flop clocked by clk)
Path Group: clk
Path Type: max

    Delay      Time   Description
-------------------------------------------------------------
   0.0000    0.0000   clock clk (rise edge)
   0.0000    0.0000 ^ measured/_5_/CLK (DFFPOSX1)
   4.2895    4.2895 v measured/_5_/Q (DFFPOSX1)
             4.2895   data arrival time

 100.0000  100.0000   clock clk (rise edge)
  -0.1615   99.8385   library setup time
            99.8385   data required time
-------------------------------------------------------------
            99.8385   data required time
            -4.2895   data arrival time
-------------------------------------------------------------
            95.5490   slack (MET)
"""
MEMORIES = """  attribute \\ram_style "distributed"
  cell $mem_v2 \\one.g_memory.mem
    parameter \\WIDTH 8
    parameter \\SIZE 11
    parameter \\RD_PORTS 1
  end
  cell $mem_v2 \\two.g_block.mem
    parameter \\WIDTH 40
    parameter signed \\OFFSET 0
    parameter \\SIZE 24
  end
"""


def areas(**more):
    measured = {"area": 150.0, "sequential_area": 96.0, "num_cells_by_type": {"DFFPOSX1": 1, "AND2X2": 1}, **more}
    return json.dumps({"modules": {"\\bench": {"area": 900.0}, "\\measured$bench.measured": measured}})


def row_of(design, **more):
    cells = {**dict.fromkeys(targets.COLUMNS, 0), "ff": 10, "gates": 50, "area": 2000.0, "ff_area": 1000.0, "memory_bits": 0}
    return {**dict(zip(table.KEY, table.key_of(design))), **cells, "fmax": {asic.UNPLACED: 200.0}, "seconds": 4, "tools": "yosys 0.70", "flow": "", "sources": "0", **more}


class Readers(unittest.TestCase):
    def test_area(self):
        self.assertEqual(asic.area_in(areas()), (150.0, 96.0))

    def test_damaged_areas(self):
        for report, said in (("", "the report of stat is damaged"), (areas()[:40], "the report of stat is damaged"), ("[]", "the report of stat is damaged"),
                             ('{"modules": {}}', "0 modules `measured`; expected 1"), (areas(area=None), "no number area"),
                             (areas(sequential_area="96"), "no number sequential_area"), (areas(area=90.0), "expected 0 < sequential_area < area"),
                             (areas(sequential_area=0.0), "expected 0 < sequential_area < area")):
            with self.subTest(report), self.assertRaisesRegex(Bad, said):
                asic.area_in(report)

    def test_cells(self):
        counted = targets.target("osu018").count({"DFFPOSX1": 7, "AND2X2": 2, "AOI21X1": 1, "CLKBUF1": 1, "XNOR2X1": 1, "memory_d": 3, "$scopeinfo": 4})
        self.assertEqual((counted["ff"], counted["gates"], counted["lut"]), (7, 5, 0))
        for unmapped in ("$_DFF_P_", "$lut", "LATCH", "$mem_v2"):
            with self.subTest(unmapped), self.assertRaisesRegex(Bad, "osu018: cell .* has no column"):
                targets.target("osu018").count({unmapped: 1})

    def test_memory_bits(self):
        self.assertEqual(asic.memory_bits(MEMORIES), 8 * 11 + 40 * 24)
        self.assertEqual(asic.memory_bits("\n"), 0)
        for dumped, said in ((MEMORIES.replace("SIZE 11", "SIZE x"), "x is not a number"), (MEMORIES.replace("    parameter \\WIDTH 8\n", ""), "2 sizes and 1 widths"),
                             (MEMORIES.replace("cell $mem_v2", "cell $mem"), "0 memories has 2 sizes")):
            with self.subTest(dumped), self.assertRaisesRegex(Bad, said):
                asic.memory_bits(dumped)

    def test_period(self):
        period, ends = asic.period_in(TIMING)
        self.assertAlmostEqual(period, 4.2895 + 0.1615, places=4)
        self.assertEqual(ends, ("measured/_5_", "measured/_9_"))
        self.assertEqual(asic.megahertz(period), 224.67)
        slow, _ = asic.period_in(TIMING.replace("95.5490   slack (MET)", "-20.0000   slack (VIOLATED)"))
        self.assertAlmostEqual(slow, 120)

    def test_damaged_timing(self):
        for report, said in (("", "0 slacks, 0 startpoints and 0 endpoints; expected 1 each"), ("No paths found.\n", "0 slacks"), (TIMING[:-40], "0 slacks"),
                             (TIMING + TIMING, "2 slacks, 2 startpoints"), (TIMING.replace("Endpoint", "End"), "0 endpoints"),
                             ("Error: netlist.v, line 3 syntax error\n" + TIMING, "OpenSTA says: Error: netlist.v, line 3 syntax error"),
                             (TIMING.replace("memory_q", "NEWX1"), "OpenSTA says: Warning: netlist.v, line 9 module NEWX1 not found"),
                             ("Warning: There is 1 combinational loop in the design.\n" + TIMING, "OpenSTA says: Warning: There is 1 combinational loop"),
                             (TIMING.replace("95.5490", "100.0000"), "slack of 100.0000 ns; expected less than the clock period, 100 ns")):
            with self.subTest(report[:60]), self.assertRaisesRegex(Bad, said):
                asic.period_in(report)

    def test_version(self):
        self.assertEqual(flow.version_in("2.0.17\n"), "2.0.17")


class Rows(unittest.TestCase):
    def setUp(self):
        self.adder = row_of(designs.design("add", "fp32", "9", target="osu018"))

    def test_the_flow_hash_covers_all_files(self):
        design = designs.design("add", "fp32", "9", target="osu018")
        text = flow.flow_text(design)
        for part in (asic.MEMORY, asic.TIMING, asic.CONSTRAINTS, "dfflibmap", design.bench()):
            self.assertIn(part, text)
        self.assertNotIn("dfflibmap", flow.flow_text(designs.design("add", "fp32", "9", target="xc7")))

    def test_ratios(self):
        row = row_of(designs.design("mul", "fp32", "11", target="osu018"), area=5000.0, ff_area=2000.0, memory_bits=50, fmax={asic.UNPLACED: 160.0})
        self.assertEqual(asic.ratios(row, self.adder), {"area": 2.5, "registers": 0.4, "memory": 50 * 100 / 2000, "period": 1.25})
        self.assertEqual(asic.ratios(self.adder, self.adder), {"area": 1, "registers": 0.5, "memory": 0, "period": 1})

    def test_the_reference_is_the_adder_of_the_lane(self):
        others = [row_of(designs.design("add", "fp32", "1", target="osu018")), row_of(designs.design("mul", "fp32", "11", target="osu018"))]
        self.assertIs(asic.reference(others + [self.adder]), self.adder)
        self.assertIsNone(asic.reference(others))
        self.assertIsNone(asic.reference([dict(self.adder, fmax={})]))

    def test_the_page_has_ratios_only(self):
        with tempfile.TemporaryDirectory() as folder:
            kept = table.Table(pathlib.Path(folder) / "costs.json")
            for design, more in ((designs.design("add", "fp32", "9", target="osu018"), {}),
                                 (designs.design("ray-triangle", "fp32", "9/11/34/32/3", target="osu018"),
                                  {"area": 123456.0, "memory_bits": 600, "fmax": {asic.UNPLACED: 123.4}})):
                kept.put(design, row_of(design, **more), {})
            text = pages.parts(kept)["asic"]
            self.assertIn("| add | 9 | 1.00 | 50 % | 1.00 | 0 | - |", text)
            self.assertIn("| ray-triangle, moller | 9/11/34/32/3 | 61.73 | 1 % | 1.62 | 600 | 30.00 |", text)
            for absolute in ("123", "2000", "200.0", "MHz"):
                self.assertNotIn(absolute, text)
            for other in ("lanes", "units"):  # they are tables of FPGAs
                self.assertEqual(pages.parts(kept)[other], "No rows yet.\n")
            lonely = table.Table(pathlib.Path(folder) / "lonely.json")
            lonely.put(designs.design("mul", "fp32", "11", target="osu018"), row_of(designs.design("mul", "fp32", "11", target="osu018")), {})
            self.assertEqual(pages.parts(lonely)["asic"], "No rows yet.\n")


class Command(unittest.TestCase):
    def setUp(self):
        kept = tempfile.TemporaryDirectory()
        self.addCleanup(kept.cleanup)
        self.folder = pathlib.Path(kept.name)
        self.library = self.folder / "some.lib"
        self.library.write_text("library(some) {}\n")
        self.yosys = self.tool("yosys", 'case "$*" in *-V*|*help*) echo "Yosys 0.70 --keep-hierarchy";; *) echo "ERROR: out of gates"; exit 3;; esac')
        self.sta = self.tool("sta", "echo 2.0.17")

    def tool(self, name, body):
        path = self.folder / name
        path.write_text(f"#!/bin/sh\n{body}\n")
        path.chmod(path.stat().st_mode | stat.S_IXUSR)
        return str(path)

    def one(self, *words, **environment):
        tools = {"CDE_YOSYS": self.yosys, "CDE_STA": self.sta, "CDE_OSU018": str(self.library)}
        done = subprocess.run([sys.executable, ROOT / "tools" / "synthesis", "one", "add", "--target", "osu018", *words], capture_output=True, text=True, check=False,
                              env={**os.environ, **tools, **environment})
        self.assertEqual(done.stderr.count("\n"), 1, done.stderr)
        return done.returncode, done.stderr

    def measured(self, timing, *words):
        """`one add` with a Yosys and an OpenSTA that print these reports."""
        for name, text in (("cells.json", areas()), ("memories.txt", MEMORIES), ("timing.log", timing), ("modules.txt", "\n1 modules:\n  fp_add_lane\n")):
            (self.folder / name).write_text(text)
        self.tool("yosys", f'case "$*" in *-V*|*help*) echo "Yosys 0.70 --keep-hierarchy";; *) grep -q some cells.lib && cp {self.folder}/*.json {self.folder}/*.txt .;; esac')
        self.tool("sta", f'case "$*" in -version) echo 2.0.17;; *timing.tcl) cat {self.folder}/timing.log;; *) exit 4;; esac')
        tools = {"CDE_YOSYS": self.yosys, "CDE_STA": self.sta, "CDE_OSU018": str(self.library)}
        done = subprocess.run([sys.executable, ROOT / "tools" / "synthesis", "one", "add", "--lat", "9", "--target", "osu018", "--any-version", *words],
                              capture_output=True, text=True, check=False, env={**os.environ, **tools})
        return done.returncode, done.stdout, done.stderr

    def test_a_row_is_made_of_the_reports(self):
        status, out, error = self.measured(TIMING, "--json")
        self.assertEqual((status, error), (0, ""))
        row = json.loads(out)
        self.assertEqual((row["target"], row["lat"], row["ff"], row["gates"], row["area"], row["ff_area"], row["memory_bits"]), ("osu018", "9", 1, 1, 150.0, 96.0, 1048))
        self.assertEqual((row["fmax"], row["paths"]), ({"unplaced": 224.67}, {"unplaced": ["measured/_5_", "measured/_9_"]}))
        self.assertRegex(row["tools"], "^yosys 0.70, sta 2.0.17, osu018 [0-9a-f]{12}$")
        self.assertEqual(row["flow"], flow.flow_hash(designs.design("add", "fp32", "9", target="osu018")))
        status, out, _ = self.measured(TIMING)
        self.assertEqual(status, 0)
        self.assertIn("unplaced 224.67 MHz: measured/_5_ -> measured/_9_", out)
        self.assertNotIn("lut", out)

    def test_area_alone_needs_no_timing(self):
        status, out, _ = self.measured("Error: not read", "--json", "--area")
        self.assertEqual((status, json.loads(out)["fmax"]), (0, {}))
        status, _, error = self.measured("Error: not read")
        self.assertEqual((status, error), (2, "synthesis: OpenSTA says: Error: not read\n"))

    def test_missing_tools_name_their_packages(self):
        for variable, said in (("CDE_STA", r"sta is not installed \(looked for /nowhere\); install the Debian package opensta, version 2.0.17, or set CDE_STA=FILE"),
                               ("CDE_OSU018", r"osu018 is not installed \(looked for /nowhere\); install the Debian package qflow-tech-osu018, or set CDE_OSU018=FILE")):
            with self.subTest(variable):
                status, error = self.one(**{variable: "/nowhere"})
                self.assertEqual(status, 77)
                self.assertRegex(error, said)

    def test_other_versions_are_refused(self):
        status, error = self.one(CDE_STA=self.tool("sta", "echo 2.6.0"))
        self.assertEqual(status, 77)
        self.assertIn("sta is 2.6.0, but the table is made with 2.0.17; install the Debian package opensta", error)
        status, error = self.one(CDE_STA=self.tool("sta", "echo a program of the same name"))
        self.assertEqual(status, 77)
        self.assertIn("does not print its version of sta; install the Debian package opensta", error)
        self.tool("sta", "echo 2.0.17")
        status, error = self.one()
        self.assertEqual(status, 77)
        self.assertRegex(error, "some.lib has the hash [0-9a-f]{12}, but the table is made with 86f79b2000f1; install the Debian package qflow-tech-osu018")

    def test_several_seeds_are_refused(self):
        status, error = self.one("--seed", "1,2", "--any-version")
        self.assertEqual(status, 2)
        self.assertIn("osu018 takes one seed, not 2, as it is not placed", error)

    def test_another_library_is_read_on_request(self):
        status, error = self.one("--any-version")
        self.assertEqual(status, 2)
        self.assertIn("yosys failed, status 3: ERROR: out of gates", error)


if __name__ == "__main__":
    unittest.main()
