"""Finds, reads and checks a tree."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from momantu_bt.formats.names import valid_names
from momantu_bt.formats.places import Place
from momantu_bt.formats.problems import errors
from momantu_bt.tree.check.checker import Checked, check
from momantu_bt.tree.files.further import add_trees
from momantu_bt.tree.files.given_text import TreeText
from momantu_bt.tree.files.includes import read_project
from momantu_bt.tree.files.lookup import TreeNotFound, find
from momantu_bt.tree.files.settings import Given
from momantu_bt.tree.files.text import read_text
from momantu_bt.tree.goals import given_goal
from momantu_bt.tree.model import Document, Literal, Reference, Template
from momantu_bt.tree.problems import Problems, TreeError
from momantu_bt.tree.registry import Registry

WORD = re.compile(r"[^\W\d]\w*")
"""A valid key in a script."""

__all__ = ["Checked", "TreeError", "TreeNotFound", "load", "read_file", "read_values"]


def load(
    tree: str | TreeText,
    registry: Registry | None = None,
    *,
    world: str | None = None,
    robot: str | None = None,
    values: Mapping[str, Any] | None = None,
    include: Sequence[Path] = (),
    goal: Any = None,
    tolerant: bool = False,
    library: bool = False,
) -> Checked:
    """Find, read and check a tree.

    tree: a path, the name of a bundled tree, or a text. values: keys of the root's board, in
    addition to those in the file or in their place (`--set`, `--values`), not converted ("66 mm");
    `Given` also has their places. include: further files, or folders of files, with trees
    that the tree runs. goal: in the place of the tree's own (`--goal`).
    tolerant: nodes, trees and keys that stand elsewhere are warnings. library: so is a file that
    has no tree, or does not say which of its trees to run.

    Raises:
        TreeNotFound: there is no such file.
        TreeError: the file has errors; all of them are in it.
    """
    having = registry if registry is not None else Registry.installed()
    found = tree if isinstance(tree, TreeText) else find(tree)
    document, problems = read_file(found, having, include)
    if library:
        problems.soften(("no-main", "no-trees"))
    _override(document, values or {}, problems)
    if goal is not None:
        given_goal(document, goal)
    checked = check(document, having, world=world, robot=robot, reading=problems, tolerant=tolerant)
    if errors(checked.problems):
        raise TreeError(checked.problems, document.source)
    return checked


def read_file(
    path: Path | TreeText, registry: Registry | None = None, include: Sequence[Path] = ()
) -> tuple[Document, Problems]:
    """Read a tree, YAML or XML, and the files that it includes, without checking them.

    registry: has the skills whose port types are needed to read XML; by default those installed.
    include: further files, or folders, for the trees that these files lack.

    Raises:
        TreeNotFound: the file cannot be opened.
        TreeError: the file is neither YAML nor XML, or has no tree.
    """
    having = registry if registry is not None else Registry.installed()
    document, problems = read_project(path, having)
    if include:
        add_trees(document, problems, include, having)
    return document, problems


def read_values(path: Path) -> Given:
    """Read a file of values, which is one YAML mapping.

    Raises:
        TreeNotFound: the file cannot be opened.
        TreeError: the file is not a YAML mapping, or has a key twice.
    """
    given = Given()
    given.read(read_text(path, str(path)), str(path))
    return given


def _override(document: Document, values: Mapping[str, Any], problems: Problems) -> None:
    known = {*document.values, *_keys_read(document)}
    given = values if isinstance(values, Given) else None
    document.source.update(given.source if given is not None else {})
    for name, value in values.items():
        key_place = place = Place(f"given value of {name}", 1, 1)
        if given is not None:
            key_place, place = given.key_places[name], given.places[name]
        if name not in known:
            hint = valid_names(name, document.values or known, "values in it")
            problems.error("unknown-value", key_place, f"the tree has no value {name!r}", hint)
        document.values[name] = Literal(value)
        document.value_places[name] = place


def _keys_read(document: Document) -> set[str]:
    """Names of all keys in the ports and conditions of a document."""
    names: set[str] = set()
    for tree in document.trees.values():
        for node in tree.root.walk():
            for value in node.ports.values():
                parts = value.parts if isinstance(value, Template) else (value,)
                names |= {part.key for part in parts if isinstance(part, Reference)}
            for script in node.conditions.values():
                names |= set(WORD.findall(script))
            code = node.ports.get("code")
            if isinstance(code, Literal):
                names |= set(WORD.findall(str(code.value)))
    return names
