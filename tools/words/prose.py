# SPDX-License-Identifier: Apache-2.0
"""Prose of a file, as paragraphs: (line, text). Markdown pages, and comments of C++, SystemVerilog, Python and shell."""
import re

CODE_SPAN = re.compile(r"`[^`]*`")
LINK = re.compile(r"!?\[([^\]]*)\]\([^)]*\)")


def plain(text):
    """Without markup: code spans are one word, links are their text."""
    return LINK.sub(r"\1", CODE_SPAN.sub("X", text)).replace("**", "")


def paragraphs_of(lines):
    """Joins (line, text) that stand together; an empty text ends a paragraph."""
    first, parts, last = None, [], None
    for number, text in lines:
        if text and parts and number == last + 1:
            parts.append(text)
        else:
            if parts:
                yield first, " ".join(parts)
            first, parts = number, [text] if text else []
        last = number
    if parts:
        yield first, " ".join(parts)


def markdown(text):
    """Prose of a page. Code, tables' rules and HTML comments are left out; each cell of a table is a paragraph."""
    lines, fenced = [], False
    for number, line in enumerate(text.split("\n"), 1):
        if line.lstrip().startswith("```"):
            fenced = not fenced
            line = ""
        if fenced or line.startswith("    ") or line.startswith("<!--") or re.fullmatch(r"[|:\- ]+", line):
            lines.append((number, ""))
        elif line.startswith("|"):
            for cell in re.split(r"(?<!\\)\|", line.strip().strip("|")):
                lines.append((number, plain(cell).strip()))
                lines.append((number, ""))
        elif line.startswith("#"):
            lines += [(number, plain(line.lstrip("# "))), (number, "")]
        else:
            item = re.match(r"\s*([-*]|\d+\.) ", line)
            if item:
                lines.append((number, ""))
                line = line[item.end():]
            lines.append((number, plain(line).strip()))
    return list(paragraphs_of(lines))


NO_PROSE = re.compile(r"(SPDX|namespace |@|!/|-{3,}|NOLINT|shellcheck|clang-format|verilator|synopsys)")


def comment_of(line, mark, block):
    """The text of a line's comment, and whether a paragraph begins there: a list item, or a comment behind code."""
    stripped = line.strip()
    if mark == "//" and (block or stripped.startswith("/*")):
        return stripped.strip("/* "), False
    if not stripped.startswith(mark):
        tail = re.search(r"(?<![:\"'])//[/!<]* (.*)", line) if mark == "//" else re.search(r"  # (.*)", line)
        return (tail.group(1), True) if tail else ("", False)
    body = stripped.lstrip("/#!<")
    if body.startswith("     " if mark == "//" else "   "):  # a table or an example
        return "", False
    item = re.match(r"\s*- ", body)
    return (body[item.end():], True) if item else (body.strip(), False)


def comments(text, mark):
    """Prose of comments that begin with `mark` ("//" or "#"): whole lines and ends of lines. Licence lines and rules are left out."""
    lines = []
    block = False
    for number, line in enumerate(text.split("\n"), 1):
        body, begins = comment_of(line, mark, block)
        if mark == "//" and (block or line.strip().startswith("/*")):
            block = "*/" not in line
        if begins:
            lines.append((number, ""))
        if NO_PROSE.match(body):
            body = ""
        lines.append((number, re.sub(r"^-+ | -+$", "", plain(body)).strip()))
    return list(paragraphs_of(lines))


def of_file(path, text):
    if path.endswith(".md"):
        return markdown(text)
    if path.endswith((".cpp", ".hpp", ".h", ".sv", ".svh", ".c")):
        return comments(text, "//")
    return comments(text, "#")


def sentences(paragraph):
    """Sentences of a paragraph. A colon or semicolon ends none."""
    return [s for s in re.split(r"(?<=[.!?])[\")]*\s+(?=\S)", paragraph) if s]
