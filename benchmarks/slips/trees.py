"""Good trees in both spellings, what is known of their places, and trees with one slip."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import MISSING, dataclass, field, fields, is_dataclass
from pathlib import Path

from momantu_bt.formats.places import Place
from momantu_bt.formats.problems import Problem
from momantu_bt.messages import VALUE_TYPES
from momantu_bt.skill import Port
from momantu_bt.tree.catalogue import SUBTREE
from momantu_bt.tree.check.checker import check
from momantu_bt.tree.check.signatures import Context
from momantu_bt.tree.files.lookup import bundled
from momantu_bt.tree.files.xml.format import read as read_xml
from momantu_bt.tree.files.xml.writer import write as write_xml
from momantu_bt.tree.files.yaml.format import read as read_yaml
from momantu_bt.tree.model import Document, Node
from momantu_bt.tree.problems import Problems, TreeError
from momantu_bt.tree.registry import Registry
from momantu_bt.values.kinds import CodeText
from slips.xml import XML_SLIPS, Slip
from slips.yaml import SLIPS

ROOT = Path(__file__).resolve().parents[2]
GOOD_TREES = (
    *(path for path in sorted(bundled().values()) if "\ninclude:" not in path.read_text("utf-8")),
    *sorted((ROOT / "tests" / "framework" / "tree" / "good_trees").glob("*.yaml")),
)


@dataclass(frozen=True)
class Mutant:
    """A tree with one slip. line: where, from 1. changed: that line after the slip."""

    kind: str
    line: int
    changed: str
    text: str


@dataclass
class GoodTree:
    """A tree without problems, and what is known of its places.

    as_xml: written in the other spelling. free: where free text stands. optional: places of the
    names of ports that may be left out.
    """

    path: Path
    registry: Registry
    as_xml: bool = False
    text: str = ""
    document: Document = field(init=False)
    free: list[Place] = field(default_factory=list)
    optional: set[tuple[int, int]] = field(default_factory=set)

    def __post_init__(self) -> None:
        self.text = self.text or self.path.read_text(encoding="utf-8")
        if self.as_xml:
            plain = read_yaml(self.text, "t.yaml")[0]
            self.text = write_xml(check(plain, self.registry).document, self.registry)
        document, reading = self.read(self.text)
        checked = check(document, self.registry, reading=reading)
        self.document, wrong = checked.document, checked.problems
        assert not wrong, f"{self.path}: {wrong[0].place}: {wrong[0].message}"
        context = Context(self.document, self.registry, Problems())
        for tree in self.document.trees.values():
            for node in tree.root.walk():
                self._note(context, node)
            for port in tree.ports.values():
                if port.direction == "in" and port.default is None:
                    continue
                self.optional.add((port.place.line, 0))

    @property
    def slips(self) -> dict[str, Slip]:
        """What can go wrong in a line of its spelling."""
        return XML_SLIPS if self.as_xml else SLIPS

    def read(self, text: str) -> tuple[Document, Problems]:
        """Read a text in its spelling; TreeError where that cannot be done."""
        return read_xml(text, "t.xml", self.registry) if self.as_xml else read_yaml(text, "t.yaml")

    def problems(self, text: str) -> tuple[Document | None, list[Problem]]:
        """What is read from a text, and every problem that it has."""
        try:
            document, found = self.read(text)
        except TreeError as error:
            return None, error.problems
        checked = check(document, self.registry, reading=found)
        return checked.document, checked.problems

    def _note(self, context: Context, node: Node) -> None:
        signature = context.signature(node)
        ports = signature.ports if signature is not None else {}
        for name, place in node.port_places.items():
            port = ports.get(name)
            if port is not None and _is_free_text(port) and node.type != SUBTREE:
                self.free.append(place)
            if port is not None and not port.required:
                at = node.port_name_places.get(name, place)
                self.optional.add((at.line, at.column))


OPTIONAL_FIELDS = {
    "type",
    "editable",
    *(
        item.name
        for type_ in VALUE_TYPES.values()
        if is_dataclass(type_)
        for item in fields(type_)
        if item.default is not MISSING or item.default_factory is not MISSING
    ),
}
"""Parts of values that have a default; in a model of XML a port's type, which is any then."""


def _is_free_text(port: Port) -> bool:
    """A text that names nothing, or a code that the tree gives its own failure."""
    texts = port.type in (str, tuple[str, ...]) and port.names is None
    free = port.type is CodeText or texts
    return port.direction == "in" and free


def mutants(tree: GoodTree, kind: str) -> Iterator[Mutant]:
    """One kind of slip at every place of a tree; comments are left alone."""
    lines = tree.text.splitlines()
    for index, line in enumerate(lines):
        code, mark, comment = line.partition(" <!--" if tree.as_xml else " #")
        if code.lstrip().startswith(("#", "<!--", "<?")):
            continue
        for changed in tree.slips[kind](code):
            after = [*lines[:index], changed + mark + comment, *lines[index + 1 :]]
            yield Mutant(kind, index + 1, changed, "\n".join(after) + "\n")


def structural(tree: GoodTree) -> Iterator[Mutant]:
    """Slips of more than a line: trees that run themselves, nodes without their companion."""
    if tree.as_xml:
        return
    lines = tree.text.splitlines()
    for name, each_tree in tree.document.trees.items():
        for node in each_tree.root.walk():
            place = node.place
            line = lines[place.line - 1]
            bare = re.match(r"^( *- )\w", line)
            if bare is not None and place.column == len(bare[1]) + 1 and not node.children:
                after = [*lines[: place.line], f"{bare[1]}{name}", *lines[place.line :]]
                yield Mutant("tree that runs itself", place.line + 1, f"{name}", "\n".join(after))
    for index, line in enumerate(lines):
        for kind, pattern in BLOCKS.items():
            if re.match(pattern, line):
                end = _block_end(lines, index)
                after = [*lines[:index], *lines[end:]]
                yield Mutant(kind, index + 1, line, "\n".join(after) + "\n")


BLOCKS = {
    "catch left out": r"^ +catch:\s*$",
    "try left out": r"^ +try:",
    "then left out": r"^ +(then|do):",
    "trees left out": r"^trees:\s*$",
}


def _block_end(lines: Sequence[str], start: int) -> int:
    """Index of the first line after a block."""
    indent = len(lines[start]) - len(lines[start].lstrip())
    for index in range(start + 1, len(lines)):
        text = lines[index].strip()
        if text and len(lines[index]) - len(lines[index].lstrip()) <= indent:
            return index
    return len(lines)


def good_trees(registry: Registry, paths: Sequence[Path] = GOOD_TREES) -> list[GoodTree]:
    """Every good tree, in both spellings."""
    return [GoodTree(path, registry, as_xml) for as_xml in (False, True) for path in paths]
