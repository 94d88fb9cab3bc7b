"""Imports at the top of a file whose modules are loaded when they are first used.

Listing and checking trees must not wait for OpenCV or a simulator. A file that needs such a module
only later, to do its work, imports it like this at the top:

    with lazily():
        import cv2
        from momantu_skills.navigation import mppi

Inside the block write `import module` or `from package import module`, never `from module import
name`: asking a module for a name loads it. Type checkers, editors and import contracts see ordinary
imports. The error for a library that is not installed comes at its first use, so an installation
without it can still list and check trees.

A library that is needed may itself import others that are not: around its import, `putting_off`
names those.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from importlib.abc import Loader, MetaPathFinder
from importlib.machinery import ModuleSpec, PathFinder, SourceFileLoader
from types import ModuleType
from typing import Any

_KNOWN_BEFORE = frozenset(
    {"__class__", "__file__", "__loader__", "__name__", "__package__", "__spec__"}
)
"""Attributes that an import sets before it runs the module."""


class _Pending(ModuleType):
    """A module that runs when one of its names is first used."""

    def __getattribute__(self, name: str) -> Any:
        if name in _KNOWN_BEFORE:
            return super().__getattribute__(name)
        spec = self.__spec__
        assert spec is not None
        assert isinstance(spec.loader, _PendingLoader)
        spec.loader.load(self)
        return getattr(self, name)


class _PutOff(_Pending):
    """A pending package that does not run when a module in it is imported."""

    def __getattribute__(self, name: str) -> Any:
        if name == "__path__":
            return ModuleType.__getattribute__(self, name)
        inside = sys.modules.get(f"{ModuleType.__getattribute__(self, '__name__')}.{name}")
        return super().__getattribute__(name) if inside is None else inside


class _Missing(ModuleType):
    """Stands for a module of a library that is not installed; its first use raises."""

    def __getattribute__(self, name: str) -> Any:
        having = super().__getattribute__("__dict__")
        if name in _KNOWN_BEFORE or name == "__path__" or name in having:
            return super().__getattribute__(name)
        spec = self.__spec__
        assert spec is not None
        if isinstance(spec.loader, _MissingFinder) and spec.loader.open:
            raise AttributeError(name)  # `from library import module` then asks for the module
        raise ModuleNotFoundError(f"No module named {spec.name!r}", name=spec.name)


class _MissingFinder(MetaPathFinder, Loader):
    """Finds libraries that are not installed, and makes modules that raise when used."""

    def __init__(self) -> None:
        self.open = True
        self.names: set[str] = set()

    def find_spec(
        self, fullname: str, path: Sequence[str] | None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        """The spec of a library that no finder knows, or of a module in it."""
        parent = fullname.rpartition(".")[0]
        if parent and parent not in self.names:
            return None  # the installed library lacks this module: a mistake, so raise now
        self.names.add(fullname)
        return ModuleSpec(fullname, self, is_package=True)

    def exec_module(self, module: ModuleType) -> None:
        """Make the module one that raises."""
        module.__class__ = _Missing

    def close(self) -> None:
        """Remove every trace, as others look here for what is installed."""
        self.open = False
        for name in self.names:
            sys.modules.pop(name, None)


class _PendingLoader(Loader):
    """Makes a pending module, and runs it with the loader that Python would have used."""

    def __init__(self, loader: SourceFileLoader, kind: type[_Pending]) -> None:
        self._loader, self._kind = loader, kind

    def exec_module(self, module: ModuleType) -> None:
        """Defer running the module until one of its names is used."""
        module.__class__ = self._kind
        module.__loader__ = self._loader

    def load(self, module: ModuleType) -> None:
        """Run the module; what it imports itself is loaded as usual."""
        assert module.__spec__ is not None
        module.__class__ = ModuleType
        module.__spec__.loader = self._loader
        first = [finder for finder in sys.meta_path if type(finder) is _LazyFinder]
        last = [finder for finder in sys.meta_path if isinstance(finder, _MissingFinder)]
        sys.meta_path[:] = [f for f in sys.meta_path if f not in first and f not in last]
        try:
            self._loader.exec_module(module)
        except BaseException:  # the next use tries again and raises the same error
            module.__spec__.loader = self
            module.__class__ = self._kind
            raise
        finally:
            sys.meta_path[:] = [*first, *sys.meta_path, *last]


class _LazyFinder(MetaPathFinder):
    """Finds modules as Python does, and puts off running those that are Python source."""

    kind: type[_Pending] = _Pending

    def find_spec(
        self, fullname: str, path: Sequence[str] | None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        """The spec of a module; None leaves it to the finders after this one."""
        spec = PathFinder.find_spec(fullname, path, target)
        if spec is None or not isinstance(spec.loader, SourceFileLoader):
            return None
        spec.loader = _PendingLoader(spec.loader, self.kind)
        return spec


class _NamedFinder(_LazyFinder):
    """Puts off running certain modules, whoever imports them."""

    kind = _PutOff

    def __init__(self, names: frozenset[str]) -> None:
        self._names = names

    def find_spec(
        self, fullname: str, path: Sequence[str] | None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        """The spec of a named module; None leaves it to the finders after this one."""
        return super().find_spec(fullname, path, target) if fullname in self._names else None


@contextmanager
def putting_off(*names: str) -> Iterator[None]:
    """Put off running these modules until they are used, whoever imports them in the block.

    names: of modules that the libraries imported in the block import too, but that need not run for
    what is wanted of those libraries. `from module import name` in a library runs the module.
    """
    finder = _NamedFinder(frozenset(names))
    sys.meta_path.insert(0, finder)
    try:
        yield
    finally:
        sys.meta_path.remove(finder)


@contextmanager
def lazily() -> Iterator[None]:
    """Put off running the modules that are imported inside the block until they are used.

    An error inside a module, and ModuleNotFoundError of a library that is not installed, are
    raised where the module is first used. If an installed library lacks a module, the error is
    raised at once.
    """
    finder, missing = _LazyFinder(), _MissingFinder()
    sys.meta_path.insert(0, finder)
    sys.meta_path.append(missing)
    try:
        yield
    finally:
        sys.meta_path.remove(finder)
        sys.meta_path.remove(missing)
        missing.close()
