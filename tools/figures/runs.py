# SPDX-License-Identifier: Apache-2.0
"""Runs: chunks on many machines, the way from a wrong answer to its line, certified filters."""
from canvas import Canvas


def shards(_root):
    c = Canvas(820, 404, "A run cut into chunks: ranks under MPI, or shards",
               "The same chunks are distributed in two ways. Under MPI, rank 0 assigns chunks to ranks, collects their results in order and writes the outputs; a "
               "journal keeps finished chunks. Without MPI each shard computes every n-th chunk into its own journal, and cde merge "
               "writes the outputs.")
    c.text(10, 22, "*One run is cut into chunks")
    for k in range(12):
        c.box(10 + 66 * k, 32, 60, 26, str(k), ("fb", "fg", "fa")[k % 3], 12)
    c.line([(410, 76), (410, 384)], "lh", 1, solid=False)
    c.text(10, 92, "*Ranks: mpirun -n 3 cde ...")
    c.text(430, 92, "*Shards: cde ... --shard I/3 --resume partI")
    for k, name in enumerate(("rank 1", "rank 0", "rank 2")):
        c.box(10 + 132 * k, 120, 118, 50, ["*" + name, "simulates"] if k != 1 else ["*rank 0", "assigns, simulates"], "fg" if k == 1 else "fb", size=11.5)
    c.arrow((142, 138), (128, 138), size=6)
    c.arrow((128, 154), (142, 154), size=6)
    c.arrow((260, 138), (274, 138), size=6)
    c.arrow((274, 154), (260, 154), size=6)
    c.text(201, 112, "chunks out, results back", "middle", 12, "tu")
    c.arrow((180, 170), (180, 216))
    c.arrow((230, 170), (230, 246), (280, 246))
    c.text(172, 198, "in order", "end", 12, "tu")
    c.box(90, 216, 120, 60, ["*Outputs", "rank 0 writes"], "fa", size=12.5)
    c.box(280, 216, 112, 60, ["*Journal", "--resume FILE", "goes on from it"], "fa", size=12)
    for k in range(3):
        x = 430 + 128 * k
        chunks = ", ".join(str(i) for i in range(k, 12, 3))
        c.box(x, 112, 116, 58, [f"*shard {k + 1}/3", "any machine", "~" + chunks], ("fb", "fg", "fa")[k], size=12)
        c.arrow((x + 58, 170), (x + 58, 190))
        c.box(x, 190, 116, 32, f"journal part{k + 1}", "fn", size=12)
        c.arrow((x + 58, 222), (x + 58, 246))
    c.box(430, 246, 372, 34, "cde merge part1 part2 part3: simulates nothing", "fg", size=12.5)
    c.arrow((616, 280), (616, 302))
    c.box(556, 302, 120, 32, "*Outputs", "fa")
    c.texts_at(10, 312, ("*Outputs equal one process's outputs, byte by byte.", "~A chunk: rays for 30 million tests or 32,768 rays",
        "~with a BVH, 65,536 lines, a frame, or 50,000 cases.",
                         "~Ranks take the next chunk when they are free."), size=12.5)
    c.texts_at(430, 362, ("~A journal of another build, option or input is refused.",), size=12)
    return c


