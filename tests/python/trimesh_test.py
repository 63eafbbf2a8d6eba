# SPDX-License-Identifier: Apache-2.0
"""cde.trimesh.RayMeshIntersector beside trimesh's own engine. Needs trimesh."""
import copy
import pickle
import unittest

import numpy as np

import cde.trimesh

try:
    import trimesh
    from trimesh.ray.ray_triangle import RayMeshIntersector
except ImportError:
    trimesh = None


@unittest.skipIf(trimesh is None, "trimesh is not installed")
class Engine(unittest.TestCase):
    def setUp(self):
        self.mesh = trimesh.creation.icosphere(subdivisions=2)
        self.mesh.apply_translation([1000, -2000, 3000])
        self.ours = cde.trimesh.RayMeshIntersector(self.mesh)
        rng = np.random.default_rng(5)
        self.origins = self.mesh.centroid + rng.uniform(-2, 2, (500, 3))
        self.directions = self.mesh.centroid + rng.uniform(-1, 1, (500, 3)) - self.origins

    def test_hits_are_those_of_trimesh(self):
        theirs = self._theirs()
        want = {(ray, triangle): where for where, ray, triangle in zip(*theirs.intersects_location(self.origins, self.directions))}
        where, ray, triangle = self.ours.intersects_location(self.origins, self.directions)
        got = dict(zip(zip(ray.tolist(), triangle.tolist()), where))
        self.assertEqual(set(got), {(int(r), int(t)) for r, t in want})
        for key, at in want.items():
            np.testing.assert_allclose(got[key], at, atol=1e-9)
        np.testing.assert_array_equal(self.ours.intersects_any(self.origins, self.directions), theirs.intersects_any(self.origins, self.directions))
        np.testing.assert_array_equal(self.ours.intersects_first(self.origins, self.directions),
                                      theirs.intersects_first(self.origins, self.directions))

    def _theirs(self):
        try:
            theirs = RayMeshIntersector(self.mesh)
            theirs.intersects_any(self.origins[:1], self.directions[:1])
            return theirs
        except ImportError as missing:
            self.skipTest(f"trimesh's own engine needs more: {missing}")

    def test_first_hits_alone(self):
        triangle, ray, where = self.ours.intersects_id(self.origins, self.directions, multiple_hits=False, return_locations=True)
        first = self.ours.intersects_first(self.origins, self.directions)
        np.testing.assert_array_equal(triangle, first[first >= 0])
        np.testing.assert_array_equal(ray, np.flatnonzero(first >= 0))
        self.assertEqual(where.shape, (len(ray), 3))
        few = self.ours.intersects_id(self.origins, self.directions, max_hits=1)
        np.testing.assert_array_equal(few[0], triangle)

    def test_points(self):
        points = self.mesh.centroid + np.random.default_rng(6).uniform(-1, 1, (500, 3))
        radius = np.linalg.norm(points - self.mesh.centroid, axis=1)
        sure = (radius < 0.95) | (radius > 1)
        np.testing.assert_array_equal(self.ours.contains_points(points)[sure], (radius < 1)[sure])
        self.mesh.ray = self.ours
        np.testing.assert_array_equal(self.mesh.contains(points)[sure], (radius < 1)[sure])

    def test_a_changed_mesh_is_seen(self):
        self.assertTrue(self.ours.intersects_any([[1000, -2000, 3009]], [[0, 0, -1]])[0])
        self.mesh.apply_translation([5, 0, 0])
        self.assertFalse(self.ours.intersects_any([[1000, -2000, 3009]], [[0, 0, -1]])[0])

    def test_copies(self):
        for other in (copy.copy(self.ours), copy.deepcopy(self.ours), pickle.loads(pickle.dumps(self.ours))):
            np.testing.assert_array_equal(other.intersects_first(self.origins, self.directions),
                                          self.ours.intersects_first(self.origins, self.directions))
        self.assertEqual(repr(self.ours), "<cde.trimesh.RayMeshIntersector: 320 triangles, watertight>")

    def test_bad_arrays(self):
        with self.assertRaisesRegex(cde.Error, "ray_origins has 2 rows and ray_directions has 1; expected as many"):
            self.ours.intersects_any([[0, 0, 0], [0, 0, 0]], [[0, 0, 1]])
        self.assertFalse(self.ours.intersects_any([[0, 0, 0]], [[0, 0, 0]])[0])


if __name__ == "__main__":
    unittest.main()
