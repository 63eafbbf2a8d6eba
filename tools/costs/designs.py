# SPDX-License-Identifier: Apache-2.0
"""Designs to measure: one operator, one pipe or one traversal unit, between registers, with three pins."""
import dataclasses

import cards
from contract import Bad, contract, listed
import targets

# Operators: module, further parameters, operands, result port. A mask is one bit.
OPERATORS = {
    "add": ("fp_add", "", "ab", "r_o"),
    "sub": ("fp_add", ", .SUB(1)", "ab", "r_o"),
    "mul": ("fp_mul", "", "ab", "r_o"),
    "div": ("fp_div", "", "ab", "r_o"),
    "sqrt": ("fp_sqrt", "", "a", "r_o"),
    "lt": ("fp_cmp", ", .OP(formats_pkg::FP_LT)", "ab", "m_o"),
    "le": ("fp_cmp", ", .OP(formats_pkg::FP_LE)", "ab", "m_o"),
    "eq": ("fp_cmp", ", .OP(formats_pkg::FP_EQ)", "ab", "m_o"),
}
ORDINARY = ("add", "mul")
# Traversal units: what they are for, and their cycles per node.
UNITS = {"traversal-unit": ("rays", 1), "traversal-unit-shared": ("rays", 2), "traversal-unit-solids": ("solids", 1)}
STYLES = ("cde", "ordinary")
MOST_LATENCY = 64
MOST_LANES = 64
KINDS = ("add", "mul", "div", "sqrt", "cmp")  # kinds of latencies of a pipe or unit, in the order of a card's parameters


def container(width):
    return 32 if width <= 32 else 64


