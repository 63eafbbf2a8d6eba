# SPDX-License-Identifier: Apache-2.0
"""Colours, fonts and estimated widths of text of the diagrams in docs/images."""

SANS = 'system-ui,-apple-system,"Segoe UI",Roboto,"Helvetica Neue",Arial,sans-serif'
MONO = 'ui-monospace,SFMono-Regular,Menlo,Consolas,"DejaVu Sans Mono",monospace'

# Every colour on white, and on #0d1117. The background stays transparent.
LIGHT = {
    "text": "#1f2328", "muted": "#59636e", "edge": "#818b98", "plain": "#f6f8fa", "grid": "#d1d9e0",
    "blue": "#0969da", "blue_fill": "#ddf4ff", "amber": "#9a6700", "amber_fill": "#fff8c5",
    "green": "#1a7f37", "green_fill": "#dafbe1", "red": "#cf222e", "red_fill": "#ffebe9",
    "purple": "#8250df", "purple_fill": "#fbefff",
}
DARK = {
    "text": "#e6edf3", "muted": "#9da7b3", "edge": "#7d8590", "plain": "#161b22", "grid": "#30363d",
    "blue": "#58a6ff", "blue_fill": "#0f2440", "amber": "#d29922", "amber_fill": "#2b2310",
    "green": "#3fb950", "green_fill": "#11281a", "red": "#f85149", "red_fill": "#33191b",
    "purple": "#bc8cff", "purple_fill": "#241a38",
}

HUES = ("blue", "amber", "green", "red", "purple")


def rules(colours):
    """Classes of one colour scheme: text tX, filled shapes fX, lines lX, solid marks mX."""
    made = {
        "tx": f"fill:{colours['text']}", "tu": f"fill:{colours['muted']}",
        "fn": f"fill:{colours['plain']};stroke:{colours['edge']}",
        "fo": f"fill:none;stroke:{colours['edge']}", "fz": f"fill:none;stroke:{colours['muted']};stroke-dasharray:5 4",
        "lx": f"fill:none;stroke:{colours['text']}", "lu": f"fill:none;stroke:{colours['muted']}",
        "lh": f"fill:none;stroke:{colours['grid']}", "mx": f"fill:{colours['text']}", "mu": f"fill:{colours['muted']}",
        "mh": f"fill:{colours['grid']}",
    }
    for hue in HUES:
        made[f"t{hue[0]}"] = f"fill:{colours[hue]}"
        made[f"f{hue[0]}"] = f"fill:{colours[hue + '_fill']};stroke:{colours[hue]}"
        made[f"l{hue[0]}"] = f"fill:none;stroke:{colours[hue]}"
        made[f"m{hue[0]}"] = f"fill:{colours[hue]}"
    return made


def sheet(used):
    """The style element for the classes that a picture uses."""
    light, dark = rules(LIGHT), rules(DARK)
    names = sorted(name for name in used if name in light)
    lines = [f"text{{font-family:{SANS}}}", f".c{{font-family:{MONO}}}", ".b{font-weight:600}", ".i{font-style:italic}"]
    lines += [f".{name}{{{light[name]}}}" for name in names]
    lines += ["@media (prefers-color-scheme:dark){"] + [f".{name}{{{dark[name]}}}" for name in names] + ["}"]
    return "<style>\n" + "\n".join(lines) + "\n</style>"


# Advance widths of DejaVu Sans, the widest of the usual fonts, in hundredths of the size: characters 32 to 126.
ADVANCES = (
    32, 40, 46, 84, 64, 95, 78, 27, 39, 39, 50, 84, 32, 36, 32, 34, 64, 64, 64, 64, 64, 64, 64, 64, 64, 64, 34, 34, 84, 84, 84, 53,
    100, 68, 69, 70, 77, 63, 58, 77, 75, 29, 29, 66, 56, 86, 75, 79, 60, 79, 69, 63, 61, 73, 68, 99, 69, 61, 69, 39, 34, 39, 84, 50,
    50, 61, 63, 55, 63, 62, 35, 63, 63, 28, 28, 58, 28, 97, 63, 61, 63, 63, 41, 52, 39, 63, 59, 82, 59, 59, 52, 64, 34, 64, 84)
OTHERS = {"·": 32, "°": 50, "²": 40, "³": 40, "–": 50, "ö": 61, "√": 64, "…": 100, "₀": 40, "₁": 40, "₂": 40}


def width(text, size, mono=False, bold=False):
    """Estimated width of a text, on the safe side."""
    if mono:
        return 0.602 * size * len(text)
    hundredths = sum(ADVANCES[ord(c) - 32] if " " <= c <= "~" else OTHERS.get(c, 84) for c in text)
    return hundredths / 100 * size * (1.12 if bold else 1)
