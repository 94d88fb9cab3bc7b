"""Slips that people make in XML trees, each at every place of a line where it can be made."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from typing import TypeAlias

Slip: TypeAlias = Callable[[str], Iterator[str]]
Change: TypeAlias = Callable[[re.Match[str]], str]


def each(pattern: str, *changes: Change, group: int = 1) -> Slip:
    """Change what a group of the pattern matches, at each of its places, in each of the ways."""

    def slips(line: str) -> Iterator[str]:
        for found in re.finditer(pattern, line):
            for change in changes:
                changed = line[: found.start(group)] + change(found) + line[found.end(group) :]
                if changed != line:
                    yield changed

    return slips


def lost(found: re.Match[str]) -> str:
    word = found[1]
    return word[: len(word) // 2] + word[len(word) // 2 + 1 :]


def swapped(found: re.Match[str]) -> str:
    word = found[1]
    return word[:-2] + word[-1] + word[-2]


_START = r"^\s*<"
XML_SLIPS: dict[str, Slip] = {
    "XML: typo in a tag": each(rf"{_START}((?:momantu:)?\w{{4,}})", lost, swapped),
    "XML: typo in a closing tag": each(r"^\s*</((?:momantu:)?\w{4,})", lost, swapped),
    "XML: typo in an attribute": each(r' ((?:momantu:)?\w{3,})="', lost, swapped),
    "XML: typo in a condition": each(r' (_\w{3,})="', lost, lambda m: m[1].lower()),
    "XML: typo in a wire": each(r'="\{@?(\w{4,})\}"', lost, swapped),
    "XML: typo in a tree": each(r' ID="(\w{4,})"', lost, swapped),
    "XML: typo in a value": each(r' (?:in_front_of|on|pose|surface)="([a-z_]{4,})"', lost, swapped),
    "XML: typo in a code": each(r' codes="([A-Z_]{4,})"', lost, swapped),
    "XML: braces forgotten": each(r'="(\{\w+\})"', lambda m: m[1][1:-1]),
    "XML: one brace forgotten": each(r'="\{\w+(\})"', lambda _: ""),
    "XML: dollar for braces": each(r'="(\{\w+\})"', lambda m: "$" + m[1][1:-1]),
    "XML: quote not opened": each(r'=(")', lambda _: ""),
    "XML: quote not closed": each(r'="[^"]*(")', lambda _: ""),
    "XML: equals forgotten": each(r'\w(=)"', lambda _: ""),
    "XML: tag not opened": each(r"^\s*(<)", lambda _: ""),
    "XML: tag not closed": each(r"(>)\s*$", lambda _: ""),
    "XML: element not closed": each(r"(/)>\s*$", lambda _: ""),
    "XML: closing tag left out": each(r"^(\s*</\w[^>]*>)$", lambda _: ""),
    "XML: attribute twice": each(r'( \w+="[^"]*")(?=.*/>)', lambda m: m[1] * 2),
    "XML: input left out": each(r'( (?:momantu:)?\w+="[^"]*")(?=.*/>)', lambda _: ""),
    "XML: unit in milliseconds": each(r'msec="(\d+)"', lambda _: "1s"),
    "XML: text for a number": each(
        r' (?:num_attempts|num_cycles|side|attempts|msec)="(\d+)"', lambda _: "many"
    ),
    "XML: unescaped sign": each(r"(&lt;|&amp;)", lambda m: "<" if m[1] == "&lt;" else "&"),
    "XML: line twice": each(r"^(\s*<[^/!?][^>]*[^/]>)$", lambda m: f"{m[1]}\n{m[1]}"),
    "XML: capital letter": each(rf"{_START}([a-z]\w{{3,}})[ /]", lambda m: m[1].upper()),
}
