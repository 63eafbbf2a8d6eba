# SPDX-License-Identifier: Apache-2.0
"""cde.RaycastingScene: answers beside brute force in float64, conventions, bad input."""
import threading
import unittest

import numpy as np

import cde
from meshes import icosphere


def random_rays(rng, count):
    origins = rng.uniform(-2, 2, (count, 3))
    directions = rng.uniform(-1, 1, (count, 3)) - origins
    return np.concatenate([origins, directions], axis=1).astype(np.float32)


def brute_force(vertices, triangles, rays):
    """t (rays, triangles) in float64, inf without a hit."""
    a, b, c = (vertices[triangles[:, k]].astype(float) for k in range(3))
    o, d = rays[:, None, :3].astype(float), rays[:, None, 3:].astype(float)
    p = np.cross(d, (c - a)[None])
    det = np.einsum("rtk,tk->rt", p, b - a)
    s = o - a[None]
    q = np.cross(s, (b - a)[None])
    with np.errstate(divide="ignore", invalid="ignore"):
        u, v, t = np.einsum("rtk,rtk->rt", s, p) / det, np.einsum("rtk,rtk->rt", q, np.broadcast_to(d, q.shape)) / det, \
            np.einsum("rtk,tk->rt", q, c - a) / det
    return np.where((u >= 0) & (v >= 0) & (u + v <= 1) & (t >= 0), t, np.inf)


