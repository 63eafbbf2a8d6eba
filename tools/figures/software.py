# SPDX-License-Identifier: Apache-2.0
"""Programs, libraries, outputs, trust, tests, first steps."""
import re

from canvas import Canvas

# Who links whom (host/CMakeLists.txt), without what comes through another.
LINKS = {"reference": {"core"}, "card": {"reference"}, "scene": {"card"}, "jobs": {"card", "mpi"}, "mpi": {"core"}, "netlist": {"card"},
    "costs": {"netlist"},
         "wave": {"netlist"}, "explain": {"wave", "scene"}, "oracle": {"core"}, "accuracy": {"oracle", "costs", "jobs", "netlist"}}


def links(root):
    """The links of the libraries as CMake has them."""
    found = {}
    for name, rest in re.findall(r"target_link_libraries\(cde_(\w+) ([^)]*)\)", (root / "host/CMakeLists.txt").read_text(encoding="utf-8")):
        found.setdefault(name, set()).update(re.findall(r"\bcde_(\w+)", rest))
    return {name: of for name, of in found.items() if name != "command"}


def checked_links(root):
    found = {name: of - {"flags"} for name, of in links(root).items() if of - {"flags"}}
    if found != LINKS:
        raise OSError(f"host/CMakeLists.txt links other libraries than tools/figures/software.py draws: {found}")


def layers(root):
    checked_links(root)
    c = Canvas(820, 492, "Layers of cde",
               "From below: the RTL and its contract, the simulation models that Verilator makes of it, the libraries of host, and the programs. Each "
               "library links only libraries below it.")
    c.text(10, 20, "*Programs, tools/")
    for k, name in enumerate(("cde", "cde-wave", "cde-explain", "cde-accuracy", "cde-bench")):
        c.box(10 + 128 * k, 30, 120, 32, "`" + name, "fn", 12.5)
    c.box(660, 30, 150, 32, "tools/command, shared", "fo", 11.5)
    c.text(10, 88, "*Libraries, host/: an arrow points to what is linked")
    spots = {"explain": (146, 104), "accuracy": (470, 104), "scene": (10, 172), "wave": (146, 172), "costs": (300, 172), "jobs": (436, 172),
        "oracle": (572, 172),
        "netlist": (223, 240), "card": (146, 308), "mpi": (572, 240), "reference": (146, 356), "core": (366, 384)}
    notes = {"explain": "operators", "accuracy": "errors", "scene": "plan, run", "wave": "wave files", "costs": "LUTs, clocks", "jobs": "chunks",
        "oracle": "exact results",
        "netlist": "elaborated RTL", "card": "driver", "mpi": "ranks", "reference": "mirror", "core": "shapes, files"}
    wide, high = 116, 36
    for name, (x, y) in spots.items():
        c.box(x, y, wide, high, [f"*{name}", "~" + notes[name]], "fg", 11.5, leading=14)
    def down(a, b, dx=0, ex=0):
        (x, y), (u, v) = spots[a], spots[b]
        c.arrow((x + wide / 2 + dx, y + high), (u + wide / 2 + ex, v), size=6, thick=1.2)
    for a, b, dx, ex in (("explain", "wave", 0, 0), ("explain", "scene", -20, 20), ("accuracy", "costs", -30, 20), ("accuracy", "jobs", 0, 10),
        ("accuracy", "oracle", 30, 0),
        ("wave", "netlist", 0, -20), ("costs", "netlist", 0, 20), ("netlist", "card", 0, 30), ("card", "reference", 0, 0)):
        down(a, b, dx, ex)
    c.arrow((68, 208), (68, 326), (146, 326), size=6, thick=1.2)
    c.arrow((494, 208), (494, 326), (262, 326), size=6, thick=1.2)
    c.arrow((520, 208), (572, 254), size=6, thick=1.2)
    c.arrow((262, 382), (366, 402), size=6, thick=1.2)
    c.arrow((630, 276), (630, 402), (482, 402), size=6, thick=1.2)
    c.line([(688, 190), (712, 190), (712, 402), (630, 402)], thick=1.2)
    c.arrow((160, 344), (110, 384), size=6, thick=1.2)
    c.text(118, 360, "loads", "end", 12, "tu")
    c.box(10, 384, 126, 36, ["simulation", "model"], "fa", 11.5, leading=14)
    c.arrow((73, 448), (73, 420), size=6, thick=1.2)
    c.text(82, 440, "verilator/", size=12, kind="tu")
    c.box(10, 448, 126, 36, ["*rtl/", "~the card"], "fb", 11.5, leading=14)
    c.texts_at(160, 458, ("rtl/contract/ and host/include/cde/contract/ say the same in both languages.",
                          "~Arrows that follow from others are left out. cde::cde is scene with all below it. mpi: where cde was built with MPI."),
                              size=11.5, leading=18)
    return c


