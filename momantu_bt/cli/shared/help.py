"""Format a verb's docstring as its help."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any


def help_of(verb: Callable[..., Any]) -> str:
    """A verb's docstring; the lines of its examples stay lines."""
    paragraphs = (verb.__doc__ or "").split("\n\n")
    return "\n\n".join(
        "\b\n" + paragraph if paragraph.strip().startswith("Examples:") else paragraph
        for paragraph in map(_dedented, paragraphs)
    )


def _dedented(paragraph: str) -> str:
    lines = paragraph.strip("\n").splitlines()
    widths = [len(line) - len(line.lstrip()) for line in lines[1:] if line.strip()]
    margin = min(widths, default=0)
    first = lines[0].lstrip() if lines else ""
    return "\n".join([first, *(line[margin:] for line in lines[1:])])
