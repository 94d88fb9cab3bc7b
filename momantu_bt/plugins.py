"""Finding what is installed by entry points: skills, services, robots, worlds, verbs.

A plug-in is checked when it is loaded. `load` refuses one that is broken, or whose name two
packages give; all others still work. Each kind of plug-in has a `Group`, in the module of that
kind, which says what such a plug-in must be.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from importlib import metadata
from importlib.metadata import EntryPoint
from pathlib import Path
from types import MappingProxyType
from typing import Any, Generic, TypeAlias, TypeVar

from momantu_bt.errors import MomantuError, words_of
from momantu_bt.formats.names import nearest, valid_names
from momantu_bt.importing import importing

PREFIX = "momantu_bt."
"""How the names of all groups begin."""
ENDINGS = (".yaml", ".yml", ".urdf", ".xacro")
"""In a group that reads files, a name with a slash or with one of these endings is a path."""

T = TypeVar("T")
_Found: TypeAlias = Mapping[str, tuple[EntryPoint, ...]]
Objection: TypeAlias = Callable[[str, Any], str | None]
"""Takes a plug-in's name and the plug-in; says why it cannot be used, or None if it can."""


class PluginError(MomantuError):
    """A plug-in is missing, broken, or named twice; the message says which and what to do."""


class PluginClash(PluginError):
    """Two packages give one name different things; the message names both."""


@dataclass(frozen=True, slots=True)
class Files(Generic[T]):
    """Reads plug-ins of a group from files, in addition to the installed ones.

    usual: the file to read if a path names a folder. read: returns the plug-in that a file
    describes; raises PluginError for a kind of file that it cannot read.
    """

    usual: str
    read: Callable[[Path], T]


class Group(Mapping[str, T]):
    """The plug-ins of one entry-point group, by name; each is imported at its first use.

    If the group has `files`, a path may replace a name. `group[name]` raises KeyError for an
    unknown name and PluginError for a broken plug-in; `load` explains both in words.

    name: of the entry point group. what: what a person calls one of its plug-ins.
    objection: says why a plug-in cannot be used.
    """

    def __init__(
        self,
        name: str,
        what: str,
        objection: Objection = lambda name, plugin: None,
        files: Files[T] | None = None,
    ) -> None:
        self.name, self.what, self.objection, self.files = name, what, objection, files

    __eq__ = object.__eq__
    __hash__ = object.__hash__

    def __getitem__(self, name: str) -> T:
        if name not in self:
            raise KeyError(name)
        return self.load(name)

    def __iter__(self) -> Iterator[str]:
        return iter(self.installed())

    def __len__(self) -> int:
        return len(self.installed())

    def __contains__(self, name: object) -> bool:
        return isinstance(name, str) and (self.is_path(name) or name in self.installed())

    def installed(self) -> Mapping[str, EntryPoint]:
        """Entry points by name, in the order of their names; nothing is imported.

        If two packages give one name different things, this holds the first; `load` refuses it.
        """
        return _first(entry_points, self.name)

    def load(self, name: str) -> T:
        """Import one plug-in by name and check it, or read the file at a path.

        Raises:
            PluginError: no plug-in has that name (the message lists the nearest), it cannot be
                imported, it is not what this group needs, or the file does not exist.
            PluginClash: two packages give this name different things.
            DescriptionError: the file is wrong.
        """
        if self.is_path(name):
            return self._from_file(Path(name))
        entry, *others = self._entries(name)
        if others:
            raise PluginClash(
                f"two plug-ins are called {name!r}: {_origin(entry)} and {_origin(others[0])}; "
                "uninstall one of them or rename its entry point"
            )
        try:
            with importing(entry.module, lambda: f"the {self.what} {name!r} ({_origin(entry)})"):
                plugin: T = entry.load()
            objection = self.objection(name, plugin)
        except KeyboardInterrupt:
            raise
        except BaseException as error:  # other people's code: it may raise anything
            reason = f"cannot be loaded: {words_of(error)}{_cure(entry, error)}"
        else:
            if objection is None:
                return plugin
            missing = "; write MODULE:NAME in the entry point" if not entry.attr else ""
            reason = f"is broken: {objection}{missing}"
        raise PluginError(f"the {self.what} {name!r} ({_origin(entry)}) {reason}")

    def is_path(self, name: str) -> bool:
        """Whether a plug-in is named by its file or folder."""
        return self.files is not None and ("/" in name or name.endswith(ENDINGS))

    def absolute(self, name: str | None) -> str | None:
        """A name of the same plug-in that is valid in any working directory."""
        return str(Path(name).absolute()) if name is not None and self.is_path(name) else name

    def near_file(self, name: str) -> str | None:
        """The path to write instead of a file's bare name; None when there is no such file."""
        if self.files is not None:
            for file in (f"{name}.yaml", f"{name}.yml", f"{name}/{self.files.usual}"):
                if Path(file).is_file():
                    return f"for the file that lies here write ./{file}"
        return None

    def _entries(self, name: str) -> tuple[EntryPoint, ...]:
        having = _installed(entry_points, self.name)
        if name in having:
            return having[name]
        near = nearest(name, having)
        meant = self.near_file(name) or (f"did you mean {near!r}?" if near else "")
        hint = f" ({meant})" if meant else ""
        names = ", ".join(having) or "none"
        raise PluginError(f"no {self.what} is called {name!r}{hint}; installed: {names}")

    def _from_file(self, path: Path) -> T:
        assert self.files is not None
        if path.is_dir():
            path /= self.files.usual
        if path.exists():
            return self.files.read(path)
        folder = path.parent
        beside = sorted(p.name for p in folder.glob("*.y*ml")) if folder.is_dir() else []
        there = f"; files there: {', '.join(beside)}" if beside else ""
        raise PluginError(f"there is no {self.what} file {path}{there}")


