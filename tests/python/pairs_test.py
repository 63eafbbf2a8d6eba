# SPDX-License-Identifier: Apache-2.0
"""cde.distance: answers, shapes of arrays, bad input."""
import pickle
import threading
import unittest

import numpy as np

import cde

IDENTITY = [1, 0, 0, 0, 1, 0, 0, 0, 1]


def spheres(rng, count, spread=3.0):
    return np.concatenate([rng.uniform(-spread, spread, (count, 3)), rng.uniform(0.1, 1, (count, 1))], axis=1).astype(np.float32)


class Answers(unittest.TestCase):
    def test_spheres(self):
        rng = np.random.default_rng(1)
        a, b = spheres(rng, 10_000), spheres(rng, 10_000)
        got = cde.distance("sphere-sphere", a, b)
        between = b[:, :3].astype(float) - a[:, :3]
        gap = np.linalg.norm(between, axis=1) - a[:, 3] - b[:, 3]
        np.testing.assert_allclose(got["distance"], gap, atol=2e-6)
        np.testing.assert_array_equal(got["contact"], got["distance"] <= 0)
        np.testing.assert_allclose(got["normals"], between / np.linalg.norm(between, axis=1, keepdims=True), atol=1e-5)
        middle = a[:, :3] + got["normals"] * (a[:, 3] + gap / 2)[:, None]
        np.testing.assert_allclose(got["points"], middle, atol=1e-5)
        self.assertFalse(got["bad"].any())
        self.assertEqual({k: (v.dtype.name, v.shape) for k, v in got.items()},
                         {"distance": ("float32", (10_000,)), "contact": ("bool", (10_000,)), "points": ("float32", (10_000, 3)),
                          "normals": ("float32", (10_000, 3)), "bad": ("bool", (10_000,))})

    def test_exchanged_shapes_turn_the_normal(self):
        box, sphere = [[0, 0, 0, 1, 1, 1, *IDENTITY]], [[3, 0, 0, 1]]
        there, back = cde.distance("sphere-obb", sphere, box), cde.distance("obb-sphere", box, sphere)
        for name in ("distance", "contact", "points"):
            np.testing.assert_array_equal(there[name], back[name])
        np.testing.assert_array_equal(there["normals"], -back["normals"])
        np.testing.assert_array_equal(back["normals"], [[1, 0, 0]])
        np.testing.assert_array_equal(back["distance"], [1])

    def test_depth_is_negative(self):
        self.assertEqual(cde.distance("sphere-sphere", [[0, 0, 0, 1]], [[1.5, 0, 0, 1]])["distance"], -0.5)

    def test_rays(self):
        got = cde.distance("ray-triangle", [[0, 0, 1, 0, 0, -2, 0, np.inf], [5, 0, 1, 0, 0, -2, 0, np.inf]], [[-1, -1, 0, 1, -1, 0, 0, 1, 0]])
        np.testing.assert_array_equal(got["distance"], [0.5, np.inf])
        np.testing.assert_array_equal(got["contact"], [True, False])
        np.testing.assert_array_equal(got["points"], np.zeros((2, 3)))

    def test_half_space(self):
        sphere, plane = [[0, 0, -5, 1]], [[0, 0, 1, 0]]
        self.assertEqual(cde.distance("sphere-plane", sphere, plane)["distance"], 4)
        self.assertEqual(cde.distance("sphere-plane", sphere, plane, half_space=True)["distance"], -6)
        with self.assertRaisesRegex(cde.Error, "half_space is for pairs with a plane, not sphere-sphere"):
            cde.distance("sphere-sphere", sphere, sphere, half_space=True)

    def test_every_pair_answers(self):
        rows = {"ray": [0, 0, 9, 0, 0, -1, 0, np.inf], "triangle": [-1, -1, 0, 1, -1, 0, 0, 1, 0], "sphere": [0, 0, 0, 1],
                "aabb": [-1, -1, -1, 1, 1, 1], "plane": [0, 0, 1, 0], "cylinder": [0, 0, 0, 0, 0, 1, 1, 1],
                "obb": [0, 0, 0, 1, 1, 1, *IDENTITY]}
        self.assertEqual(set(rows), set(cde.SHAPES))
        self.assertEqual(len(cde.PAIRS), 15)
        for pair in cde.PAIRS:
            a, b = pair.split("-")
            got = cde.distance(pair, [rows[a]], [rows[b]])
            self.assertTrue(got["contact"][0], pair)


