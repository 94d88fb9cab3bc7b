"""The trees of a YAML file: their names, what they take and give, and their nodes."""

from __future__ import annotations

from collections.abc import Mapping

from momantu_bt.formats.places import Place
from momantu_bt.formats.yaml.values import Entries, Raw, Scalar
from momantu_bt.tree.catalogue import MODIFIERS, SPELLED
from momantu_bt.tree.files.port_values import drop_duplicates, mapping, words
from momantu_bt.tree.files.queue import into_tree
from momantu_bt.tree.files.yaml.declarations import read_declarations
from momantu_bt.tree.files.yaml.nodes import NodeReader
from momantu_bt.tree.files.yaml.reading import Reading
from momantu_bt.tree.files.yaml.words import HEADER, PORTS
from momantu_bt.tree.language import AGAIN, TREE_NAME, TREE_NAME_HINT
from momantu_bt.tree.model import Node, Tree
from momantu_bt.tree.problems import Problems


def read_trees(
    entry: tuple[Scalar, Raw] | None, place: Place, outside: Mapping[str, Tree], problems: Problems
) -> dict[str, Tree] | None:
    """The value under `trees:`; None, and a problem, if there is no tree.

    place: the place of the whole file. outside: trees of the files that it includes.
    """
    having: list[tuple[Scalar, Raw]] = []
    if entry is not None:
        having = mapping(entry[1], "trees", "Name: [node, node]", problems)
    if not having and entry is None and outside:
        return {}
    if not having:
        where = entry[0].place if entry is not None else Place(place.file, place.line, 1)
        hint = "write `trees:` and under it `Name:`"
        problems.error("no-trees", where, "the file has no tree", hint)
        return None
    names = {*(key.text for key, _ in having), *outside}
    reader = NodeReader(Reading(names, problems))
    trees: dict[str, Tree] = {}
    for key, raw in having:
        _check_name(key, problems)
        if key.text not in trees:
            trees[key.text] = _tree(key, raw, reader)
    return trees


def _check_name(key: Scalar, problems: Problems) -> None:
    if not isinstance(key.value, str) or not TREE_NAME.fullmatch(key.text):
        message = f"{key.text!r} cannot be the name of a tree"
        problems.error("bad-name", key.place, message, TREE_NAME_HINT)
    elif key.text in SPELLED or key.text in MODIFIERS or key.text == AGAIN:
        message = f"{key.text!r} is a word of the language"
        problems.error("bad-name", key.place, message, "give the tree another name")


def _tree(key: Scalar, raw: Raw, reader: NodeReader) -> Tree:
    problems = reader.reading.problems
    tree = Tree(key.text, Node("", key.place), key.place)
    body = raw
    if isinstance(raw, Entries):
        drop_duplicates(raw, problems)
        _header(tree, {k.text: v for k, v in raw.entries if k.text in HEADER}, problems)
        body = Entries(
            [(k, v) for k, v in raw.entries if k.text not in HEADER], raw.place, raw.flow
        )
        if not body.entries:
            problems.error("no-node", key.place, f"the tree {key.text!r} has no node")
            return tree
    reader.read(body, into_tree(tree))
    return tree


def _header(tree: Tree, header: Mapping[str, Raw], problems: Problems) -> None:
    for name in PORTS:
        if name in header:
            read_declarations(tree, header[name], name, problems)
    if "open" in header:
        _open(tree, header["open"], problems)
    if "doc" in header:
        tree.doc = words(header["doc"], problems, "`doc`")


def _open(tree: Tree, raw: Raw, problems: Problems) -> None:
    if isinstance(raw, Scalar) and isinstance(raw.value, bool):
        tree.open = raw.value
    else:
        hint = "an open tree takes any key as a port"
        problems.error("wrong-value", raw.place, "`open` is true or false", hint)
