"""Texts of files: reading them up to a size limit, valid characters, comments."""

from __future__ import annotations

import re
from pathlib import Path

from momantu_bt.formats.places import Place
from momantu_bt.formats.problems import Problem

NOT_TEXT = re.compile(r"[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")
"""Control characters and other characters that XML cannot contain."""


class Beside(str):
    """A comment at the end of a line. A comment on a line of its own is a plain `str`."""


class TextError(Exception):
    """A file is too long, or not UTF-8; `problem` says where."""

    def __init__(self, problem: Problem) -> None:
        super().__init__(f"{problem.place}: {problem.message}")
        self.problem = problem


def read_text(path: Path, shown: str, what: str, most_bytes: int) -> str:
    """The text of a file, without a byte order mark.

    shown: the file's name in messages. what: what messages call this kind of file.

    Raises:
        OSError: the file cannot be read.
        TextError: the file has more than `most_bytes`, or is not UTF-8.
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