class Casting(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.vertices, cls.triangles = icosphere()
        cls.scene = cde.RaycastingScene()
        cls.scene.add_triangles(cls.vertices, cls.triangles)
        cls.rays = random_rays(np.random.default_rng(3), 3000)
        cls.t = brute_force(cls.vertices, cls.triangles, cls.rays)

    def test_first_hits(self):
        got = self.scene.cast_rays(self.rays)
        first = self.t.min(axis=1)
        np.testing.assert_array_equal(np.isfinite(got["t_hit"]), np.isfinite(first))
        hit = np.isfinite(first)
        self.assertGreater(hit.sum(), 2000)
        np.testing.assert_allclose(got["t_hit"][hit], first[hit], rtol=1e-4, atol=1e-6)
        np.testing.assert_array_equal(got["geometry_ids"], np.where(hit, 0, cde.RaycastingScene.INVALID_ID))
        np.testing.assert_array_equal(got["primitive_ids"][~hit], cde.RaycastingScene.INVALID_ID)
        at = self.rays[:, :3] + got["t_hit"][:, None] * self.rays[:, 3:]
        corners = self.vertices[self.triangles[got["primitive_ids"][hit]]]
        u, v = got["primitive_uvs"][hit].T[:, :, None]
        np.testing.assert_allclose((1 - u - v) * corners[:, 0] + u * corners[:, 1] + v * corners[:, 2], at[hit], atol=2e-5)
        normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        np.testing.assert_allclose(got["primitive_normals"][hit], normals / np.linalg.norm(normals, axis=1, keepdims=True), atol=1e-4)
        for name in ("primitive_uvs", "primitive_normals"):
            self.assertFalse(got[name][~hit].any())

    def test_all_hits(self):
        got = self.scene.list_intersections(self.rays)
        counts = np.isfinite(self.t).sum(axis=1)
        np.testing.assert_array_equal(np.diff(got["ray_splits"]), counts)
        np.testing.assert_array_equal(got["ray_ids"], np.repeat(np.arange(len(self.rays)), counts))
        np.testing.assert_array_equal(self.scene.count_intersections(self.rays), counts)
        self.assertTrue((np.diff(got["t_hit"])[np.diff(got["ray_ids"]) == 0] >= 0).all())
        np.testing.assert_allclose(got["t_hit"], np.sort(self.t, axis=1)[np.isfinite(np.sort(self.t, axis=1))], rtol=1e-4, atol=1e-6)

    def test_occlusion(self):
        np.testing.assert_array_equal(self.scene.test_occlusions(self.rays), np.isfinite(self.t).any(axis=1))
        first = self.scene.cast_rays(self.rays)["t_hit"]
        np.testing.assert_array_equal(self.scene.test_occlusions(self.rays, tnear=0.0, tfar=0.25), first <= 0.25)

    def test_inside(self):
        points = np.random.default_rng(4).uniform(-1, 1, (2000, 3)).astype(np.float32)
        radius = np.linalg.norm(points, axis=1)
        sure = (radius < 0.97) | (radius > 1)
        np.testing.assert_array_equal(self.scene.inside(points)[sure], (radius < 1)[sure])

    def test_inside_on_a_grid(self):
        # Rays from these points along any axis meet edges and corners of the cube.
        scene = cde.RaycastingScene()
        corners = np.array([[x, y, z] for x in (0, 4) for y in (0, 4) for z in (0, 4)], np.float32)
        quads = ([0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3])
        faces = [[q[0], q[k], q[k + 1]] for q in quads for k in (1, 2)]
        scene.add_triangles(corners, faces)
        grid = np.stack(np.meshgrid(*3 * [np.arange(-1, 6, dtype=np.float32)], indexing="ij"), axis=-1)
        surface = ((grid == 0) | (grid == 4)).any(axis=-1) & ((grid >= 0) & (grid <= 4)).all(axis=-1)
        np.testing.assert_array_equal(scene.inside(grid)[~surface], ((grid > 0) & (grid < 4)).all(axis=-1)[~surface])
        self.assertFalse(scene.inside([np.nan, 1, 1]).any())

    def test_inside_of_an_open_surface_is_refused(self):
        scene = cde.RaycastingScene()
        scene.add_triangles(self.vertices, self.triangles[1:])
        with self.assertRaisesRegex(cde.Error, "scene: is not closed: an edge of triangle") as raised:
            scene.inside([[0, 0, 0]])
        self.assertEqual(raised.exception.code, "bad input")

    def test_no_leak_at_vertices_and_edges(self):
        targets = np.concatenate([self.vertices, (self.vertices[self.triangles[:, 0]] + self.vertices[self.triangles[:, 1]]) / 2])
        rays = np.concatenate([np.zeros_like(targets), targets], axis=1)
        self.assertTrue(np.isfinite(self.scene.cast_rays(rays)["t_hit"]).all())

    def test_threads_do_not_change_results(self):
        one, many = self.scene.cast_rays(self.rays, nthreads=1), self.scene.cast_rays(self.rays, nthreads=7)
        for name, value in one.items():
            np.testing.assert_array_equal(many[name], value)

    def test_several_threads_may_cast(self):
        scene = cde.RaycastingScene()
        scene.add_triangles(self.vertices, self.triangles)
        got = [None] * 4

        def cast(k):
            got[k] = scene.cast_rays(self.rays)["t_hit"]

        threads = [threading.Thread(target=cast, args=(k,)) for k in range(4)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        for k in range(4):
            np.testing.assert_array_equal(got[k], self.scene.cast_rays(self.rays)["t_hit"])

    def test_layouts(self):
        want = self.scene.cast_rays(self.rays)["t_hit"]
        wide = np.zeros((3000, 9), np.float32)
        wide[:, 1:7] = self.rays
        for rays in (wide[:, 1:7], np.asfortranarray(self.rays), self.rays.tolist(), self.rays[::-1][::-1]):
            np.testing.assert_array_equal(self.scene.cast_rays(rays)["t_hit"], want)
        shaped = self.scene.cast_rays(self.rays.reshape(30, 100, 6))
        self.assertEqual(shaped["primitive_uvs"].shape, (30, 100, 2))
        np.testing.assert_array_equal(shaped["t_hit"].ravel(), want)
        self.assertEqual(self.scene.cast_rays(self.rays[0])["t_hit"].shape, ())
        none = self.scene.cast_rays(np.empty((0, 6), np.float32))
        self.assertEqual([len(v) for v in none.values()], [0] * 6)


class Scenes(unittest.TestCase):
    def test_geometries_are_told_apart(self):
        vertices, triangles = icosphere(0)
        scene = cde.RaycastingScene("moller")
        self.assertEqual([scene.add_triangles(vertices + np.float32([4 * k, 0, 0]), triangles) for k in range(3)], [0, 1, 2])
        rays = np.float32([[4 * k + 0.1, 0.2, 9, 0, 0, -1] for k in range(4)])
        got = scene.cast_rays(rays)
        self.assertEqual(got["geometry_ids"].tolist(), [0, 1, 2, scene.INVALID_ID])
        self.assertEqual(len(set(got["primitive_ids"][:3].tolist())), 1)
        self.assertEqual(repr(scene), "<cde.RaycastingScene: 60 triangles in 3 geometries, moller>")
        # Triangles that come later are seen.
        scene.add_triangles(vertices + np.float32([12, 0, 0]), triangles)
        self.assertEqual(scene.cast_rays(rays)["geometry_ids"].tolist(), [0, 1, 2, 3])

    def test_empty_scene(self):
        scene = cde.RaycastingScene()
        rays = np.float32([[0, 0, 0, 0, 0, 1]])
        self.assertEqual(scene.cast_rays(rays)["t_hit"], np.inf)
        self.assertFalse(scene.test_occlusions(rays).any())
        self.assertEqual(scene.count_intersections(rays).tolist(), [0])
        self.assertEqual(scene.list_intersections(rays)["ray_splits"].tolist(), [0, 0])
        self.assertFalse(scene.inside([[0, 0, 0]]).any())
        self.assertTrue(scene.cast_rays(np.float32([[np.nan, 0, 0, 0, 0, 1]]))["bad"])

    def test_bad_meshes(self):
        vertices, triangles = icosphere(0)
        scene = cde.RaycastingScene()
        broken = vertices.copy()
        broken[3, 1] = np.nan
        for arguments, said in (((vertices, triangles.astype(np.int64)), r"triangle_indices is int64; expected an array of uint32 with shape \(\.\.\., 3\)"),
                                ((vertices[:, :2], triangles), r"vertex_positions has shape \(12, 2\)"),
                                ((vertices, triangles + np.uint32(1)), r"triangle_indices\[\d+\] names vertex 12, but there are 12"),
                                ((vertices, triangles[:0]), "triangle_indices is empty"), ((broken, triangles), r"vertex_positions\[3\] is not finite")):
            with self.assertRaisesRegex(cde.Error, said):
                scene.add_triangles(*arguments)
        self.assertEqual(repr(scene), "<cde.RaycastingScene: 0 triangles in 0 geometries, watertight>")
        with self.assertRaisesRegex(cde.Error, "algorithm is 'fast'; expected moller, badouel, pluecker, watertight"):
            cde.RaycastingScene("fast")
        with self.assertRaisesRegex(cde.Error, "nthreads is -1; expected 0 to 1024"):
            cde.RaycastingScene(nthreads=-1)

    def test_bad_rays(self):
        scene = cde.RaycastingScene()
        scene.add_triangles(*icosphere(0))
        rays = np.float32([[0, 0, 9, 0, 0, -1], [0, 0, 9, 0, 0, 0], [np.nan, 0, 9, 0, 0, -1]])
        got = scene.cast_rays(rays)
        self.assertEqual(got["bad"].tolist(), [False, True, True])
        self.assertEqual(np.isfinite(got["t_hit"]).tolist(), [True, False, False])
        self.assertEqual(scene.test_occlusions(rays).tolist(), [True, False, False])
        for cast in (scene.cast_rays, scene.test_occlusions):
            with self.assertRaisesRegex(cde.Error, r"rays\[1\]: direction is zero"):
                cast(rays, bad="raise")
        with self.assertRaisesRegex(cde.Error, "tnear is nan and tfar is inf; expected numbers"):
            scene.test_occlusions(rays, tnear=np.nan)
        many = np.broadcast_to(rays[0], (2**31, 6))
        with self.assertRaisesRegex(cde.Error, f"{2**31} rays take 180.0 GiB for results, more than there is; ask in parts"):
            scene.cast_rays(many)
        with self.assertRaisesRegex(cde.Error, r"rays is float64; expected an array of float32 with shape \(\.\.\., 6\): per ray"):
            scene.cast_rays(rays.astype(np.float64))


if __name__ == "__main__":
    unittest.main()
