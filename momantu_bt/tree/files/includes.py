"""A tree file with the files that it includes, in either spelling, as one document."""

from __future__ import annotations

import os.path
from collections.abc import Iterator
from contextlib import nullcontext
from dataclasses import dataclass, field
from pathlib import Path
from typing import Protocol

from momantu_bt.formats.names import nearest
from momantu_bt.formats.problems import Problem, errors
from momantu_bt.tree.files.given_text import TreeText
from momantu_bt.tree.files.lookup import TreeNotFound, tree_files
from momantu_bt.tree.files.resolve import resolve
from momantu_bt.tree.files.text import checked_text, read_text
from momantu_bt.tree.files.xml.format import XmlSource
from momantu_bt.tree.files.yaml.format import YamlSource
from momantu_bt.tree.language import is_xml
from momantu_bt.tree.model import Document, Include, Tree
from momantu_bt.tree.problems import Problems, TooManyProblems, TreeError
from momantu_bt.tree.registry import Registry

MAX_FILES = 64
MAX_TOTAL = 3_000_000
"""The most characters that all files together may have."""

_MARKS = (".git", "pyproject.toml")
"""Names that mark a folder as the folder of a project."""


class Source(Protocol):
    """A file whose syntax is right and whose nodes are not read yet."""

    text: str

    def includes(self) -> tuple[Include, ...]:
        """The files it includes."""
        ...

    def document(self, outside: dict[str, Tree], *, included: bool = False) -> Document | None:
        """Its own part of the document; None, with a problem reported, if it has none."""
        ...


def read_project(
    tree: Path | TreeText, registry: Registry, *, resolving: bool = True
) -> tuple[Document, Problems]:
    """Read a tree file, or a text, and all that it includes. A text includes as a file here would.

    resolving: whether every tree that a node runs must be known, and every included file read.

    Included files must lie in the project. The project is the nearest folder above `path` that has
    `.git` or `pyproject.toml`, or else the file's own folder. Includes give only their trees.

    Raises:
        TreeNotFound: the file itself cannot be opened.
        TreeError: a file is neither YAML nor XML, holds no tree, or has too many problems.
    """
    path = Path.cwd() / tree.shown if isinstance(tree, TreeText) else tree
    project = _Project(registry, Problems(), project_folder(path), resolving)
    try:
        return project.read(path, tree if isinstance(tree, TreeText) else None)
    except TooManyProblems as error:
        raise TreeError(errors(error.problems), project.source) from None


def project_folder(path: Path) -> Path:
    """The folder that included files must lie in."""
    here = path.resolve().parent
    for folder in (here, *here.parents):
        if any((folder / mark).exists() for mark in _MARKS):
            return folder
    return here


@dataclass(slots=True)
class _Open:
    """A file whose includes are being read. path: its real path; shown: its name in reports."""

    path: Path
    shown: str
    source: Source
    includes: Iterator[Include]
    visible: dict[str, Tree] = field(default_factory=dict)