@dataclasses.dataclass(frozen=True)
class Design:
    what: str
    format: str
    lat: tuple            # one latency, or one per kind in KINDS
    lanes: int = 1
    style: str = "cde"
    algorithm: str = ""   # only for ray-triangle
    target: str = "ecp5-85"

    @property
    def pipe(self):
        return self.what in contract().pairs

    @property
    def unit(self):
        return self.what in UNITS

    @property
    def card(self):
        return self.what == cards.WHAT

    @property
    def lat_text(self):
        return "/".join(map(str, self.lat))

    @property
    def module(self):
        if self.style == "ordinary":
            return f"ordinary_{self.what}"
        if self.pipe:
            return self.what + (f" {self.algorithm}" if self.algorithm else "")
        if self.unit or self.card:
            return self.what
        return OPERATORS[self.what][0] if self.what in OPERATORS else "fp_cvt"

    @property
    def label(self):
        name = self.module if self.pipe or self.unit or self.card or self.style == "ordinary" else f"fp_{self.what}"
        return f"{name} {self.format} LAT {self.lat_text}" + (f" LANES {self.lanes}" if self.lanes > 1 else "") + f" {self.target}"

    @property
    def arguments(self):
        words = [self.what, "--format", self.format, "--lat", self.lat_text, "--lanes", str(self.lanes)]
        if self.algorithm:
            words += ["--algorithm", self.algorithm]
        if self.style != "cde":
            words += ["--style", self.style]
        return words + ["--target", self.target]

    def order(self):
        """The place of a row in the table."""
        known = contract()
        whats = list(OPERATORS) + [f"to_{f}" for f in known.formats] + list(known.pairs) + list(UNITS) + [cards.WHAT]
        formats = list(known.formats)
        named = self.format in known.formats
        return (list(targets.TARGETS).index(self.target), whats.index(self.what),
                -known.format(self.format)[1], formats.index(self.format) if named else len(formats), self.format,
                list(known.algorithms).index(self.algorithm) if self.algorithm else 0, STYLES.index(self.style), self.lanes, self.lat)

    # ---- The text that is synthesised ----
    def bench(self):
        """Text of the modules `measured`, whose cells are counted, and `bench`, which shifts operands in and folds results, with registers on both sides."""
        if self.card:
            return cards.bench(self.lat)
        exp, man = contract().format(self.format)
        width = 1 + exp + man
        body, inputs, outputs = self._unit() if self.unit else self._pipe(exp, man, width) if self.pipe else self._operator(exp, man, width)
        return f"""module measured (input logic clk_i, input logic [{inputs - 1}:0] d_i, output logic [{outputs - 1}:0] q_o);
{body}endmodule

module bench (input logic clk_i, input logic d_i, output logic q_o);
  logic [{inputs - 1}:0] in_q;
  logic [{outputs - 1}:0] r, r_q, out_q;
  measured measured (.clk_i, .d_i(in_q), .q_o(r));
  always_ff @(posedge clk_i) begin
    in_q <= {{in_q[{inputs - 2}:0], d_i}};
    r_q <= r;
    out_q <= {{out_q[{max(outputs - 2, 0)}:0], out_q[{outputs - 1}]}} ^ r_q;
  end
  assign q_o = out_q[{outputs - 1}];
endmodule
"""

    def _operator(self, exp, man, width):
        lanes, out = self.lanes, width
        if self.style == "ordinary":
            return (f"  ordinary_{self.what} #(.EXP({exp}), .MAN({man})) unit (\n"
                    f"      .clk_i, .a_i(d_i[{width - 1}:0]), .b_i(d_i[{2 * width - 1}:{width}]), .r_o(q_o));\n"), 2 * width, width
        if self.what.startswith("to_"):
            module, extra, operands, result = "fp_cvt", "", "a", "r_o"
            exp_o, man_o = contract().format(self.what[3:])
            out = 1 + exp_o + man_o
            numbers = f".EXP_I({exp}), .MAN_I({man}), .EXP_O({exp_o}), .MAN_O({man_o})"
        else:
            module, extra, operands, result = OPERATORS[self.what]
            numbers = f".EXP({exp}), .MAN({man}){extra}"
        word = container(out)
        if module == "fp_cmp":
            out = 1
        text = f"  logic [{lanes - 1}:0][{word - 1}:0] r, unused_flags;\n"
        for k, name in enumerate(operands):
            text += f"  logic [{lanes - 1}:0][{container(width) - 1}:0] {name};\n"
            for lane in range(lanes):
                text += f"  assign {name}[{lane}] = d_i[{(k * lanes + lane) * width}+:{width}];\n"
        for lane in range(lanes):
            text += f"  assign q_o[{lane * out}+:{out}] = r[{lane}][{out - 1}:0];\n"
        ports = ", ".join(f".{name}_i({name})" for name in operands)
        text += (f"  {module} #({numbers}, .LANES({lanes}), .LAT({self.lat[0]}), .ARITH(\"rtl\")) unit (\n"
                 f"      .clk_i, {ports}, .{result}(r), .flags_o(unused_flags));\n")
        return text, len(operands) * lanes * width, lanes * out

    def _pipe(self, exp, man, width):
        lanes, word = self.lanes, container(width)
        known = contract()
        a_words, b_words = known.pair_words[self.what]
        text, at = "", 0
        for name, words in (("a", a_words), ("b", b_words)):
            text += f"  logic [{words - 1}:0][{lanes - 1}:0][{word - 1}:0] {name};\n"
            for k in range(words):
                for lane in range(lanes):
                    text += f"  assign {name}[{k}][{lane}] = d_i[{at}+:{width}];\n"
                    at += width
        text += (f"  logic [{lanes - 1}:0][{word - 1}:0] f, t;\n"
                 f"  logic [2:0][{lanes - 1}:0][{word - 1}:0] cp, n;\n  logic [15:0] unused_latency;\n")
        out = 0
        for lane in range(lanes):
            text += f"  assign q_o[{out}] = f[{lane}][0];\n"
            out += 1
            for value in ["t"] + [f"{v}[{k}]" for v in ("cp", "n") for k in range(3)]:
                text += f"  assign q_o[{out}+:{width}] = {value}[{lane}][{width - 1}:0];\n"
                out += width
        cycles = f".LAT({self._latencies()})"
        text += (f"  scaled_pipe #(.EXP({exp}), .MAN({man}), .LANES({lanes}), {cycles}, .ARITH(\"rtl\"),\n"
                 f"      .PAIR({known.pairs[self.what]}), .ALGORITHM({known.algorithms.get(self.algorithm, 0)})) unit (\n"
                 "      .clk_i, .enter_i(1'b1), .a_i(a), .b_i(b), .f_o(f), .t_o(t), .cp_o(cp), .n_o(n),\n"
                 "      .latency_o(unused_latency));\n")
        return text, at, out

    def _unit(self):
        bvh = contract().bvh
        inputs = {"front_i": 9 * 32, "floor_i": 32, "limit_i": 32, "farthest_i": 1, "valid_i": 1, "node_i": bvh["NODE_WORDS"] * 32}
        use, cycles = UNITS[self.what]
        key, other, solid = (bvh["RAY_KEY"], "SOLIDS", 0) if use == "rays" else (16, "RAYS", 1)  # NODE_KEY of rtl/bvh/bvh.svh
        group = 40 + 2 * bvh["PLACE"] + 4 + bvh["CHILDREN"] * (2 + 3 + key)  # GROUP_BITS of rtl/bvh/bvh.svh
        ports, at = "", 0
        for name, width in inputs.items():
            ports += f".{name}(d_i[{at}+:{width}]), "
            at += width
        text = (f"  traversal_unit #(.LAT({self._latencies()}), .ARITH(\"rtl\"), .{other}(0), .CYCLES({cycles})) unit (\n"
                f"      .clk_i, {ports}.solid_i(1'b{solid}), .group_o(q_o));\n")
        return text, at, group

    def _latencies(self):
        return "{" + ", ".join(f"32'd{n}" for n in self.lat) + "}"


