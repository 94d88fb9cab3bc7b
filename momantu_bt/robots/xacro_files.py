"""Expand xacro files, without ROS.

A xacro file is a program: it evaluates Python expressions, reads files and the environment. The
`xacro` package hides Python's built-in functions from expressions, but a malicious file can get
around that. Expand only files that you trust.
"""

from __future__ import annotations

import sys
import threading
import xml.parsers.expat
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from types import ModuleType

from momantu_bt.formats.names import nearest
from momantu_bt.formats.places import KeyPath
from momantu_bt.lazy import lazily
from momantu_bt.robots.errors import PartError
from momantu_bt.robots.packages import Packages
from momantu_bt.robots.xacro_packages import missing_packages

with lazily():
    import xacro


_LOCK = threading.Lock()
"""xacro keeps its state in module variables."""
_INDEX = "ament_index_python"
"""ROS's package index; xacro looks up the packages of `$(find …)` in it."""


def expand(
    path: Path, args: Mapping[str, object], packages: Packages, place: KeyPath
) -> tuple[bytes, tuple[Path, ...]]:
    """The URDF that a xacro file gives, and the files that it includes.

    packages: in which `$(find x)` is looked up.

    Raises:
        PartError: xacro reports an error; the message has its words and the file.
    """
    given = {name: _argument(value) for name, value in args.items()}
    with _LOCK, _package_index(packages) as missing:
        xacro.all_includes.clear()
        try:
            document = xacro.process_file(str(path), mappings=given)
        except Exception as error:  # expressions of the file may raise anything
            told = (xacro.XacroException, xml.parsers.expat.ExpatError, OSError)
            words = str(error) if isinstance(error, told) else f"{type(error).__name__}: {error}"
            words = _with_others(missing[-1], path, packages) if missing else words
            raise PartError(place, _said(path, words, xacro.filestack)) from None
        included = tuple(dict.fromkeys(Path(str(each)) for each in xacro.all_includes))
    return document.toxml().encode(), included


def _with_others(words: str, path: Path, packages: Packages) -> str:
    """A sentence about a missing package, and after it the others that will be asked for."""
    every = missing_packages(path, packages)
    if len(every) < 2:
        return words
    return (
        f"{words}. {len(every)} packages that the file and its includes name cannot be found: "
        f"{', '.join(every)}; its arguments decide which of them are used"
    )


def _argument(value: object) -> str:
    return str(value).lower() if isinstance(value, bool) else str(value)


def _said(path: Path, message: str, stack: list[str | None]) -> str:
    inner = next((name for name in reversed(stack or []) if name), str(path))
    within = "" if Path(inner) == path else f", included from {path.name}"
    return f"xacro cannot expand {inner}{within}: {message.strip()}"


@contextmanager
def _package_index(packages: Packages) -> Iterator[list[str]]:
    """Stand in for ROS's package index while a file is expanded.

    Yields: sentences about requested packages that are missing.
    """
    missing: list[str] = []

    def find(name: str) -> str:
        try:
            return str(_package(name, packages))
        except LookupError as error:
            missing.append(str(error))
            raise

    index, finder = ModuleType(_INDEX), ModuleType(f"{_INDEX}.packages")
    finder.get_package_share_directory = find  # type: ignore[attr-defined]
    mine = {index.__name__: index, finder.__name__: finder}
    before = {name: sys.modules.get(name) for name in mine}
    sys.modules.update(mine)
    try:
        yield missing
    finally:
        for name, module in before.items():
            if module is None:
                del sys.modules[name]
            else:
                sys.modules[name] = module


def _package(name: str, packages: Packages) -> Path:
    """The folder that `$(find name)` means."""
    found = packages.find(name)
    if found is not None:
        return found
    beside = sorted(p.name for p in packages.folder.iterdir() if p.is_dir())
    near = nearest(name, beside)
    hint = f" (did you mean {near!r}?)" if near else ""
    raise LookupError(
        f"$(find {name}) is neither a folder beside the robot file nor any other package that can "
        f"be found{hint}; {packages.searched()}"
    )
