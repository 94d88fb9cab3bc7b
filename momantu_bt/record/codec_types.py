"""Find types by name for values of a record; reading a record runs no code but theirs."""

from __future__ import annotations

import sys
from functools import cache
from importlib import import_module

from momantu_bt.plugins import packages

_OWN = "momantu_bt"


def type_name(kind: type) -> str:
    """`module:qualified name`."""
    return f"{kind.__module__}:{kind.__qualname__}"


def find_type(name: str) -> type | None:
    """The type of a name; None if it cannot be found here.

    Only modules that are already loaded, or that belong to a package with plug-ins, are used:
    reading a record runs no other code.
    """
    module_name, _, path = name.partition(":")
    package = module_name.partition(".")[0]
    if module_name not in sys.modules and package not in _packages():
        return None
    try:
        found: object = import_module(module_name)
        for part in path.split("."):
            found = getattr(found, part)
    except (ImportError, AttributeError, ValueError):
        return None
    return found if isinstance(found, type) else None


@cache
def _packages() -> frozenset[str]:
    """Top-level packages of this framework and of everything that is plugged into it."""
    return frozenset({_OWN, *packages()})