def explain(root):
    pipe = (root / "rtl/pipes/ray_triangle_moller.sv").read_text(encoding="utf-8").splitlines()
    line = 1 + next(i for i, words in enumerate(pipe) if "DF_VSUB(s, o, v0)" in words)
    c = Canvas(820, 430, "From a wrong answer to its line",
               "An answer of the card that differs from the reference is packed into a folder. cde explain runs the pair alone and sets every "
               "operator of the card beside the same operation of the reference. The first operators whose operands agree and whose results differ "
               "name the line of RTL.")
    c.box(10, 16, 190, 78, ["*Wrong answer", "cde query, cast or run:", "card differs from the", "reference in one bit"], "fr", size=12)
    c.arrow((200, 55), (240, 55))
    c.box(240, 16, 270, 78, ["*Folder cde-failure", "fail.txt: read this first", "explain.txt, why.txt, fail.json", "waves.fst, waves.gtkw"], "fa", size=12)
    c.arrow((510, 55), (550, 55))
    c.box(550, 16, 260, 78, ["*cde explain PAIR 'A | B'", "the pair alone through one pipe,", "operators reported as they compute"], "fg", size=12)
    c.arrow((680, 94), (680, 124))
    c.rect(10, 124, 800, 208, "fz", 6, solid=False)
    c.text(24, 146, "*Card: operators of the RTL")
    c.text(424, 146, "*Reference: the same operations")
    ops = (("e2 = v2 − v0", "same"), ("e1 = v1 − v0", "same"), ("s = o − v0", "first"), ("q = s × e1", "later"))
    for k, (name, what) in enumerate(ops):
        y = 158 + 42 * k
        left = {"same": name, "first": "s: 0.605 + 0.919 = 1.524", "later": f"{name}: another operand"}[what]
        right = {"same": name, "first": "s = o − v0: 0.605 − 0.919 = −0.313", "later": name}[what]
        c.box(24, y, 300, 32, left, {"same": "fn", "first": "fr", "later": "fo"}[what], 12.5)
        c.box(424, y, 300, 32, right, "fo" if what == "later" else "fn", 12.5)
        c.line([(324, y + 16), (346, y + 16)], "lu", 1, solid=False)
        c.line([(402, y + 16), (424, y + 16)], "lu", 1, solid=False)
        c.text(374, y + 20, "equal" if what == "same" else "differ", "middle", 12, {"same": "tg", "first": "tr", "later": "tu"}[what])
    c.text(734, 262, "first", size=12, kind="tr")
    c.arrow((15, 258), (15, 386), (24, 386), hue="r")
    c.box(24, 366, 330, 40, [f"*ray_triangle_moller.sv:{line}  op_s[0]", "the operands are right, the result is not"], "fr", size=12)
    c.texts_at(380, 362, ("Drawn: a subtraction became an addition. The output ends with", "the operators that differ first, each with its line of RTL.",
                          "~--from-record RUN:QUERY:FRAME:PRIMARY explains a record."), size=12, leading=18)
    return c


def filters(_root):
    c = Canvas(820, 330, "A certified filter on the card",
               "A row of pairs enters narrow lanes, which propose a normal per pair. A short sum in the wide format proves most misses. Pairs that stay "
               "uncertain wait in order for one wide lane, which gives F, T, CP and n. Rows leave in order.")
    c.box(10, 60, 110, 62, ["*Row", "L pairs of", "solids"], "fa", size=12.5)
    c.arrow((120, 91), (150, 91))
    for k, words in enumerate(("lane 0: narrow pipe", "lane 1: narrow pipe", "...", "lane L − 1")):
        c.box(150, 22 + 36 * k, 150, 30, words, "fo" if k == 2 else "fb", 12.5)
    c.arrow((300, 91), (352, 91))
    c.text(326, 84, "/n", "middle")
    c.box(352, 46, 170, 90, ["*Proof, wide format", "g = n·(oB − oA)", "− h_A(n) − h_B(−n)", "g > 32 u S ?"], "fb", size=12.5)
    c.arrow((522, 91), (640, 91))
    c.text(581, 84, "yes: miss", "middle", 12, "tg")
    c.box(640, 60, 170, 62, ["*Answers, in order", "F, T, CP, n where F = 1", "F = 0 otherwise"], "fa", size=12)
    c.arrow((437, 136), (437, 186))
    c.text(445, 164, "no: uncertain", size=12, kind="tr")
    c.box(352, 186, 170, 50, ["*Slots, a row each", "lane by lane, in order"], "fa", size=12.5)
    c.arrow((522, 211), (640, 211))
    c.box(640, 186, 170, 50, ["*One wide lane", "one pair per cycle"], "fb", size=12.5)
    c.arrow((725, 186), (725, 122))
    c.texts_at(10, 266,
        ("A separating plane proves a miss, wherever it comes from: the narrow pipe may be wrong, records are not. Hits always take the wide lane.",
                         "Used in modes hits and any, where a miss has no T. In other modes every pair takes the wide lane. REG_UNCERTAIN counts its pairs.",
                         "~h: support functions. S: distance of the origins and reach of both bodies. u: unit roundoff of the wide format, "
                         "as fp32 behind fp16."),
               size=11.5, leading=18)
    return c
