"""Imports at the top of a file whose modules are loaded when they are first used.

Listing and checking trees must not wait for OpenCV or a simulator. A file that needs such a module
only when it works says so where imports belong:

    with lazily():
        import cv2
        from momantu_skills.navigation import mppi

Inside the block write `import module` or `from package import module`, never `from module import
name`: asking a module for a name loads it. Type checkers, editors and import contracts see ordinary
imports.
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
    """A module that is run as soon as somebody asks it for a name."""

    def __getattribute__(self, name: str) -> Any:
        if name in _KNOWN_BEFORE:
            return super().__getattribute__(name)
        spec = self.__spec__
        assert spec is not None
        assert isinstance(spec.loader, _PendingLoader)
        spec.loader.load(self)
        return getattr(self, name)


class _PendingLoader(Loader):
    """Makes a pending module, and runs it with the loader that Python would have used."""

    def __init__(self, loader: SourceFileLoader) -> None:
        self._loader = loader

    def exec_module(self, module: ModuleType) -> None:
        """Put off what this is asked for."""
        module.__class__ = _Pending
        module.__loader__ = self._loader

    def load(self, module: ModuleType) -> None:
        """Run the module; what it imports itself is loaded as usual."""
        assert module.__spec__ is not None
        module.__class__ = ModuleType
        module.__spec__.loader = self._loader
        put_off = [finder for finder in sys.meta_path if isinstance(finder, _LazyFinder)]
        sys.meta_path[:] = [finder for finder in sys.meta_path if finder not in put_off]
        try:
            self._loader.exec_module(module)
        except BaseException:  # the next use tries again and tells the same
            module.__spec__.loader = self
            module.__class__ = _Pending
            raise
        finally:
            sys.meta_path[:0] = put_off


class _LazyFinder(MetaPathFinder):
    """Finds modules as Python does, and puts off running those that are Python source."""

    def find_spec(
        self, fullname: str, path: Sequence[str] | None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        """The spec of a module; None leaves it to the finders after this one."""
        spec = PathFinder.find_spec(fullname, path, target)
        if spec is None or not isinstance(spec.loader, SourceFileLoader):
            return None
        spec.loader = _PendingLoader(spec.loader)
        return spec


@contextmanager
def lazily() -> Iterator[None]:
    """Put off running the modules that are imported inside the block until they are used.

    A module that is not installed is told at once, by ModuleNotFoundError. An error inside a
    module is raised where the module is first used.
    """
    finder = _LazyFinder()
    sys.meta_path.insert(0, finder)
    try:
        yield
    finally:
        sys.meta_path.remove(finder)
