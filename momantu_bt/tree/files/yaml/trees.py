"""The trees of a YAML file: their names, what they take and give, and their nodes."""

from __future__ import annotations

import re
from collections.abc import Collection, Mapping

from momantu_bt.formats.yaml.values import Entries, Items, Raw, Scalar
from momantu_bt.tree.catalogue import MODIFIERS, SPELLED
from momantu_bt.tree.files.port_values import drop_duplicates, mapping, words
from momantu_bt.tree.files.queue import into_tree
from momantu_bt.tree.files.xml.nodes import NodeReader as AttributeReader
from momantu_bt.tree.files.yaml.declarations import read_declarations
from momantu_bt.tree.files.yaml.misspelled import mend_declarations
from momantu_bt.tree.files.yaml.models import give_ports, read_metadata
from momantu_bt.tree.files.yaml.nodes import NodeReader
from momantu_bt.tree.files.yaml.parts import read_tree_attributes
from momantu_bt.tree.files.yaml.reading import Reading
from momantu_bt.tree.files.yaml.words import HEADER, PORTS
from momantu_bt.tree.language import AGAIN, TREE_NAME, TREE_NAME_HINT
from momantu_bt.tree.model import Document, MetadataFields, Node, Tree
from momantu_bt.tree.problems import Problems
from momantu_bt.tree.registry import Registry

_RUN_TOGETHER = re.compile(rf"({'|'.join(PORTS)})[^\w]")
"""A key of a tree that runs into its value."""


def read_trees(
    entry: tuple[Scalar, Raw] | None,
    document: Document,
    outside: Mapping[str, Tree],
    registry: Registry,
    problems: Problems,
) -> None:
    """Give a document the trees under `trees:`. Its models must be known.

    outside: trees of the files that it includes. registry: the skills.
    """
    having: list[tuple[Scalar, Raw]] = []
    if entry is not None:
        having = mapping(entry[1], "trees", "Name: [node, node]", problems)
    bodies: list[tuple[Tree, Raw]] = []
    known = [*outside, *(key.text for key, _ in having)]
    for key, raw in having:
        _check_name(key, problems)
        if key.text not in document.trees:
            bodies.append(_header(key, raw, [*known, *registry.skills], problems))
            document.trees[key.text] = bodies[-1][0]
    give_ports(document, problems)
    ports = {name: tree.ports for name, tree in {**outside, **document.trees}.items()}
    attributes = AttributeReader(ports, registry, problems)
    reading = Reading(ports.keys(), registry.skills, problems, attributes, document.explicit)
    reader = NodeReader(reading)
    for tree, body in bodies:
        _read_nodes(tree, body, reader)


def _check_name(key: Scalar, problems: Problems) -> None:
    with problems.keeping():
        if not isinstance(key.value, str) or not TREE_NAME.fullmatch(key.text):
            message = f"{key.text!r} cannot be the name of a tree"
            hint = TREE_NAME_HINT if isinstance(key.value, str) else f'write "{key.text}"'
            problems.error("bad-name", key.place, message, hint)
        elif key.text in SPELLED or key.text in MODIFIERS or key.text == AGAIN:
            message = f"{key.text!r} is a word of the language"
            problems.error("bad-name", key.place, message, "give the tree another name")


def _header(key: Scalar, raw: Raw, skills: Collection[str], problems: Problems) -> tuple[Tree, Raw]:
    """A tree with everything but its nodes, and the value that has the nodes."""
    tree = Tree(key.text, Node("", key.place), key.place)
    if not isinstance(raw, Entries):
        return tree, raw
    told = problems.count
    _near_words(raw, problems)
    told_words = problems.count
    mend_declarations(raw, skills, problems)
    told += problems.count - told_words
    drop_duplicates(raw, problems)
    header = {k.text: v for k, v in raw.entries if k.text in HEADER}
    for name in PORTS:
        if name in header:
            read_declarations(tree, header[name], name, problems)
    tree.misread = problems.count > told
    if "open" in header:
        _open(tree, header["open"], problems)
    if "doc" in header:
        tree.doc = words(header["doc"], problems, "`doc`")
    if "metadata" in header:
        first = next(n for n in header if n in (*PORTS, "metadata")) == "metadata"
        at = 0 if first else len(tree.ports)
        tree.metadata = (MetadataFields(read_metadata(header["metadata"], problems), at),)
    if "tree" in header:
        read_tree_attributes(tree, header["tree"], problems)
    body = [(k, v) for k, v in raw.entries if k.text not in HEADER or k.text == "nodes"]
    return tree, Entries(body, raw.place, raw.flow)


def _near_words(raw: Entries, problems: Problems) -> None:
    """Report `inputs {…`, where a colon or a space is missing, and leave it out."""
    kept: list[tuple[Scalar, Raw]] = []
    for key, value in raw.entries:
        wrong = _RUN_TOGETHER.match(key.text)
        if wrong is None:
            kept.append((key, value))
            continue
        message = f"`{wrong[1]}` needs a colon and a space after it"
        problems.error("unknown-key", key.place, message, f"write `{wrong[1]}: {{name: type}}`")
    raw.entries = kept


def _read_nodes(tree: Tree, body: Raw, reader: NodeReader) -> None:
    problems = reader.reading.problems
    several = body.entries[0] if isinstance(body, Entries) and len(body.entries) == 1 else None
    if several is not None and several[0].text == "nodes" and isinstance(several[1], Items):
        _read_roots(tree, several[1], reader)
        return
    if isinstance(body, Entries) and not body.entries:
        problems.error("no-node", tree.place, f"the tree {tree.name!r} has no node")
        return
    reader.read(body, into_tree(tree))


def _read_roots(tree: Tree, raw: Items, reader: NodeReader) -> None:
    """Read a number of root nodes other than one, which an XML file has by mistake."""
    problems = reader.reading.problems
    with problems.keeping():
        if not raw.items:
            problems.error("no-node", tree.place, f"the tree {tree.name!r} has no node")
        for extra in raw.items[1:]:
            message = f"the tree {tree.name!r} has {len(raw.items)} nodes at its root; it has one"
            problems.error("children", extra.place, message, "put them into a `sequence:`")
    for number, item in enumerate(raw.items):
        reader.read(item, into_tree(tree) if not number else tree.further.append)


def _open(tree: Tree, raw: Raw, problems: Problems) -> None:
    if isinstance(raw, Scalar) and isinstance(raw.value, bool):
        tree.open = raw.value
    else:
        hint = "an open tree takes any key as a port"
        problems.error("wrong-value", raw.place, "`open` is true or false", hint)
