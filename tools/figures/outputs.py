# SPDX-License-Identifier: Apache-2.0
"""makes the pictures that commands write: waves.svg by cde query --trace and cde wave export, render.png by cde render, terrain.png as tools/demo does; needs
the build folder's cde and cde-wave"""
import pathlib
import subprocess
import sys
import tempfile

import png

NAMES = {"waves"}
PAIRS = """0 0 0 1 | 1.5 0 0 1
0 0 0 1 | 3 0 0 1
0 0 0 1 | 0 2 0 1
0 0 0 2 | 0 0 1 1
1 1 1 1 | 1 1 4 0.5
0 0 0 1 | 5 0 0 2
"""
TERRAIN = "terrain:128,160,1 --camera 120,-60,560,760,1000,60,44 --size 516x344 --shadows"  # of tools/demo, smaller
SIGNALS = ("clk_i", "valid_i", "ready_o", "tag_i:dec", "valid_o", "tag_o:dec", "f_o[0]", "t_o[0]:fp32", "t_o[1]:fp32")


def run(build, folder, *words):
    done = subprocess.run([str(build / "cde"), *words], cwd=folder, stdout=subprocess.DEVNULL, check=False)
    if done.returncode:
        raise OSError(f"cde {' '.join(words)} ended with status {done.returncode}")


def write(root, build, folder):
    with tempfile.TemporaryDirectory() as name:
        place = pathlib.Path(name)
        (place / "pairs.txt").write_text(PAIRS, encoding="utf-8")
        run(build, place, "query", "sphere-sphere", "pairs.txt", "--lanes", "2", "--trace", "pairs.fst", "-q")
        run(build, place, "wave", "export", "pairs.fst", *SIGNALS, "-o", "waves.svg", "--columns", "110")
        run(build, place, "render", *TERRAIN.split(), "--shaded", "terrain.png", "-q")
        run(build, place, "render", str(root / "meshes" / "torus.stl"), "--size", "480x320", "--shaded", "render.png", "-q")
        (folder / "waves.svg").write_bytes((place / "waves.svg").read_bytes())
        for picture in ("terrain.png", "render.png"):
            data = png.smaller((place / picture).read_bytes())
            (folder / picture).write_bytes(data)
            print(f"docs/images/{picture}: {len(data)} bytes", file=sys.stderr)
    return 0
