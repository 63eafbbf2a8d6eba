# SPDX-License-Identifier: Apache-2.0
"""The tables of docs/background/costs.md and docs/tables/costs.md, between their markers."""
import json
import re
import statistics

from contract import ROOT, Bad
import asic
import designs
import table
import targets

PAGES = [ROOT / "docs" / "background" / "costs.md", ROOT / "docs" / "tables" / "costs.md"]
MARKS = re.compile(r"(<!-- costs: (\w+) -->\n)(.*?)(<!-- end -->)", re.S)


def grid(head, rows, words=()):
    """A table in Markdown, or a sentence without rows. The first column and those of `words` are text, the others numbers."""
    if not rows:
        return "No rows yet.\n"
    lines = ["| " + " | ".join(head) + " |", "| " + " | ".join("---" if k == 0 or name in words else "---:" for k, name in enumerate(head)) + " |"]
    lines += ["| " + " | ".join(map(str, row)) + " |" for row in rows]
    return "\n".join(lines) + "\n"


def clock(row):
    """Median over the seeds, with the least and the largest."""
    found = sorted(row["fmax"].values())
    if not found:
        return "-"
    return f"{statistics.median(found):.1f}" + (f" ({found[0]:.1f} to {found[-1]:.1f})" if len(found) > 1 else "")


def is_pipe(row):
    return table.design_of(row).pipe


def is_unit(row):
    return table.design_of(row).unit


def is_card(row):
    return table.design_of(row).card


def operators(kept, target, clocks):
    head = ["operator", "format", "cycles", "LUT", "carry", "FF", "DSP"] + (["MHz"] if clocks else [])
    rows = []
    for row in kept.sorted():
        if row["target"] == target and not is_pipe(row) and not is_unit(row) and not is_card(row) and row["style"] == "cde":
            rows.append([row["what"], row["format"], row["lat"], row["lut"], row["carry"], row["ff"], row["dsp"]] + ([clock(row)] if clocks else []))
    return grid(head, rows)


def ordinary(kept):
    """This project's operators compared with the ordinary style, at latency 1, where the table has both."""
    rows = []
    for row in kept.sorted():
        other = dict(row, style="ordinary")
        there = kept.rows.get(tuple(other[k] for k in table.KEY))
        if row["style"] != "cde" or there is None:
            continue
        target = targets.TARGETS[row["target"]]
        ours, theirs = target.used(row)["logic"], target.used(there)["logic"]
        rows.append([row["target"], row["what"], row["format"], f"{row['lut']} + {row['carry']}", f"{there['lut']} + {there['carry']}", ours, theirs,
                     f"{ours / theirs:.2f}", row["dsp"], there["dsp"]])
    return grid(["target", "operator", "format", "LUT + carry", "LUT + carry, ordinary", "logic", "logic, ordinary", "ratio", "DSP", "DSP, ordinary"], rows)


def lanes(kept):
    rows = []
    for row in kept.sorted():
        if not is_pipe(row) or not targets.TARGETS[row["target"]].has:
            continue
        fit, least = targets.TARGETS[row["target"]].lanes(row)
        rows.append([row["what"] + (f", {row['algorithm']}" if row["algorithm"] else ""), row["format"], row["lat"], row["target"], row["lut"], row["carry"],
                     row["ff"], row["dsp"], row["ram"], clock(row), f"{fit} ({least})"])
    return grid(["pipe", "format", "cycles of add/mul/div/sqrt/cmp", "target", "LUT", "carry", "FF", "DSP", "RAM", "MHz", "lanes that fit"], rows)


def units(kept):
    head = ["unit", "cycles per node", "cycles of add/mul/div/sqrt/cmp", "LUT", "carry", "LUT memory", "FF", "DSP", "RAM", "logic", "MHz"]
    rows = []
    for row in kept.sorted():
        if is_unit(row) and targets.TARGETS[row["target"]].has:
            rows.append([row["what"], designs.UNITS[row["what"]][1], row["lat"], row["lut"], row["carry"], row["lutram"], row["ff"], row["dsp"], row["ram"],
                         targets.TARGETS[row["target"]].used(row)["logic"], clock(row)])
    return grid(head, rows)


def cards(kept):
    """Whole cards: what they use of the FPGA, and their clocks."""
    names = {"logic": "logic", "ff": "FF", "dsp": "multiplier blocks", "ram": "block memories"}
    rows = []
    for row in kept.sorted():
        if is_card(row):
            target = targets.TARGETS[row["target"]]
            rows += [[names[what], used, target.has[what], f"{100 * used / target.has[what]:.1f} %"] for what, used in target.used(row).items()]
            rows.append([f"clock, MHz, {len(row['fmax'])} seeds", clock(row), "", ""])
    return grid([f"`{designs.cards.WHAT}`", "used", "on the FPGA", "share"], rows)


