# SPDX-License-Identifier: Apache-2.0
"""Scenes, rays as text and arrays, bodies at a closed mesh."""
import math

from canvas import Canvas


def frame(_root):
    c = Canvas(820, 372, "One frame of a scene",
               "The scene runner computes poses, uploads what changed, loads primaries and starts one pass per query and packet. The card writes "
               "records. The scene runner compares each record with the reference and writes tables of records and run.json.")
    c.text(10, 24, "*Once per scene", size=13)
    c.box(10, 36, 150, 56, ["scene file", "*SCENE.toml"], "fa")
    c.arrow((160, 64), (196, 64))
    c.box(196, 36, 170, 56, ["*Planner", "card, transform site,", "BVH or brute force"], "fg", size=12)
    c.arrow((366, 64), (402, 64))
    c.box(402, 36, 180, 56, ["*Card", "simulation model, found", "or built"], "fb", size=12)
    c.text(10, 126, "*In each frame f, time f / rate", size=13)
    c.rect(10, 136, 800, 164, "fz", 6, solid=False)
    steps = (("*1  Pose", "objects in binary64,", "rounded once", "fg"), ("*2  Upload", "what changed, or", "12 words per object", "fg"),
             ("*3  Load", "up to 256 primaries", "per packet", "fg"), ("*4  Pass", "per query", "and packet", "fb"), ("*5  Compare", "each record with",
                 "the reference", "fg"))
    for i, (name, first, second, kind) in enumerate(steps):
        x = 22 + i * 158
        c.box(x, 152, 146, 62, [name, first, second], kind, size=12)
        if i:
            c.arrow((x - 12, 183), (x, 183), size=6)
    c.arrow((725, 214), (725, 262), (585, 262))
    c.box(352, 238, 233, 48, ["*Records of the frame", "appended to one table per query"], "fa", size=12)
    c.text(718, 255, "equal", "end", 12, "tu")
    c.arrow((765, 214), (765, 330), hue="r")
    c.text(757, 326, "differs: the run ends after this frame, status 3", "end", 12, "tr")
    c.line([(352, 262), (95, 262)], "lx", 1.4, "4 3")
    c.arrow((95, 262), (95, 214), dash="4 3")
    c.text(222, 255, "next frame", "middle", 12, "tu")
    c.arrow((440, 286), (440, 340))
    c.text(10, 356, "In the folder of the run: QUERY.csv, .bin or .npy, run.json, and with --report a page", size=12)
    return c


def keys(_root):
    c = Canvas(820, 474, "The tables of a scene file",
               "A scene file has keys of its own, a table card, a table report, any number of objects, each with a source of shapes and an optional "
               "motion, and any number of queries.")
    c.box(10, 200, 130, 84, ["*SCENE.toml", "title, frames,", "rate, check"], "fa")
    rows = ((20, 84, "`[report]", "0 or 1", ("form of the tables of records: results, bits, only_hits",), "fn"),
            (116, 84, "`[card]", "0 or 1", ("replaces choices of the planner: lanes, pairs, arithmetic, format,",
                "filter, algorithm, box, clock_mhz, bus, host, burst, narrow,",
                                             "memory, ecc, trace, transform_site, bvh, latency"), "fb"),
            (212, 132, "`[[object]]", "any number", ("name, parent", "one source of shapes: mesh (scale, deform), ray, triangle, sphere,",
                "aabb, plane, cylinder, obb, random, random_rays, camera, rays_csv"), "fg"),
            (356, 108, "`[[query]]", "any number", ("name, pair, mode, normals, iterations, mask, self, inside, packets",
                "primaries and secondaries name objects"), "fb"))
    for y, high, name, count, lines, kind in rows:
        c.line([(140, 242), (160, 242), (160, y + 26), (180, y + 26)])
        c.box(180, y, 130, 52, [name, "~" + count], kind)
        c.texts_at(326, y + 18, lines, size=12.5, leading=18)
    c.line([(205, 264), (205, 318), (326, 318)])
    c.box(326, 298, 160, 40, ["`[object.motion]", "~0 or 1"], "fg", size=12)
    c.texts_at(500, 313, ("kind: still, velocity, path, keyframes,", "random; without it the object rests"), size=12.5, leading=18)
    c.arrow((245, 356), (245, 264), dash="4 3")
    c.text(252, 350, "by name", size=12, kind="tu")
    c.texts_at(10, 444, ("~Lengths are in any unit, angles in degrees, times in seconds.", "~An unknown key is an error, with file, line and column."),
        size=12)
    return c


def nearest(a, b, p):
    d = (b[0] - a[0], b[1] - a[1])
    t = max(0.0, min(1.0, ((p[0] - a[0]) * d[0] + (p[1] - a[1]) * d[1]) / (d[0] ** 2 + d[1] ** 2)))
    return a[0] + t * d[0], a[1] + t * d[1]


