# SPDX-License-Identifier: Apache-2.0
"""The ray-triangle pipe by Moeller and Trumbore as dataflow (rtl/pipes/ray_triangle_moller.sv): a column per cycle."""
from canvas import Canvas

LEFT, COLUMN, GAP, HIGH = 20, 76, 16, 34
TOP = 64
STEP = 56


def place(row):
    return TOP + row * STEP


# name: row, first cycle, last cycle, words, kind
MOELLER = {
    "e2": (0, 0, 1, ("e2 =", "v2 − v0"), "fa"), "e1": (1, 0, 1, ("e1 =", "v1 − v0"), "fa"), "s": (2, 0, 1, ("s =", "o − v0"), "fb"),
    "p": (0, 1, 3, "p = d × e2", "fb"), "q": (2, 1, 3, "q = s × e1", "fb"),
    "det": (0, 3, 6, "det = p · e1", "fb"), "u": (1, 3, 6, "u = p · s", "fb"), "v": (2, 3, 6, "v = q · d", "fb"), "tn": (3, 3, 6, "tn = q · e2", "fb"),
    "uv": (1, 6, 7, "u + v", "fb"), "t": (3, 6, 7, ("T =", "tn / det"), "fr"), "in": (0, 6, 7, ("0 ≤ u, v", "≤ |det|"), "fg"), "in2": (1, 7, 8, ("u + v",
        "≤ |det|"), "fg"),
    "td": (4, 7, 8, "T d", "fb"), "range": (3, 7, 8, ("tmin ≤ T", "≤ tmax"), "fg"), "cp": (4, 8, 9, ("CP =", "o + T d"), "fb"), "met": (2, 8, 9, "F", "fn"),
    "result": (3, 9, 10, ("F, T,", "CP"), "fn"),
}
MOELLER_ARROWS = (("e2", "p"), ("s", "q"), ("p", "det"), ("p", "u"), ("q", "v"), ("q", "tn"), ("u", "uv"), ("uv", "in2"), ("tn", "t"), ("t", "range"),
          ("t", "td"), ("td", "cp"), ("cp", "result"), ("met", "result"), ("det", "in"), ("e1", "q"), ("in2", "met"), ("range", "met"),
          ("v", "uv"), ("u", "in"), ("in", "in2"))


# rtl/pipes/sphere_sphere.sv, with distance_result.sv
SPHERES = {
    "w": (0, 0, 1, ("w =", "cB − cA"), "fb"), "dd": (0, 1, 4, "dd = w · w", "fb"), "d": (0, 4, 5, ("d =", "√dd"), "fr"), "inv": (0, 5, 6, "1 / d", "fr"),
    "n": (0, 6, 7, ("n =", "w / d"), "fb"), "reach": (1, 0, 1, ("sum =", "rA + rB"), "fb"), "s": (1, 5, 6, ("s = d", "− sum"), "fb"), "half": (1, 6, 7,
        "s / 2", "fb"),
    "along": (1, 7, 8, ("rA +", "s / 2"), "fb"), "off": (1, 8, 9, ("times", "n"), "fb"), "cp": (1, 9, 10, ("CP =", "cA + ..."), "fb"),
    "wd": (2, 1, 6, "w waits: 5 cycles", "fn"), "rd": (3, 1, 5, "sum waits: 4 cycles", "fn"), "f": (2, 6, 7, "s ≤ 0", "fg"),
    "out": (2, 10, 11, ("F, T,", "CP, n"), "fn"), "nd": (0, 7, 8, ("n waits", "1 cycle"), "fn"),
}
SPHERES_ARROWS = (("w", "dd"), ("dd", "d"), ("d", "inv"), ("inv", "n"), ("d", "s"), ("s", "half"), ("half", "along"), ("along", "off"), ("off", "cp"),
    ("cp", "out"),
                  ("n", "nd"), ("nd", "off"), ("w", "wd"), ("reach", "rd"), ("rd", "s"), ("s", "f"), ("wd", "n"))


class Flow:
    """Boxes in columns of cycles."""

    def __init__(self, c, boxes, column):
        self.c, self.boxes, self.column = c, boxes, column

    def edges(self, name):
        row, start, end, _, _ = self.boxes[name]
        return LEFT + start * self.column + GAP / 2, LEFT + end * self.column - GAP / 2, place(row) + HIGH / 2

    def draw(self, cycles, rows, arrows):
        c = self.c
        for k in range(cycles + 1):
            x = LEFT + k * self.column
            c.line([(x, 34), (x, place(rows - 1) + HIGH + 10)], "lh", 1, "2 3", solid=False)
            c.text(x, 26, str(k), "middle", 12, "tu")
        c.text(LEFT - 14, 12, "cycle, with operators of one cycle each", size=12, kind="tu")
        for a, b in arrows:
            (_, x0, y0), (x1, _, y1) = self.edges(a), self.edges(b)
            c.arrow((x0, y0), (x1, y1), thick=1.2, size=6)
        for row, start, end, words, kind in self.boxes.values():
            x = LEFT + start * self.column + GAP / 2
            c.box(x, place(row), (end - start) * self.column - GAP, HIGH, words, kind, 13 if isinstance(words, str) and end - start > 1 else 11.5, leading=14)
        return place(rows - 1) + HIGH + 34


def legend(c, y, entries):
    x = LEFT
    for kind, words, wide in entries:
        c.rect(x, y - 11, 14, 14, kind, 2)
        c.text(x + 20, y, words, size=12)
        x += wide


def moeller(_root):
    c = Canvas(800, 448, "The ray-triangle pipe by Moeller and Trumbore",
               "Dataflow of the pipe with one column per cycle, for operators of one cycle. Edges of the triangle are computed once for all "
               "lanes. Cross and inner products give det, u, v and the numerator of t. One division gives T. After ten cycles F, T and CP leave.")
    y = Flow(c, MOELLER, COLUMN).draw(10, 5, MOELLER_ARROWS)
    legend(c, y, (("fa", "once for all lanes", 150), ("fb", "add, subtract, multiply", 186), ("fr", "divide", 80), ("fg", "compare", 92), ("fn",
        "registers", 92)))
    c.texts_at(LEFT, y + 26,
        ("A lane has 27 multipliers, 1 divider, 12 adders, 15 subtractors and 8 comparators. The pipe takes L pairs per cycle and never stalls.",
                              "Not every operand has an arrow. u and v are barycentric coordinates times det, so the inside test needs no division.",
                              "~With the box rule the latency is 13 cycles. A miss has F = 0, T = +∞, CP = 0."), size=11.5)
    return c


def spheres(_root):
    c = Canvas(800, 372, "The pipe of two spheres as dataflow",
               "Dataflow of sphere-sphere with one column per cycle, for operators of one cycle: difference of the centres, squared length, "
               "square root, quotient, "
               "normal, signed distance and contact point. Values that are early wait in delays that the notation adds.")
    y = Flow(c, SPHERES, 69).draw(11, 4, SPHERES_ARROWS)
    legend(c, y, (("fb", "add, subtract, multiply", 186), ("fr", "divide, square root", 156), ("fg", "compare", 92), ("fn",
        "delays that the notation adds, registers", 260)))
    c.texts_at(LEFT, y + 26, ("` `DF_VSUB(w, b_c, a_c)  `DF_DOT(dd, w, w)  `DF_SQRT(d, dd)",
        "One line per operator. No delay is counted by hand; not every delay is drawn. 11 cycles, never stalls."),
               size=12, leading=18)
    return c
