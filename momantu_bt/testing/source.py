"""The source of a skill: its classes, and the modules of their packages that it reaches."""

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
from momantu_bt.service import Service
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


def family(skill: type[Skill | Service]) -> tuple[type, ...]:
    """The class and all that it inherits from, nearest first; without Skill, Service, object."""
    return tuple(kind for kind in skill.__mro__ if kind not in (Skill, Service, object))


def classes(skill: type[Skill | Service]) -> list[tuple[Module, ast.ClassDef]]:
    """The class statements of a skill and of its base classes, except Skill."""
    found: list[tuple[Module, ast.ClassDef]] = []
    for kind in family(skill):
        module = _module(kind.__module__)
        if module is None:
            continue
        named = (n for n in ast.walk(module.tree) if isinstance(n, ast.ClassDef))
        found += [(module, node) for node in named if node.name == kind.__name__][:1]
    return found


def methods(
    skill: type[Skill | Service],
) -> list[tuple[Module, ast.FunctionDef | ast.AsyncFunctionDef]]:
    """The methods that a skill has: its own, and those that it inherits.

    A base's method that a nearer class replaces counts only if some `super()` can reach it.
    """
    found: list[tuple[Module, ast.FunctionDef | ast.AsyncFunctionDef]] = []
    replaced: set[str] = set()
    names = {kind.__name__ for kind in family(skill)}
    for module, owner in classes(skill):
        own = [n for n in owner.body if isinstance(n, ast.FunctionDef | ast.AsyncFunctionDef)]
        live = [method for method in own if method.name not in replaced]
        found += [(module, method) for method in live]
        replaced |= {method.name for method in own}
        replaced -= {name for method in live for name in _asked_of_bases(method, names)}
    return found


def _asked_of_bases(method: ast.AST, family: set[str]) -> set[str]:
    """Names in `super().name` and `Base.name`."""
    asked = (node for node in ast.walk(method) if isinstance(node, ast.Attribute))
    return {
        node.attr
        for node in asked
        if getattr(getattr(node.value, "func", None), "id", "") == "super"
        or getattr(node.value, "id", "") in family
    }


def reached(skill: type[Skill | Service]) -> list[Module]:
    """The modules of the skill and its base classes, and all that they import, also indirectly.

    From each package only its own modules are followed. Imports inside functions count too. The
    search imports only parent packages.
    """
    homes = dict.fromkeys(kind.__module__ for kind in family(skill))
    tops = {name.partition(".")[0] for name in homes}
    waiting, found = list(homes), dict[str, Module]()
    while waiting and len(found) < MOST_MODULES:
        name = waiting.pop()
        module = None if name in found else _module(name)
        if module is None:
            continue
        found[name] = module
        waiting += [other for other in _imported(module) if other.partition(".")[0] in tops]
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
