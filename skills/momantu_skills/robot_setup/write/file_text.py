"""Texts of a robot file: numbers, names, paths, comments."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator

from momantu_bt.formats.yaml import writer


def number(value: float, digits: int = 4) -> str:
    """A number as a person writes it."""
    text = f"{value:.{digits}f}".rstrip("0").rstrip(".")
    return "0" if text in ("-0", "") else text


def scalar(value: str) -> str:
    """A name or a path as YAML takes it: quoted where it would be read as anything else."""
    return writer.scalar(value, flow=True)


def quoted(value: str) -> str:
    """A text as YAML takes it: always in quotes, so that it stays a text."""
    return json.dumps(value, ensure_ascii=False)


def listed(names: Iterable[str]) -> str:
    """Names as a list in one line."""
    return f"[{', '.join(map(scalar, names))}]"


def comment(text: str, indent: str = "", width: int = 98) -> Iterator[str]:
    """Lines of a comment, none longer than the width where its words allow."""
    line = f"{indent}#"
    for word in text.split():
        if len(line) + 1 + len(word) > width and line != f"{indent}#":
            yield line
            line = f"{indent}#"
        line += f" {word}"
    yield line