def programs(_root):
    c = Canvas(820, 372, "The five programs, their verbs and libraries",
               "cde has the verbs cast, render, query, run, plan, fp, merge, doctor, help and version. It starts cde-wave, cde-explain, cde-accuracy and cde-bench for "
               "the other verbs.")
    c.box(10, 130, 250, 116, ["*cde", "cast, render, query,", "run, plan, fp,", "merge, doctor, help,", "version"], "fg", size=13)
    rows = (("cde-wave", "wave COMMAND", "wave", "ncurses for tui"), ("cde-explain", "explain", "explain", ""), ("cde-accuracy", "accuracy, advise",
        "accuracy", "Boost"),
            ("cde-bench", "bench, reproduce, inventory", "wave", "FCL, Embree in part"))
    for k, (name, verbs, library, needs) in enumerate(rows):
        y = 14 + 88 * k
        c.line([(260, 188), (300, 188), (300, y + 34)], thick=1.3)
        c.arrow((300, y + 34), (340, y + 34), thick=1.3)
        c.box(340, y, 230, 68, ["*" + name, verbs], "fb")
        c.texts_at(586, y + 30 if not needs else y + 22, (f"library {library}",) + ((f"~needs {needs}",) if needs else ()), size=12.5, leading=20)
    c.text(10, 272, "starts the program of a verb, from its", size=12, kind="tu")
    c.text(10, 288, "own folder or libexec/cde", size=12, kind="tu")
    c.text(10, 316, "~All link tools/command, and by it", size=12)
    c.text(10, 332, "~the libraries scene, jobs and costs.", size=12)
    return c


def outputs(_root):
    c = Canvas(820, 366, "What a verb writes",
               "Results go to stdout or to files named by options, messages and summaries to stderr. With --json one JSON object goes to "
               "stdout. cde run writes "
               "run.json and tables of records into its folder.")
    c.box(10, 96, 120, 70, ["*cde VERB", "--json"], "fg")
    streams = (("stdout", "one JSON object; for query its last line", "fb", 20), ("stderr", "messages, progress, summary", "fn", 90), ("-o FILE",
        "records: CSV, NumPy or JSON lines", "fa", 160),
               ("-o FOLDER", "cde run: run.json, a table per query, with --report a page", "fa", 230), ("cde-failure",
                   "a wrong answer: fail.json, fail.txt, waves.fst", "fr", 300))
    for name, words, kind, y in streams:
        c.line([(130, 131), (160, 131), (160, y + 22)], thick=1.3)
        c.arrow((160, y + 22), (190, y + 22), thick=1.3)
        c.box(190, y, 110, 44, "*" + name if name[0] != "-" else "`" + name, kind)
        c.text(312, y + 18, words, size=12.5)
    for y, words in ((20, "~blocks: program and machine, card, question, counts, times"), (90, "~not JSON"), (160,
        "~complete or absent: renamed when it is whole"),
                     (230, "~run.json has the same keys as --json"), (300, "~keys of a failure, for scripts")):
        c.text(312, y + 38, words, size=12)
    for y, words in ((20, "*JSON"), (160, "cast: JSON lines"), (230, "*run.json"), (300, "*fail.json")):
        c.text(808, y + 38, words, "end", 12.5, "tb")
    return c


