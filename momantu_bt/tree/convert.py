"""Converts tree files between YAML and XML, and checks that nothing is lost."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import fields, is_dataclass
from enum import StrEnum
from pathlib import Path

from momantu_bt.formats.problems import errors
from momantu_bt.tree.check.nodes import with_named_inputs
from momantu_bt.tree.check.signatures import Context
from momantu_bt.tree.files.resolve import resolve
from momantu_bt.tree.files.scalars import CannotWrite
from momantu_bt.tree.files.xml import writer as xml_writer
from momantu_bt.tree.files.xml.format import XmlSource
from momantu_bt.tree.files.yaml import writer as yaml_writer
from momantu_bt.tree.files.yaml.format import YamlSource
from momantu_bt.tree.language import is_xml
from momantu_bt.tree.load import read_file
from momantu_bt.tree.model import Document, Node
from momantu_bt.tree.problems import Problems, TreeError
from momantu_bt.tree.registry import Registry

__all__ = [
    "CannotWrite",
    "Spelling",
    "document_spelling",
    "meaning",
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


def read_right(path: Path, registry: Registry) -> Document:
    """Read a tree file and check its syntax; its nodes need not be installed.

    Raises:
        TreeNotFound: the file cannot be read.
        TreeError: the file has syntax errors.
    """
    document, problems = read_file(path, registry)
    found = problems.sorted()
    if errors(found):
        raise TreeError(found, document.source)
    return document


def write(document: Document, to: Spelling, registry: Registry) -> str:
    """Write a document as text in a format; reading it back gives the same document.

    Raises:
        CannotWrite: the format cannot express something in the document.
    """
    document = _named(document, registry)
    writing = yaml_writer.write if to is Spelling.YAML else xml_writer.write
    text = writing(document, registry)
    again, problems = _read_again(text, to, document, registry)
    wrong = errors(problems.sorted())
    if again is None or wrong:
        said = f": {wrong[0].message}" if wrong else ""
        raise CannotWrite(f"{to.upper()} has no room for this tree{said}")
    if meaning(_named(again, registry)) != meaning(document):
        raise CannotWrite(f"{to.upper()} would say something else than this tree")
    return text


def _named(document: Document, registry: Registry) -> Document:
    """The document with the ports of bare values named, where the skill is known."""
    return with_named_inputs(Context(document, registry, Problems()))


def _read_again(
    text: str, to: Spelling, document: Document, registry: Registry
) -> tuple[Document | None, Problems]:
    problems = Problems()
    outside = {n: t for n, t in document.trees.items() if t.place.file != document.file}
    file = document.file
    source: YamlSource | XmlSource
    try:
        if to is Spelling.YAML:
            source = YamlSource.of(text, file, problems)
        else:
            source = XmlSource.of(text, file, registry, problems)
    except TreeError as error:
        raise CannotWrite(f"{to.upper()} has no room for it: {error}") from None
    again = source.document(outside)
    if again is not None:
        again.trees = {**again.trees, **outside}
        resolve(again)
    return again, problems


def meaning(document: Document) -> object:
    """The content of a document for comparisons, including the types of values.

    The types are needed as `true == 1 == 1.0` in Python. For each tree there is a flat list of
    nodes in file order with the number of their children, so that very deep trees can be compared.
    """
    nodes = {name: [_node(n) for n in tree.root.walk()] for name, tree in document.trees.items()}
    return (_typed(document, leaving=("trees",)), _trees(document), nodes)


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
