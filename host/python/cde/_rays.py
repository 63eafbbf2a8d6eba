# SPDX-License-Identifier: Apache-2.0
"""Rays against triangles, with the conventions of Open3D's RaycastingScene."""
import numpy as np

from . import _native
from ._arrays import memory_for, rows
from ._error import Error

ALGORITHMS = tuple(_native.algorithm_names())


class RaycastingScene:
    """Triangles that rays are cast at, by a BVH in software whose results have the bits of the card.

    The methods, arrays and ids are those of open3d.t.geometry.RaycastingScene, with NumPy arrays in place of tensors. A ray is a row of six
    float32: origin, direction. Its direction may have any length, in whose units t counts. Triangles are hit from both sides. Ties of t go to
    the triangle that was added first. Several threads may cast at a time.
    """

    INVALID_ID = 0xFFFFFFFF  #: geometry and triangle of a ray without a hit

    def __init__(self, algorithm="watertight", nthreads=0):
        """Makes an empty scene.

        Args:
            algorithm: a name in `ALGORITHMS`. No ray leaks through an edge or vertex with "watertight".
            nthreads: threads of a cast; 0: one per processor. Results do not depend on it.
        """
        if algorithm not in ALGORITHMS:
            raise Error(f"algorithm is {algorithm!r}; expected {', '.join(ALGORITHMS)}")
        self._algorithm = algorithm
        self._triangles = _native.Triangles(algorithm)
        self._first = []  # first triangle of each geometry
        self._nthreads = _threads(nthreads)

    def __repr__(self):
        return f"<cde.RaycastingScene: {self._triangles.size} triangles in {len(self._first)} geometries, {self._algorithm}>"

    def add_triangles(self, vertex_positions, triangle_indices):
        """Adds a mesh. Returns its geometry id, counted from 0.

        Args:
            vertex_positions: float32 (V, 3), finite.
            triangle_indices: uint32 (F, 3), each below V.
        """
        vertices, _ = rows(vertex_positions, "vertex_positions", 3)
        triangles, _ = rows(triangle_indices, "triangle_indices", 3, np.uint32)
        if not len(triangles):
            raise Error("triangle_indices is empty; expected at least one triangle", "bad input")
        if int(triangles.max()) >= len(vertices):
            row = int(np.argmax(triangles.max(axis=1)))
            raise Error(f"triangle_indices[{row}] names vertex {int(triangles[row].max())}, but there are {len(vertices)}", "bad input")
        if not np.isfinite(vertices).all():
            row = int(np.argmin(np.isfinite(vertices).all(axis=1)))
            raise Error(f"vertex_positions[{row}] is not finite", "bad input")
        self._triangles.add(vertices, triangles)
        self._first.append(self._triangles.size - len(triangles))
        return len(self._first) - 1

    def cast_rays(self, rays, nthreads=0, *, bad="report"):
        """The first hit of each ray.

        Args:
            rays: float32 (..., 6).
            nthreads: as in the constructor; 0: the constructor's.
            bad: "report": `bad` is True for a ray with a NaN, an infinite origin or a zero direction, and it hits nothing. "raise": an
                `Error` names the first such ray.

        Returns:
            A dict of arrays with the leading shape of `rays`:
                t_hit: float32, inf without a hit.
                geometry_ids, primitive_ids: uint32, INVALID_ID without a hit. A primitive is a triangle of its geometry.
                primitive_uvs: float32 (..., 2), weights of the triangle's second and third corner.
                primitive_normals: float32 (..., 3), unit, right-handed around the corners.
                bad: bool.
        """
        array, shape = self._rays(rays)
        out = self._trace(array, 0.0, np.inf, False, nthreads, bad)
        result = {"t_hit": np.where(out["bad"], np.float32(np.inf), out["t"]), **self._ids(out["triangles"]), "primitive_uvs": out["uvs"],
                  "primitive_normals": out["normals"], "bad": out["bad"]}
        return {name: value.reshape(shape + value.shape[1:]) for name, value in result.items()}

    def test_occlusions(self, rays, tnear=0.0, tfar=np.inf, nthreads=0, *, bad="report"):
        """Whether each ray hits anything with tnear <= t <= tfar, as bool with the leading shape of `rays` (float32 (..., 6))."""
        array, shape = self._rays(rays)
        return self._trace(array, tnear, tfar, True, nthreads, bad)["hit"].reshape(shape)

    def count_intersections(self, rays):
        """The number of triangles that each ray hits, as int32 with the leading shape of `rays` (float32 (..., 6))."""
        array, shape = self._rays(rays)
        counts = np.zeros(len(array), np.uint32)
        if len(array) and self._triangles.size:
            self._triangles.find_hits(array, 0.0, np.inf, counts)
        return counts.astype(np.int32).reshape(shape)

    def list_intersections(self, rays):
        """All hits of each ray, by ascending t.

        Args:
            rays: float32 (..., 6), N in all.

        Returns:
            A dict of arrays, one row per hit, ray by ray:
                ray_splits: int64 (N + 1,). The hits of ray i are rows ray_splits[i] to ray_splits[i + 1].
                ray_ids: int64, t_hit: float32, geometry_ids, primitive_ids: uint32.
                primitive_uvs: float32 (M, 2), primitive_normals: float32 (M, 3), as for cast_rays().
        """
        array, _ = self._rays(rays)
        counts = np.zeros(len(array), np.uint32)
        hits = self._triangles.find_hits(array, 0.0, np.inf, counts) if len(array) and self._triangles.size else ()
        out = _columns(len(hits))
        ids = np.empty(len(hits), np.uint32)
        if len(hits):
            self._triangles.put_hits(hits, array, ids, out["t"], out["triangles"], out["uvs"], out["normals"])
        return {"ray_splits": np.concatenate([[0], np.cumsum(counts, dtype=np.int64)]), "ray_ids": ids.astype(np.int64), "t_hit": out["t"],
                **self._ids(out["triangles"]), "primitive_uvs": out["uvs"], "primitive_normals": out["normals"]}

    def inside(self, points):
        """Whether each point is inside the closed surface of all triangles, as bool with the leading shape of `points` (float32 (..., 3)).

        The winding number decides, in float64. A call takes time in proportion to points times triangles. On the surface either answer is
        possible, and a point that is not finite is outside.

        Raises:
            Error: the triangles are not closed; it names a triangle and its edge.
        """
        array, shape = rows(points, "points", 3)
        inside = np.zeros(len(array), bool)
        if len(array) and self._triangles.size:
            self._triangles.contains(array, inside)
        return inside.reshape(shape)

    def _rays(self, value):
        array, shape = rows(value, "rays", 6, what="per ray its origin (3) and direction (3)")
        if len(array) >= 2**32:
            raise Error(f"rays has {len(array)} rays; expected fewer than 2^32", "capacity")
        return array, shape

    def _trace(self, array, tnear, tfar, occluded, nthreads, bad):
        if bad not in ("report", "raise"):
            raise Error(f"bad is {bad!r}; expected 'report' or 'raise'")
        count = len(array)
        tnear, tfar = float(tnear), float(tfar)
        if np.isnan(tnear) or np.isnan(tfar):
            raise Error(f"tnear is {tnear} and tfar is {tfar}; expected numbers or infinities")
        memory_for(count, 90, "rays")
        out = {"hit": np.zeros(count, bool), "bad": np.zeros(count, bool), **_columns(0 if occluded else count)}
        if count:
            self._triangles.trace(array, tnear, tfar, occluded, _threads(nthreads) or self._nthreads, *out.values())
        if bad == "raise" and out["bad"].any():
            row = int(np.argmax(out["bad"]))
            why = _native.defect("ray", np.concatenate([array[row], np.float32([tnear, tfar])]))
            raise Error(f"rays[{row}]: {why}", "bad input")
        return out

    def _ids(self, triangles):
        """Numbers of geometries, and of triangles in them."""
        hit = triangles != self.INVALID_ID
        first = np.array(self._first, np.uint32)
        geometries = np.full(triangles.shape, self.INVALID_ID, np.uint32)
        of_hits = np.searchsorted(first, triangles[hit], side="right") - 1
        geometries[hit] = of_hits
        primitives = triangles.copy()
        primitives[hit] -= first[of_hits]
        return {"geometry_ids": geometries, "primitive_ids": primitives}


def _columns(count):
    return {"t": np.full(count, np.inf, np.float32), "triangles": np.full(count, RaycastingScene.INVALID_ID, np.uint32),
            "uvs": np.zeros((count, 2), np.float32), "normals": np.zeros((count, 3), np.float32)}


def _threads(count):
    if not isinstance(count, (int, np.integer)) or not 0 <= count <= 1024:
        raise Error(f"nthreads is {count!r}; expected 0 to 1024")
    return int(count)
