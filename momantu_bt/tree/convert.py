"""Converting a tree from one spelling to the other, with a check that nothing was lost."""

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
    """The spelling of a tree file."""

    YAML = "yaml"
    XML = "xml"

    @property
    def other(self) -> Spelling:
        """The one that this is not."""
        return Spelling.XML if self is Spelling.YAML else Spelling.YAML


def spelling_of(path: Path) -> Spelling | None:
    """The spelling that a file's suffix means; None for any other suffix."""
    known = {".yaml": Spelling.YAML, ".yml": Spelling.YAML, ".xml": Spelling.XML}
    return known.get(path.suffix.lower())


def document_spelling(document: Document) -> Spelling:
    """The spelling that a document was read from."""
    xml = is_xml(document.file, document.source[document.file])
    return Spelling.XML if xml else Spelling.YAML


def read_right(path: Path, registry: Registry) -> Document:
    """A tree file that is right in form; its nodes need not be installed.

    Raises:
        TreeNotFound: it cannot be read.
        TreeError: it is wrong in form.
    """
    document, problems = read_file(path, registry)
    found = problems.sorted()
    if errors(found):
        raise TreeError(found, document.source)
    return document


def write(document: Document, to: Spelling, registry: Registry) -> str:
    """A document that is right in form, as text that reads back as the same document.

    Raises:
        CannotWrite: something in it has no words in that spelling.
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
        resolve(again, problems)
    return again, problems


def meaning(document: Document) -> object:
    """The content of a document for comparisons, with the types of its values.

    Python's own `==` takes `true` for 1, and 1 for 1.0. Of nodes it has a list for each tree, in
    the order of the file and with the number of their children, so that deep ones can be compared.
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
