# SPDX-License-Identifier: Apache-2.0
"""Charts of data that the repository has: docs/accuracy.json, docs/costs.json, tables of docs/tables/stability.md and docs/background/reproduction.md."""
import json
import math
import re
import statistics

import style
from canvas import Canvas

FORMATS = {"bf16": "a", "fp16": "b", "tf32": "g", "fp24": "p", "fp32": "r"}
FRACTION = {"bf16": 7, "fp16": 10, "tf32": 10, "fp24": 16, "fp32": 23}
SUPERSCRIPT = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


def power(exponent):
    return "10" + str(exponent).translate(SUPERSCRIPT)


class Axis:
    """A logarithmic axis from 10^low to 10^high between two places."""

    def __init__(self, start, end, low, high):
        self.start, self.end, self.low, self.high = start, end, low, high

    def at(self, value):
        return self.start + (math.log10(value) - self.low) / (self.high - self.low) * (self.end - self.start)

    def decades(self):
        return range(math.ceil(self.low), math.floor(self.high) + 1)


def table(text, first):
    """Rows of cells of the first table whose head begins with a cell."""
    lines = text.splitlines()
    start = next((i for i, line in enumerate(lines) if line.startswith(f"| {first} |")), None)
    if start is None:
        raise OSError(f"no table begins with '{first}'")
    rows = []
    for line in lines[start:]:
        if not line.startswith("|"):
            break
        rows.append([cell.strip() for cell in line.strip("|").split("|")])
    return rows[0], rows[2:]


# ---- accuracy ----
def accuracy_rows(root):
    """Pair, format, logic of a lane, p99 of the error of T over S: rays by watertight with the box rule."""
    told = json.loads((root / "docs/accuracy.json").read_text(encoding="utf-8"))
    rows = []
    for row in told["configurations"]:
        if row["format"] not in FORMATS or row["variant"] != "card" or (row["pair"] == "ray-triangle" and (row["algorithm"], row["box"]) != ("watertight",
            True)):
            continue
        error = row["all_families"]["t_error_u"]["p99"] * 2.0 ** -(FRACTION[row["format"]] + 1)
        rows.append((row["pair"], row["format"], row["cost"]["luts"] + 2 * row["cost"]["carries"], error))
    return rows, told["cases"]


def pair_labels(c, rows, x, y_axis, top):
    """Names below, to the left of a line from each fp32 dot, as deep as it takes for no line to meet a name."""
    placed = []
    for pair, _, cost, error in sorted((row for row in rows if row[1] == "fp32"), key=lambda row: row[2]):
        at = x.at(cost)
        left = at - 4 - style.width(pair, 11.5)
        level = 1 + max((level for other, level in placed if other > left - 6), default=-1)
        placed.append((at, level))
        base = top + 15 * level
        c.line([(at, y_axis.at(error) + 5), (at, base + 2)], "lh", 1)
        c.text(at - 4, base, pair, "end", 11.5)
    return top + 15 * max(level for _, level in placed)


def accuracy(root):
    rows, cases = accuracy_rows(root)
    c = Canvas(820, 492, "Error of T against cost, one dot per pair and number format",
               "Logarithmic chart. Across: logic of one lane on an ECP5, estimated. Upwards: 99th percentile of the error of T over the size of the pair. "
               "Each pair is a line through five number formats; more bits cost more and err less.")
    x, y = Axis(70, 806, 3.4, 6.4), Axis(352, 44, -8, -1.7)
    for k in y.decades():
        c.line([(70, y.at(10 ** k)), (806, y.at(10 ** k))], "lh", 1, solid=False)
        c.text(62, y.at(10 ** k) + 4, power(k), "end", 12, "tu")
    for k in x.decades():
        c.line([(x.at(10 ** k), 44), (x.at(10 ** k), 352)], "lh", 1, solid=False)
        c.text(x.at(10 ** k), 38, f"{10 ** k:,}", "middle", 12, "tu")
    for pair in dict.fromkeys(row[0] for row in rows):
        own = sorted((row for row in rows if row[0] == pair), key=lambda row: row[2])
        c.line([(x.at(logic), y.at(error)) for _, _, logic, error in own], "lu", 0.8, solid=False)
    bottom = pair_labels(c, rows, x, y, 368)
    for _, form, logic, error in rows:
        c.dot(x.at(logic), y.at(error), "m" + FORMATS[form], 4)
    c.text(70, 15, "*99th percentile of the error of T / S", size=12)
    at = 470
    for form, hue in FORMATS.items():
        c.dot(at, 11, "m" + hue, 4)
        c.text(at + 8, 15, form, size=12)
        at += 68
    c.text(10, bottom + 28, "Across: LUTs + 2 x carry cells of one lane on an ECP5 (LFE5U-85F): a sum of measured operators, without delays. S: size of the pair.", size=12)
    c.text(10, bottom + 46, f"~{cases:,} cases per pipe; ray-triangle by watertight with the box rule; cylinder pairs with iterations 8, 8, 8.", size=12)
    c.height = bottom + 56
    return c


# ---- costs ----
def cost_rows(root):
    told = json.loads((root / "docs/costs.json").read_text(encoding="utf-8"))
    return [row for row in told["rows"] if row["target"] == "ecp5-85" and row["style"] == "cde"]


def logic(row):
    return row["lut"] + 2 * row["carry"] + 6 * row["lutram"]


