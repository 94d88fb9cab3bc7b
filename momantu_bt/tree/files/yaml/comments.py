"""Comments of a YAML tree file, given to what they are about in the model.

A comment belongs to what follows it. A comment at the end of a line belongs to what is on that
line. A comment that is indented further than what follows ends the list or mapping above it.
"""

from __future__ import annotations

from bisect import bisect_left, bisect_right
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

from momantu_bt.formats.places import Place, lines_of
from momantu_bt.formats.text import Beside
from momantu_bt.formats.yaml.comments import Comment
from momantu_bt.formats.yaml.values import Entries, Items, Raw
from momantu_bt.tree.files.yaml.models import add_comment
from momantu_bt.tree.model import Document, Node, PortDeclaration, Tree

_FIRST_KEYS = ("momantu_bt", "world", "goal", "main", "include", "xml")
_PORT_KEYS = ("inputs:", "outputs:", "inouts:", "doc:", "open:", "metadata:", "tree:")
_DASH = 2
"""The columns of `- `: an item's name stands so far to the right of its list."""

Put = Callable[[str], None]


@dataclass(frozen=True, slots=True)
class _Anchor:
    """Something that comments can belong to.

    above, beside: each takes a comment. node: the node that this is part of.
    """

    line: int
    column: int
    above: Put
    beside: Put
    node: Node | None = None


