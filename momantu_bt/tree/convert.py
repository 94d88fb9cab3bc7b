"""Converts tree files between YAML and XML, and checks that nothing is lost."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import fields, is_dataclass
from enum import StrEnum
from pathlib import Path

from momantu_bt.errors import InputError
from momantu_bt.formats.places import Place
from momantu_bt.formats.problems import Problem, errors
from momantu_bt.formats.xml.difference import first_difference
from momantu_bt.formats.xml.reader import XmlSyntaxError
from momantu_bt.tree.catalogue import SUBTREE
from momantu_bt.tree.check.nodes import with_named_inputs
from momantu_bt.tree.check.signatures import Context
from momantu_bt.tree.files.comments import set_comments_apart, set_odd_comments_apart
from momantu_bt.tree.files.given_text import TreeText
from momantu_bt.tree.files.includes import read_project
from momantu_bt.tree.files.scalars import CannotWrite
from momantu_bt.tree.files.syntax import OURS
from momantu_bt.tree.files.text import read_text
from momantu_bt.tree.files.xml import writer as xml_writer
from momantu_bt.tree.files.xml.format import XmlSource
from momantu_bt.tree.files.xml.format3 import from_format_3
from momantu_bt.tree.files.yaml import writer as yaml_writer
from momantu_bt.tree.files.yaml.format import YamlSource
from momantu_bt.tree.language import is_xml
from momantu_bt.tree.model import Document, Node
from momantu_bt.tree.problems import Problems, TreeError
from momantu_bt.tree.registry import Registry

__all__ = [
    "CannotWrite",
    "Spelling",
    "document_spelling",
    "meaning",
    "read_format_3",
    "read_right",
    "spelling_of",
    "write",
]


class Spelling(StrEnum):
    """The two formats of tree files."""

    YAML = "yaml"
    XML = "xml"

    @property
    def other(self) -> Spelling:
        """The other of the two formats."""
        return Spelling.XML if self is Spelling.YAML else Spelling.YAML


def spelling_of(path: Path) -> Spelling | None:
    """The format for a file's suffix; None for an unknown suffix."""
    known = {".yaml": Spelling.YAML, ".yml": Spelling.YAML, ".xml": Spelling.XML}
    return known.get(path.suffix.lower())


def document_spelling(document: Document) -> Spelling:
    """The format from which a document was read."""
    xml = is_xml(document.file, document.source[document.file])
    return Spelling.XML if xml else Spelling.YAML


def read_right(given: Path | TreeText, registry: Registry) -> tuple[Document, list[Problem]]:
    """Read a tree whole; its nodes need not be known, nor the files that it includes.

    Returns with it the problems of included files of a YAML file: trees of files that are not read
    count as nodes, unless `subtree:` names them. An XML file always says what a tree is.

    Raises:
        TreeNotFound: the file cannot be read.
        TreeError: the file has errors after which something of it would be lost.
        CannotWrite: it has something that a document cannot hold; the place says where.
    """
    shown = given.shown if isinstance(given, TreeText) else str(given)
    text = given.text if isinstance(given, TreeText) else read_text(given, shown)
    if is_xml(shown, text):
        return _read_xml(text, shown, registry), []
    document, problems = read_project(given, registry, resolving=False)
    if problems.lost():
        raise TreeError(problems.lost(), document.source)
    return document, [each for each in errors(problems.sorted()) if each.code == "include"]


def read_format_3(
    given: Path | TreeText, registry: Registry
) -> tuple[Document, list[tuple[Place, str]]]:
    """Read a file of BehaviorTree.CPP 3, and remarks on what means something else in version 4.

    Raises:
        TreeNotFound, TreeError, CannotWrite: as `read_right`.
        FormatError: the file is not of version 3.
    """
    file = given.shown if isinstance(given, TreeText) else str(given)
    text = given.text if isinstance(given, TreeText) else read_text(given, file)
    if not is_xml(file, text) or re.search(r"<root\b[^>]*BTCPP_format\s*=\s*[\"']4", text):
        raise FormatError(f"{file} is not of format 3 of BehaviorTree.CPP; leave --from out")
    try:
        text, remarks = from_format_3(text, file)
    except XmlSyntaxError as error:
        raise TreeError([error.problem], {file: text}) from None
    return _read_xml(text, file, registry), remarks


class FormatError(InputError):
    """A file is of another format than `--from` says."""


