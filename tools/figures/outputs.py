# SPDX-License-Identifier: Apache-2.0
"""makes the pictures that commands write: waves.svg, render.png, terrain.png; needs a build"""
NAMES = {"waves"}


def write(root, build, folder):
    raise NotImplementedError