@dataclass(slots=True)
class _Attacher:
    document: Document
    lines: tuple[str, ...]
    written: list[int]
    anchors: list[_Anchor] = field(default_factory=list)
    parents: dict[int, Node] = field(default_factory=dict)

    def indent(self, line: int) -> int:
        """The column of the first word of a line, after dashes."""
        text = self.lines[line - 1]
        return len(text) - len(text.lstrip(" -")) + 1

    # what comments can belong to

    def collect(self, raw: Raw) -> None:
        document = self.document
        for key, value in raw.entries if isinstance(raw, Entries) else []:
            if key.text in _FIRST_KEYS:
                self.add(key.place, _adder(document, "header_comments"))
            elif key.text == "models":
                self.add(key.place, _adder(document, "models_comments"))
                self.models(value)
        for name, place in document.value_places.items():
            self.add(place, _named_adder(document.value_comments, name))
        for tree in document.trees.values():
            if tree.place.file == document.file:
                self.tree(tree)
        self.anchors.sort(key=lambda anchor: (anchor.line, anchor.column))

    def add(
        self, place: Place, above: Put, beside: Put | None = None, of: Node | None = None
    ) -> None:
        if place.file == self.document.file:
            anchor = _Anchor(place.line, place.column, above, beside or above, of)
            self.anchors.append(anchor)

    def models(self, raw: Raw) -> None:
        items = raw.items if isinstance(raw, Items) else []
        if len(items) != len(self.document.models):
            return  # some of them are wrong
        for number, item in enumerate(items):
            self.add(item.place, self.model_adder(number, None))
            entries = item.entries if isinstance(item, Entries) else []
            listed = [value for key, value in entries if key.text == "ports"]
            ports = listed[0].items if listed and isinstance(listed[0], Items) else []
            if len(ports) == len(self.document.models[number].ports):
                for at, port in enumerate(ports):
                    self.add(port.place, self.model_adder(number, at))

    def model_adder(self, number: int, port: int | None) -> Put:
        return lambda text: add_comment(self.document, number, port, text)

    def tree(self, tree: Tree) -> None:
        self.add(tree.place, _adder(tree, "comments"))
        for declaration in tuple(tree.ports.values()):
            words = self.lines[declaration.place.line - 1].lstrip()
            if words.startswith(_PORT_KEYS):  # several in one line
                self.add(declaration.place, _adder(tree, "comments"))
            else:
                self.add(declaration.place, _declaration_adder(tree, declaration))
        for node in tree.nodes():
            for child in node.children:
                self.parents[id(child)] = node
            for handler in node.handlers:
                if handler.node is not None:
                    self.parents[id(handler.node)] = node
        for node in tree.nodes():
            self.node(node)

    def node(self, node: Node) -> None:
        outermost = node
        while (
            parent := self.parents.get(id(outermost))
        ) is not None and parent.written_as_modifier:
            outermost = parent
        above, end = _adder(outermost, "comments"), _adder(node, "end_comments")
        key = node
        while key.written_as_modifier and key.children:
            key = key.children[0]
        if node is not key:
            self.modifier(node.place, key, _adder(outermost, "comments"), end)
        elif not self.is_bare_list(node):
            self.add(node.place, above, _adder(node, "comments"), node)
        for place in node.condition_places.values():
            self.modifier(place, key, above, end)
        for name, place in node.port_name_places.items():
            put = end if node is not key else _named_adder(node.port_comments, name)
            self.add(place, put, of=node)
        for handler in node.handlers:
            self.add(handler.place, _adder(handler, "comments"), of=node)

    def modifier(self, place: Place, key: Node, above: Put, end: Put) -> None:
        """Add a modifier's line. If it begins the item, a comment above it is about the item."""
        first = (place.line, place.column) < (key.place.line, key.place.column)
        self.add(place, above if first else end, end, key)

    def is_bare_list(self, node: Node) -> bool:
        """Whether it is a list without a key of its own. Its first item has the same place."""
        text = self.lines[node.place.line - 1][node.place.column - 1 :]
        return node.type == "Sequence" and text.startswith("- ") and bool(node.children)

    # giving

    def give(self, remark: Comment) -> None:
        index = bisect_left(self.anchors, remark.line, key=lambda anchor: anchor.line)
        following = index
        while following < len(self.anchors) and self.anchors[following].line == remark.line:
            following += 1
        if remark.beside and following > index:
            self.anchors[index].beside(Beside(remark.text))
        elif remark.beside and index and not self.opens(remark):
            self.anchors[index - 1].beside(Beside(remark.text))
        else:
            self.above(remark, index)

    def opens(self, remark: Comment) -> bool:
        """Whether the text before the comment only begins something: `catch:`."""
        return self.lines[remark.line - 1][: remark.column - 1].rstrip().endswith((":", "-"))

    def above(self, remark: Comment, following: int) -> None:
        ahead = self.anchors[following] if following < len(self.anchors) else None
        if not remark.beside and following and self.is_deeper(remark):
            end = self.ended(self.anchors[following - 1].node, remark.column)
            if end is not None:
                end.end_comments += (remark.text,)
                return
        if ahead is not None:
            ahead.above(remark.text)
        else:
            self.document.comments += (remark.text,)

    def is_deeper(self, remark: Comment) -> bool:
        """Whether a comment is indented further than the next line that is not a comment."""
        following = bisect_right(self.written, remark.line)
        if following == len(self.written):
            return True
        return remark.column > self.indent(self.written[following])

    def ended(self, node: Node | None, column: int) -> Node | None:
        """The node at whose end, after everything in it, a comment in this column stands."""
        while node is not None:
            if column > node.place.column:
                return node
            parent = self.parents.get(id(node))
            if column >= node.place.column - _DASH:
                return parent if parent is not None else node
            node = parent
        return None


def attach(document: Document, raw: Raw, text: str, remarks: Sequence[Comment]) -> None:
    """Give each comment of a file to a part of its document. raw: the file's mapping."""
    lines = lines_of(text)
    written = [number for number, line in enumerate(lines, 1) if line.split("#")[0].strip()]
    attacher = _Attacher(document, lines, written)
    attacher.collect(raw)
    for remark in remarks:
        attacher.give(remark)


def _adder(owner: object, name: str) -> Put:
    def put(comment: str) -> None:
        setattr(owner, name, (*getattr(owner, name), comment))

    return put


def _named_adder(comments: dict[str, tuple[str, ...]], name: str) -> Put:
    def put(comment: str) -> None:
        comments[name] = (*comments.get(name, ()), comment)

    return put


def _declaration_adder(tree: Tree, declaration: PortDeclaration) -> Put:
    def put(comment: str) -> None:
        now = tree.ports[declaration.name]
        tree.ports[declaration.name] = replace(now, comments=(*now.comments, comment))

    return put