def standard_cells(kept):
    """Ratios of the rows of standard cells to the adder of the lane."""
    found = [row for row in kept.sorted() if targets.TARGETS[row["target"]].library and row["fmax"]]
    to = asic.reference(found)
    rows = []
    for row in found if to else ():
        ratio = asic.ratios(row, to)
        rows.append([row["what"] + (f", {row['algorithm']}" if row["algorithm"] else ""), row["lat"], f"{ratio['area']:.2f}", f"{100 * ratio['registers']:.0f} %",
                     f"{ratio['period']:.2f}", row["memory_bits"], f"{ratio['memory']:.2f}" if row["memory_bits"] else "-"])
    return grid(["design, fp32", "cycles", "area", "FF, of the area", "clock period", "memory bits, not in the area", "area of these bits as FF"], rows)


def devices():
    """docs/devices.json, which the programs compile in."""
    rows = [[f"`{d['name']}`", d["kind"], d["fpga"], d["clock_mhz"], d["lanes"], d["traversal_units"], d["node_cycles"],
             "/".join(str(d["latencies"][k]) for k in ("add", "mul", "div", "sqrt", "compare")), d["memory"], d["why"]]
            for d in json.loads((ROOT / "docs" / "devices.json").read_text())["devices"]]
    return grid(["device", "kind", "FPGA", "MHz", "lanes", "traversal units", "cycles per node", "cycles of add/mul/div/sqrt/compare", "memory", "evidence"], rows,
                words=("kind", "FPGA", "memory", "evidence"))


def made_with(kept):
    """Targets, with the tools of their rows."""
    rows = []
    for name, target in targets.TARGETS.items():
        here = [row for row in kept.rows.values() if row["target"] == name]
        tools = "; ".join(sorted({row["tools"] for row in here})) or "-"
        route = f"`{' '.join((target.router, *target.route))}`" if target.router else f"none; timing by `{target.timer}`" if target.timer else "area alone"
        rows.append([f"`{name}`", target.device, f"`{target.synthesis}`", route,
                     tools, len(here), f"{sum(row['seconds'] for row in here) / 60:.0f}"])
    return grid(["target", "device", "Yosys", "place and route", "tools", "rows", "minutes"], rows)


def parts(kept):
    return {"targets": made_with(kept),
            "ecp5": operators(kept, "ecp5-85", True),
            "hx8k": operators(kept, "hx8k", True),
            "ordinary": ordinary(kept),
            "lanes": lanes(kept),
            "units": units(kept),
            "card": cards(kept),
            "devices": devices(),
            "asic": standard_cells(kept),
            "xc7": operators(kept, "xc7", False),
            "virtex2p": operators(kept, "virtex2p", False)}


def everything(kept):
    return "".join(f"<!-- costs: {name} -->\n{text}<!-- end -->\n\n" for name, text in parts(kept).items())


def filled(kept, page):
    """The page with the table's figures, the names of changed parts, and the parts that the page lacks."""
    made, changed, seen = parts(kept), [], []

    def put(mark):
        name = mark.group(2)
        if name not in made:
            raise Bad(f"docs: no table {name}; expected one of {', '.join(made)}")
        seen.append(name)
        if mark.group(3) != made[name]:
            changed.append(name)
        return mark.group(1) + made[name] + mark.group(4)

    page = MARKS.sub(put, page)
    return page, changed, [name for name in made if name not in seen]


def filled_pages(kept):
    """Each page with its text, its correct text and the tables that differ; then the tables that no page has."""
    pages, lacking = [], set(parts(kept))
    for page in PAGES:
        text = page.read_text()
        wanted, changed, absent = filled(kept, text)
        pages.append((page, text, wanted, changed))
        lacking &= set(absent)
    return pages, sorted(lacking)


def differences(kept):
    pages, lacking = filled_pages(kept)
    return [f"{page.relative_to(ROOT)}, table {name}: differs from docs/costs.json" for page, _, _, changed in pages for name in changed] + \
        [f"docs/tables/costs.md: no table {name}" for name in lacking]


def write(kept):
    pages, lacking = filled_pages(kept)
    if lacking:
        raise Bad(f"docs/tables/costs.md: no table {lacking[0]}; expected a line <!-- costs: {lacking[0]} -->, then one <!-- end -->")
    for page, text, wanted, _ in pages:
        if wanted != text:
            page.write_text(wanted)
