"""Nodes of the model in YAML: modifiers beside a node's key, short ports in braces, lists below.

Writes with a stack, not by recursion.
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass, field
from typing import TypeAlias

from momantu_bt.formats.text import Beside
from momantu_bt.formats.yaml.writer import scalar
from momantu_bt.tree.catalogue import (
    EXPLICIT,
    NODES,
    PRE_CONDITIONS,
    SUBTREE,
    Kind,
    NodeSpec,
    is_ours,
)
from momantu_bt.tree.files.scalars import CannotWrite, port_text
from momantu_bt.tree.files.xml.ports import PREFIX
from momantu_bt.tree.files.xml.tags import Tags
from momantu_bt.tree.files.yaml.kept import TAG, Shown, attribute_lines, xml_lines
from momantu_bt.tree.files.yaml.leaf_writer import LeafWriter
from momantu_bt.tree.files.yaml.lines import STEP, WIDTH, above, beside
from momantu_bt.tree.files.yaml.scripts import script_text
from momantu_bt.tree.files.yaml.spellings import (
    FORCE,
    bare_condition,
    can_be_modifier,
    has_modifiers,
    is_short,
    switch_cases,
)
from momantu_bt.tree.files.yaml.words import COMPANIONS, NODE, RUNS, SWITCH
from momantu_bt.tree.language import AGAIN
from momantu_bt.tree.model import BROKEN, Handler, Node


@dataclass(frozen=True, slots=True)
class _Value:
    """A node after `key:`. lead: the text up to the colon. pad: goes before the lines below it.

    braces: whether a short node may stand on the line of its key.
    """

    node: Node
    lead: str
    pad: str
    comments: tuple[str, ...] = ()
    taken: Collection[str] = ()
    braces: bool = True


@dataclass(frozen=True, slots=True)
class _Body:
    """A node as the keys of a mapping. lead: the text before its first key."""

    node: Node
    lead: str
    taken: Collection[str] = ()


_Piece: TypeAlias = str | _Value | _Body


@dataclass(frozen=True, slots=True)
class NodeWriter:
    """Writes nodes. leaves: writes their names and ports. tags: their tags in XML."""

    leaves: LeafWriter
    tags: Tags
    shown: Shown = field(init=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "shown", Shown(self.tags))

    def is_nothing(self, node: Node) -> bool:
        """Whether a tree lacks its root node."""
        return node.type == BROKEN and node.tag is None

    def item(self, node: Node, pad: int) -> list[str]:
        """The lines of a node as an item of a list."""
        return self._lines(_Body(self.shown.of(node), " " * pad + "- "))

    def value(
        self, node: Node, lead: str, pad: int, *, taken: Collection[str], comments: tuple[str, ...]
    ) -> list[str]:
        """The lines of a node after `key:`. taken: keys that have another meaning beside it."""
        return self._lines(_Value(self.shown.of(node), lead, " " * pad, comments, taken))

    def body(self, node: Node, pad: int, *, taken: Collection[str]) -> list[str]:
        """The lines of a node as keys of the mapping that it is in."""
        return self._lines(_Body(self.shown.of(node), " " * pad, taken))

    def _lines(self, first: _Piece) -> list[str]:
        lines: list[str] = []
        stack: list[_Piece] = [first]
        while stack:
            piece = stack.pop()
            if isinstance(piece, str):
                lines.append(piece)
                continue
            try:
                below = self._value(piece) if isinstance(piece, _Value) else self._body(piece)
            except CannotWrite as error:
                error.place = piece.node.place
                raise
            stack.extend(reversed(below))
        return lines

    def _value(self, piece: _Value) -> list[_Piece]:
        node, lead, pad = piece.node, piece.lead, piece.pad
        heading = lead + beside(piece.comments)
        bare = node.type == "Sequence" and node.children and not has_modifiers(node)
        if bare and not node.comments:
            items = [_Body(child, f"{pad}- ") for child in node.children]
            return [heading, *items, *above(node.end_comments, pad, every=True)]
        if self._is_short(node, piece.taken):
            inside = self._inside(node)
            key = self.leaves.key(node)
            line = f"{lead} {{{key}: {inside}}}" if inside else f"{lead} {key}"
            fits = len(line) <= WIDTH and piece.braces and key not in piece.taken
            if fits or not inside:
                return [line + beside((*piece.comments, *node.comments))]
        return [heading, _Body(node, pad, piece.taken)]

    def _is_short(self, node: Node, taken: Collection[str] = ()) -> bool:
        """Whether a node and its child, if it has one, fit in braces."""
        named = self._by_name(node, taken) or any(map(self._by_name, node.children))
        return is_short(node) and not named and not self.shown.says_xml(node)

    def _inside(self, node: Node) -> str:
        """The text after the key of a short node in braces. It may be empty."""
        if not node.children:
            return self.leaves.text(node, flow=True)
        child = node.children[0]
        below = self.leaves.text(child, flow=True)
        inside = f"{{{self.leaves.key(child)}: {below}}}" if below else self.leaves.key(child)
        return "{" + ", ".join([*self.leaves.pairs(node), f"child: {inside}"]) + "}"

    # one node as keys

    def _body(self, piece: _Body) -> list[_Piece]:
        inner, modifiers = self._unwrapped(piece.node)
        lead, pad = piece.lead, " " * len(piece.lead)
        edge = pad.removesuffix(STEP) if lead.endswith("- ") else pad
        remarks = [c for outer in reversed(modifiers) for c in outer.comments]
        pieces: list[_Piece] = [*above((*map(str, remarks), *inner.comments), edge)]
        entries = self._entries(inner, pad)
        if self._by_name(inner, piece.taken):
            pieces += self._named(inner, lead, pad, entries)
        else:
            pieces += self._keyed(inner, lead, pad, bool(entries or modifiers))
            pieces += entries
        for outer in modifiers:
            inside = [c for each in outer.port_comments.values() for c in each]
            remark = tuple(Beside(c) for c in (*inside, *outer.end_comments))
            pieces += [*above(remark, pad), pad + self._modifier(outer) + beside(remark)]
        return pieces

    def _unwrapped(self, node: Node) -> tuple[Node, list[Node]]:
        """The node without its modifiers, and those modifiers, innermost first."""
        chain = [node]
        while can_be_modifier(chain[-1]):
            chain.append(chain[-1].children[0])
        inner = chain.pop()
        modifiers: list[Node] = []
        used = {"" if self._by_name(inner) else self.leaves.key(inner)}
        for outer in reversed(chain):
            key = self._modifier(outer).partition(":")[0]
            if key in used:  # a mapping has each key once, so write this one with `child:`
                inner, modifiers, used = outer, [], {self.leaves.key(outer)}
            else:
                modifiers.append(outer)
                used.add(key)
        return inner, modifiers

    def _modifier(self, node: Node) -> str:
        if node.type in FORCE:
            return FORCE[node.type]
        key = NODES[node.type].yaml[0]
        values = [f" {port_text(value)}" for value in node.ports.values()]
        return f"{key}:{''.join(values)}"

    def _entries(self, node: Node, pad: str) -> list[str]:
        """Name, note and conditions: keys of the node itself, beside its own key."""
        lines = [
            f"{pad}{key}: {scalar(text)}"
            for key, text in (("name", node.name), ("note", node.note))
            if text is not None
        ]
        if node.disabled:
            lines.append(f"{pad}disabled: true")
        lines += [
            f"{pad}{key}: {script_text(text, asked=key in PRE_CONDITIONS)}"
            for key, text in node.conditions.items()
        ]
        lines += attribute_lines(node.attributes, pad)
        return lines + xml_lines(self.shown.xml[id(node)], pad)

    # a node by its type or name, under `node:` or `subtree:`

    def _by_name(self, node: Node, taken: Collection[str] = ()) -> bool:
        """Whether no word of YAML can stand for a node as it is."""
        spec = NODES.get(node.type)
        if spec is None:
            name = node.target if node.type == SUBTREE else node.type
            if not self.leaves.can_be_key(node) or name in taken:
                return True
            return bool(node.type == SUBTREE and node.children) or "children" in node.ports
        return spec.yaml[0] in taken or not _has_its_children(node, spec)

    def _named(self, node: Node, lead: str, pad: str, entries: list[str]) -> list[_Piece]:
        key, name = NODE, node.type
        if node.type == SUBTREE:
            key, name = RUNS, node.target or ""
        elif node.type == BROKEN:
            tags = dict(self.shown.xml[id(node)])
            known = node.tag in EXPLICIT and tags.get(TAG) == node.tag
            name = self.shown.ids[id(node)] if known else node.tag or ""
        elif is_ours(name):
            name = PREFIX + name
        if node.handlers:
            raise CannotWrite(f"{name} takes no `catch:`")
        lines = [f"{lead}{key}: {scalar(name, typed=False)}{beside(node.comments)}", *entries]
        if node.ports:
            line = f"{pad}ports: {{{', '.join(self.leaves.pairs(node))}}}"
            fits = len(line) <= WIDTH and not node.port_comments
            inside = self.leaves.ports(node, pad + STEP)
            lines += [line] if fits else [f"{pad}ports:", *inside]
        pieces: list[_Piece] = [*lines]
        if node.children:
            items = [_Body(child, f"{pad}{STEP}- ") for child in node.children]
            pieces += [f"{pad}children:", *items]
        return [*pieces, *above(node.end_comments, pad + STEP, every=True)]

    def _keyed(self, node: Node, lead: str, pad: str, more: bool) -> list[_Piece]:
        """The node's key with everything under it. more: whether other keys follow."""
        spec = NODES.get(node.type)
        key, end = self.leaves.key(node), above(node.end_comments, pad + STEP, every=True)
        heading = f"{lead}{key}:{beside(node.comments)}"
        if spec is not None and spec.switch and (cases := switch_cases(node)) is not None:
            return [*self._switch(node, cases, lead, pad), *end]
        if spec is not None and spec.yaml[0] in COMPANIONS and not spec.switch:
            return [*self._branches(node, lead, pad), *end]
        if spec is not None and spec.handlers:
            return [heading, *self.leaves.ports(node, pad + STEP), *self._recovery(node, pad), *end]
        if spec is not None and spec.kind is Kind.DECORATOR:
            line = f"{lead}{key}: {self._inside(node)}" if self._is_short(node) else ""
            if line and len(line) <= WIDTH:
                return [line + beside((*node.comments, *node.children[0].comments))]
            return [heading, *self.leaves.ports(node, pad + STEP), *self._child(node, pad), *end]
        if node.handlers:
            raise CannotWrite(f"{key} takes no `catch:`")
        if node.children:
            return [heading, *self._children(node, pad), *end]
        return [*self.leaves.lines(node, lead, pad, more), *end]

    def _children(self, node: Node, pad: str) -> list[_Piece]:
        if not node.ports and node.type in NODES:
            return [_Body(child, f"{pad}{STEP}- ") for child in node.children]
        if not node.children:
            return [*self.leaves.ports(node, pad + STEP)]
        items = [_Body(child, f"{pad}{STEP * 2}- ") for child in node.children]
        return [*self.leaves.ports(node, pad + STEP), f"{pad}{STEP}children:", *items]

    def _child(self, node: Node, pad: str) -> list[_Piece]:
        return [_Value(node.children[0], f"{pad}{STEP}child:", pad + STEP * 2)]

    def _branches(self, node: Node, lead: str, pad: str) -> list[_Piece]:
        key = self.leaves.key(node)
        names = (key, *COMPANIONS[key])
        first, *others = node.children
        pieces: list[_Piece] = [_Value(first, f"{lead}{key}:", pad + STEP, node.comments)]
        if (script := bare_condition(first)) is not None:
            comments = (*node.comments, *first.comments)
            pieces = [*above(first.comments, pad), f"{lead}{key}: {script}{beside(comments)}"]
        for name, child in zip(names[1:], others, strict=False):
            pieces.append(_Value(child, f"{pad}{name}:", pad + STEP))
        return pieces

    def _switch(self, node: Node, cases: list[str], lead: str, pad: str) -> list[_Piece]:
        deeper = pad + STEP * 2
        *chosen, default = node.children
        variable = port_text(node.ports["variable"])
        pieces: list[_Piece] = [
            f"{lead}{SWITCH}: {variable}{beside(node.comments)}",
            f"{pad}cases:",
        ]
        for number, (case, child) in enumerate(zip(cases, chosen, strict=True), start=1):
            comments = node.port_comments.get(f"case_{number}", ())
            pieces += above(comments, pad + STEP)
            pieces.append(_Value(child, f"{pad}{STEP}{case}:", deeper, comments))
        return [*pieces, _Value(default, f"{pad}default:", pad + STEP)]

    def _recovery(self, node: Node, pad: str) -> list[_Piece]:
        if len(node.children) != 1 or not node.handlers:
            raise CannotWrite(f"{self.leaves.key(node)} needs one `try` and a handler")
        inside, deeper = pad + STEP, pad + STEP * 2
        pieces: list[_Piece] = [
            _Value(node.children[0], f"{inside}try:", deeper, braces=False),
            f"{inside}catch:",
        ]
        for handler in node.handlers:
            pieces += [*above(handler.comments, deeper), self._handler(handler, deeper)]
        return pieces

    def _handler(self, handler: Handler, pad: str) -> _Piece:
        if not handler.codes:
            raise CannotWrite("a handler without a code")
        lead = f"{pad}{scalar(' | '.join(handler.codes), typed=False)}:"
        if handler.node is None:
            return f"{lead} {AGAIN}{beside(handler.comments)}"
        return _Value(handler.node, lead, pad + STEP, handler.comments)


def _has_its_children(node: Node, spec: NodeSpec) -> bool:
    """Whether the node's own word in YAML has a place for each of its children."""
    count = len(node.children)
    if spec.switch:
        return count == spec.switch + 1 and bool(node.ports)
    if spec.handlers:
        return True  # what it lacks is reported where it is written
    if spec.yaml[0] in COMPANIONS:
        return not node.ports and 2 <= count <= 1 + len(COMPANIONS[spec.yaml[0]])
    if spec.kind is Kind.DECORATOR:
        return count == 1
    return spec.kind is Kind.CONTROL or not count
