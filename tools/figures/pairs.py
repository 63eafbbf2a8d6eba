# SPDX-License-Identifier: Apache-2.0
"""The pairs in section: both bodies, the signed distance and its witness points, as geometry.py computes them."""
from canvas import Canvas
from geometry import add, box, ray_hit, segment, signed, signed_half_plane, sphere

SCALE = 29
WIDE, HIGH = 278, 186
PLANE = "plane"  # the half-plane below y = -0.9


class Section:
    """Half a cell: world coordinates, y upwards, with its middle at a place of the picture."""

    def __init__(self, c, x, y):
        self.c, self.x, self.y = c, x, y

    def at(self, p):
        return self.x + p[0] * SCALE, self.y - p[1] * SCALE

    def body(self, body, kind, axis=None):
        if len(body.points) == 1:
            self.c.circle(*self.at(body.points[0]), body.radius * SCALE, kind)
        elif len(body.points) == 2:
            self.c.line([self.at(p) for p in body.points], "l" + kind[1], 3.5, solid=False)  # a triangle, edge-on
        else:
            self.c.polygon([self.at(p) for p in body.points], kind)
        if axis:
            self.c.line([self.at(p) for p in axis], "lu", 1, "7 3 2 3", solid=False)

    def plane(self):
        left, right, low = self.x - 2.15 * SCALE, self.x + 2.15 * SCALE, self.y + 0.9 * SCALE
        self.c.line([(left, low), (right, low)], "la", 2.5, solid=False)

    def answer(self, s, n, on_a, on_b):
        a, b = self.at(on_a), self.at(on_b)
        self.c.line([a, b], "lr", 2, solid=False)
        self.c.dot(*a, "mr")
        self.c.dot(*b, "mr")
        middle = ((a[0] + b[0]) / 2, (a[1] + b[1]) / 2)
        self.c.circle(*middle, 4.5, "lr", 1.3)
        side = (-n[1] * 0.34, n[0] * 0.34)
        start = add(add(on_a, side), n, -0.1)
        self.c.arrow(self.at(start), self.at(add(start, n, 0.95)), hue="g", thick=1.6)
        self.caption(f"s = {s:+.2f}".replace("-", "−"), f"F = {int(s <= 0)}, T = {abs(s):.2f}")

    def caption(self, first, second):
        holder = (self.x - WIDE / 4, self.y - 80, self.x + WIDE / 4 - 3, self.y + 100)
        self.c.text(self.x, self.y + 74, first, "middle", 12, holder=holder)
        self.c.text(self.x, self.y + 90, second, "middle", 12, holder=holder)


def axis_of(body):
    """The middle line of a cylinder's section: its first edge is across the axis."""
    p = body.points
    low, high = add(p[0], add(p[1], p[0], -1), 0.5), add(p[3], add(p[2], p[3], -1), 0.5)
    d = add(high, low, -1)
    return add(low, d, -0.08), add(high, d, 0.08)


