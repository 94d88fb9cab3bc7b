"""What both formats share: version, valid names of trees, handlers' codes; and how to tell them."""

from __future__ import annotations

import re
from pathlib import Path

from momantu_bt.failure import CODE
from momantu_bt.formats.places import Place
from momantu_bt.tree.problems import Problems

VERSION = 1
"""The version of the language, the value of `momantu_bt:`."""

TREE_NAME = re.compile(r"[^\W\d][\w.-]*(?: [\w.-]+)*")
"""Valid names of trees; as in BehaviorTree.CPP they may have more than letters."""
TREE_NAME_HINT = "letters, digits, `_`, `-`, `.` and single spaces, a letter first"

AGAIN = "again"
"""The handler that tries again without running a node."""
ANY = "any"
"""The code of a handler for all other codes."""
_HANDLER_CODE = re.compile(rf"(?:\w+\.)?{CODE.pattern}|{ANY}")

FAILURE_KEY = "failure"
"""The key from which a handler reads the failure."""


def handler_codes(text: str, place: Place, problems: Problems) -> tuple[str, ...]:
    """The codes of a handler (`A | B`); an invalid code is reported and left out."""
    codes = tuple(part.strip() for part in text.split("|"))
    wrong = dict.fromkeys(code for code in codes if not _HANDLER_CODE.fullmatch(code))
    for code in wrong:
        hint = "codes are upper-case words, `A | B` several, `any` the rest"
        problems.error("bad-code", place, f"{code!r} is not a failure code", hint)
    return tuple(code for code in codes if code not in wrong)


def is_xml(file: str, content: str) -> bool:
    """Whether a tree file is XML, by its suffix or, for other suffixes, by its first character."""
    suffix = Path(file).suffix.lower()
    if suffix in (".yaml", ".yml"):
        return False
    return suffix in (".xml", ".btproj") or content.lstrip("\ufeff \t\r\n").startswith("<")
