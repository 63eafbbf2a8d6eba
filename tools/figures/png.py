# SPDX-License-Identifier: Apache-2.0
"""Reads and writes PNG of 8 bits a channel, to make pictures smaller without loss."""
import struct
import zlib

CHANNELS = {0: 1, 2: 3, 4: 2, 6: 4}


def paeth(a, b, c):
    p = a + b - c
    pa, pb, pc = abs(p - a), abs(p - b), abs(p - c)
    return a if pa <= pb and pa <= pc else b if pb <= pc else c


def predictor(kind, line, above, step):
    """What a filter takes off each byte of a line."""
    left = bytes(step) + line[:-step]
    if kind == 1:
        return left
    if kind == 2:
        return above
    if kind == 3:
        return bytes((a + b) // 2 for a, b in zip(left, above))
    return bytes(paeth(a, b, c) for a, b, c in zip(left, above, bytes(step) + above[:-step]))


def unfilter(kind, line, above, step):
    line = bytearray(line)
    for i, value in enumerate(line):
        a = line[i - step] if i >= step else 0
        c = above[i - step] if i >= step else 0
        line[i] = (value + (0, a, above[i], (a + above[i]) // 2, paeth(a, above[i], c))[kind]) & 255
    return bytes(line)


def read(data):
    """Width, height, type of colour, and the lines of a picture."""
    if data[:8] != b"\x89PNG\r\n\x1a\n":
        raise OSError("not a PNG")
    at, packed, head = 8, b"", None
    while at < len(data):
        length, name = struct.unpack(">I4s", data[at:at + 8])
        body = data[at + 8:at + 8 + length]
        if name == b"IHDR":
            head = struct.unpack(">IIBBBBB", body)
        elif name == b"IDAT":
            packed += body
        at += 12 + length
    wide, high, depth, colour, _, _, interlace = head
    if depth != 8 or colour not in CHANNELS or interlace:
        raise OSError("a PNG of another kind than 8 bits a channel, without palette")
    step = CHANNELS[colour]
    raw, lines, above = zlib.decompress(packed), [], bytes(wide * step)
    for y in range(high):
        start = y * (wide * step + 1)
        above = unfilter(raw[start], raw[start + 1:start + 1 + wide * step], above, step)
        lines.append(above)
    return wide, high, colour, lines


def chunk(name, body):
    return struct.pack(">I", len(body)) + name + body + struct.pack(">I", zlib.crc32(name + body))


def write(wide, high, colour, lines):
    """Filters line by line: the one with the smallest differences."""
    step, above, raw = CHANNELS[colour], bytes(len(lines[0])), bytearray()
    for line in lines:
        best = min(((sum(min(d, 256 - d) for d in differences), kind, differences) for kind in range(5)
                    for differences in [bytes((a - b) & 255 for a, b in zip(line, predictor(kind, line, above, step))) if kind else line]))
        raw += bytes([best[1]]) + best[2]
        above = line
    head = struct.pack(">IIBBBBB", wide, high, 8, colour, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(bytes(raw), 9)) + chunk(b"IEND", b"")


def smaller(data):
    """The same picture in fewer bytes."""
    again = write(*read(data))
    return again if len(again) < len(data) else data