def inside(_root):
    c = Canvas(820, 356, "A body outside, across and inside a closed mesh",
               "A mesh is a surface of triangles. A sphere outside the mesh and a sphere wholly inside it are both apart from each triangle: F is 0. "
               "Only inside tells them apart. A sphere across the surface has F = 1, with the depth against one triangle.")
    mesh = [(math.cos(k * math.pi / 4 + 0.2) * 1.9, math.sin(k * math.pi / 4 + 0.2) * 1.75) for k in range(8)]
    cases = (("outside", (2.55, 0.95), 0.42), ("across the surface", (1.5, 0.45), 0.5), ("wholly inside", (0.15, -0.1), 0.55))
    scale = 47
    for i, (name, center, radius) in enumerate(cases):
        x0, y0 = 112 + i * 273, 134
        at = lambda p, x0=x0, y0=y0: (x0 + p[0] * scale, y0 - p[1] * scale)
        c.polygon([at(p) for p in mesh], "la", 3)
        for p in mesh:
            c.dot(*at(p), "ma", 3.5)
        c.circle(*at(center), radius * scale, "fb")
        c.line([at(p) for p in mesh], "la", 1.5, solid=False, close=True)
        c.dot(*at(center), "mb", 2.5)
        point = min((nearest(*ab, center) for ab in zip(mesh, mesh[1:] + mesh[:1])), key=lambda p: math.dist(p, center))
        distance = math.dist(point, center)
        s = distance - radius
        direction = ((point[0] - center[0]) / distance, (point[1] - center[1]) / distance)
        on_body = (center[0] + direction[0] * radius, center[1] + direction[1] * radius)
        c.line([at(on_body), at(point)], "lr", 2.2, solid=False)
        c.dot(*at(point), "mr")
        c.dot(*at(on_body), "mr")
        turning = sum(math.atan2((a[0] - center[0]) * (b[1] - center[1]) - (a[1] - center[1]) * (b[0] - center[0]),
                                 (a[0] - center[0]) * (b[0] - center[0]) + (a[1] - center[1]) * (b[1] - center[1])) for a, b in zip(mesh,
                                     mesh[1:] + mesh[:1]))
        is_in = round(turning / (2 * math.pi))
        x = 16 + i * 273
        c.text(x, 20, "*" + name)
        c.text(x, 252, f"F = {int(s <= 0)}, T = {abs(s):.2f}")
        c.text(x, 272, "T: " + ("depth against one triangle" if s <= 0 else "least distance to a triangle"), size=12, kind="tu")
        c.text(x, 294, f"`inside = {is_in}", kind="tb" if is_in else "tx")
    c.texts_at(16, 322, ("The card tests triangles, not the enclosed body. Outside and wholly inside have records of the same form; inside tells them apart.",
                         "~Section through a closed mesh, mode nearest. The host computes inside for the sphere's centre, by its winding number."),
                             size=12)
    return c


def rays(_root):
    c = Canvas(820, 410, "A ray as text and as array",
               "The fields of a ray: origin o, direction d, tmin and tmax. The same ray as a line of text, as a line with named columns, and "
               "as the last axis of an array of 6, 7 or 8 numbers or as a structure.")
    c.text(10, 22, "*One ray")
    names = ("ox", "oy", "oz", "dx", "dy", "dz", "tmin", "tmax")
    for k, name in enumerate(names):
        c.box(10 + 62 * k, 34, 62, 28, "`" + name, "fb" if k < 3 else "fg" if k < 6 else "fn")
    c.text(103, 80, "origin", "middle", 12, "tu")
    c.text(289, 80, "direction; T counts in |d|", "middle", 12, "tu")
    c.text(444, 80, "optional: 0, ∞", "middle", 12, "tu")
    c.dot(560, 72, "mb", 4)
    c.line([(585, 66), (770, 24)], "lb", 5, solid=False)
    c.line([(560, 72), (800, 17)], "lu", 1, "4 3", solid=False)
    c.arrow((560, 72), (622, 58))
    c.text(556, 88, "/o", "middle")
    c.text(626, 74, "/d")
    c.text(585, 54, "/tmin", "middle", 12)
    c.text(762, 46, "/tmax", "middle", 12)
    c.text(10, 118, "*Text: a line per ray; separators are semicolons, commas, tabs or blanks")
    for k, (line, words) in enumerate((("0.1,0.2,5,0,0,-1", "6 numbers: tmin is 0, tmax is ∞"), ("0.1 0.2 5 0 0 -1 0 100", "8 numbers"),
        ("0,1;0,2;5;0;0;-1", "decimal commas, only with semicolons"))):
        c.box(10 + 268 * k, 130, 256, 32, "`" + line, "fn", align="start")
        c.text(12 + 268 * k, 180, words, size=12, kind="tu")
    c.text(10, 222, "*Text with a header: named columns in any order; row numbers are left out")
    c.box(10, 234, 390, 56, ["`,dx,dy,dz,ox,oy,oz", "`0,0,0,-1,0.1,0.2,5"], "fn", align="start")
    c.texts_at(412, 256, ("as pandas writes it:", "the first column counts rows"), size=12, leading=18)
    c.text(10, 324, "*Arrays: .npy, or .npz with one array; floats of 2, 4 or 8 bytes or whole numbers")
    shapes = (("(6,)", "one ray", "one record"), ("(n, 8)", "n rays", "records (n,)"), ("(480, 640, 6)", "480 x 640 rays", "records (480, 640)"),
              ("o: 3, d: 3", "structure,", "or ox to dz"))
    for k, (shape, what, records) in enumerate(shapes):
        c.box(10 + 200 * k, 336, 192, 62, ["`" + shape, what, "~" + records], "fg" if k < 3 else "fb", size=12.5)
    return c
