# SPDX-License-Identifier: Apache-2.0
"""DMA and a PCI burst (rtl/bus/pci_dma.sv, rtl/contract/pci_pkg.sv, rtl/memory/sram_ring.sv)."""
from canvas import Canvas

WAVE_LEFT, CLOCK = 110, 62


def ring(c):
    c.text(10, 22, "*A transfer", size=14)
    c.box(10, 36, 190, 136, "", "fg")
    c.text(105, 54, "*Host: CPU, memory", "middle")
    for i in range(5):
        kind = "fa" if i in (1, 2, 3) else "fo"
        c.rect(22, 68 + 18 * i, 84, 18, kind, 0)
    c.text(64, 82, "descriptors", "middle", 12)
    c.text(114, 99, "head", size=12)
    c.text(114, 153, "tail", size=12)
    c.text(114, 121, "32 bytes", size=12, kind="tu")
    c.box(540, 36, 150, 136, "", "fb")
    c.text(615, 54, "*PCI bridge", "middle")
    c.texts_at(550, 76, ("target", "master, DMA engine", "page table: 4,096", "FIFOs: 8 KB each way", "bursts: 64 to 4,096", "bytes, within a page"), size=12)
    c.box(726, 36, 84, 136, ["*Board", "spaces 0-6", "of the", "local bus"], "fb", size=12)
    c.arrow((690, 104), (726, 104), both=True)
    steps = ((50, "1  CPU writes the tail"), (78, "2  descriptor: 4 words of 64 bits"), (106, "3  pages are looked up, data in bursts"),
             (134, "4  completion record: 2 words"), (162, "5  interrupt, if asked for"))
    for y, words_ in steps:
        ends = ((204, y + 4), (536, y + 4)) if y in (50, 78) else ((536, y + 4), (204, y + 4))
        c.arrow(*ends, both=y == 106, thick=1.3)
        c.text(370, y - 1, words_, "middle", 12)


def field(c, x, y, wide, words, bits, kind="fn"):
    c.box(x, y, wide, 30, words, kind, 12)
    c.text(x + wide / 2, y + 43, bits, "middle", 11, "tu")


def words(c):
    y = 214
    c.text(10, y, "*Words", size=14)
    c.text(10, y + 30, "descriptor 0", size=12)
    field(c, 110, y + 12, 340, "bytes", "63:32")
    field(c, 450, y + 12, 340, "mapped address", "31:0", "fa")
    c.text(10, y + 86, "descriptor 1", size=12)
    for x, wide, name, bits, kind in ((110, 90, "0", "63:42", "fo"), (200, 60, "irq", "41", "fn"), (260, 70, "to host", "40", "fn"), (330, 50, "0", "39:35",
        "fo"),
                                      (380, 70, "space", "34:32", "fn"), (450, 340, "offset in the local space", "31:0", "fa")):
        field(c, x, y + 68, wide, name, bits, kind)
    c.text(10, y + 142, "completion 0", size=12)
    field(c, 110, y + 124, 270, "bytes moved / 8", "63:35")
    field(c, 380, y + 124, 70, "lap", "32", "fr")
    field(c, 450, y + 124, 340, "fault address", "31:0")
    c.text(10, y + 198, "completion 1", size=12)
    for x, wide, name, bits, kind in ((110, 60, "lap", "63", "fr"), (170, 140, "0", "62:40", "fo"), (310, 140, "code", "39:32", "fn"), (450, 170,
        "PCI status", "31:16", "fn"),
                                      (620, 170, "descriptor", "15:0", "fn")):
        field(c, x, y + 180, wide, name, bits, kind)


def level(c, y, name, low):
    """A signal that is low in the cycles of a set; edges follow the rising clock."""
    points, high = [(WAVE_LEFT, y)], True
    for k in range(11):
        x = WAVE_LEFT + k * CLOCK
        if (k in low) == high:
            points += [(x, points[-1][1]), (x + 8, y + 14 if high else y)]
            high = not high
    points.append((WAVE_LEFT + 11 * CLOCK, points[-1][1]))
    c.line(points, "lb", 1.6, solid=False)
    c.text(WAVE_LEFT - 10, y + 12, name, "end", 12)


def burst(c):
    y = 478
    c.text(10, y, "*A read burst towards the card: four data phases of 8 bytes, host profile ideal", size=14)
    for k in range(11):
        x = WAVE_LEFT + k * CLOCK
        c.line([(x, y + 34), (x, y + 176)], "lh", 1, "2 3", solid=False)
        c.text(x + CLOCK / 2, y + 26, str(k), "middle", 11, "tu")
    c.text(WAVE_LEFT - 10, y + 26, "cycle", "end", 12, "tu")
    ad = y + 40
    for start, count, name, kind in ((1, 1, "address", "fa"), (4, 1, "data 0", "fb"), (5, 1, "data 1", "fb"), (6, 1, "data 2", "fb"), (7, 1, "data 3", "fb")):
        c.box(WAVE_LEFT + start * CLOCK + 3, ad - 3, count * CLOCK - 2, 20, name, kind, 11)
    c.text(WAVE_LEFT - 10, ad + 12, "AD", "end", 12)
    level(c, y + 66, "FRAME#", range(1, 7))
    level(c, y + 90, "IRDY#", range(2, 8))
    level(c, y + 114, "DEVSEL#", range(3, 8))
    level(c, y + 138, "TRDY#", range(4, 8))
    c.dimension(WAVE_LEFT + 1.5 * CLOCK, WAVE_LEFT + 4.5 * CLOCK, y + 180, "latency: 3 cycles", size=11)
    c.text(WAVE_LEFT + 5 * CLOCK, y + 184, "REQ64# follows FRAME#, ACK64# follows DEVSEL#", size=11, kind="tu")


def records(c):
    y = 706
    c.text(10, y, "*Records leave the SRAM ring packed: two records of 7 words are seven beats of 64 bits", size=14)
    for beat in range(7):
        for half in range(2):
            word = 2 * beat + half
            x = 10 + beat * 114 + half * 54
            names = ("CP x", "CP y", "CP z", "flags", "index", "T", "prim.")
            c.box(x, y + 14, 54, 26, names[word % 7], "fb" if word < 7 else "fg", 11)
        c.text(10 + beat * 114 + 54, y + 56, f"beat {beat}", "middle", 11, "tu")


def picture(_root):
    c = Canvas(820, 776, "DMA transfers of the card over PCI",
               "The driver writes descriptors into a ring in host memory and moves the tail. The DMA engine reads a descriptor, looks up every "
               "page, moves the data in bursts and writes a completion record. Below: the words of descriptors and completion records, a PCI read "
               "burst signal by signal, and the packing of records.")
    for part in (ring, words, burst, records):
        part(c)
    return c
