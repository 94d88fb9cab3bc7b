"""Reading tree files as text, and telling YAML from XML."""

from __future__ import annotations

from pathlib import Path

from momantu_bt.formats import text
from momantu_bt.formats.places import Place
from momantu_bt.formats.problems import Problem
from momantu_bt.tree.files.lookup import TreeNotFound
from momantu_bt.tree.files.syntax import MAX_BYTES, WHAT
from momantu_bt.tree.problems import TreeError


def checked_text(given: str, shown: str) -> str:
    """A text that is no file's, without a byte order mark; TreeError if it is too long."""
    size = len(given.encode("utf-8", "surrogatepass"))
    if size > MAX_BYTES:
        message = f"the text has {size} bytes; a {WHAT} has at most {MAX_BYTES}"
        raise TreeError([Problem("too-large", message, Place(shown))], {})
    return given.removeprefix("\ufeff")


def read_text(path: Path, shown: str) -> str:
    """A file's text. shown: the file's name in what is reported.

    Raises:
        TreeNotFound: it cannot be read.
        TreeError: it is too long, or not UTF-8.
    """
    try:
        return text.read_text(path, shown, WHAT, MAX_BYTES)
    except OSError as error:
        raise TreeNotFound(f"{shown} cannot be read: {error.strerror}") from None
    except text.TextError as error:
        raise TreeError([error.problem], {}) from None