def number(word, least, most, name):
    try:
        value = int(word)
    except ValueError:
        value = None
    if value is None or not least <= value <= most:
        raise Bad(f"{word} is not a {name}; expected {least} to {most}")
    return value


def design(what, format="fp32", lat=None, lanes="1", style="cde", algorithm=None, target="ecp5-85"):
    """A checked design, from its words."""
    known = contract()
    targets.target(target)
    pipe = what in known.pairs
    if what in known.iterative:
        raise Bad(f"{what} is an iterative pipeline, which is not measured; expected {listed(p for p in known.pairs if p not in known.iterative)}")
    unit = what in UNITS or what == cards.WHAT
    if not pipe and not unit and what not in OPERATORS and not (what.startswith("to_") and what[3:] in known.formats):
        raise Bad(f"{what} is not an operator, a pair, a unit or a card; expected {listed(OPERATORS)}, to_FORMAT, "
                  f"{listed(p for p in known.pairs if p not in known.iterative)}, {listed(UNITS)}, {cards.WHAT}")
    if what == cards.WHAT and target != cards.TARGET:
        raise Bad(f"{what} needs the target {cards.TARGET}, not {target}")
    if unit and (format != "fp32" or lanes not in ("1", 1)):
        raise Bad(f"{what} needs fp32 and LANES 1")
    known.format(format)
    if style not in STYLES:
        raise Bad(f"{style} is not a style; expected {listed(STYLES)}")
    if style == "ordinary" and what not in ORDINARY:
        raise Bad(f"there is no ordinary {what}; expected {listed(ORDINARY)}")
    if algorithm and what != "ray-triangle":
        raise Bad(f"{what} has no algorithms; expected ray-triangle")
    if what == "ray-triangle":
        algorithm = algorithm or "moller"
        if algorithm not in known.algorithms:
            raise Bad(f"{algorithm} is not an algorithm; expected {listed(known.algorithms)}")
    words = (lat or ("1/1/1/1/1" if pipe or unit else "1")).split("/")
    if len(words) != (len(KINDS) if pipe or unit else 1):
        raise Bad(f"--lat {lat}: {what} takes " + (f"five numbers, {'/'.join(KINDS)}" if pipe or unit else "one number"))
    cycles = tuple(number(word, 1, MOST_LATENCY, "latency") for word in words)
    if style == "ordinary" and (cycles != (1,) or lanes not in ("1", 1)):
        raise Bad(f"ordinary_{what} needs LAT 1 and LANES 1")
    return Design(what, format, cycles, number(lanes, 1, MOST_LANES, "number of lanes"), style, algorithm or "", target)
