# SPDX-License-Identifier: Apache-2.0
"""Each primitive with its words (rtl/contract/pairs_pkg.sv), drawn in space."""
import math

from canvas import Canvas

WIDE, HIGH = 206, 262
TURN, TILT = math.radians(-32), math.radians(22)


def project(x, y, z):
    """Orthographic view: x to the right, z upwards."""
    u = x * math.cos(TURN) - y * math.sin(TURN)
    v = x * math.sin(TURN) + y * math.cos(TURN)
    return u, -(z * math.cos(TILT) + v * math.sin(TILT))


class View:
    """A picture's place and scale."""

    def __init__(self, c, x, y, scale):
        self.c, self.x, self.y, self.scale = c, x, y, scale

    def at(self, *point):
        u, v = project(*point)
        return self.x + u * self.scale, self.y + v * self.scale

    def line(self, *points, kind="lb", thick=1.5, dash=None):
        self.c.line([self.at(*p) for p in points], kind, thick, dash, solid=False)

    def area(self, *points, kind="fb"):
        self.c.polygon([self.at(*p) for p in points], kind)

    def mark(self, point, words, dx=6, dy=-5, anchor="start"):
        x, y = self.at(*point)
        self.c.dot(x, y)
        self.c.text(x + dx, y + dy, "/" + words, anchor)

    def arrow(self, a, b, hue="x", thick=1.6):
        self.c.arrow(self.at(*a), self.at(*b), hue=hue, thick=thick)


def box_lines(view, center, axes, half):
    """A box: three faces that are seen, three edges that are hidden."""
    def corner(signs):
        return tuple(center[k] + sum(signs[i] * half[i] * axes[i][k] for i in range(3)) for k in range(3))
    hidden = (-1, 1, -1)
    view.c.polygon([view.at(*corner(s)) for s in ((-1, -1, -1), (1, -1, -1), (1, 1, -1), (1, 1, 1), (-1, 1, 1), (-1, -1, 1))], "fb")
    for i in range(3):
        other = list(hidden)
        other[i] = -other[i]
        view.line(corner(hidden), corner(tuple(other)), kind="lu", thick=1, dash="3 3")
    front = (1, -1, 1)
    for i in range(3):
        other = list(front)
        other[i] = -other[i]
        view.line(corner(front), corner(tuple(other)))
    return corner


def ray(c, x, y):
    v = View(c, x + 34, y + 92, 1)
    o, d = (0, 0, 0), (55, 0, 26)
    v.line((25, 0, 11.8), (150, 0, 70.9), kind="lb", thick=5)
    v.line(o, (165, 0, 78), kind="lu", thick=1, dash="4 3")
    v.arrow(o, d)
    v.mark(o, "o", -6, 16)
    c.text(v.at(*d)[0] + 4, v.at(*d)[1] + 17, "/d")
    for t, words in ((25 / 55, "tmin"), (150 / 55, "tmax")):
        px, py = v.at(*(t * k for k in d))
        c.line([(px - 3, py - 7), (px + 3, py + 7)], "lx", 2)
        c.text(px - 6, py - 11, "/" + words, "middle")


def triangle(c, x, y):
    v = View(c, x + 100, y + 80, 1)
    points = ((-70, 0, -28), (70, -10, -30), (15, 20, 52))
    v.area(*points)
    v.mark(points[0], "v0", -4, 17, "middle")
    v.mark(points[1], "v1", 4, 17, "middle")
    v.mark(points[2], "v2", 0, -8, "middle")


def sphere(c, x, y):
    c.circle(x + 100, y + 74, 54, "fb")
    c.ellipse(x + 100, y + 74, 54, 20, "lu", thick=1, dash="3 3")
    end = (x + 100 + 54 * math.cos(0.7), y + 74 - 54 * math.sin(0.7))
    c.arrow((x + 100, y + 74), end, thick=1.6)
    c.dot(x + 100, y + 74)
    c.text(x + 94, y + 70, "/c", "end")
    c.text(x + 116, y + 52, "/r", "end")


def aabb(c, x, y):
    v = View(c, x + 100, y + 74, 1)
    corner = box_lines(v, (0, 0, 0), ((1, 0, 0), (0, 1, 0), (0, 0, 1)), (46, 34, 34))
    v.mark(corner((-1, -1, -1)), "min", -4, 18, "middle")
    v.mark(corner((1, 1, 1)), "max", 2, -8, "middle")


