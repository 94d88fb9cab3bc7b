"""The source of a skill: its class, and the modules of its own package that it reaches."""

from __future__ import annotations

import ast
import importlib.util
import inspect
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from momantu_bt.formats.places import Place
from momantu_bt.skill import Skill

MOST_MODULES = 500
"""Largest number of modules that are read from one package."""


@dataclass(frozen=True, slots=True)
class Module:
    """One module's source. name: dotted; is_package: whether it is an `__init__`."""

    name: str
    path: Path
    tree: ast.Module
    is_package: bool = False

    def place(self, node: ast.AST) -> Place:
        """The line of a part of it."""
        return Place(str(self.path), getattr(node, "lineno", 1))


def classes(skill: type[Skill]) -> list[tuple[Module, ast.ClassDef]]:
    """The class statements of a skill and of its base classes, except Skill."""
    found: list[tuple[Module, ast.ClassDef]] = []
    for kind in skill.__mro__[: skill.__mro__.index(Skill)]:
        module = _module(kind.__module__)
        if module is None:
            continue
        named = (n for n in ast.walk(module.tree) if isinstance(n, ast.ClassDef))
        found += [(module, node) for node in named if node.name == kind.__name__][:1]
    return found


def reached(skill: type[Skill]) -> list[Module]:
    """The skill's module and all modules of its own package that it imports, also indirectly.

    Imports inside functions count too. The search imports only parent packages.
    """
    top = skill.__module__.partition(".")[0]
    waiting, found = [skill.__module__], dict[str, Module]()
    while waiting and len(found) < MOST_MODULES:
        name = waiting.pop()
        module = None if name in found else _module(name)
        if module is None:
            continue
        found[name] = module
        waiting += [other for other in _imported(module) if other.partition(".")[0] == top]
    return list(found.values())


@cache
def _module(name: str) -> Module | None:
    """A module's source; None if it has none, such as a built-in module."""
    path = _path(name)
    if path is None or path.suffix != ".py":
        return None
    tree = ast.parse(path.read_text(encoding="utf-8"), str(path))
    return Module(name, path, tree, path.name == "__init__.py")


def _path(name: str) -> Path | None:
    if name in sys.modules:
        file = inspect.getsourcefile(sys.modules[name]) if _has_file(name) else None
        return None if file is None else Path(file)
    try:
        spec = importlib.util.find_spec(name)
    except (ImportError, ValueError):
        return None
    return None if spec is None or not spec.has_location else Path(str(spec.origin))


def _has_file(name: str) -> bool:

    return getattr(sys.modules[name], "__file__", None) is not None


def _imported(module: Module) -> Iterator[str]:
    """Dotted names of what a module imports, including names that are not modules."""
    for node in ast.walk(module.tree):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            base = _base(module, node)
            yield base
            yield from (f"{base}.{alias.name}" for alias in node.names)


def _base(module: Module, node: ast.ImportFrom) -> str:
    if not node.level:
        return node.module or ""
    parts = module.name.split(".")
    keep = len(parts) - node.level + (1 if module.is_package else 0)
    return ".".join([*parts[:keep], *([node.module] if node.module else [])])