@dataclass(slots=True)
class _Project:
    registry: Registry
    problems: Problems
    folder: Path
    resolving: bool
    documents: dict[Path, Document] = field(default_factory=dict)
    visible: dict[Path, dict[str, Tree]] = field(default_factory=dict)
    source: dict[str, str] = field(default_factory=dict)
    broken: list[Problem] = field(default_factory=list)
    """Syntax errors of included files. If there are any, only they are reported."""

    def read(self, path: Path, given: TreeText | None = None) -> tuple[Document, Problems]:
        main = path.resolve()
        if given is None:
            stack = [self.open(main, str(path))]
        else:
            stack = [self.opened(main, given.shown, checked_text(given.text, given.shown))]
        while stack:
            top = stack[-1]
            include = next(top.includes, None)
            if include is None:
                self.close(stack.pop(), stack[-1] if stack else None)
                continue
            with nullcontext() if self.resolving else self.problems.keeping():
                target = self.target(top, include, stack)
            if target is not None and target in self.visible:
                top.visible |= self.visible[target]
            elif target is not None:
                self.enter(target, include, stack)
        if self.broken and self.resolving:
            raise TreeError(self.broken, self.source)
        found = self.documents.get(main)
        nothing = found is not None and not (found.trees or found.includes or found.models)
        if found is None or (nothing and self.resolving):
            raise TreeError(errors(self.problems.sorted()), self.source)
        return self.whole(self.documents.pop(main)), self.problems

    def open(self, path: Path, shown: str) -> _Open:
        return self.opened(path, shown, read_text(path, shown))

    def opened(self, path: Path, shown: str, text: str) -> _Open:
        """A file, or a text, whose syntax is right."""
        self.source[shown] = text
        source: Source
        if is_xml(shown, text):
            source = XmlSource.of(text, shown, self.registry, self.problems)
        else:
            source = YamlSource.of(text, shown, self.registry, self.problems)
        return _Open(path, shown, source, iter(source.includes()))

    def enter(self, target: Path, include: Include, stack: list[_Open]) -> None:
        """Open an included file, unless there are too many or it is not a file to include."""
        shown = os.path.normpath(Path(stack[-1].shown).parent / include.path)
        total = sum(map(len, self.source.values()))
        if len(self.source) >= MAX_FILES or total >= MAX_TOTAL:
            message = f"more than {MAX_FILES} files or {MAX_TOTAL} characters in all"
            self.problems.error("too-large", include.place, message, "include fewer files")
            return
        try:
            stack.append(self.open(target, shown))
        except TreeNotFound as error:
            self.problems.error("include", include.place, str(error))
        except TreeError as error:
            self.broken.extend(error.problems)
            self.visible[target] = {}

    def target(self, top: _Open, include: Include, stack: list[_Open]) -> Path | None:
        """The included file's real path; None, and a problem, if it cannot be included."""
        if include.package is not None or not include.path:
            return None  # its reader has reported it
        try:
            wanted = (top.path.parent / include.path).resolve()
            exists = wanted.is_file()
        except (OSError, ValueError, RuntimeError):
            wanted, exists = top.path, False
        if not wanted.is_relative_to(self.folder):
            message = f"{include.path} is not in the project {self.folder.name}"
            hint = "included files lie beside the main file or below the project's folder"
            self.problems.error("include", include.place, message, hint)
            return None
        if not exists:
            self._report_missing(wanted, include)
            return None
        circle = [each.shown for each in stack if each.path == wanted]
        if circle:
            names = [each.shown for each in stack]
            path = " -> ".join([*names[names.index(circle[0]) :], circle[0]])
            message, hint = f"the file includes itself: {path}", "remove one of the includes"
            self.problems.error("include-cycle", include.place, message, hint)
            return None
        return wanted

    def _report_missing(self, wanted: Path, include: Include) -> None:
        beside = [each.name for each in tree_files(wanted.parent)]
        near = nearest(wanted.name, beside)
        hint = f"tree files there: {', '.join(beside) or 'none'}"
        if near is not None:
            hint = f"did you mean {Path(include.path).parent / near}?"
        self.problems.error("include", include.place, f"there is no file {include.path}", hint)

    def close(self, done: _Open, parent: _Open | None) -> None:
        """Read the file's own trees. The trees of its includes must be known."""
        document = done.source.document(done.visible, included=parent is not None)
        if document is not None:
            self.documents[done.path] = document
            for name, tree in document.trees.items():
                self._report_duplicate(name, tree, done.visible.get(name))
                done.visible.setdefault(name, tree)
        self.visible[done.path] = done.visible
        if parent is not None:
            parent.visible |= {
                name: tree
                for name, tree in done.visible.items()
                if not self._report_duplicate(name, tree, parent.visible.get(name))
            }

    def _report_duplicate(self, name: str, tree: Tree, other: Tree | None) -> bool:
        if other is None or other is tree:
            return False
        for place, elsewhere in ((tree.place, other.place), (other.place, tree.place)):
            message = f"the tree {name!r} stands in {elsewhere} too"
            self.problems.error("duplicate-tree", place, message, "rename one of them")
        return True

    def whole(self, main: Document) -> Document:
        """The main document with the trees of all others, and with every name resolved."""
        for other in self.documents.values():
            for name, tree in other.trees.items():
                self._report_duplicate(name, tree, main.trees.get(name))
                main.trees.setdefault(name, tree)
            main.further_models += (*other.models, *other.further_models)
        main.source = self.source
        if self.resolving:
            resolve(main)
        return main
