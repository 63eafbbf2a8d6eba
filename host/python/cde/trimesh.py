# SPDX-License-Identifier: Apache-2.0
"""Ray queries of a trimesh.Trimesh, with the methods of trimesh.ray.

    mesh.ray = cde.trimesh.RayMeshIntersector(mesh)
"""
import numpy as np

from ._error import Error
from ._rays import RaycastingScene


class RayMeshIntersector:
    """The ray engine of a mesh: each method takes and returns what those of trimesh's own engines do.

    Arrays are float64, in the mesh's frame and unit. Rays are cast in float32, relative to the centre of the mesh's bounds. Locations are
    where the ray meets the plane of the triangle, in float64.
    """

    def __init__(self, geometry, algorithm="watertight"):
        """Args: a trimesh.Trimesh, which may change later, and the algorithm of `cde.RaycastingScene`."""
        self.mesh = geometry
        self._algorithm = algorithm
        self._made = (None, None, None)  # hash of the mesh, its scene and centre

    def __repr__(self):
        return f"<cde.trimesh.RayMeshIntersector: {len(self.mesh.faces)} triangles, {self._algorithm}>"

    def __copy__(self):
        return RayMeshIntersector(self.mesh, self._algorithm)

    def __deepcopy__(self, memo):
        return self.__copy__()

    def __getstate__(self):
        return {"mesh": self.mesh, "_algorithm": self._algorithm, "_made": (None, None, None)}

    def _scene(self):
        key = hash(self.mesh)
        if self._made[0] != key:
            vertices = np.asarray(self.mesh.vertices, np.float64)
            centre = (vertices.min(axis=0) + vertices.max(axis=0)) / 2 if len(vertices) else np.zeros(3)
            scene = RaycastingScene(self._algorithm)
            if len(self.mesh.faces):
                scene.add_triangles((vertices - centre).astype(np.float32), np.asarray(self.mesh.faces).astype(np.uint32))
            self._made = (key, scene, centre)
        return self._made[1], self._made[2]

    def _rays(self, origins, directions):
        """The scene, origins, unit directions, and rays of the scene."""
        origins = np.asarray(origins, np.float64).reshape(-1, 3)
        directions = np.asarray(directions, np.float64).reshape(-1, 3)
        if origins.shape != directions.shape:
            raise Error(f"ray_origins has {len(origins)} rows and ray_directions has {len(directions)}; expected as many")
        lengths = np.linalg.norm(directions, axis=1, keepdims=True)
        unit = np.divide(directions, lengths, out=np.zeros_like(directions), where=lengths > 0)
        scene, centre = self._scene()
        return scene, origins, unit, np.concatenate([origins - centre, unit], axis=1).astype(np.float32)

    def intersects_id(self, ray_origins, ray_directions, multiple_hits=True, max_hits=100, return_locations=False):
        """Triangle and ray of each hit, (m,) int each, and if asked their locations (m, 3); at most `max_hits` per ray."""
        scene, origins, unit, rays = self._rays(ray_origins, ray_directions)
        if multiple_hits:
            found = scene.list_intersections(rays)
            ray, triangle = found["ray_ids"], found["primitive_ids"].astype(np.int64)
            nth = np.arange(len(ray)) - found["ray_splits"][ray]
            ray, triangle = ray[nth < max_hits], triangle[nth < max_hits]
        else:
            first = scene.cast_rays(rays)["primitive_ids"]
            ray = np.flatnonzero(first != scene.INVALID_ID)
            triangle = first[ray].astype(np.int64)
        if not return_locations:
            return triangle, ray
        return triangle, ray, self._locations(origins[ray], unit[ray], triangle)

    def _locations(self, origins, directions, triangles):
        corners = np.asarray(self.mesh.vertices, np.float64)[np.asarray(self.mesh.faces)[triangles]].reshape(-1, 3, 3)
        normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        along = np.einsum("ij,ij->i", normals, directions)
        with np.errstate(divide="ignore", invalid="ignore"):
            t = np.einsum("ij,ij->i", normals, corners[:, 0] - origins) / along
        return origins + t[:, None] * directions

    def intersects_location(self, ray_origins, ray_directions, multiple_hits=True):
        """Location (m, 3), ray (m,) and triangle (m,) of each hit."""
        triangle, ray, where = self.intersects_id(ray_origins, ray_directions, multiple_hits, return_locations=True)
        return where, ray, triangle

    def intersects_first(self, ray_origins, ray_directions):
        """The first triangle that each ray hits, (n,) int; -1 without a hit."""
        scene, _, _, rays = self._rays(ray_origins, ray_directions)
        first = scene.cast_rays(rays)["primitive_ids"]
        return np.where(first == scene.INVALID_ID, -1, first.astype(np.int64))

    def intersects_any(self, ray_origins, ray_directions):
        """Whether each ray hits the mesh, (n,) bool."""
        scene, _, _, rays = self._rays(ray_origins, ray_directions)
        return scene.test_occlusions(rays)

    def contains_points(self, points):
        """Whether each point is inside the mesh, (n,) bool. The mesh must be closed."""
        scene, centre = self._scene()
        points = np.asarray(points, np.float64).reshape(-1, 3)
        return scene.inside((points - centre).astype(np.float32))
