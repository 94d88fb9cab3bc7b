"""Where an exception was raised, in the words of a person who has to mend it."""

from __future__ import annotations

import linecache
import traceback
from pathlib import Path
from types import FrameType


def raised_at(error: BaseException, module: str) -> str:
    """`pkg/turn.py:31: speed = 1 / 0`: the innermost line of a plug-in that an exception passed.

    module: a module of the plug-in; all modules of its package count. Empty if the exception passed
    none of them. The file is relative to the folder that holds the package, so that it is the same
    on every machine.
    """
    top = module.partition(".")[0]
    passed = traceback.walk_tb(error.__traceback__)
    mine = [each for each in passed if _module(each[0]).partition(".")[0] == top]
    if not mine:
        return ""
    frame, line = mine[-1]
    code = linecache.getline(frame.f_code.co_filename, line).strip()
    return f"{_file(frame)}:{line}" + (f": {code}" if code else "")


def _module(frame: FrameType) -> str:
    return str(frame.f_globals.get("__name__", ""))


def _file(frame: FrameType) -> str:
    """The file, from its top-level package on."""
    path, module = Path(frame.f_code.co_filename), _module(frame)
    depth = module.count(".") + (path.name == "__init__.py")
    inside = path.with_suffix("").parts[-depth - 1 :]
    named = ".".join(inside).removesuffix(".__init__")
    return "/".join(path.parts[-depth - 1 :]) if named == module else path.name
