# SPDX-License-Identifier: Apache-2.0
"""One brute-force pass as a timing diagram (rtl/engine/engine_control.sv, rtl/update/update_lanes.sv)."""
from canvas import Canvas

LEFT, CELL, HIGH = 146, 17, 24
LOAD, CLEAR, BUBBLES, ROWS, SECONDARIES, LATENCY, WRITE = 5, 4, 4, 2, 4, 10, 6
TESTS = ROWS * SECONDARIES
START = LOAD + CLEAR + BUBBLES  # first cycle in which a row enters
END = START + TESTS + LATENCY + 1  # first cycle of the write-back


def at(cycle):
    return LEFT + cycle * CELL


def bar(c, y, cycle, count, words, kind, size=12):
    c.box(at(cycle), y, count * CELL, HIGH, words, kind, size)


def track(c, y, name, note=None):
    c.text(LEFT - 10, y + (16 if note is None else 11), name, "end", 13)
    if note:
        c.text(LEFT - 10, y + 25, note, "end", 12, "tu")


def tracks(c, y, step):
    track(c, y, "local bus")
    bar(c, y, 0, 4, "primaries", "fg", 12)
    bar(c, y, 4, 1, "", "fg")
    c.text(at(4) - 2, y - 5, "counts, mode, go", "middle", 12, "tu")
    y += step
    track(c, y, "state")
    for start, count, words in ((LOAD, CLEAR, "clear"), (LOAD + CLEAR, BUBBLES + TESTS, "secondaries × rows"), (START + TESTS, LATENCY + 1, "drain"),
                                (END, WRITE, "write back")):
        bar(c, y, start, count, words, "fn")
    y += step
    track(c, y, "secondary", "held for all rows")
    bar(c, y, LOAD + CLEAR, BUBBLES, "bubbles", "fo")
    for s in range(SECONDARIES):
        bar(c, y, START + s * ROWS, ROWS, f"S{s}", "fa")
    y += step
    track(c, y, "row enters pipe")
    for i in range(TESTS):
        bar(c, y, START + i, 1, str(i % ROWS), "fb")
    y += step
    track(c, y, "row leaves pipe")
    for i in range(TESTS):
        bar(c, y, START + LATENCY + i, 1, str(i % ROWS), "fb")
    c.dimension(at(START), at(START + LATENCY), y + 12, "latency, 10 cycles", size=12)
    y += step
    track(c, y, "stencil-T write", "old T is read from")
    c.text(LEFT - 10, y + 39, "the other buffer", "end", 12, "tu")
    for s in range(SECONDARIES):
        bar(c, y, START + LATENCY + s * ROWS, ROWS, "T1" if s % 2 == 0 else "T0", "fa")
    y += step + 14
    track(c, y, "record written")
    for i, words in enumerate(("0", "1", "2", "..", "127")):
        bar(c, y, END + (i if i < 3 else (3 if i == 3 else 4)), 1 if i < 4 else 2, words, "fb")
    y += step
    track(c, y, "interrupt")
    last = END + WRITE
    c.line([(at(0), y + HIGH), (at(last), y + HIGH), (at(last), y + 4), (at(last + 1), y + 4)], "lr", 1.6)
    return y + HIGH


def formula(c, y):
    c.line([(10, y), (810, y)], "lh", 1)
    c.text(10, y + 26, "*Cycles = clear + bubbles + secondaries × rows + stalls + drain", size=14)
    c.text(10, y + 48, "rows = primaries in use / L, rounded up")
    c.text(300, y + 48, "clear = 256 / L")
    c.text(425, y + 48, "drain = latency of the pipe + 3 (mode nearest)")
    c.text(10, y + 70, "The write-back is counted apart: one record per cycle, for active primaries only.")
    c.text(10, y + 92, "L = 64, 128 primaries, 1,280 secondaries, latency 19, ideal DDR: 4 + 23 + 1,280 × 2 + 0 + 22 = 2,609 cycles, as cde cast counts.",
        size=12)
    c.text(10, y + 112, "~Drawn: L = 64, 128 primaries (2 rows), 4 secondaries, mode nearest, ray-triangle by moller, operators of one cycle.", size=12)
    c.text(10, y + 129, "~Bubbles are shortened: the first secondary needs the latency of DDR. In modes all and hits records are written as rows leave.",
        size=12)


def picture(_root):
    c = Canvas(820, 522, "One brute-force pass in time",
               "The host loads primaries and starts the pass. The card clears its buffers and waits for the first secondary. Then one row of L "
               "primaries enters the pipe per cycle, all rows for each secondary. Each row leaves after the latency of the pipe, and the "
               "update engine writes the better T to one of two stencil-T buffers in turn. After the drain the card writes one record per "
               "cycle and raises the interrupt.")
    bottom = tracks(c, 26, 43)
    for cycle in (LOAD, START, START + TESTS, END, END + WRITE):
        c.line([(at(cycle), 104), (at(cycle), bottom)], "lh", 1, "2 3", solid=False)
    formula(c, bottom + 10)
    return c
