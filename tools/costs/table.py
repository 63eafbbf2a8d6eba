# SPDX-License-Identifier: Apache-2.0
"""The table, a file with one row per line, and the plan of its rows."""
import contextlib
import fcntl
import itertools
import json
import os
import pathlib

from contract import ROOT, Bad, listed
import designs
import flow
import sources

TABLE = ROOT / "docs" / "costs.json"
PLAN = ROOT / "tools" / "costs" / "plan"
KEY = ("what", "style", "algorithm", "format", "lat", "lanes", "target")


def key_of(design):
    return (design.what, design.style, design.algorithm, design.format, design.lat_text, design.lanes, design.target)


def design_of(row):
    return designs.design(row["what"], row["format"], row["lat"], str(row["lanes"]), row["style"], row["algorithm"] or None, row["target"])


# ---- The plan ----
def plan(text, name="plan"):
    """(design, seeds) of every line: WHAT,... FORMAT,... TARGET,... and KEY=VALUE,... of lat, lanes, algorithm, style, seeds."""
    rows = {}
    for at, line in enumerate(text.splitlines(), 1):
        words = line.split("#")[0].split()
        if not words:
            continue
        try:
            if len(words) < 3:
                raise Bad("expected a line WHAT,... FORMAT,... TARGET,... [KEY=VALUE,... ...]")
            options = {"lat": [None], "lanes": ["1"], "algorithm": [None], "style": ["cde"], "seeds": ["1"]}
            for word in words[3:]:
                option, _, values = word.partition("=")
                if option not in options or not values:
                    raise Bad(f"{word} is unknown; expected {listed(o + '=' for o in options)}")
                options[option] = values.split(",")
            seeds = designs.number(options["seeds"][0], 1, 99, "number of seeds")
            for what, style, algorithm, target, format_, lanes, lat in itertools.product(
                    words[0].split(","), options["style"], options["algorithm"], words[2].split(","), words[1].split(","), options["lanes"], options["lat"]):
                one = designs.design(what, format_, lat, lanes, style, algorithm, target)
                rows[key_of(one)] = (one, max(seeds, rows.get(key_of(one), (one, 0))[1]))
        except Bad as bad:
            raise Bad(f"{name}:{at}: {bad}") from bad
    return list(rows.values())


# ---- The table ----
class Table:
    def __init__(self, path=None):
        self.path = pathlib.Path(path or TABLE)
        self.rows, self.sources = {}, {}
        if self.path.exists():
            self._read()

    def _read(self):
        try:
            told = json.loads(self.path.read_text())
            self.rows = {tuple(row[k] for k in KEY): row for row in told["rows"]}
            self.sources = told["sources"]
        except (ValueError, KeyError, TypeError) as wrong:
            raise Bad(f"{self.path} is not a table of costs: {type(wrong).__name__}: {wrong}") from wrong

    def sorted(self):
        return sorted(self.rows.values(), key=lambda row: design_of(row).order())

    def text(self):
        rows = self.sorted()
        used = {row["sources"] for row in rows}
        lines = [json.dumps(row) for row in rows]
        lists = [f"{json.dumps(name)}: {json.dumps(self.sources[name])}" for name in sorted(used)]
        return '{"rows": [\n' + ",\n".join(lines) + '\n],\n"sources": {\n' + ",\n".join(lists) + "\n}}\n"

    def put(self, design, row, hashes):
        """Writes a row to the file, which is complete at any time."""
        with self._locked():
            if self.path.exists():
                self._read()
            whole = dict(zip(KEY, key_of(design)))
            whole.update(row, command=" ".join(["tools/synthesis", "one", *design.arguments]))
            self.rows[key_of(design)] = whole
            self.sources[row["sources"]] = hashes
            beside = self.path.with_name(self.path.name + ".new")
            beside.write_text(self.text())
            os.replace(beside, self.path)

    @contextlib.contextmanager
    def _locked(self):
        folder = os.open(self.path.parent, os.O_RDONLY)
        try:
            fcntl.flock(folder, fcntl.LOCK_EX)
            yield
        finally:
            os.close(folder)

    def stale(self, row):
        """Why a row is stale: its changed files or method, or "" if it is valid."""
        then = self.sources.get(row["sources"])
        if then is None:
            return "its sources are not listed"
        now = sources.digests(then)
        changed = [name for name in then if then[name] != now[name]]
        if changed:
            return changed[0] + (f" and {len(changed) - 1} other{'s' if len(changed) > 2 else ''}" if len(changed) > 1 else "") + " changed"
        if row["flow"] != flow.flow_hash(design_of(row)):
            return "the measurement (tools/costs/) changed"
        return ""

    def holds(self, design, seeds, tools):
        """Whether the table has this row, and a new measurement would be the same."""
        row = self.rows.get(key_of(design))
        return bool(row) and not self.stale(row) and row["tools"] == tools and (not row["fmax"] or len(row["fmax"]) >= seeds)