def plane(c, x, y):
    v = View(c, x + 92, y + 92, 1)
    v.area((-70, -45, 0), (60, -45, 0), (60, 45, 0), (-70, 45, 0))
    v.arrow((0, 0, 0), (0, 0, 62))
    c.dot(*v.at(0, 0, 0))
    c.text(v.at(0, 0, 62)[0] + 8, v.at(0, 0, 62)[1] + 10, "/n")


def cylinder(c, x, y):
    cx, cy, half, r = x + 86, y + 76, 42, 46
    c.put(f'<path d="M{cx - r} {cy - half}A{r} 15 0 0 1 {cx + r} {cy - half}V{cy + half}A{r} 15 0 0 1 {cx - r} {cy + half}Z" class="fb" '
          'stroke-width="1.4"/>', "fb")
    c.ellipse(cx, cy - half, r, 15, "fb")
    c.ellipse(cx, cy + half, r, 15, "lu", thick=1, dash="3 3")
    c.arrow((cx, cy - half), (cx + r, cy - half), thick=1.6)
    c.arrow((cx, cy), (cx, cy - 32), thick=1.6)
    c.dot(cx, cy)
    c.text(cx - 7, cy + 5, "/c", "end")
    c.text(cx + 6, cy - 12, "/axis")
    c.text(cx + r + 6, cy - half + 4, "/radius")
    c.arrow((cx + r + 10, cy), (cx + r + 10, cy + half), thick=1.2, both=True, hue="u", size=5)
    c.text(cx + r + 16, cy + 20, "/half")
    c.text(cx + r + 16, cy + 35, "/height")


def obb(c, x, y):
    v = View(c, x + 100, y + 76, 1)
    a = math.radians(24)
    axes = ((math.cos(a), 0, math.sin(a)), (0, 1, 0), (-math.sin(a), 0, math.cos(a)))
    box_lines(v, (0, 0, 0), axes, (52, 34, 28))
    for axis, length, words, dx, dy in ((axes[0], 52, "e1", -6, -8), (axes[1], -34, "e2", -10, 8), (axes[2], 28, "e3", 13, 8)):
        tip = tuple(length * k for k in axis)
        v.arrow((0, 0, 0), tip)
        px, py = v.at(*tip)
        c.text(px + dx, py + dy, "/" + words, "middle")
    c.dot(*v.at(0, 0, 0))
    c.text(v.at(0, 0, 0)[0] + 8, v.at(0, 0, 0)[1] + 14, "/c", "middle")


CELLS = (
    ("ray", ray, ("8 words", "0-2  o, 3-5  d", "6  tmin, 7  tmax", "largest component", "of d is a size")),
    ("triangle", triangle, ("9 words", "0-2  v0, 3-5  v1,", "6-8  v2", "flat, two-sided")),
    ("sphere", sphere, ("4 words", "0-2  c, 3  r", "r is a size")),
    ("AABB", aabb, ("6 words", "0-2  min, 3-5  max", "max > min on each axis")),
    ("plane", plane, ("4 words", "0-2  n, 3  d", "n of unit length;", "all points with n·x = d")),
    ("cylinder", cylinder, ("8 words", "0-2  c, 3-5  axis", "6  half height, 7  radius", "axis of unit length")),
    ("OBB", obb, ("15 words, two DDR beats", "0-2  c, 3-5  half extents", "6-14  rotation by rows,", "its columns are the axes")),
)


def picture(_root):
    c = Canvas(840, 2 * HIGH + 16, "The seven primitives and the words of their slots",
               "Ray, triangle, sphere, axis-aligned box, plane, cylinder and oriented box, each with its fields and the number of words "
               "that a slot of it has.")
    for i, (name, draw, lines) in enumerate(CELLS):
        x, y = 6 + (i % 4) * (WIDE + 2), 8 + (i // 4) * HIGH
        c.text(x + 10, y + 16, "*" + name, size=14)
        draw(c, x, y + 18)
        c.texts_at(x + 10, y + 182, lines, size=12)
    x, y = 6 + 3 * (WIDE + 2), 8 + HIGH
    c.texts_at(x + 10, y + 60, ("*words", "one number each, 32 bits", "on the card in fp32", "", "*size", "a length from 2^low",
                                "to 2^high; in fp32 from", "2^-34 to 2^40", "", "~OBB: e1, e2, e3 are", "~half extents times axes"), size=12)
    return c