def installed_names(group: str) -> tuple[str, ...]:
    """Names of the plug-ins of an entry point group; nothing is imported."""
    return tuple(_installed(entry_points, group))


def packages() -> frozenset[str]:
    """Top-level packages that give plug-ins of any kind."""
    groups = (group for group in _everything() if group.startswith(PREFIX))
    entries = [entry for group in groups for entry in entry_points(group)]
    return frozenset(entry.module.partition(".")[0] for entry in entries)


def entry_points(group: str) -> Iterable[EntryPoint]:
    """Entry points of a group, of all installed packages."""
    return _everything().get(group, ())


@cache
def _everything() -> Mapping[str, Iterable[EntryPoint]]:
    """Entry points by group. They do not change while a process runs; asking is slow."""
    found = metadata.entry_points()
    return {group: tuple(found.select(group=group)) for group in found.groups}


@cache
def _first(find: Callable[[str], Iterable[EntryPoint]], group: str) -> Mapping[str, EntryPoint]:
    """The first of each name."""
    found = _installed(find, group)
    return MappingProxyType({name: entries[0] for name, entries in found.items()})


@cache
def _installed(find: Callable[[str], Iterable[EntryPoint]], group: str) -> _Found:
    """All entry points of a name, by name."""
    found: dict[str, dict[str, EntryPoint]] = {}
    for entry in sorted(find(group), key=lambda e: (e.name, e.value)):
        found.setdefault(entry.name, {}).setdefault(entry.value, entry)
    return {name: tuple(entries.values()) for name, entries in found.items()}


def _cure(entry: EntryPoint, error: BaseException) -> str:
    """What to do about an entry point whose module or name does not exist; else empty."""
    absent = error.name if isinstance(error, ModuleNotFoundError) else None
    if absent is not None and f"{entry.module}.".startswith(f"{absent}."):
        return "; is the entry point spelt as the module, and the package installed again?"
    module = sys.modules.get(entry.module)
    if isinstance(error, AttributeError) and module is not None and entry.attr:
        names = [name for name in vars(module) if not name.startswith("_")]
        if entry.attr.partition(".")[0] not in names:
            return f"; {valid_names(entry.attr, names, 'its names')}"
    return ""


def _origin(entry: EntryPoint) -> str:
    package = entry.dist.name if entry.dist is not None else "an unknown package"
    return f"{entry.value} of {package}"
