"""Nodes of the model in YAML: modifiers beside a node's key, short ports in braces, lists below.

Writes with a stack, not by recursion.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from typing import TypeAlias

from momantu_bt.plugins import PluginError
from momantu_bt.tree.catalogue import (
    BUILT_IN,
    FORCED,
    MODIFIERS,
    SPELLED,
    SUBTREE,
    Kind,
    ScriptText,
)
from momantu_bt.tree.model import FIRST_INPUT, Beside, Handler, Literal, Node, PortValue
from momantu_bt.tree.registry import Registry
from momantu_bt.tree.yaml_nodes import AGAIN, COMPANIONS
from momantu_bt.tree.yaml_scalars import (
    CannotWrite,
    literal,
    port_text,
    scalar,
    script_spelling,
    script_text,
)

WIDTH = 100
"""Columns of a line, where ports can be moved to lines of their own."""

_FORCE = {type_: f"force: {word}" for word, type_ in FORCED.items()}
_STEP = "  "


def above(comments: Sequence[str], pad: str, *, every: bool = False) -> list[str]:
    """Comments as lines of their own. every: those too that stand beside something."""
    own = [c for c in comments if every or not isinstance(c, Beside)]
    # of several beside one line, one stays there
    own += [] if every else [c for c in comments if isinstance(c, Beside)][1:]
    return [f"{pad}{_signed(line)}" for comment in own for line in comment.split("\n")]


def beside(comments: Sequence[str]) -> str:
    """The comment at the end of a line, with what sets it apart; empty where there is none."""
    first = next((c for c in comments if isinstance(c, Beside)), None)
    return "" if first is None else f"  {_signed(first.replace(chr(10), ' '))}"


def spread(value: PortValue, lead: str, text: str, comments: Sequence[str]) -> list[str]:
    """A value behind `key:`; a long list or mapping with an entry a line. text: it on one line."""
    line, pad = f"{lead} {text}", " " * (len(lead) - len(lead.lstrip()) + len(_STEP))
    nested = value.value if isinstance(value, Literal) and _is_nested(value) else None
    if len(line) <= WIDTH or not nested:
        return [line + beside(comments)]
    if isinstance(nested, dict):
        entries = [f"{scalar(k, typed=False)}: {literal(v)}" for k, v in nested.items()]
    else:
        entries = [f"- {literal(item)}" for item in nested]
    return [lead + beside(comments), *(pad + entry for entry in entries)]


def _signed(text: str) -> str:
    return f"#{text}" if not text or text.startswith("#") else f"# {text}"


@dataclass(frozen=True, slots=True)
class _Value:
    """A node behind `key:`. lead: up to the colon; pad: before the lines below it.

    braces: a short node may stand on the line of its key.
    """

    node: Node
    lead: str
    pad: str
    comments: tuple[str, ...] = ()
    taken: Collection[str] = ()
    braces: bool = True


@dataclass(frozen=True, slots=True)
class _Body:
    """A node as the keys of a mapping. lead: what stands before its first key."""

    node: Node
    lead: str
    taken: Collection[str] = ()


_Piece: TypeAlias = str | _Value | _Body


@dataclass(frozen=True, slots=True)
class NodeWriter:
    """Writes nodes. trees: names that are trees; registry: skills, where one is known."""

    trees: Collection[str]
    registry: Registry

    def value(
        self, node: Node, lead: str, pad: int, *, taken: Collection[str], comments: tuple[str, ...]
    ) -> list[str]:
        """The lines of a node behind `key:`. taken: keys that mean something else beside it."""
        return self._lines(_Value(node, lead, " " * pad, comments, taken))

    def body(self, node: Node, pad: int, *, taken: Collection[str]) -> list[str]:
        """The lines of a node as keys of the mapping they stand in."""
        return self._lines(_Body(node, " " * pad, taken))

    def _lines(self, first: _Piece) -> list[str]:
        lines: list[str] = []
        stack: list[_Piece] = [first]
        while stack:
            piece = stack.pop()
            if isinstance(piece, str):
                lines.append(piece)
            elif isinstance(piece, _Value):
                stack.extend(reversed(self._value(piece)))
            else:
                stack.extend(reversed(self._body(piece)))
        return lines

    def _value(self, piece: _Value) -> list[_Piece]:
        node, lead, pad = piece.node, piece.lead, piece.pad
        heading = lead + beside(piece.comments)
        if node.type == "Sequence" and node.children and not _has_modifiers(node):
            items = [_Body(child, f"{pad}- ") for child in node.children]
            comments = above(node.comments, pad, every=True)
            return [heading, *comments, *items, *above(node.end_comments, pad, every=True)]
        if _is_short(node):
            inside = self._inside(node)
            key = self._key(node)
            line = f"{lead} {{{key}: {inside}}}" if inside else f"{lead} {key}"
            fits = len(line) <= WIDTH and piece.braces and key not in piece.taken
            if fits or not inside:
                return [line + beside((*piece.comments, *node.comments))]
        return [heading, _Body(node, pad, piece.taken)]

    def _inside(self, node: Node) -> str:
        """What follows the key of a short node within braces; empty where there is nothing."""
        if not node.children:
            return self._leaf_text(node, flow=True)
        child = node.children[0]
        below = self._leaf_text(child, flow=True)
        inside = f"{{{self._key(child)}: {below}}}" if below else self._key(child)
        return "{" + ", ".join([*self._pairs(node), f"child: {inside}"]) + "}"

    # one node as keys

    def _body(self, piece: _Body) -> list[_Piece]:
        inner, modifiers = self._unwrapped(piece.node)
        lead, pad = piece.lead, " " * len(piece.lead)
        if self._key(inner) in piece.taken:
            raise CannotWrite(f"{self._key(inner)!r} means something else in a tree's first lines")
        edge = pad.removesuffix(_STEP) if lead.endswith("- ") else pad
        remarks = [c for outer in reversed(modifiers) for c in outer.comments]
        pieces: list[_Piece] = [*above((*map(str, remarks), *inner.comments), edge)]
        entries = self._entries(inner, pad)
        pieces += self._keyed(inner, lead, pad, bool(entries or modifiers))
        pieces += entries
        for outer in modifiers:
            remark = tuple(Beside(c) for c in outer.end_comments)
            pieces += [*above(remark, pad), pad + self._modifier(outer) + beside(remark)]
        return pieces

    def _unwrapped(self, node: Node) -> tuple[Node, list[Node]]:
        """The node without what can be written as modifiers, and that, innermost first."""
        chain = [node]
        while _can_be_modifier(chain[-1]):
            chain.append(chain[-1].children[0])
        inner = chain.pop()
        modifiers: list[Node] = []
        used = {self._key(inner)}
        for outer in reversed(chain):
            key = self._modifier(outer).partition(":")[0]
            if key in used:  # a mapping has each key once: this one is written with `child:`
                inner, modifiers, used = outer, [], {self._key(outer)}
            else:
                modifiers.append(outer)
                used.add(key)
        return inner, modifiers

    def _modifier(self, node: Node) -> str:
        if node.type in _FORCE:
            return _FORCE[node.type]
        key = BUILT_IN[node.type].yaml[0]
        values = [f" {port_text(value)}" for value in node.ports.values()]
        return f"{key}:{''.join(values)}"

    def _entries(self, node: Node, pad: str) -> list[str]:
        """Name, note, conditions: what is the node's own beside its key."""
        lines = [
            f"{pad}{key}: {scalar(text)}"
            for key, text in (("name", node.name), ("note", node.note))
            if text is not None
        ]
        if node.disabled:
            lines.append(f"{pad}disabled: true")
        return lines + [f"{pad}{key}: {script_text(s)}" for key, s in node.conditions.items()]

    def _keyed(self, node: Node, lead: str, pad: str, more: bool) -> list[_Piece]:
        """The node's key with all that belongs under it. more: other keys follow."""
        spec = BUILT_IN.get(node.type)
        key, end = self._key(node), above(node.end_comments, pad + _STEP, every=True)
        heading = f"{lead}{key}:{beside(node.comments)}"
        if spec is not None and spec.yaml[0] in COMPANIONS:
            return [*self._branches(node, lead, pad), *end]
        if spec is not None and spec.handlers:
            return [heading, *self._ports(node, pad + _STEP), *self._recovery(node, pad), *end]
        if spec is not None and spec.kind is Kind.DECORATOR:
            line = f"{lead}{key}: {self._inside(node)}" if _is_short(node) else ""
            if line and len(line) <= WIDTH:
                return [line + beside((*node.comments, *node.children[0].comments))]
            return [heading, *self._ports(node, pad + _STEP), *self._child(node, pad), *end]
        if node.handlers:
            raise CannotWrite(f"{key} takes no `catch:`")
        if node.children:
            return [heading, *self._children(node, pad), *end]
        return [*self._leaf(node, lead, pad, more), *end]

    def _children(self, node: Node, pad: str) -> list[_Piece]:
        if not node.ports and node.type in BUILT_IN:
            return [_Body(child, f"{pad}{_STEP}- ") for child in node.children]
        items = [_Body(child, f"{pad}{_STEP * 2}- ") for child in node.children]
        return [*self._ports(node, pad + _STEP), f"{pad}{_STEP}children:", *items]

    def _child(self, node: Node, pad: str) -> list[_Piece]:
        if len(node.children) != 1:
            raise CannotWrite(f"{self._key(node)} has {len(node.children)} children, not one")
        return [_Value(node.children[0], f"{pad}{_STEP}child:", pad + _STEP * 2)]

    def _branches(self, node: Node, lead: str, pad: str) -> list[_Piece]:
        key = self._key(node)
        names = (key, *COMPANIONS[key])
        if not 2 <= len(node.children) <= len(names) or node.ports:
            raise CannotWrite(f"{key} has {len(node.children)} children, not 2 or 3")
        first, *others = node.children
        pieces: list[_Piece] = [_Value(first, f"{lead}{key}:", pad + _STEP, node.comments)]
        if (script := _condition(first)) is not None:
            comments = (*node.comments, *first.comments)
            pieces = [*above(first.comments, pad), f"{lead}{key}: {script}{beside(comments)}"]
        for name, child in zip(names[1:], others, strict=False):
            pieces.append(_Value(child, f"{pad}{name}:", pad + _STEP))
        return pieces

    def _recovery(self, node: Node, pad: str) -> list[_Piece]:
        if len(node.children) != 1 or not node.handlers:
            raise CannotWrite(f"{self._key(node)} needs one `try` and a handler")
        inside, deeper = pad + _STEP, pad + _STEP * 2
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
        return _Value(handler.node, lead, pad + _STEP, handler.comments)

    # leaves and ports

    def _leaf(self, node: Node, lead: str, pad: str, more: bool) -> list[str]:
        key, remark = self._key(node), beside(node.comments)
        if not node.ports:
            colon = ":" if more or not lead.endswith("- ") else ""
            return [f"{lead}{key}{colon}{remark}"]
        line = f"{lead}{key}: {self._leaf_text(node)}"
        if len(line) <= WIDTH and not node.port_comments:
            return [line + remark]
        if self._is_bare(node):
            return [*(f"{pad}{_signed(c)}" for cs in node.port_comments.values() for c in cs), line]
        return [f"{lead}{key}:{remark}", *self._ports(node, pad + _STEP)]

    def _leaf_text(self, node: Node, *, flow: bool = False) -> str:
        """What follows a leaf's `key:` on its line; empty where it has no ports."""
        if self._is_bare(node):
            ((name, value),) = node.ports.items()
            return self._port(node, name, value, flow=flow)
        return f"{{{', '.join(self._pairs(node))}}}" if node.ports else ""

    def _pairs(self, node: Node) -> list[str]:
        return [
            f"{scalar(name, flow=True, typed=False)}: {self._port(node, name, value, flow=True)}"
            for name, value in node.ports.items()
        ]

    def _ports(self, node: Node, pad: str) -> list[str]:
        lines: list[str] = []
        for name, value in node.ports.items():
            comments = node.port_comments.get(name, ())
            lead = f"{pad}{scalar(name, typed=False)}:"
            lines += above(comments, pad)
            lines += spread(value, lead, self._port(node, name, value), comments)
        return lines

    def _port(self, node: Node, name: str, value: PortValue, *, flow: bool = False) -> str:
        spec = BUILT_IN.get(node.type)
        port = spec.ports.get(name) if spec is not None else None
        if port is not None and port.type is ScriptText and isinstance(value, Literal):
            return script_text(str(value.value), flow=flow)
        return port_text(value, flow=flow)

    def _is_bare(self, node: Node) -> bool:
        """Whether its one value stands without the port's name: `reset_pose: home`."""
        if len(node.ports) != 1:
            return False
        ((name, value),) = node.ports.items()
        if isinstance(value, Literal) and (value.value is None or _is_nested(value)):
            return False
        spec = BUILT_IN.get(node.type)
        if spec is not None:
            script = spec.ports[name].type is ScriptText if name in spec.ports else False
            spelled = not script or script_spelling(_text(value)) is not None
            return name == spec.first and spelled
        if name == FIRST_INPUT:
            return True
        place = node.port_places.get(name)
        was_bare = place is not None and place == node.port_name_places.get(name)
        return was_bare or (isinstance(value, Literal) and name == self._only_input(node))

    def _only_input(self, node: Node) -> str | None:
        """The first input of a known skill, where nothing else is required."""
        try:
            ports = self.registry.skills[node.type].ports.values()
        except (KeyError, PluginError):
            return None
        inputs = [port for port in ports if port.direction == "in"]
        if not inputs or any(port.required for port in inputs[1:]):
            return None
        return inputs[0].name if inputs[0].required else None

    def _key(self, node: Node) -> str:
        """The node's name in YAML, as a key."""
        spec = BUILT_IN.get(node.type)
        if spec is not None:
            return spec.yaml[0]
        name = node.target if node.type == SUBTREE else node.type
        tree = node.type == SUBTREE
        words = (*SPELLED, *BUILT_IN, *MODIFIERS, SUBTREE, AGAIN)
        if not name or "$" in name or name in words or (name in self.trees) is not tree:
            raise CannotWrite(f"no node in YAML is called {name!r}")
        return scalar(name)