CONVEX = (
    ("sphere-sphere", (sphere((-1.2, -0.4), 1.0), sphere((1.35, 0.5), 0.75)), (sphere((-0.75, -0.2), 1.15), sphere((0.8, 0.3), 0.95))),
    ("triangle-sphere", (segment((-1.9, -1.3), (-0.5, 1.2)), sphere((1.1, -0.1), 0.9)), (segment((-1.8, -0.8), (0.5, 0.85)), sphere((0.55, -0.25), 1.15))),
    ("sphere-obb", (sphere((-1.25, 0.55), 0.8), box((1.0, -0.5), (0.9, 0.6), 25)), (sphere((-0.8, 0.4), 1.05), box((0.7, -0.35), (1.1, 0.75), 25))),
    ("triangle-aabb", (segment((-1.9, 1.1), (-0.7, -1.1)), box((1.0, -0.1), (0.8, 0.9))), (segment((-1.6, 1.2), (0.15, -0.35)), box((0.7, -0.2), (1.0,
        0.9)))),
    ("triangle-obb", (segment((-1.8, -1.2), (-0.4, 1.2)), box((1.1, -0.4), (0.9, 0.6), -20)), (segment((-1.9, 0.5), (0.1, 0.1)), box((0.75, 0.0), (1.0,
        0.8), -20))),
    ("obb-obb", (box((-1.2, 0.35), (0.8, 0.55), 30), box((1.25, -0.3), (0.7, 0.7), -15)), (box((-0.75, 0.3), (0.95, 0.7), 30), box((0.8, -0.3), (0.9, 0.8),
        -15))),
    ("triangle-triangle", (segment((-1.6, -1.2), (-0.7, 1.3)), segment((0.3, -0.4), (1.7, 1.0))), (segment((-1.2, -1.3), (0.4, 1.3)), segment((-0.75, 0.2),
        (1.7, -0.4)))),
    ("obb-plane", (box((0.0, 0.75), (1.0, 0.6), 25), PLANE), (box((0.0, -0.25), (1.0, 0.65), 25), PLANE)),
    ("sphere-plane", (sphere((0.0, 0.75), 0.95), PLANE), (sphere((0.0, -0.2), 1.05), PLANE)),
)
CYLINDER = (
    ("triangle-cylinder", "along", (segment((-1.8, 1.2), (-0.6, -1.1)), box((1.0, 0.0), (0.6, 1.1), -15)), (segment((-1.7, 0.9), (0.25, 0.2)), box((0.75,
        -0.1), (0.75, 1.2), -15))),
    ("cylinder-cylinder", "along", (box((-1.15, 0.2), (0.5, 1.0), 35), box((1.15, -0.1), (0.55, 1.1), -10)), (box((-0.75, 0.3), (0.6, 1.1), 35), box((0.75,
        -0.2), (0.65, 1.1), -10))),
    ("obb-cylinder", "along", (box((-1.1, 0.3), (0.8, 0.6), 30), box((1.2, -0.1), (0.55, 1.1), 15)), (box((-0.75, 0.3), (0.95, 0.75), 30), box((0.85, -0.2),
        (0.65, 1.1), 15))),
    ("triangle-cylinder", "across", (segment((-1.9, -1.3), (-0.5, 1.2)), sphere((1.1, -0.1), 0.9)), (segment((-1.8, 0.9), (0.0, 0.15)), sphere((0.75, -0.2),
        1.05))),
    ("cylinder-cylinder", "across", (sphere((-1.2, 0.45), 0.95), sphere((1.3, -0.4), 0.75)), (sphere((-0.75, 0.25), 1.1), sphere((0.85, -0.3), 0.9))),
    ("obb-cylinder", "across", (box((-1.15, 0.35), (0.8, 0.55), 35), sphere((1.25, -0.3), 0.85)), (box((-0.7, 0.3), (1.0, 0.7), 35), sphere((0.85, -0.3),
        0.95))),
)


def pair(c, x, y, name, cases, note=""):
    c.rect(x, y, WIDE - 6, HIGH - 6, "lh", 6, solid=False)
    c.text(x + 10, y + 18, "*" + name, size=13)
    if note:
        c.text(x + WIDE - 16, y + 18, note, "end", 12, "tu")
    for i, (a, b) in enumerate(cases):
        view = Section(c, x + WIDE * (0.25 + 0.5 * i) - 3, y + 80)
        cylinders = note == "along"
        if b is PLANE:
            view.plane()
            view.body(a, "fb")
            view.answer(*signed_half_plane(a, (0, 1), -0.9))
            continue
        view.body(b, "fa", axis_of(b) if cylinders else None)
        view.body(a, "fb", axis_of(a) if cylinders and name.startswith("cylinder") else None)
        view.body(b, "la")
        view.answer(*signed(a, b))


def key(c, y, first):
    c.rect(10, y - 11, 14, 14, "fb", 2)
    c.text(30, y, "A, primary", size=12)
    c.rect(108, y - 11, 14, 14, "fa", 2)
    c.text(128, y, "B, secondary", size=12)
    c.line([(226, y - 4), (256, y - 4)], "lr", 2, solid=False)
    c.dot(226, y - 4, "mr")
    c.dot(256, y - 4, "mr")
    c.circle(241, y - 4, 4.5, "lr", 1.3)
    c.text(264, y, "witness points pA and pB, CP between them", size=12)
    c.arrow((540, y - 4), (566, y - 4), hue="g", thick=1.6)
    c.text(572, y, "n, from A to B", size=12)
    c.text(672, y, "pB − pA = s n", size=12)
    c.text(10, y + 20, first, size=12, kind="tu")


