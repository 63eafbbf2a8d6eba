# SPDX-License-Identifier: Apache-2.0
"""Collision queries whose bits equal a simulated card's.

    import numpy as np, cde
    scene = cde.RaycastingScene()
    scene.add_triangles(vertices, triangles)       # float32 (V, 3), uint32 (F, 3)
    scene.cast_rays(rays)["t_hit"]                 # float32 (N, 6): origin, direction
    cde.distance("sphere-obb", spheres, boxes)     # signed distance, contact, points, normals
"""
from ._error import Error
from ._native import version as __version__
from ._pairs import PAIRS, SHAPES, distance
from ._rays import ALGORITHMS, RaycastingScene

__all__ = ["ALGORITHMS", "Error", "PAIRS", "RaycastingScene", "SHAPES", "distance"]