def trust(_root):
    c = Canvas(820, 388, "What cde trusts",
               "Files of strangers are read with limits, waves and foreign meshes by child processes. Simulation models are loaded, and the "
               "builder is run, only if "
               "folder, file and checksum belong to the user or root and no other user can write them.")
    c.text(10, 22, "*Read: files of strangers")
    c.box(10, 34, 190, 84, ["meshes, waves", "~foreign meshes: 30 s,", "~512 MB + 64 x the file", "~at most 2 GB"], "fr", size=12.5)
    c.box(10, 134, 190, 52, ["scenes, rays,", "pairs, STL, OBJ, PLY"], "fr", size=12.5)
    c.box(10, 202, 190, 52, ["journals", "~merge: not another user's"], "fr", size=12.5)
    c.arrow((200, 76), (228, 76))
    c.box(228, 48, 116, 56, ["child", "process"], "fg", size=12.5)
    c.arrow((344, 76), (388, 76), (388, 118))
    c.arrow((200, 160), (330, 160))
    c.arrow((200, 228), (300, 228), (300, 180), (330, 180))
    c.box(330, 118, 150, 84, ["*cde", "as its caller,", "never set-uid,", "no network"], "fg", size=12.5)
    c.text(560, 22, "*Loaded, run: files of user or root")
    c.box(560, 34, 250, 84, ["*Simulation model, a library", "folder, file and checksum belong to", "the user or root, no other writer;",
        "checksum and configuration match"], "fb", size=12.5)
    c.arrow((560, 76), (440, 76), (440, 118))
    c.text(500, 69, "loads", "middle", 12, "tu")
    c.box(560, 134, 250, 84, ["*Builder", "verilator/, rtl/, host/include/cde/", "no other user owns or writes them;", "in a source tree also its owner"],
        "fb", size=12.5)
    c.arrow((480, 160), (560, 160))
    c.text(520, 153, "starts", "middle", 12, "tu")
    c.arrow((685, 218), (685, 246))
    c.box(560, 246, 250, 34, "Verilator, clang++ of PATH", "fn", size=12.5)
    c.arrow((405, 202), (405, 262))
    c.text(413, 236, "writes", size=12, kind="tu")
    c.box(310, 262, 190, 56, ["*Outputs", "complete or absent", "renamed when whole"], "fa", size=12.5)
    c.texts_at(10, 346, ("A user who can write your home, PATH, environment or the installation can run anything as you.",
                         "~Folders that CDE_MODELS and CDE_CACHE name follow the same rules. Open MPI uses the network where ranks run."), size=12,
                             leading=18)
    return c


def tiers(root):
    page = (root / "docs/maintainer/testing.md").read_text(encoding="utf-8")
    rows = {}
    for name in ("default", "full"):
        row = re.search(rf"^\| {name} \|(.*)\|$", page, re.M)
        if not row:
            raise OSError(f"docs/maintainer/testing.md has no row for the tier {name}")
        rows[name] = [cell.strip() for cell in row.group(1).split("|")][-2:]
    c = Canvas(820, 330, "The two tiers of tests",
               "The default tier builds the programs, the tests and the simulation models that its tests open. The full tier builds all models, runs all tests "
               "and plants faults.")
    c.rect(10, 16, 800, 250, "fb", 6, solid=False)
    c.text(26, 40, "*Full tier: tools/test --full")
    c.text(794, 40, f"{rows['full'][0]} of CPU time, {rows['full'][1]}", "end", 12.5)
    c.rect(26, 56, 440, 194, "fg", 6, solid=False)
    c.text(42, 80, "*Default tier: tools/test")
    c.text(450, 80, f"{rows['default'][0]}, {rows['default'][1]}", "end", 12.5)
    c.texts_at(42, 106, ("builds: programs, test programs, models that its tests open", "every fault of tools/mutants/ has its test",
        "every verb and every example of the docs runs",
                         "checks the table of faults, plants none", "~tests/tiers.cmake is its only list"), size=12.5, leading=24)
    c.texts_at(484, 106, ("builds: also models marked FULL", "all formats, both back ends", "slow operators, large pairs, ranks",
        "soaks, models without rewriting",
                          "tools/mutate plants every fault;", "a test has to notice it"), size=12.5, leading=24)
    c.texts_at(10, 292, ("CDE_FULL=1 in the environment gives tests of either tier more cases. A label or a pattern picks tests: tools/test -L bus, -R Ring.",
                         "~Times: two cores of an AMD EPYC in a bare chroot, packages and models included."), size=12, leading=18)
    return c


def first_steps(_root):
    c = Canvas(820, 300, "The five first steps",
        "What each of the five steps takes, the command, and what it gives: a picture, records of rays, an answer about a pair, a run of a scene, waves.")
    rows = (("a mesh, a camera", "cde render terrain:128,160,1", "terrain.png"), ("rays", "cde cast terrain --ray ...", "records: F, T, CP, index"),
            ("two spheres", "cde query sphere-sphere", "F, T, CP, n"), ("a scene file", "cde run spheres.toml", "tables, run.json, a page"),
            ("--trace waves.fst", "cde wave find, cde wave tx", "times and transactions"))
    for k, (given, command, result) in enumerate(rows):
        y = 14 + 48 * k
        c.text(10, y + 23, f"*{k + 1}")
        c.box(30, y, 170, 36, given, "fa")
        c.arrow((200, y + 18), (230, y + 18))
        c.box(230, y, 290, 36, "`" + command, "fg")
        c.arrow((520, y + 18), (550, y + 18))
        c.box(550, y, 230, 36, result, "fb")
    c.text(10, 276, "Every answer comes from the simulated card, and cde compares each one with the software reference, bit by bit.", size=12.5)
    return c
