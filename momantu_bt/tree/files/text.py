"""Reading tree files as text, and telling YAML from XML."""

from __future__ import annotations

from pathlib import Path

from momantu_bt.formats.places import Place
from momantu_bt.formats.problems import Problem
from momantu_bt.tree.files.lookup import TreeNotFound
from momantu_bt.tree.files.syntax import MAX_BYTES
from momantu_bt.tree.problems import TreeError


def read_text(path: Path, shown: str) -> str:
    """A file's text; of one that is too long a little more than is allowed.

    shown: the file's name in what is reported.

    Raises:
        TreeNotFound: it cannot be read.
        TreeError: it is not UTF-8.
    """
    try:
        with path.open("rb") as file:
            data = file.read(MAX_BYTES + 1)
        return data.decode("utf-8-sig")
    except OSError as error:
        raise TreeNotFound(f"{shown} cannot be read: {error.strerror}") from None
    except UnicodeDecodeError as error:
        line = data.count(b"\n", 0, error.start) + 1
        column = error.start - (data.rfind(b"\n", 0, error.start) + 1) + 1
        place = Place(shown, line, column)
        problem = Problem("syntax", "the file is not UTF-8 text", place, "save it as UTF-8")
        raise TreeError([problem], {}) from None


def is_xml(file: str, text: str) -> bool:
    """By the suffix; where that says nothing, by the first character."""
    suffix = Path(file).suffix.lower()
    if suffix in (".yaml", ".yml"):
        return False
    return suffix in (".xml", ".btproj") or text.lstrip("\ufeff \t\r\n").startswith("<")