def _read_xml(text: str, file: str, registry: Registry) -> Document:
    problems = Problems(most=None)
    document = XmlSource.of(text, file, registry, problems).document({})
    if document is None:
        raise TreeError(errors(problems.sorted()), {file: text})
    try:
        again = xml_writer.write(document, registry)
    except CannotWrite:
        again = ""
    difference = first_difference(text, again) if again else None
    kept = OURS in text and not problems.lost()
    if (again and difference is None) or kept:
        return document
    if problems.lost():
        raise TreeError(problems.lost(), document.source)
    line, what = difference or (1, "the whole file")
    error = CannotWrite(f"{what} has no place in a tree file of ours")
    error.place = Place(file, line, 1)
    raise error


def write(document: Document, to: Spelling, registry: Registry) -> str:
    """Write a document as text in a format; reading it back gives the same document.

    Raises:
        CannotWrite: the format cannot express something in the document.
    """
    document = _named(document, registry)
    writing = yaml_writer.write if to is Spelling.YAML else xml_writer.write
    from_xml = document_spelling(document) is Spelling.XML
    text, again = "", document
    if from_xml:
        set_odd_comments_apart(document)
    for _ in range(_MOST_PASSES if to is Spelling.YAML and from_xml else 1):
        text = writing(document, registry)
        again = _read_again(text, to, document, registry)
        if not (from_xml and set_comments_apart(document, again)):
            break
    if meaning(_named(again, registry)) != meaning(document):
        raise CannotWrite(f"{to.upper()} would say something else than this tree")
    if from_xml:
        _check_kept(document, again, to, registry)
    return text


_MOST_PASSES = 8
"""How often comments are moved. Comments that get another place in YAML may change others'."""


def _check_kept(document: Document, again: Document, to: Spelling, registry: Registry) -> None:
    """Refuse to write when something would be lost that only XML says."""
    before, after = (xml_writer.write(each, registry) for each in (document, again))
    difference = first_difference(before, after)
    if difference is not None:
        raise CannotWrite(f"{to.upper()} would lose {difference[1]}")


def _named(document: Document, registry: Registry) -> Document:
    """The document with the ports of bare values named, where the skill is known."""
    return with_named_inputs(Context(document, registry, Problems(most=None)))


def _read_again(text: str, to: Spelling, document: Document, registry: Registry) -> Document:
    problems = Problems(most=None)
    outside = {n: t for n, t in document.trees.items() if t.place.file != document.file}
    file = document.file
    source: YamlSource | XmlSource
    try:
        if to is Spelling.YAML:
            source = YamlSource.of(text, file, registry, problems)
        else:
            source = XmlSource.of(text, file, registry, problems)
    except TreeError as error:
        raise CannotWrite(f"{to.upper()} has no room for it: {error}") from None
    again = source.document(outside)
    wrong = problems.lost() if again is not None else errors(problems.sorted())
    if again is None or wrong:
        said = f": {wrong[0].message}" if wrong else ""
        raise CannotWrite(f"{to.upper()} has no room for this tree{said}")
    again.trees = {**again.trees, **outside}
    return again


def meaning(document: Document) -> object:
    """The content of a document for comparisons, including the types of values.

    The types are needed as `true == 1 == 1.0` in Python. For each tree there is a flat list of
    nodes in file order with the number of their children, so that very deep trees can be compared.
    What the model of a tree says is in its ports.
    """
    nodes = {name: [_node(n) for n in tree.nodes()] for name, tree in document.trees.items()}
    others = [m for m in document.models if m.kind != SUBTREE or m.name not in document.trees]
    return (_typed(document, leaving=("trees", "models")), _typed(others), _trees(document), nodes)


def _trees(document: Document) -> object:
    return {name: _typed(tree, leaving=("root",)) for name, tree in document.trees.items()}


def _node(node: Node) -> object:
    catches = [(handler.codes, handler.node is None) for handler in node.handlers]
    return (_typed(node, leaving=("children", "handlers")), len(node.children), catches)


def _typed(value: object, leaving: Sequence[str] = ()) -> object:
    # as deep as a value, which the readers bound
    if is_dataclass(value):
        kept = [each.name for each in fields(value) if each.compare and each.name not in leaving]
        return (type(value).__name__, {name: _typed(getattr(value, name)) for name in kept})
    if isinstance(value, dict):
        return {key: _typed(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_typed(item) for item in value]
    return (type(value).__name__, value)
