"""Trees from further files: those that a document runs and neither it nor its includes have."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path

from momantu_bt.formats.problems import Severity
from momantu_bt.tree.catalogue import SUBTREE
from momantu_bt.tree.files.includes import read_project
from momantu_bt.tree.files.lookup import TreeNotFound, tree_files
from momantu_bt.tree.files.resolve import resolve
from momantu_bt.tree.model import Document, Node, Tree
from momantu_bt.tree.problems import Problems, TreeError
from momantu_bt.tree.registry import Registry

_MOST_FILES = 2000


def add_trees(
    document: Document, problems: Problems, include: Sequence[Path], registry: Registry
) -> None:
    """Add the trees that a document runs and lacks, with what they run in turn, and all models.

    include: files, and folders of files. A file of a folder that cannot be read is left out; its
    problems are reported if it is named itself, or if one of its trees is added.

    Raises:
        TreeNotFound: a path does not exist, or a folder has no tree files.
        TreeError: a file that is named itself cannot be read.
    """
    having: dict[str, list[tuple[Tree, Document, Problems]]] = {}
    for path, named in _files(include):
        try:
            other, found = read_project(path, registry)
        except TreeError:
            if named:
                raise
            continue
        document.further_models += (*other.models, *other.further_models)
        for name, tree in other.trees.items():
            having.setdefault(name, []).append((tree, other, found))
    _add(document, problems, having)
    resolve(document)


def _files(include: Iterable[Path]) -> Iterator[tuple[Path, bool]]:
    """The files to read, and whether each is named itself."""
    count = 0
    for path in include:
        if path.is_file():
            yield path, True
            continue
        folders = [path, *sorted(p for p in path.rglob("*") if p.is_dir())]
        found = [file for folder in folders for file in tree_files(folder)]
        if not found:
            raise TreeNotFound(f"{path} is neither a tree file nor a folder with tree files")
        count += len(found)
        if count > _MOST_FILES:
            raise TreeNotFound(f"{path} has more than {_MOST_FILES} tree files; name fewer")
        yield from ((file, False) for file in found)


def _add(
    document: Document,
    problems: Problems,
    having: dict[str, list[tuple[Tree, Document, Problems]]],
) -> None:
    waiting = list(document.trees.values())
    while waiting:
        for node in waiting.pop().root.walk():
            name = _runs(node)
            if name is None or name in document.trees or name not in having:
                continue
            (tree, source, found), *others = having[name]
            if others and any(other.place.file != tree.place.file for other, *_ in others):
                message = f"the tree {name!r} stands in {tree.place} and in {others[0][0].place}"
                hint = "include the file with the one that is meant, and not both"
                problems.error("duplicate-tree", node.place, message, hint)
            document.trees[name] = tree
            document.source.update(source.source)
            _report(problems, found, tree.place.file)
            waiting.append(tree)


def _runs(node: Node) -> str | None:
    """The tree that a node may run."""
    return node.target if node.type == SUBTREE else node.type


def _report(problems: Problems, found: Problems, file: str) -> None:
    """Pass on the errors in the file of a tree that is added."""
    for problem in found.sorted():
        if problem.severity is Severity.ERROR and problem.place.file == file:
            if problem.code in ("no-main",):
                continue
            problems.error(problem.code, problem.place, problem.message, problem.hint)
