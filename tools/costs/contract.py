# SPDX-License-Identifier: Apache-2.0
"""Tables of formats, operations, pairs and algorithms, read from the text of rtl/contract/."""
import functools
import pathlib
import re

ROOT = pathlib.Path(__file__).resolve().parents[2]


class Bad(Exception):
    """An invalid input, with a one-line message that names what is allowed."""


def listed(words):
    return ", ".join(words)


class Contract:
    """Tables of formats_pkg and pairs_pkg, and numbers of bvh_pkg."""

    def __init__(self, formats, pairs, bvh):
        self.formats = self._formats(formats)
        self._pairs(pairs)
        self.bvh = {name: int(value) for name, value in re.findall(r"^ *localparam int ([A-Z_]+) = (\d+);", bvh, re.M)}

    @staticmethod
    def _codes(text, prefix, kind="int"):
        """NAME -> number of `localparam KIND PREFIX_NAME = number;`"""
        found = re.findall(rf"^ *localparam {re.escape(kind)} {prefix}_([A-Z0-9_]+) = (?:\d+'d)?(\d+);", text, re.M)
        return {name: int(code) for name, code in found}

    @staticmethod
    def _numbers(text, name):
        body = re.search(rf"\b{name} = \{{([^}}]*)\}}+;", text)
        if not body:
            raise Bad(f"rtl/contract/ has no table {name}")
        return [int(n) for n in re.findall(r"\d+'d(\d+)", body.group(1))]

    def _formats(self, text):
        names = self._codes(text, "FORMAT")
        exps, mans = self._numbers(text, "FORMAT_EXPS"), self._numbers(text, "FORMAT_MANS")
        return {name.lower(): (exps[k], mans[k]) for name, k in names.items()}

    def _pairs(self, text):
        shapes = self._codes(text, "SHAPE")
        words = self._numbers(text, "SHAPE_WORDS")
        self.shape_words = {name: words[code] for name, code in shapes.items() if code < len(words)}
        self.algorithms = {name.lower(): code for name, code in self._codes(text, "ALGORITHM", "logic [7:0]").items()}
        self.pairs, self.pair_words = {}, {}
        roles = []
        for table in ("PRIMARY_SHAPES", "SECONDARY_SHAPES"):
            body = text[text.index(table + " = {"):].split("};")[0]
            roles.append(re.findall(r"^ *SHAPE_INDEX'\(SHAPE_([A-Z]+)\)", body, re.M))
        for name, code in self._codes(text, "PAIR", "pair_t").items():
            word = name.lower().replace("_", "-")
            self.pairs[word] = code
            self.pair_words[word] = (self.shape_words[roles[0][code]], self.shape_words[roles[1][code]])
        iterative = re.search(r"\bITERATIVE_PAIRS =[^;]*;", text).group(0)
        self.iterative = {name.lower().replace("_", "-") for name in re.findall(r"PAIR_([A-Z_]+)", iterative.split("\n", 1)[1])}

    def format(self, word):
        """Exponent and fraction bits of a format, by name or in the form e4m11."""
        if word in self.formats:
            return self.formats[word]
        spelled = re.fullmatch(r"e(\d+)m(\d+)", word)
        if spelled:
            exp, man = int(spelled.group(1)), int(spelled.group(2))
            if 3 <= exp <= 11 and 2 <= man <= 52:
                return exp, man
        raise Bad(f"{word} is not a format; expected {listed(self.formats)}, or eEmM with E from 3 to 11 and M from 2 to 52")


@functools.lru_cache(maxsize=None)
def contract():
    folder = ROOT / "rtl" / "contract"
    return Contract(*((folder / f"{name}_pkg.sv").read_text() for name in ("formats", "pairs", "bvh")))
