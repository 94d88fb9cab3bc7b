"""Shared libraries that a package needs and the machine may lack: taken from another wheel."""

from __future__ import annotations

import ctypes
import importlib.util
from collections.abc import Iterable
from pathlib import Path

_loaded: dict[str, ctypes.CDLL] = {}


def ensure_shared_library(name: str, carriers: Iterable[str]) -> None:
    """Load a shared library, before the first import of a package that needs it.

    The machine's own library comes first, then that of a carrier. Once it is loaded under this
    name, packages that need it find it. If neither exists, nothing happens: the import that needs
    the library says what is missing.

    Args:
        name: the library's own name, such as `libfoo.so.1`.
        carriers: packages that hold it in their folder `lib`; they need not be installed.
    """
    if name in _loaded:
        return
    for path in (name, *(str(folder / "lib" / name) for folder in _folders(carriers))):
        try:
            _loaded[name] = ctypes.CDLL(path)
        except OSError:
            continue
        return


def _folders(packages: Iterable[str]) -> list[Path]:
    """The folders of packages; nothing is imported."""
    found = [importlib.util.find_spec(package) for package in packages]
    return [
        Path(folder)
        for spec in found
        if spec is not None
        for folder in spec.submodule_search_locations or ()
    ]
