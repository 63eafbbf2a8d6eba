# SPDX-License-Identifier: Apache-2.0
"""The program of docs/guides/python.md draws its picture, and the examples print what the page says. Needs Matplotlib for the picture."""
import ast
import os
import pathlib
import re
import tempfile
import unittest

import numpy as np

import cde

PAGE = (pathlib.Path(__file__).resolve().parents[2] / "docs" / "guides" / "python.md").read_text()


class Guide(unittest.TestCase):
    def test_picture(self):
        try:
            import matplotlib
        except ImportError:
            self.skipTest("Matplotlib is not installed")
        matplotlib.use("Agg")
        program = re.search(r"```python\n(.*?)```", PAGE, re.S).group(1)
        before = os.getcwd()
        with tempfile.TemporaryDirectory() as folder:
            os.chdir(folder)
            try:
                names = {}
                exec(compile(program, "python.md", "exec"), names)
                picture = matplotlib.image.imread("wave.png")
            finally:
                os.chdir(before)
        self.assertEqual(picture.shape[:2], (1000, 1000))
        self.assertEqual(names["rays"].shape, (1000, 1000, 6))
        self.assertIn(f"{len(names['triangles']):,} triangles", PAGE)
        hit = np.isfinite(names["hits"]["t_hit"]).mean()
        self.assertGreater(hit, 0.4)
        self.assertLess(hit, 0.95)
        if keep := os.environ.get("CDE_KEEP_PICTURE"):
            matplotlib.image.imsave(keep, picture[::2, ::2])

    def test_examples(self):
        examples = re.findall(r"^    >>> (.*)\n    (.*)$", PAGE, re.M)
        self.assertTrue(examples)
        for code, printed in examples:
            self.assertEqual(repr(eval(compile(ast.parse(code, mode="eval"), "python.md", "eval"), {"cde": cde})), printed)

    def test_lists(self):
        self.assertIn(f"lists the {len(cde.PAIRS)} pairs", PAGE)
        methods = re.findall(r"`(\w+)\((?:\w+)[^`]*\)`", PAGE)
        self.assertGreater(len(methods), 5)
        for method in methods:
            self.assertTrue(hasattr(cde.RaycastingScene, method) or hasattr(cde, method), method)


if __name__ == "__main__":
    unittest.main()
