# SPDX-License-Identifier: Apache-2.0
"""A picture: shapes, lines and texts that know where they are, written as SVG and checked for texts that collide."""
import html
import math

import style


def number(value):
    """A coordinate, to a hundredth."""
    short = f"{value:.2f}".rstrip("0").rstrip(".")
    return "0" if short == "-0" else short


def points_text(points):
    return " ".join(f"{number(x)},{number(y)}" for x, y in points)


class Text:
    """A text with its box on the picture, and the shape that has to hold it, if one does."""

    def __init__(self, words, left, top, right, bottom, holder):
        self.words, self.left, self.top, self.right, self.bottom, self.holder = words, left, top, right, bottom, holder


class Canvas:
    """Lines of a text may begin with a mark: * bold, ~ muted, ` code; one of these may follow another."""

    def __init__(self, width, height, title, description):
        self.width, self.height, self.title, self.description = width, height, title, description
        self.parts, self.texts, self.segments, self.used = [], [], [], set()

    # ---- Elements ----
    def put(self, element, *classes):
        self.used.update(c for group in classes for c in group.split())
        self.parts.append(element)

    def text(self, x, y, words, anchor="start", size=13, kind="tx", holder=None):
        """One line; y is its baseline."""
        marks = {"*": "b", "~": "tu", "`": "c", "/": "i"}
        classes = [kind]
        while words and words[0] in marks and len(words) > 1:
            mark = marks[words[0]]
            classes = [mark] if mark == "tu" and classes == ["tx"] else classes + [mark]
            words = words[1:]
        wide = style.width(words, size, "c" in classes, "b" in classes)
        left = x - {"start": 0, "middle": wide / 2, "end": wide}[anchor]
        self.texts.append(Text(words, left, y - 0.76 * size, left + wide, y + 0.22 * size, holder))
        where = "" if anchor == "start" else f' text-anchor="{anchor}"'
        self.put(f'<text x="{number(x)}" y="{number(y)}" font-size="{number(size)}"{where} class="{" ".join(classes)}">'
                 f"{html.escape(words, quote=False)}</text>", *classes)

    def texts_at(self, x, y, lines, anchor="start", size=13, leading=None, kind="tx"):
        """Several lines from a first baseline on; returns the baseline behind them."""
        for line in lines:
            self.text(x, y, line, anchor, size, kind)
            y += leading or size * 1.35
        return y

    def rect(self, x, y, wide, high, kind="fn", radius=4, dash=False, solid=True):
        extra = ' stroke-dasharray="5 4"' if dash else ""
        self.put(f'<rect x="{number(x)}" y="{number(y)}" width="{number(wide)}" height="{number(high)}" rx="{radius}" class="{kind}"{extra}/>', kind)
        if solid:
            corners = [(x, y), (x + wide, y), (x + wide, y + high), (x, y + high), (x, y)]
            self.segments += list(zip(corners, corners[1:]))

    def box(self, x, y, wide, high, lines, kind="fn", size=13, align="middle", top=None, leading=None, dash=False):
        """A box with lines in its middle, or from a given distance to its upper edge on."""
        self.rect(x, y, wide, high, kind, dash=dash)
        lines = [lines] if isinstance(lines, str) else lines
        step = leading or size * 1.32
        first = y + (top if top is not None else (high - step * len(lines)) / 2 + step * 0.74)
        holder = (x, y, x + wide, y + high)
        for i, line in enumerate(lines):
            if line:
                at = {"middle": x + wide / 2, "start": x + 10, "end": x + wide - 10}[align]
                self.text(at, first + i * step, line, align, size, holder=holder)

    def line(self, points, kind="lx", thick=1.4, dash=None, solid=True, close=False):
        extra = f' stroke-dasharray="{dash}"' if dash else ""
        name = "polygon" if close else "polyline"
        self.put(f'<{name} points="{points_text(points)}" stroke-width="{number(thick)}" stroke-linejoin="round"{extra} class="{kind}"/>', kind)
        if solid:
            ends = list(points) + ([points[0]] if close else [])
            self.segments += list(zip(ends, ends[1:]))

    def head(self, tip, back, kind="mx", size=7):
        """An arrow's head at tip, coming from back."""
        dx, dy = tip[0] - back[0], tip[1] - back[1]
        length = math.hypot(dx, dy) or 1
        dx, dy = dx / length, dy / length
        base = (tip[0] - dx * size, tip[1] - dy * size)
        side = size * 0.45
        self.put(f'<polygon points="{points_text([tip, (base[0] - dy * side, base[1] + dx * side), (base[0] + dy * side, base[1] - dx * side)])}" '
                 f'class="{kind}"/>', kind)
        return tip[0] - dx * size * 0.8, tip[1] - dy * size * 0.8

    def arrow(self, *points, hue="x", thick=1.4, both=False, dash=None, size=7):
        """A line through points with a head at its end, or at both."""
        points = list(points)
        points[-1] = self.head(points[-1], points[-2], f"m{hue}", size)
        if both:
            points[0] = self.head(points[0], points[1], f"m{hue}", size)
        self.line(points, f"l{hue}", thick, dash)

    def polygon(self, points, kind="fn", thick=1.4, solid=False):
        self.line(points, kind, thick, solid=solid, close=True)

    def circle(self, x, y, radius, kind="fn", thick=1.4, dash=None):
        extra = f' stroke-dasharray="{dash}"' if dash else ""
        self.put(f'<circle cx="{number(x)}" cy="{number(y)}" r="{number(radius)}" stroke-width="{number(thick)}"{extra} class="{kind}"/>', kind)

    def ellipse(self, x, y, rx, ry, kind="fn", turn=0, thick=1.4, dash=None):
        extra = f' stroke-dasharray="{dash}"' if dash else ""
        extra += f' transform="rotate({number(turn)} {number(x)} {number(y)})"' if turn else ""
        self.put(f'<ellipse cx="{number(x)}" cy="{number(y)}" rx="{number(rx)}" ry="{number(ry)}" stroke-width="{number(thick)}"{extra} class="{kind}"/>',
            kind)

    def dot(self, x, y, kind="mx", radius=3):
        self.put(f'<circle cx="{number(x)}" cy="{number(y)}" r="{number(radius)}" class="{kind}"/>', kind)

    def dimension(self, x0, x1, y, label, hue="u", size=12):
        """A horizontal dimension line with its label above."""
        for x in (x0, x1):
            self.line([(x, y - 4), (x, y + 4)], f"l{hue}", 1, solid=False)
        self.arrow((x0, y), (x1, y), hue=hue, thick=1, both=True, size=5)
        self.text((x0 + x1) / 2, y - 5, label, "middle", size, kind=f"t{hue}")

    # ---- Result ----
    def svg(self):
        size = f'viewBox="0 0 {number(self.width)} {number(self.height)}" width="{number(self.width)}" height="{number(self.height)}"'
        head = ["<!-- SPDX-License-Identifier: Apache-2.0; written by tools/diagrams -->",
                f'<svg xmlns="http://www.w3.org/2000/svg" {size} role="img" aria-labelledby="title desc">',
                f'<title id="title">{html.escape(self.title, quote=False)}</title>',
                f'<desc id="desc">{html.escape(self.description, quote=False)}</desc>', style.sheet(self.used)]
        return "\n".join(head + self.parts + ["</svg>", ""])

    def problems(self):
        """Texts that leave the picture or their box, that overlap, or that a line runs through."""
        found = []
        for i, text in enumerate(self.texts):
            if text.left < 1 or text.right > self.width - 1 or text.top < 0 or text.bottom > self.height:
                found.append(f"'{text.words}' leaves the picture")
            if text.holder and (text.left < text.holder[0] + 3 or text.right > text.holder[2] - 3 or
                                text.top < text.holder[1] + 1 or text.bottom > text.holder[3] - 1):
                found.append(f"'{text.words}' leaves its box ({text.right - text.left:.0f} wide)")
            found += [f"'{text.words}' overlaps '{other.words}'" for other in self.texts[i + 1:] if
                      text.left < other.right and other.left < text.right and text.top < other.bottom - 1 and other.top < text.bottom - 1]
            found += [f"a line runs through '{text.words}' from {a} to {b}" for a, b in self.segments if crosses(text, a, b)]
        return found


def crosses(text, a, b):
    """Whether a segment runs through a text's box, less a pixel on every side."""
    low, high = 0.0, 1.0
    for start, end, least, most in ((a[0], b[0], text.left + 1, text.right - 1), (a[1], b[1], text.top + 1.5, text.bottom - 1.5)):
        step = end - start
        if abs(step) < 1e-9:
            if start <= least or start >= most:
                return False
            continue
        first, second = sorted(((least - start) / step, (most - start) / step))
        low, high = max(low, first), min(high, second)
    return low < high
