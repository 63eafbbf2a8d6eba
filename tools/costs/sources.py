# SPDX-License-Identifier: Apache-2.0
"""Sources of a design, and their hashes, which ignore comments and spaces."""
import functools
import hashlib
import re

from contract import ROOT, Bad

FOLDERS = ("rtl", "tools/costs/ordinary")


def bare(text):
    """The text without comments and with normalised spaces."""
    token = re.compile(r'"(?:\\.|[^"\\\n])*"|//[^\n]*|/\*.*?\*/', re.S)
    text = token.sub(lambda m: m.group(0) if m.group(0)[0] == '"' else " ", text)
    return " ".join(text.split())


def digest(text, length=12):
    return hashlib.sha256(text.encode()).hexdigest()[:length]


def digests(files, root=ROOT):
    """file -> hash of its content, "-" for a missing file."""
    return {name: digest_of(root / name) for name in sorted(files)}


@functools.lru_cache(maxsize=None)
def digest_of(path):
    return digest(bare(path.read_text())) if path.is_file() else "-"


def combined(hashes):
    return digest("\n".join(f"{name} {value}" for name, value in sorted(hashes.items())))


@functools.lru_cache(maxsize=None)
def _tree():
    """file name -> path in the tree."""
    found = {}
    for folder in FOLDERS:
        for path in sorted((ROOT / folder).rglob("*.sv*")):
            if "simulated" not in path.parts:
                found[path.name] = str(path.relative_to(ROOT))
    return found


def hardware():
    """The files for synthesis, packages first."""
    packages = ["rtl/contract/" + name for name in (ROOT / "rtl/contract/packages.f").read_text().split()]
    return packages + sorted(p for p in _tree().values() if p.endswith(".sv") and p not in packages)


def closure(modules, root=ROOT):
    """Files of the modules, and of all packages and includes that these need."""
    tree, files = _tree(), set()
    waiting = []
    for module in modules:
        if module + ".sv" not in tree:
            raise Bad(f"module {module} has no file with its name in {' or '.join(FOLDERS)}")
        waiting.append(tree[module + ".sv"])
    while waiting:
        name = waiting.pop()
        if name in files:
            continue
        files.add(name)
        text = bare((root / name).read_text())
        wanted = [f"{package}.sv" for package in re.findall(r"\b(\w+_pkg)\s*::", text)]
        wanted += [include.rsplit("/", 1)[-1] for include in re.findall(r'`include "([^"]+)"', text)]
        waiting += [tree[w] for w in wanted if w in tree]
    return files
