# SPDX-License-Identifier: Apache-2.0
"""Rays through a BVH: the traversal unit, and why a widened box loses no hit (rtl/bvh, docs/background/bvh.md)."""
from canvas import Canvas


def upper(c):
    c.box(10, 20, 130, 62, ["*Ray ring", "4,096 places"], "fa")
    c.arrow((140, 51), (186, 51))
    c.box(186, 20, 164, 62, ["*Ray front", "o, M' |1/d|, 1/d", "once per ray"], "fb", size=12)
    c.arrow((350, 51), (398, 51))
    c.box(398, 20, 246, 124, ["*Contexts, 256 rays", "ray, T interval that counts,", "best record: T, CP, index,", "stack of groups, 16 levels;",
                              "a group: children still to visit"], "fa", size=12)
    c.arrow((644, 51), (690, 51))
    c.box(690, 20, 120, 62, ["*Records", "one per ray,", "in any order"], "fa", size=12)
    c.arrow((268, 82), (268, 172))
    c.text(276, 122, "starts at", size=12, kind="tu")
    c.text(276, 137, "the root", size=12, kind="tu")


def middle(c):
    c.box(10, 190, 130, 62, ["*Node memory", "18 words per", "node"], "fa", size=12)
    c.arrow((140, 221), (186, 221))
    c.box(186, 172, 164, 98, ["*Traversal unit", "near, far of eight boxes;", "culls, sorts children;", "one node per cycle"], "fb", size=12)
    c.line([(350, 190), (436, 190)])
    c.arrow((436, 190), (436, 144))
    c.text(358, 184, "others met", size=12, kind="tu")
    c.box(474, 182, 170, 78, ["*Choice", "next child of the top", "group; drops groups", "beyond the T interval"], "fb", size=12)
    c.arrow((560, 144), (560, 182), both=True)
    c.arrow((474, 236), (350, 236))
    c.text(412, 230, "node", "middle", 12, "tu")


def leaves(c):
    c.arrow((230, 270), (230, 304), (75, 304), (75, 340))
    c.text(150, 298, "leaf met first", "middle", 12, "tu")
    c.line([(530, 260), (530, 304), (230, 304)])
    c.text(380, 298, "leaf", "middle", 12, "tu")
    c.box(10, 340, 130, 58, ["*Slot table", "slot: secondary"], "fa", size=12)
    c.arrow((140, 369), (172, 369))
    c.box(172, 340, 128, 58, ["*DDR", "secondaries, a beat", "of 9 words each"], "fa", size=12)
    c.arrow((300, 369), (332, 369))
    c.box(332, 340, 118, 58, ["Transformer", "(option)"], "fb", size=12, dash=True)
    c.arrow((450, 369), (482, 369))
    c.box(482, 340, 162, 58, ["*Leaf pipes, two lanes", "F, T, CP of one or two", "secondaries"], "fb", size=12)
    c.arrow((644, 369), (680, 369))
    c.box(680, 340, 130, 58, ["*Better record", "least (T, index)"], "fb", size=12)
    c.arrow((745, 340), (745, 112), (644, 112))
    c.text(738, 205, "best record,", "end", 12, "tu")
    c.text(738, 220, "T interval", "end", 12, "tu")
    c.text(738, 235, "gets smaller", "end", 12, "tu")


def traversal(_root):
    c = Canvas(820, 476, "BVH traversal in the card",
               "A ray takes a free context and starts at the root. The traversal unit reads a node, tests its eight boxes and sorts the children that "
               "the ray meets. The first child is visited next, the others wait on the stack of the context. Secondaries of leaves come "
               "from DDR and are tested by two lanes. The better of T and index shrinks the T interval of the ray.")
    for part in (upper, middle, leaves):
        part(c)
    c.texts_at(10, 426,
        ("A child is culled if near > far, far < tmin, or near > the best T so far (mode nearest). All comparisons are strict, so ties survive.",
                         "Traversal units, leaf fetch and pipes take one operation per cycle and never wait for a context; "
                         "queues hold every context.",
                         "~Each traversal unit has its own copy of the node memory and its share of the contexts. Leaf fetch and leaf pipes are shared."),
                             size=11.5)
    return c


