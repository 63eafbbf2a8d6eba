# SPDX-License-Identifier: Apache-2.0
"""Signed distances and witness points in the plane: convex polygons, rounded by a radius, and half-planes; rays."""
import math


def add(a, b, times=1.0):
    return a[0] + times * b[0], a[1] + times * b[1]


def dot(a, b):
    return a[0] * b[0] + a[1] * b[1]


def unit(a):
    length = math.hypot(*a)
    return a[0] / length, a[1] / length


class Body:
    """A convex polygon, a segment or a point, and all that is within a radius of it."""

    def __init__(self, points, radius=0.0):
        self.points, self.radius = points, radius

    def reach(self, n):
        """The support of the polygon: the largest n·x."""
        return max(dot(n, p) for p in self.points)

    def edges(self):
        many = len(self.points)
        return [(self.points[i], self.points[(i + 1) % many]) for i in range(many if many > 2 else many - 1)]

    def normals(self):
        """Both normals of every edge; those that point inwards are never the best."""
        sides = [unit((b[1] - a[1], a[0] - b[0])) for a, b in self.edges()]
        return sides + [(-n[0], -n[1]) for n in sides]


def box(center, half, degrees=0.0):
    a = math.radians(degrees)
    u, v = (math.cos(a), math.sin(a)), (-math.sin(a), math.cos(a))
    return Body([add(add(center, u, i * half[0]), v, j * half[1]) for i, j in ((-1, -1), (1, -1), (1, 1), (-1, 1))])


def sphere(center, radius):
    return Body([center], radius)


def segment(a, b):
    return Body([a, b])


def nearest_on(edge, p):
    a, b = edge
    d = add(b, a, -1)
    t = min(1.0, max(0.0, dot(add(p, a, -1), d) / dot(d, d)))
    return add(a, d, t)


def closest(a, b):
    """The nearest points of two polygons that are apart."""
    pairs = [(p, q) for p in a.points for q in b.points]
    pairs += [(p, nearest_on(edge, p)) for p in a.points for edge in b.edges()]
    pairs += [(nearest_on(edge, q), q) for q in b.points for edge in a.edges()]
    return min(pairs, key=lambda pq: math.dist(*pq))


def deepest(a, b):
    """The normal of the largest separation of two polygons that overlap, that separation, and a witness point on a."""
    def separation(n):
        return -b.reach((-n[0], -n[1])) - a.reach(n)
    own, other = a.normals(), [(-n[0], -n[1]) for n in b.normals()]
    n = max(own + other, key=separation)
    s = separation(n)
    on_a = [p for p in a.points if a.reach(n) - dot(n, p) < 1e-9]
    on_b = [q for q in b.points if dot(n, q) + b.reach((-n[0], -n[1])) < 1e-9]
    if len(on_b) == 1:
        return n, s, add(on_b[0], n, -s)  # b's corner, and where it is on a's face
    if len(on_a) == 1:
        return n, s, on_a[0]
    side = (-n[1], n[0])  # two faces: the middle of what they have in common
    low = max(min(dot(side, p) for p in on_a), min(dot(side, q) for q in on_b))
    high = min(max(dot(side, p) for p in on_a), max(dot(side, q) for q in on_b))
    return n, s, add((n[0] * a.reach(n), n[1] * a.reach(n)), side, (low + high) / 2)


def signed(a, b):
    """Signed distance s, normal n from a to b, witness points on a and on b: pB - pA = s n."""
    n, core, at = deepest(a, b) if any(edge for edge in a.edges() + b.edges()) else (None, 1.0, None)
    if core > 0:
        p, q = closest(a, b)
        core, at = math.dist(p, q), p
        n = unit(add(q, p, -1))
    s = core - a.radius - b.radius
    on_a = add(at, n, a.radius)
    return s, n, on_a, add(on_a, n, s)


def signed_half_plane(a, normal, d):
    """The same against the solid n·x <= d; n of the result points into it."""
    n = (-normal[0], -normal[1])
    low = min(dot(normal, p) for p in a.points)
    at = [p for p in a.points if dot(normal, p) - low < 1e-9]
    middle = (sum(p[0] for p in at) / len(at), sum(p[1] for p in at) / len(at))
    s = low - d - a.radius
    on_a = add(middle, n, a.radius)
    return s, n, on_a, add(on_a, n, s)


def stretch(o, d, body):
    """Parameters at which a ray's line enters and leaves a body: a disc, or a polygon of three corners and more."""
    if len(body.points) == 1:
        oc = add(o, body.points[0], -1)
        a, b, c = dot(d, d), dot(oc, d), dot(oc, oc) - body.radius ** 2
        root = b * b - a * c
        return None if root < 0 else ((-b - math.sqrt(root)) / a, (-b + math.sqrt(root)) / a)
    found = []
    for p, q in body.edges():
        e = add(q, p, -1)
        det = d[0] * e[1] - d[1] * e[0]
        if abs(det) > 1e-12:
            w = add(p, o, -1)
            t, u = (w[0] * e[1] - w[1] * e[0]) / det, (w[0] * d[1] - w[1] * d[0]) / det
            if 0 <= u <= 1:
                found.append(t)
    return (min(found), max(found)) if found else None


def ray_hit(o, d, body, tmin=0.0, tmax=math.inf):
    """T of a ray against a surface: where it enters if that is in the interval, else where it leaves; None: a miss."""
    ends = stretch(o, d, body)
    for t in ends or ():
        if tmin <= t <= tmax:
            return t
    return None