def _is_short(node: Node) -> bool:
    """Whether it may stand in braces: a leaf with nothing but ports, or a decorator around one."""
    spec = BUILT_IN.get(node.type)
    if spec is not None and spec.kind is Kind.DECORATOR:
        below = node.children[0] if len(node.children) == 1 else node
        return not _says_more(node) and not below.children and _is_short(below)
    leaf = not node.children and (spec is None or spec.kind is Kind.LEAF)
    return leaf and not _says_more(node) and not node.handlers


def _says_more(node: Node) -> bool:
    """Whether something besides key and ports needs a line."""
    remarks = node.port_comments or node.end_comments or above(node.comments, "")
    return bool(remarks) or _has_modifiers(node)


def _has_modifiers(node: Node) -> bool:
    """Whether keys stand beside the node's own, or around it."""
    named = node.name is not None or node.note is not None or node.disabled
    return bool(named or node.conditions or _can_be_modifier(node))


def _can_be_modifier(node: Node) -> bool:
    spec = BUILT_IN.get(node.type)
    if spec is None or not (spec.modifier or node.type in _FORCE) or len(node.children) != 1:
        return False
    if node.name is not None or node.note is not None or node.disabled or node.conditions:
        return False
    values = list(node.ports.values())
    fits = not values or (list(node.ports) == [spec.first] and not _is_nothing(values[0]))
    return fits and not any(_is_nested(value) for value in values)


def _is_nothing(value: PortValue) -> bool:
    return isinstance(value, Literal) and value.value is None


def _is_nested(value: PortValue) -> bool:
    return isinstance(value, Literal) and isinstance(value.value, list | tuple | dict)


def _text(value: PortValue) -> str:
    return str(value.value) if isinstance(value, Literal) else ""


def _condition(node: Node) -> str | None:
    """The script that `if:` can ask instead of a node; None where the node says more."""
    code = node.ports.get("code")
    if node.type != "ScriptCondition" or not isinstance(code, Literal) or len(node.ports) != 1:
        return None
    if _has_modifiers(node) or node.children or node.end_comments or node.port_comments:
        return None
    spelled = script_spelling(str(code.value))
    return scalar(spelled, typed=False) if spelled is not None and "$" in spelled else None