def bound(_root):
    c = Canvas(820, 456, "Why a widened box loses no hit",
               "Nested boxes around a triangle: the box of the triangle, the band in which a computed hit can lie, the box of the node, which is "
               "rounded outwards, and the node's box widened by M'. The stretch of the ray in the widened box contains the computed T.")
    c.rect(40, 40, 400, 330, "lb", 3, dash=True, solid=False)
    c.rect(82, 82, 316, 246, "fn", 3, solid=False)
    c.rect(110, 106, 260, 198, "lr", 3, dash=True, solid=False)
    c.rect(130, 126, 220, 158, "la", 2, solid=False)
    triangle = [(130, 284), (350, 226), (214, 126)]
    c.polygon(triangle, "fa", 1.6)
    o, far = (14, 78), (462, 382)
    slope = (far[1] - o[1]) / (far[0] - o[0])
    def on(x):
        return x, o[1] + slope * (x - o[0])
    c.line([on(14), on(452)], "lu", 1.2, "4 3", solid=False)
    c.line([on(40), on(440)], "lb", 3, solid=False)
    c.arrow(on(440), on(458), hue="b")
    c.dot(*on(14), "mb", 4)
    c.text(14, 66, "o", "middle")
    c.dot(*on(40), "mx", 3)
    c.dot(*on(440), "mx", 3)
    c.text(46, on(40)[1] - 8, "near", size=12)
    c.text(434, on(440)[1] + 20, "far", "end", 12)
    t = on(334)
    c.dot(*t, "mr", 4)
    c.circle(*t, 7, "lr", 1.4)
    c.arrow((300, 348), (t[0] - 4, t[1] + 9), hue="r", thick=1.2)
    c.text(296, 352, "P = o + T d as computed", "end", 12, kind="tr")
    x, y = 490, 46
    rows = (("la", None, ("*Box of the triangle", "of the three vertices, exact")),
            ("lr", "5 4", ("*Box rule", "a hit is accepted only if o + T d is outside", "by less than m'; with T as computed",
                "m' < 192 u (R + m') (1 + 4u) + 12 u W")),
            ("lu", None, ("*Box of the child in its node", "contains the triangle; corners are", "bytes times 2^e, rounded outwards")),
            ("lb", "5 4", ("*Widened for the ray", "on every axis by M' = 208 u R + 13 u W")))
    for kind, dash, lines in rows:
        c.line([(x, y - 4), (x + 34, y - 4)], kind, 2, dash, solid=False)
        c.texts_at(x + 44, y, lines, size=12)
        y += 16 * len(lines) + 20
    c.texts_at(20, 406, ("Without roundings T lies in [near, far] by 16 u R + u W. Near and far are whole numbers, rounded outwards from fp32 within 5 u R.",
                         "So near ≤ T ≤ far as computed, for every box above a hit. Culling uses T alone: the argument holds for all four algorithms.",
                         "~R: largest distance along an axis from o to the root's box. W: largest coordinate of that box. u = 2^-24. "
                         "Margins are not to scale."),
               size=12, leading=18)
    return c


def node_cache(_root):
    """rtl/bvh/node_reader.sv."""
    c = Canvas(820, 330, "Nodes in DDR, behind a cache",
               "A visit is looked up in the tags. If its node is on chip or in the cache, the traversal unit reads it. Else the visit joins a queue, and "
               "the node is fetched from DDR unless it is already under way. When the node has arrived, the visit leaves the queue, and the unit reads "
               "the node from the cache.")
    c.box(10, 60, 154, 62, ("*Visits", "first children, then", "from stack, new rays"), "fa", 12.5)
    c.box(208, 60, 128, 62, ("*Look-up", "tags of one set,", "one visit per cycle"), "fb", 12.5)
    c.arrow((164, 91), (208, 91))
    c.line([(208, 243), (186, 243), (186, 110)])
    c.arrow((186, 110), (208, 110))
    c.text(178, 190, "again, if all", "end", 12, "tu")
    c.text(178, 205, "ways were in use", "end", 12, "tu")
    c.box(430, 20, 150, 48, ("*Pinned nodes", "the first ones, on chip"), "fa", 12.5)
    c.box(430, 112, 150, 48, ("*Cache", "lines of one node"), "fa", 12.5)
    c.box(668, 60, 132, 62, ("*Traversal unit", "reads one node", "per 1 or 2 cycles"), "fb", 12.5)
    c.arrow((336, 80), (380, 80), (380, 44), (430, 44))
    c.arrow((336, 102), (380, 102), (380, 136), (430, 136))
    c.text(388, 62, "pinned", size=12, kind="tu")
    c.text(388, 126, "hit", size=12, kind="tu")
    c.arrow((580, 44), (620, 44), (620, 80), (668, 80))
    c.arrow((580, 136), (620, 136), (620, 102), (668, 102))
    c.box(208, 212, 128, 62, ("*Queue", "of waiting visits,", "one per context"), "fa", 12.5)
    c.arrow((272, 122), (272, 212))
    c.text(280, 160, "miss, or the node", size=12, kind="tu")
    c.text(280, 175, "is under way", size=12, kind="tu")
    c.box(430, 212, 150, 62, ("*DDR", "nodes, slots, triangles;", "answers in order"), "fa", 12.5)
    c.arrow((336, 232), (430, 232))
    c.text(383, 226, "fetch", "middle", 12, "tu")
    c.arrow((505, 212), (505, 160))
    c.text(513, 190, "two beats per node", size=12, kind="tu")
    c.line([(336, 258), (400, 258), (400, 300), (734, 300)])
    c.arrow((734, 300), (734, 122))
    c.text(567, 294, "the oldest visit, when its node has arrived", "middle", 12, "tu")
    return c


