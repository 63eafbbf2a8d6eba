# SPDX-License-Identifier: Apache-2.0
"""Simulation model of a card's netlist, as Yosys mapped it to cells of the FPGA."""
import concurrent.futures
import os
import pathlib
import re
import shutil
import subprocess

import cards
from contract import Bad
from flow import Missing
from sources import ROOT

HERE = pathlib.Path(__file__).resolve().parent / "netlist"
# Kind of cell -> the output that a planted fault inverts.
OUTPUTS = {"LUT4": "Z", "PFUMX": "Z", "L6MUX21": "Z", "CCU2C": "S0", "TRELLIS_FF": "Q", "TRELLIS_DPR16X4": "DO", "MULT18X18D": "P9", "DP16KD": "DOB0"}


def cells(lines):
    """Yields kind, name, first line and last line of every cell instance in a netlist's lines."""
    kind = name = first = None
    for at, line in enumerate(lines):
        begin = re.match(r"  ([A-Z][A-Z0-9_]*) (#\($)?", line)
        if kind is None and begin and begin.group(1) in OUTPUTS:
            kind, first, name = begin.group(1), at, None
        if kind:
            named = re.match(r"  (?:\)|[A-Z][A-Z0-9_]*) (\\\S+ |[A-Za-z_]\w*) \($", line)
            name = named.group(1).strip() if named else name
            if line == "  );":
                yield kind, name, first, at
                kind = None


def with_faults(text, count):
    """The netlist with `count` planted faults, spread evenly over its cells, and a line about each fault."""
    lines = text.splitlines()
    found = list(cells(lines))
    if not found:
        raise Bad("netlist.v has no cells of the FPGA; expected the netlist of tools/synthesis one card --keep")
    told = []
    for number in range(1, count + 1):
        kind, name, first, last = found[(2 * number - 1) * len(found) // (2 * count)]
        pin = OUTPUTS[kind]
        for at in range(first, last):
            net = re.match(rf"    \.{pin}\(\{{? ?(\\\S+ |[A-Za-z_]\w*(?:\[\d+\])?)", lines[at])
            if not net:
                continue
            lines[at] = lines[at][:net.start(1)] + f"fault_{number}_sound " + lines[at][net.end(1):]
            lines[last] += f"\n  wire fault_{number}_sound;\n  fault #(.NUMBER({number})) fault_{number} (.sound(fault_{number}_sound), .net({net.group(1)}));"
            told.append(f"{number} {kind}.{pin} {name}")
            break
        else:
            told.append(f"{number} {kind}.{pin} {name}: not connected, so there is no fault")
    return "\n".join(lines) + "\n", told


def program(name):
    found = shutil.which(os.environ.get("CDE_CLANG", name) if name == "clang++" else name)
    if not found:
        raise Missing(f"{name} is not installed (tools/setup build)")
    return found


def run(command, folder):
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    if done.returncode:
        said = [line for line in (done.stdout + done.stderr).splitlines() if "rror" in line] or ["no output"]
        raise Bad(f"{pathlib.Path(command[0]).name} failed, status {done.returncode}: {said[0]}")
    return done.stdout


def compile_all(folder, root, say):
    """Compiles Verilator's C++ and the harness of rtl/fpga_card.sv into model.so."""
    flags = [program("clang++"), "-std=c++20", "-fPIC", "-march=native", "-w", "-DVL_TIME_CONTEXT", "-fvisibility=hidden", "-I.", "-Iv",
             "-isystem", f"{root}/include", "-isystem", f"{root}/include/vltstd"]
    (folder / "params.inc").write_text("".join(f'"{name}={value}\\n"\n' for name, value in cards.PARAMETERS.items()))
    (folder / "harness.cpp").write_text(
        f'#include "{ROOT}/verilator/models/fpga_card_model.cpp"\n'
        'extern "C" __attribute__((visibility("default"))) const unsigned long long cde_built_config_hash = 0;\n')
    own = ["-O1", f"-I{ROOT}/verilator", f"-I{ROOT}/verilator/models", f"-I{ROOT}/host/include", '-DCDE_KIND="fpga_card"', "-DCDE_CONFIG_HASH=0ull"]
    jobs = [(f"{folder}/harness.cpp", own), (f"{HERE}/fault.cpp", ["-O1"])]
    jobs += [(f"{root}/include/{name}.cpp", ["-O1"]) for name in ("verilated", "verilated_threads")]
    # Code that Verilator calls slow runs once.
    jobs += [(str(name), ["-O0" if name.name.endswith("__Slow.cpp") else "-O1"]) for name in sorted((folder / "v").glob("*.cpp"))]
    say(f"compiling {len(jobs)} files")

    def compile_one(job):
        source, more = job
        run([*flags, *more, "-c", source, "-o", f"{pathlib.Path(source).stem}.o"], folder)

    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        list(pool.map(compile_one, jobs))
    run([flags[0], "-shared", "-o", "model.so", *[f"{pathlib.Path(source).stem}.o" for source, _ in jobs], "-latomic", "-lpthread"], folder)


def build(folder, out, faults, say):
    """Builds the model of FOLDER/netlist.v into the file `out`. Returns a line about each planted fault."""
    folder = pathlib.Path(folder).resolve()
    if not (folder / "netlist.v").is_file():
        raise Bad(f"{folder} has no netlist.v; expected a folder of tools/synthesis one card --keep")
    text, told = with_faults((folder / "netlist.v").read_text(), faults)
    work = folder / "model"
    shutil.rmtree(work, ignore_errors=True)
    work.mkdir()
    (work / "netlist.v").write_text(text)
    verilator = program("verilator")
    say("reading the netlist (Verilator)")
    run([verilator, "--cc", "-O3", "--x-assign", "fast", "--x-initial", "fast", "--output-split", "20000", "-Wno-lint", "-Wno-style", "--no-assert",
         "--prefix", "Vmodel", "--top-module", "bench", "-Mdir", "v", str(HERE / "cells.sv"), "netlist.v"], work)
    compile_all(work, run([verilator, "--getenv", "VERILATOR_ROOT"], work).strip(), say)
    shutil.copyfile(work / "model.so", out)
    os.chmod(out, 0o755)
    return told