class Arrays(unittest.TestCase):
    def setUp(self):
        self.rng = np.random.default_rng(2)
        self.a, self.b = spheres(self.rng, 50), spheres(self.rng, 50)
        self.want = cde.distance("sphere-sphere", self.a, self.b)

    def same(self, got, rows=slice(None)):
        for name, value in self.want.items():
            np.testing.assert_array_equal(got[name], value[rows], name)

    def test_layouts(self):
        wide = np.zeros((50, 7), np.float32)
        wide[:, 2:6] = self.a
        readonly = self.a.copy()
        readonly.flags.writeable = False
        for layout in (np.asfortranarray(self.a), wide[:, 2:6], readonly, self.a[::-1][::-1], self.a.tolist(), self.a.reshape(5, 10, 4)):
            self.same(cde.distance("sphere-sphere", layout, self.b))
        self.same(cde.distance("sphere-sphere", self.a[::3], self.b[::3]), slice(None, None, 3))

    def test_one_row_pairs_with_all(self):
        one = cde.distance("sphere-sphere", self.a[0], self.b)
        all_rows = cde.distance("sphere-sphere", np.repeat(self.a[:1], 50, axis=0), self.b)
        np.testing.assert_array_equal(one["distance"], all_rows["distance"])
        self.assertEqual(len(cde.distance("sphere-sphere", self.b, self.a[0])["distance"]), 50)

    def test_no_rows(self):
        none = np.empty((0, 4), np.float32)
        for a, b in ((none, none), (none, self.b[:1])):
            self.assertEqual([len(v) for v in cde.distance("sphere-sphere", a, b).values()], [0] * 5)

    def test_wrong_arrays_are_named(self):
        for a, said in ((self.a.astype(np.float64), r"a is float64; expected an array of float32 with shape \(\.\.\., 4\): per sphere its centre \(3\), radius"),
                        (self.a.astype(">f4"), "a is >f4; expected an array of float32"),
                        (self.a[:, :3], r"a has shape \(50, 3\); expected an array of float32 with shape \(\.\.\., 4\)"),
                        (np.float32(1), r"shape \(\)"), ("text", "which is no array"), (None, "no array|shape"), ([[1, 2], [3]], "no array")):
            with self.assertRaisesRegex(cde.Error, said) as raised:
                cde.distance("sphere-sphere", a, self.b)
            self.assertEqual(raised.exception.code, "usage")
        with self.assertRaisesRegex(cde.Error, "a has 50 rows and b has 49; expected as many, or one row"):
            cde.distance("sphere-sphere", self.a, self.b[1:])
        with self.assertRaisesRegex(cde.Error, "bad is 'ignore'; expected 'report' or 'raise'"):
            cde.distance("sphere-sphere", self.a, self.b, bad="ignore")
        for name in ("sphere-cube", "sphere-triangle-x", ""):
            with self.assertRaises(cde.Error):
                cde.distance(name, self.a, self.b)

    def test_more_pairs_than_memory_are_refused_at_once(self):
        many = np.broadcast_to(self.a[0], (2**40, 4))
        with self.assertRaisesRegex(cde.Error, f"{2**40} pairs take 34816.0 GiB for results, more than there is; ask in parts") as raised:
            cde.distance("sphere-sphere", many, self.b[0])
        self.assertEqual(raised.exception.code, "capacity")

    def test_identical_and_touching_shapes(self):
        got = cde.distance("sphere-sphere", self.a, self.a)
        np.testing.assert_array_equal(got["distance"], -2 * self.a[:, 3])
        np.testing.assert_allclose(np.linalg.norm(got["normals"], axis=1), 1)
        touching = cde.distance("sphere-sphere", [[0, 0, 0, 1]], [[2, 0, 0, 1]])
        self.assertEqual((touching["distance"][0], touching["contact"][0]), (0, True))

    def test_errors_survive_other_processes(self):
        error = pickle.loads(pickle.dumps(cde.Error("what", "bad input")))
        self.assertEqual((type(error), str(error), error.code), (cde.Error, "what", "bad input"))

    def test_bad_shapes(self):
        self.b[7, 3] = -1
        self.b[9, 0] = np.nan
        got = cde.distance("sphere-sphere", self.a, self.b)
        self.assertEqual(np.flatnonzero(got["bad"]).tolist(), [7, 9])
        self.assertTrue(np.isnan(got["distance"][[7, 9]]).all())
        self.assertFalse(got["contact"][[7, 9]].any())
        with self.assertRaisesRegex(cde.Error, r"b\[7\]: radius is -1") as raised:
            cde.distance("sphere-sphere", self.a, self.b, bad="raise")
        self.assertEqual(raised.exception.code, "bad input")

    def test_threads(self):
        got = [None] * 4
        many = np.tile(self.a, (400, 1)), np.tile(self.b, (400, 1))

        def ask(k):
            got[k] = cde.distance("sphere-sphere", *many)["distance"]

        threads = [threading.Thread(target=ask, args=(k,)) for k in range(4)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        for k in range(4):
            np.testing.assert_array_equal(got[k][:50], self.want["distance"])
            np.testing.assert_array_equal(got[k], got[0])


if __name__ == "__main__":
    unittest.main()