def node_test(_root):
    """rtl/bvh/node_boxes_int.sv and node_order.sv: modules and words between them."""
    c = Canvas(860, 424, "The node test for rays in whole numbers",
               "Fp32 operators compute T of byte 0 of the three axes. In parallel node_scale computes steps, units and margins. Time_steps converts "
               "three planes and the ray's interval into whole steps after T_ref. Node_side adds bytes times units and takes the greatest of three "
               "axes, for the near and the far side. Comparisons decide which children are entered, and node_order ranks them. With two cycles per "
               "node, one set of units does the near side, then the far side.")
    c.box(20, 40, 150, 62, ("*3 sub, 3 mul", "c = (origin − o) i", "~fp32, per axis"), "fb", 12.5)
    c.box(20, 128, 150, 62, ("`node_scale", "ranges, lo, steps,", "units, margins"), "fg", 12.5)
    c.box(20, 216, 150, 44, ("bytes of 8 children", "~wait"), "fn", 12.5)
    c.box(216, 40, 100, 62, ("T_ref =", "c of axis lo"), "fn", 12.5)
    c.box(356, 40, 148, 62, ("*5 time_steps", "planes, lowest, highest", "in whole steps"), "fa", 11.5)
    c.box(546, 92, 146, 134, ("*2 node_side", "near, and −far:", "plane − margin", "+ byte × unit,", "greatest of 3 axes", "~24 multipliers each"), "fa", 12.5)
    c.box(734, 40, 110, 62, ("near + −far ≤ 0,", "limits;", "key of 12 bits"), "fg", 12)
    c.box(734, 164, 110, 62, ("`node_order", "28 comparisons,", "ranks"), "fg", 12.5)
    c.arrow((170, 71), (216, 71))
    c.arrow((316, 71), (356, 71))
    c.arrow((170, 144), (266, 144), (266, 102))
    c.arrow((170, 168), (546, 168))
    c.text(360, 160, "units, margins", "middle", 12, "tu")
    c.arrow((504, 71), (522, 71), (522, 118), (546, 118))
    c.arrow((170, 238), (522, 238), (522, 206), (546, 206))
    c.arrow((692, 118), (712, 118), (712, 71), (734, 71))
    c.arrow((789, 102), (789, 164))
    c.text(789, 250, "children hit,", "middle", 12, "tu")
    c.text(789, 265, "in order", "middle", 12, "tu")
    c.line([(20, 286), (844, 286)], "lh", 1, "2 3", solid=False)
    c.texts_at(20, 312, ("*One cycle per node (NODE_CYCLES = 1)", "5 time_steps and 2 node_side work at once.",
                         "48 products of 8 by 18 bits per cycle."), size=12.5)
    c.texts_at(440, 312, ("*Two cycles per node (NODE_CYCLES = 2)", "First cycle: c of axes 0 and 1; planes; near side of 8 children.",
                          "Second cycle: c of axis 2; lowest and highest; far side.", "2 sub, 2 mul, 3 time_steps, 1 node_side: 24 products."), size=12.5)
    c.texts_at(20, 378, ("*Four cycles per node (NODE_CYCLES = 4)", "Near and far side of children 0 to 3, then of children 4 to 7.",
                         "1 sub, 1 mul, 2 time_steps, 1 node_side: 12 products."), size=12.5)
    c.text(440, 396, "The next node follows at once. Nothing stalls.", size=12, kind="tu")
    return c
