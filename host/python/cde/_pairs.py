# SPDX-License-Identifier: Apache-2.0
"""Queries between pairs of shapes."""
import numpy as np

from . import _native
from ._arrays import memory_for, rows
from ._error import Error

#: Names of the pairs, primary shape first.
PAIRS = tuple(_native.pair_names())

#: Columns of each shape in an array.
SHAPES = {
    "ray": "origin (3), direction (3), tmin, tmax",
    "triangle": "three corners (9)",
    "sphere": "centre (3), radius",
    "aabb": "lower corner (3), upper corner (3)",
    "plane": "unit normal n (3), d of n.x = d",
    "cylinder": "centre (3), unit axis (3), half height, radius",
    "obb": "centre (3), half extents (3), rotation row by row (9)",
}


def distance(pair, a, b, *, half_space=False, bad="report"):
    """Signed distance, contact point and normal of pairs of shapes.

    Computed in binary32 by the software reference, whose bits are the card's.

    Args:
        pair: a name in `PAIRS`, or with its shapes exchanged: "sphere-obb", "obb-sphere".
        a, b: arrays of float32, one row per shape, with the columns of `SHAPES`. One row pairs with all rows of the other array. Lengths
            are in any one unit, in one right-handed frame.
        half_space: a plane bounds the solid half-space n.x <= d, instead of a surface with two sides.
        bad: what to do about a shape that breaks its contract, as with a NaN or a negative radius. "report": its row has bad = True, NaN
            everywhere else and contact = False. "raise": an `Error` that names the first such row.

    Returns:
        A dict of arrays, one row per pair:
            distance: float32 (N,), signed distance: positive apart, negative when penetrating (minus the penetration depth). For a ray: t
                of its first hit in units of the direction's length; inf without a hit.
            contact: bool (N,), whether the shapes meet.
            points: float32 (N, 3), the contact point, in the middle of the gap or overlap; for a ray the hit, 0 without one.
            normals: float32 (N, 3), unit, from a to b; 0 for a ray.
            bad: bool (N,), whether a shape breaks its contract.

    Raises:
        Error: an unknown pair, an array of another shape or dtype, or (bad="raise") a bad shape.
    """
    if bad not in ("report", "raise"):
        raise Error(f"bad is {bad!r}; expected 'report' or 'raise'")
    name, shapes, words, exchanged = _native.parse_pair(str(pair))
    if half_space and shapes[1] != "plane":
        raise Error(f"half_space is for pairs with a plane, not {name}")
    order = (1, 0) if exchanged else (0, 1)
    arrays = []
    for what, value, which in (("a", a, order[0]), ("b", b, order[1])):
        arrays.append(rows(value, what, words[which], what=f"per {shapes[which]} its {SHAPES[shapes[which]]}")[0])
    count = _count(*(len(array) for array in arrays))
    memory_for(count, 34, "pairs")
    out = {"distance": np.empty(count, np.float32), "contact": np.empty(count, bool), "points": np.empty((count, 3), np.float32),
           "normals": np.empty((count, 3), np.float32), "bad": np.empty(count, bool)}
    first, second = (arrays[1], arrays[0]) if exchanged else arrays
    if count:
        _native.test_pairs(name, first, second, exchanged, bool(half_space), *out.values())
    if bad == "raise" and out["bad"].any():
        row = int(np.argmax(out["bad"]))
        for what, array, which in zip("ab", arrays, order):
            at = row if len(array) > 1 else 0
            if why := _native.defect(shapes[which], np.ascontiguousarray(array[at])):
                raise Error(f"{what}[{at}]: {why}", "bad input")
        raise Error(f"pair {row} is out of contract", "bad input")
    return out


def _count(a, b):
    if a == b or b == 1:
        return a
    if a == 1:
        return b
    raise Error(f"a has {a} rows and b has {b}; expected as many, or one row")