def convex(_root):
    c = Canvas(840, 3 * HIGH + 52, "The nine convex pairs with a closed form, apart and overlapping",
               "One cell per pair, in section. Each shows two bodies apart and overlapping, with the signed distance s, the witness points, "
               "the contact point CP between them, and the normal n from A to B. F is 1 if s is at most 0; T is the size of s.")
    for i, (name, apart, overlap) in enumerate(CONVEX):
        pair(c, 4 + (i % 3) * WIDE, 4 + (i // 3) * HIGH, name, (apart, overlap))
    key(c, 3 * HIGH + 22, "Sections through the witness points. A flat triangle appears as a line. s > 0 is the distance, s ≤ 0 minus the depth.")
    return c


def cylinder(_root):
    c = Canvas(840, 2 * HIGH + 52, "The three cylinder pairs, apart and overlapping",
               "One column per pair. The upper row is a section along the axes of the cylinders, the lower row a section across. Each cell shows the "
               "signed distance s, the witness points, CP between them, and the normal n from A to B.")
    for i, (name, note, apart, overlap) in enumerate(CYLINDER):
        pair(c, 4 + (i % 3) * WIDE, 4 + (i // 3) * HIGH, name, (apart, overlap), note)
    key(c, 2 * HIGH + 22,
        "Sections along and across the cylinder's axis (dashed). A triangle appears as a line. s > 0 is the distance, s ≤ 0 minus the depth.")
    return c


def ray_case(view, body, ray, words, axis=None):
    o, d, tmin, tmax, end = ray
    view.body(body, "fa", axis)
    t = ray_hit(o, d, body, tmin, tmax)
    far = add(o, d, min(end, tmax))
    view.c.line([view.at(o), view.at(far)], "lu", 1.2, "4 3", solid=False)
    stop = add(o, d, t if t is not None else min(end, tmax))
    view.c.line([view.at(add(o, d, tmin)), view.at(stop)], "lb", 2.2, solid=False)
    view.c.dot(*view.at(o), "mb", 3.5)
    view.c.arrow(view.at(o), view.at(add(o, d)), hue="b", thick=2.2)
    if tmin:
        x, y = view.at(add(o, d, tmin))
        view.c.line([(x, y - 7), (x, y + 7)], "lb", 2, solid=False)
    if t is not None:
        view.c.dot(*view.at(stop), "mr")
        view.c.circle(*view.at(stop), 5.5, "lr", 1.3)
    view.caption(words, f"F = 1, T = {t:.2f}" if t is not None else "F = 0, T = +∞")


def rays(_root):
    c = Canvas(840, HIGH + 74, "The three ray pairs",
               "Rays against a triangle, a sphere and a cylinder, in section. T is the smallest parameter in the interval from tmin to tmax at "
               "which the ray meets the surface. A ray that starts inside a sphere or cylinder reports where it leaves.")
    inf = float("inf")
    cylinder_body, tilted = box((0.3, 0.0), (0.8, 1.1), -20), box((0.2, -0.1), (0.9, 1.1), -20)
    cells = (
        ("ray-triangle", ((segment((0.3, -1.2), (0.9, 1.3)), ((-2.0, -0.5), (1.0, 0.25), 0.0, inf, 4.2), "either face counts", None),
                          (segment((0.3, 0.1), (0.9, 1.4)), ((-2.0, -0.4), (1.0, -0.05), 0.0, inf, 4.2), "a miss", None))),
        ("ray-sphere", ((sphere((0.5, 0.0), 1.1), ((-2.1, -0.7), (0.8, 0.25), 0.0, inf, 5.2), "it enters", None),
                        (sphere((0.0, 0.0), 1.3), ((-0.5, -0.3), (0.7, 0.25), 0.0, inf, 3.6), "inside: it leaves", None))),
        ("ray-cylinder", ((cylinder_body, ((-1.9, 1.0), (0.8, -0.35), 0.0, inf, 5.0), "it enters", axis_of(cylinder_body)),
                          (tilted, ((-2.1, 0.5), (0.8, -0.2), 2.2, inf, 5.4), "entry below tmin", axis_of(tilted)))),
    )
    for i, (name, cases) in enumerate(cells):
        x, y = 4 + i * WIDE, 4
        c.rect(x, y, WIDE - 6, HIGH - 6, "lh", 6, solid=False)
        c.text(x + 10, y + 18, "*" + name)
        for k, (body, ray, words, axis) in enumerate(cases):
            ray_case(Section(c, x + WIDE * (0.25 + 0.5 * k) - 3, y + 80), body, ray, words, axis)
    y = HIGH + 22
    c.dot(14, y - 4, "mb", 3.5)
    c.arrow((14, y - 4), (44, y - 4), hue="b", thick=2.2)
    c.text(52, y, "o and d; the bar is tmin", size=12)
    c.dot(250, y - 4, "mr")
    c.circle(250, y - 4, 5.5, "lr", 1.3)
    c.text(264, y, "CP = o + T d; T counts in units of |d|", size=12)
    c.rect(520, y - 11, 14, 14, "fa", 2)
    c.text(540, y, "the target in section, a surface for rays", size=12)
    c.text(10, y + 22,
        "A hit has tmin ≤ T ≤ tmax. Two intersections in the interval: T is the smaller one. A miss has T = +∞ and CP = 0. Rays have no normal.",
           size=12, kind="tu")
    c.text(10, y + 40, "A triangle appears as a line.", size=12, kind="tu")
    return c
