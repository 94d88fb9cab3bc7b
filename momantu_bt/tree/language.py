"""What both formats share: version, valid names of trees, handlers' codes; and how to tell them."""

from __future__ import annotations

import re
from pathlib import Path

from momantu_bt.failure import CODE
from momantu_bt.formats.places import Place
from momantu_bt.tree.problems import Problems

VERSION = 1
"""The version of the language, the value of `momantu_bt:`."""

TREE_NAME = re.compile(r"[^\s$/\\\x00-\x1f\x7f](?:[^$/\\\x00-\x1f\x7f]*[^\s$/\\\x00-\x1f\x7f])?")
"""Valid names of trees; as in BehaviorTree.CPP they may have more than letters."""
TREE_NAME_HINT = "any text on one line without `$`, `/` and backslash, no space at its ends"

_STARTS = (
    "A-Z_a-z\u00c0-\u00d6\u00d8-\u00f6\u00f8-\u02ff\u0370-\u037d\u037f-\u1fff\u200c-\u200d"
    "\u2070-\u218f\u2c00-\u2fef\u3001-\ud7ff\uf900-\ufdcf\ufdf0-\ufffd\U00010000-\U000effff"
)
NODE_NAME = re.compile(rf"[{_STARTS}][{_STARTS}0-9.\u00b7\u0300-\u036f\u203f-\u2040-]*")
"""Valid names of plug-ins that are nodes of trees: those of XML elements, without a colon."""
NODE_NAME_HINT = "letters, digits, `_`, `-` and `.`, a letter or `_` first, as in XML"

AGAIN = "again"
"""The handler that tries again without running a node."""
ANY = "any"
"""The code of a handler for all other codes."""
_HANDLER_CODE = re.compile(rf"(?:{NODE_NAME.pattern}\.)?{CODE.pattern}|{ANY}")

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


def is_handler(text: str) -> bool:
    """Whether a text is the code of a handler, or several."""
    return all(_HANDLER_CODE.fullmatch(part.strip()) for part in text.split("|"))


def is_xml(file: str, content: str) -> bool:
    """Whether a tree file is XML, by its suffix or, for other suffixes, by its first character."""
    suffix = Path(file).suffix.lower()
    if suffix in (".yaml", ".yml"):
        return False
    return suffix in (".xml", ".btproj") or content.lstrip("\ufeff \t\r\n").startswith("<")
