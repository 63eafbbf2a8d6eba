# SPDX-License-Identifier: Apache-2.0
"""The card: its blocks with their data paths, a pass in time, the bus."""
from canvas import Canvas


def top(c):
    c.box(10, 16, 150, 78, ["*Host", "driver, host memory"], "fg")
    c.arrow((160, 55), (268, 55), both=True, thick=2)
    c.text(214, 46, "PCI", "middle")
    c.text(214, 75, "64 bits,", "middle", 12, "tu")
    c.text(214, 90, "66 MHz", "middle", 12, "tu")
    c.box(268, 16, 214, 78, ["*PCI bridge", "target: posted writes,", "delayed reads", "DMA: FIFOs of 8 KB each way"], "fb")
    c.arrow((482, 55), (586, 55), both=True, thick=2)
    c.text(534, 46, "two FIFOs", "middle", 12)
    c.text(534, 75, "PCI clock |", "middle", 12, "tu")
    c.text(534, 90, "core clock", "middle", 12, "tu")
    c.box(586, 16, 224, 78, ["*Registers, sequencer", "check every access, start", "passes, count events,", "raise the interrupt"], "fb")
    c.arrow((698, 94), (698, 122), both=True)
    c.rect(10, 122, 800, 24, "fn")
    c.text(410, 139, "Local bus: one 64-bit beat per cycle", "middle")


def brute_force(c):
    c.box(10, 188, 190, 200, ["*Primary register file", "256 primaries", "in rows of L"], "fa", top=62)
    c.arrow((105, 146), (105, 188))
    c.text(112, 172, "64 bits", size=12, kind="tu")
    c.box(240, 188, 165, 58, ["*DDR, secondaries", "2 GB, packed slots"], "fa")
    c.arrow((322, 146), (322, 188))
    c.text(329, 172, "64 bits", size=12, kind="tu")
    c.arrow((322, 246), (322, 286))
    c.text(329, 262, "9 words", size=12, kind="tu")
    c.text(329, 277, "per cycle", size=12, kind="tu")
    c.box(240, 286, 165, 34, "DDR read arbiter", "fb")
    c.arrow((322, 320), (322, 344))
    c.box(240, 344, 165, 34, "Transformer (option)", "fb", dash=True)
    c.arrow((240, 361), (200, 361), both=True)
    c.text(220, 352, "pose", "middle", 12, "tu")
    c.arrow((322, 378), (322, 410))
    c.box(240, 410, 165, 48, ["*Secondary register file", "64 slots ahead"], "fa", size=12)
    c.arrow((105, 388), (105, 494))
    c.text(113, 440, "L primaries", size=12, kind="tu")
    c.text(113, 455, "per cycle", size=12, kind="tu")
    c.arrow((322, 458), (322, 494))
    c.text(315, 480, "1 secondary, all lanes", "end", 12, "tu")
    c.box(10, 494, 395, 52, ["*Pair pipes, L lanes", "L pairs per cycle: F, T, CP and, as an option, n"], "fb")
    c.arrow((105, 546), (105, 592))
    c.text(113, 573, "L results per cycle", size=12, kind="tu")
    c.box(10, 592, 250, 82, ["*Update engine", "two stencil-T buffers: old T, new T", "F-index buffer, CP", "best record per primary"], "fb", size=12)
    c.arrow((343, 546), (343, 592))
    c.box(280, 592, 125, 82, ["*Output FIFO", "modes all", "and hits"], "fa", size=12)


def traversal(c):
    c.box(440, 188, 205, 58, ["*Ray ring, 4,096 places", "BVH nodes, slot table"], "fa", dash=True)
    c.arrow((542, 146), (542, 188))
    c.text(549, 172, "64 bits", size=12, kind="tu")
    c.arrow((542, 246), (542, 344))
    c.text(549, 280, "rays;", size=12, kind="tu")
    c.text(549, 295, "nodes of", size=12, kind="tu")
    c.text(549, 310, "18 words", size=12, kind="tu")
    c.box(458, 344, 187, 82, ["*Traversal units", "(option) each reads one", "node and tests its eight", "boxes per cycle"], "fb", size=12, dash=True)
    c.arrow((500, 344), (500, 303), (405, 303))
    c.text(452, 296, "leaf requests", "middle", 12, "tu")
    c.arrow((405, 361), (424, 361), (424, 520), (458, 520))
    c.arrow((552, 426), (552, 494), both=True)
    c.text(559, 457, "ray, leaf;", size=12, kind="tu")
    c.text(559, 472, "best T", size=12, kind="tu")
    c.box(458, 494, 187, 52, ["*Leaf pipes, two lanes", "one leaf per cycle"], "fb", dash=True)


def records(c):
    c.box(680, 188, 130, 76, ["*Record ring", "SRAM, 524,288", "records"], "fa")
    c.arrow((745, 188), (745, 146))
    c.text(738, 172, "64 bits", "end", 12, "tu")
    c.box(458, 606, 187, 54, ["*Record maker", "7 words per record"], "fb")
    c.line([(135, 674), (135, 694), (551, 694)])
    c.arrow((551, 694), (551, 660))
    c.text(300, 688, "write-back at the end of a pass", "middle", 12, "tu")
    c.arrow((405, 633), (458, 633))
    c.line([(645, 633), (745, 633), (745, 520)])
    c.line([(645, 520), (745, 520)])
    c.arrow((745, 520), (745, 264))
    c.text(738, 380, "1 record", "end", 12, "tu")
    c.text(738, 395, "per cycle", "end", 12, "tu")


def legend(c):
    x = 10
    for kind, words, wide in (("fb", "logic", 74), ("fa", "memory", 92), ("fg", "software", 96)):
        c.rect(x, 712, 14, 14, kind, 2)
        c.text(x + 20, 724, words, size=12, kind="tu")
        x += wide
    c.line([(x, 719), (x + 26, 719)], "lu", 1.4, "5 4")
    c.text(x + 32, 724, "optional; words are 32 bits in fp32; L is the number of lanes, 1 to 256", size=12, kind="tu")


def card(_root):
    c = Canvas(820, 736, "Block diagram of the card",
               "The host writes secondaries to DDR and primaries to the register file over PCI and the local bus. L lanes of pair pipes test one "
               "secondary against L primaries per cycle. The update engine keeps the best record per primary. Optional traversal units send "
               "rays through a BVH to leaf pipes. Records go to a ring in SRAM, which the host reads.")
    for part in (top, brute_force, traversal, records, legend):
        part(c)
    return c
