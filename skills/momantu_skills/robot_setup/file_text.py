"""Texts of a robot file: numbers, paths, comments."""

from __future__ import annotations

from collections.abc import Iterator


def number(value: float, digits: int = 4) -> str:
    """A number as a person writes it."""
    text = f"{value:.{digits}f}".rstrip("0").rstrip(".")
    return "0" if text in ("-0", "") else text


def path_text(value: str) -> str:
    """A path as YAML takes it."""
    plain = all(letter.isalnum() or letter in "/._-" for letter in value)
    return value if plain else '"' + value.replace("\\", "\\\\").replace('"', '\\"') + '"'


def comment(text: str, indent: str = "", width: int = 98) -> Iterator[str]:
    """Lines of a comment, none longer than the width where its words allow."""
    line = f"{indent}#"
    for word in text.split():
        if len(line) + 1 + len(word) > width and line != f"{indent}#":
            yield line
            line = f"{indent}#"
        line += f" {word}"
    yield line
