# SPDX-License-Identifier: Apache-2.0
"""Meshes of tests."""
import numpy as np


def icosphere(divisions=2):
    """Vertices float32 (V, 3) on the unit sphere, and triangles uint32 (F, 3), right-handed from outside."""
    g = (1 + 5**0.5) / 2
    vertices = [(-1, g, 0), (1, g, 0), (-1, -g, 0), (1, -g, 0), (0, -1, g), (0, 1, g), (0, -1, -g), (0, 1, -g), (g, 0, -1), (g, 0, 1), (-g, 0, -1),
                (-g, 0, 1)]
    faces = [(0, 11, 5), (0, 5, 1), (0, 1, 7), (0, 7, 10), (0, 10, 11), (1, 5, 9), (5, 11, 4), (11, 10, 2), (10, 7, 6), (7, 1, 8), (3, 9, 4), (3, 4, 2),
             (3, 2, 6), (3, 6, 8), (3, 8, 9), (4, 9, 5), (2, 4, 11), (6, 2, 10), (8, 6, 7), (9, 8, 1)]
    vertices = [np.array(v) / np.linalg.norm(v) for v in vertices]
    for _ in range(divisions):
        middle, finer = {}, []

        def between(a, b):
            key = min(a, b), max(a, b)
            if key not in middle:
                at = vertices[a] + vertices[b]
                vertices.append(at / np.linalg.norm(at))
                middle[key] = len(vertices) - 1
            return middle[key]

        for a, b, c in faces:
            ab, bc, ca = between(a, b), between(b, c), between(c, a)
            finer += [(a, ab, ca), (b, bc, ab), (c, ca, bc), (ab, bc, ca)]
        faces = finer
    return np.array(vertices, np.float32), np.array(faces, np.uint32)
