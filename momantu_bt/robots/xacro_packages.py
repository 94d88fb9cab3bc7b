"""The packages that a xacro file and its includes name, found without running any of it.

xacro stops at the first package that is missing. A reader who is told of one after another has to
start again for each, so that all that can be seen from the text are told at once.
"""

from __future__ import annotations

import re
from pathlib import Path

from momantu_bt.robots.packages import Packages

_FIND = re.compile(r"\$\(find\s+([\w.-]+)\s*\)")
_INCLUDE = re.compile(r"<xacro:include\b[^>]*?\bfilename\s*=\s*([\"'])(.*?)\1", re.DOTALL)
_COMMENT = re.compile(r"<!--.*?-->", re.DOTALL)


def missing_packages(path: Path, packages: Packages) -> tuple[str, ...]:
    """Packages that `$(find …)` names in a file or its includes and that cannot be found.

    In the order in which they stand. Conditions are not evaluated: with the arguments that were
    given, not each of them need be used. What an argument or a property names cannot be seen.
    """
    missing: dict[str, None] = {}
    seen: set[Path] = set()
    waiting = [path.resolve()]
    while waiting:
        file = waiting.pop(0)
        if file in seen:
            continue
        seen.add(file)
        try:
            text = _COMMENT.sub("", file.read_text(encoding="utf-8", errors="replace"))
        except OSError:
            continue
        missing |= dict.fromkeys(n for n in _FIND.findall(text) if packages.find(n) is None)
        waiting += [
            found
            for _, name in _INCLUDE.findall(text)
            if (found := _included(name, file, packages))
        ]
    return tuple(missing)


def _included(name: str, by: Path, packages: Packages) -> Path | None:
    """The file that an include means; None where it is missing or only known when it runs."""
    found = _FIND.match(name)
    if found is not None:
        folder = packages.find(found[1])
        name = "" if folder is None else f"{folder}{name[found.end() :]}"
    if not name or "$" in name:
        return None
    file = (by.parent / name).resolve()
    return file if file.is_file() else None