def bars(c, left, y, title, rows, scale, place):
    """A bar per row: format, logic, clock."""
    c.text(left, y, "*" + title)
    for i, row in enumerate(rows):
        top = y + 10 + 19 * i
        c.text(left + 44, top + 12, row["format"], "end", 12)
        wide = logic(row) * scale
        c.rect(left + 50, top, wide, 15, "f" + {**FORMATS, "fp64": "n"}[row["format"]], 2)
        more = f", {row['dsp']} DSP" if row["dsp"] else ""
        c.text(left + 56 + wide, top + 12, f"{logic(row):,} / {statistics.median(row['fmax'].values()):.0f} MHz{more}", size=11.5, kind="tu")
    return y + place


def costs(root):
    rows = cost_rows(root)
    order = list(FORMATS) + ["fp64"]

    def fastest(what):
        found = []
        for form in order:
            own = [row for row in rows if row["what"] == what and row["format"] == form]
            if own:
                found.append(max(own, key=lambda row: statistics.median(row["fmax"].values())))
        return found
    c = Canvas(820, 446, "Logic and clock of operators and lanes on an ECP5",
               "Bars of the logic of adders, multipliers, dividers, square roots and ray-triangle lanes per number format on a Lattice "
               "ECP5, with the clock that place and "
               "route reports.")
    for left, top, title, what, scale in ((10, 20, "add", "add", 0.1), (420, 20, "multiply", "mul", 0.1), (10, 168, "divide", "div", 0.1), (420, 168,
        "square root", "sqrt", 0.1)):
        bars(c, left, top, title, fastest(what), scale, 0)
    lanes = [row for form in order for row in rows if row["what"] == "ray-triangle" and row["format"] == form]
    bars(c, 10, 298, "one ray-triangle lane (moller), placed and routed alone", lanes, 0.0085, 0)
    c.text(10, 408, "Logic = LUTs + 2 carry cells + 6 LUTs used as memory / clock by place and route, median of the seeds. The device has 83,640 LUTs.",
        size=12)
    c.text(10, 426, "~Lattice LFE5U-85F, speed grade 6; Yosys and nextpnr. Of several latencies the fastest is drawn. Lanes have another scale.", size=11.5)
    return c


# ---- stability ----
def stability(root):
    text = (root / "docs/tables/stability.md").read_text(encoding="utf-8")
    head, rows = table(text, "pair")
    changes = head[1:]
    c = Canvas(820, 64 + 20 * len(rows) + 36, "Share of answers that keep every bit under each change",
               "A table of bars: one row per pipe, one column per change of the words of a pair. The length of a bar is the share of cases "
               "in which F and T keep every bit.")
    left, wide = 196, 124
    for k, name in enumerate(changes):
        c.text(left + wide * k + 4, 20, "*" + name, size=12.5)
    for i, row in enumerate(rows):
        y = 34 + 20 * i
        c.text(left - 10, y + 12, row[0], "end", 12)
        for k, cell in enumerate(row[1:]):
            x = left + wide * k
            if not cell:
                continue
            every = cell == "every bit"
            share = 1.0 if every else float(re.match(r"([\d.]+) %", cell).group(1)) / 100
            c.rect(x + 4, y + 1, 62 * share, 14, "fg" if every else "fa", 2, solid=False)
            c.text(x + 70, y + 12, "every bit" if every else f"{share * 100:.1f} %", size=11.5, kind="tg" if every else "tx")
    y = 34 + 20 * len(rows) + 20
    c.text(10, y, "fp32, 2,000 cases per pipe. F never differs beyond the band. Empty: the change does not apply.", size=12)
    c.text(10, y + 18, "~The other answers differ by roundings; docs/tables/stability.md has the largest difference of each.", size=12)
    return c


# ---- reproduction ----
UNITS = {"ms": 1e-3, "µs": 1e-6, "s": 1.0}


def reproduction(root):
    head, rows = table((root / "docs/background/reproduction.md").read_text(encoding="utf-8"), "per frame")
    c = Canvas(820, 0, "Modelled time per frame of the cards beside measured software",
               "Dots on a logarithmic time axis for four workloads: three cards, modelled, and scalar, vector and Embree software, measured.")
    x = Axis(300, 730, -7, 0)
    y, behind = 44, len(c.parts)
    first = y - 12
    for row in rows:
        c.text(10, y + 4, "*" + row[0], size=12.5)
        y += 20
        for k, cell in enumerate(row[1:]):
            found = re.match(r"([\d.]+) (ms|µs|s)\b", cell)
            name = head[k + 1]
            if not found:
                continue
            seconds = float(found.group(1)) * UNITS[found.group(2)]
            card = k < 3
            c.text(290, y + 4, ("card: " if card else "software: ") + name, "end", 12)
            c.line([(300, y), (x.at(seconds), y)], "l" + ("b" if card else "g"), 1.2, solid=False)
            c.dot(x.at(seconds), y, "m" + ("b" if card else "g"), 4.5)
            c.text(x.at(seconds) + 9, y + 4, cell, size=12)
            y += 18
        y += 12
    late = len(c.parts)
    for k in x.decades():
        c.line([(x.at(10.0 ** k), first), (x.at(10.0 ** k), y - 14)], "lh", 1, "2 3", solid=False)
        c.text(x.at(10.0 ** k), 22, {0: "1 s", -1: "0.1 s", -2: "10 ms", -3: "1 ms", -4: "0.1 ms", -5: "10 µs", -6: "1 µs", -7: "0.1 µs"}[k], "middle",
            11.5, "tu")
    c.parts = c.parts[late:] + c.parts[behind:late]  # lines of the grid below the dots
    c.dot(14, y + 4, "mb", 4.5)
    c.text(24, y + 8, "modelled: device large (projected, 100 MHz), fp32, PCI 64/66", size=12)
    c.dot(400, y + 4, "mg", 4.5)
    c.text(410, y + 8, "measured: one thread, AMD EPYC with AVX-512", size=12)
    c.height = y + 20
    return c
