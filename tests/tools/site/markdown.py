"""Markdown as the site and its tests need it: what is code and what is not, links, headings and their anchors."""

import re
from collections.abc import Callable, Iterator
from typing import NamedTuple

FENCE = re.compile(r"^( *)(```+|~~~+) *([\w+-]*)")
LINK = re.compile(r"(!?)\[((?:[^\[\]]|\[[^\]]*\])*)\]\(([^()\s]+)\)")
CODE_SPAN = re.compile(r"(`+)(?!`).+?(?<!`)\1(?!`)")
HEADING = re.compile(r"^#{1,6} +(.*?) *#*$")


class Block(NamedTuple):
    """A code block: fenced, or indented by four."""

    language: str  # empty where none is named
    text: str
    line: int  # of its first line of text, from 1


def parts(text: str) -> Iterator[tuple[bool, str]]:
    """The lines with their ends: is it code, and the line."""
    fence, blank, indented = "", True, False
    for line in text.splitlines(keepends=True):
        found = FENCE.match(line)
        if fence:
            yield True, line
            fence = "" if line.strip() == fence else fence
            continue
        if found and not indented:
            fence = found[2]
            yield True, line
            continue
        indented = line.startswith("    ") and (blank or indented)
        blank = not line.strip()
        yield indented, line


def prose(text: str, change: Callable[[str], str]) -> str:
    """The text with every line that is not code changed."""
    return "".join(line if code else change(line) for code, line in parts(text))


def blocks(text: str) -> list[Block]:
    """All code blocks in their order."""
    found: list[Block] = []
    language, kept, first = None, [], 0
    for number, (code, line) in enumerate([*parts(text), (False, "")], 1):
        fence = FENCE.match(line) if code else None
        if fence and language in (None, ""):
            language, kept, first = fence[3] or "text", [], number + 1
        elif code and language is None:
            language, kept, first = "", [line[4:]], number
        elif code and not fence:
            kept.append(line[4:] if language == "" else line)
        elif language is not None:
            found.append(Block(language, "".join(kept), first))
            language = None
    return found


def links(text: str) -> list[tuple[str, int]]:
    """The addresses of links and pictures outside code, and their lines."""
    found = []
    for number, (code, line) in enumerate(parts(text), 1):
        if not code:
            found += [(address, number) for _, _, address in LINK.findall(CODE_SPAN.sub("", line))]
    return found


def rewritten(text: str, change: Callable[[str], str]) -> str:
    """The text with every link outside code leading where `change` says."""
    return prose(text, lambda line: LINK.sub(lambda m: f"{m[1]}[{m[2]}]({change(m[3])})", line))


def anchors(text: str) -> list[str]:
    """The anchors of the headings, as the site makes them: repeated ones get a number."""
    found: list[str] = []
    for code, line in parts(text):
        heading = None if code else HEADING.match(line)
        if heading:
            found.append(_free(slug(heading[1]), found))
    return found


def slug(heading: str) -> str:
    """The anchor of a heading by Python-Markdown's rule."""
    words = re.sub(r"[^\w\s-]", "", LINK.sub(r"\2", heading)).strip().lower()
    return re.sub(r"[-\s]+", "-", words)


def _free(anchor: str, taken: list[str]) -> str:
    number = 0
    while (name := f"{anchor}_{number}" if number else anchor) in taken:
        number += 1
    return name
