"""Texts of files: read within bounds, the characters they may have, comments in them."""

from __future__ import annotations

import re
from pathlib import Path

from momantu_bt.formats.places import Place
from momantu_bt.formats.problems import Problem

NOT_TEXT = re.compile(r"[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")
"""Control characters and the like, which stand in values alone: XML cannot hold them."""


class Beside(str):
    """A comment at the end of the line of what it belongs to; a plain text stands above it."""


class TextError(Exception):
    """A file is too long, or not UTF-8; `problem` says where."""

    def __init__(self, problem: Problem) -> None:
        super().__init__(f"{problem.place}: {problem.message}")
        self.problem = problem


def read_text(path: Path, shown: str, what: str, most_bytes: int) -> str:
    """The text of a file, without a byte order mark.

    shown: its name in places. what: what a person calls such a file, in messages.

    Raises:
        OSError: it cannot be read.
        TextError: it has more than `most_bytes`, or is not UTF-8.
    """
    with path.open("rb") as file:
        data = file.read(most_bytes + 1)
    if len(data) > most_bytes:
        message = f"the file has {path.stat().st_size} bytes; a {what} has at most {most_bytes}"
        raise TextError(Problem("too-large", message, Place(shown)))
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = data.count(b"\n", 0, error.start) + 1
        column = error.start - (data.rfind(b"\n", 0, error.start) + 1) + 1
        place = Place(shown, line, column)
        problem = Problem("syntax", "the file is not UTF-8 text", place, "save it as UTF-8")
        raise TextError(problem) from None
