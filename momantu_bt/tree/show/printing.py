"""Trees in plain words: for `momantu-bt show` and for the live display."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from momantu_bt.tree.catalogue import NODES
from momantu_bt.tree.catalogue.wording import ports_in_words, script_text
from momantu_bt.tree.model import Document, Handler, Node, Tree

_WIDEST = 96
"""The most characters of one node's text. Longer values are cut."""
_MOST_CODES = 3
"""The most codes of a handler that a display of a run names."""


@dataclass(frozen=True, slots=True)
class Line:
    """One line of a printed tree. node: None for a heading or a handler's codes."""

    depth: int
    text: str
    node: Node | None


def lines(document: Document) -> Iterator[Line]:
    """The main tree and, below it, every other tree that the document has."""
    for tree in main_first(document):
        yield Line(0, heading(tree), None)
        yield from tree_lines(tree.root, 1)


def main_first(document: Document) -> list[Tree]:
    """The trees of a document, the main one first; a file of models has none."""
    return sorted(document.trees.values(), key=lambda tree: tree.name != document.main)


def tree_lines(root: Node, depth: int = 0) -> Iterator[Line]:
    """A node and everything below it, one line each; decorators share their child's line."""
    stack: list[tuple[Node | Handler, int, str]] = [(root, depth, "")]
    while stack:
        item, level, role = stack.pop()
        if isinstance(item, Handler):
            node = item.node
            yield Line(level, f"{handler_text(item)}:" + ("" if node else " try again"), None)
            if node is not None:
                stack.append((node, level + 1, ""))
            continue
        inner, outer = unwrap(item)
        yield Line(level, (f"{role}: " if role else "") + text(inner, outer), inner)
        stack.extend((each, level + 1, its_role) for its_role, each in reversed(below(inner)))


def below(node: Node) -> list[tuple[str, Node | Handler]]:
    """A node's children and handlers. Children with roles come with their roles."""
    roles = _roles(node)
    roles += [""] * (len(node.children) - len(roles))
    children: list[tuple[str, Node | Handler]] = [*zip(roles, node.children, strict=False)]
    return children + [("", handler) for handler in node.handlers]


def handler_text(handler: Handler, most: int | None = None) -> str:
    """The codes of a handler: `on A or B`. most: of more codes than that, the rest is counted."""
    codes = ["anything else" if c == "any" else c for c in handler.codes]
    if most is not None and len(codes) > most:
        codes[most - 1 :] = [f"{len(codes) - most + 1} more"]
    return "on " + " or ".join(codes)


def plan(node: Node) -> tuple[tuple[str, bool], ...]:
    """A node's children and handlers as displays of a run name them, in the order of `below`.

    Each has its prefix, such as `if: ` or `on TIMEOUT → `, and whether it is a node; a handler
    without one tries again. Empty if no child needs a prefix.
    """
    spec = NODES.get(node.type)
    handled = spec is not None and spec.handlers
    prefixes = [(f"{role}: " if role else "", True) for role, _ in below(node)]
    if handled:
        tries, handlers = len(node.children), node.handlers
        prefixes[:tries] = [("try: ", True)] * tries
        prefixes[tries:] = [
            (f"{handler_text(h, _MOST_CODES)} → ", h.node is not None) for h in handlers
        ]
    return tuple(prefixes) if any(prefix for prefix, _ in prefixes) else ()


def around(node: Node) -> str:
    """The words of a decorator that stands on its child's line; empty for every other node."""
    outer = _has_words(node) and len(node.children) == 1 and not node.conditions
    return _in_words(node) if outer else ""


def unwrap(node: Node) -> tuple[Node, list[Node]]:
    """A node without the decorators around it, and those decorators, outermost first."""
    outer: list[Node] = []
    while around(node):
        outer.append(node)
        node = node.children[0]
    return node, outer


def text(node: Node, outer: list[Node] | None = None) -> str:
    """One node in one line: what it is, its ports, and the decorators around it."""
    words = title(node)
    ports = ", ".join(port_texts(node))
    if ports:
        words += f" {ports}" if len(ports) <= _WIDEST else f" {ports[: _WIDEST - 1]}…"
    extras = extra_texts(node, outer)
    if extras:
        words += f"  ({', '.join(extras)})"
    return words


def extra_texts(node: Node, outer: list[Node] | None = None) -> list[str]:
    """The decorators of a node, innermost first, and its conditions, in words."""
    extras = [_in_words(each) for each in reversed(outer or [])]
    extras += [f"{name} {script_text(script)}" for name, script in node.conditions.items()]
    return [*extras, "disabled"] if node.disabled else extras


def heading(tree: Tree) -> str:
    """A tree's name, its inputs and its outputs."""
    words = tree.name
    for direction, verb in (("in", "takes"), ("inout", "shares"), ("out", "gives")):
        ports = [p for p in tree.ports.values() if p.direction == direction]
        if ports:
            words += f" {verb} " + ", ".join(f"{p.name} ({p.type_name})" for p in ports)
    return words


def _roles(node: Node) -> list[str]:
    """The role of each child for the node."""
    spec = NODES.get(node.type)
    if spec is None or spec.handlers:
        return []
    if spec.roles is not None:
        return spec.roles(node)
    return ["" if role == "child" else role.replace("_do", "") for role in spec.positions]


def title(node: Node) -> str:
    """A node's type and ports, after its name if it has one."""
    spec = NODES.get(node.type)
    if spec is None:
        said = node.target or node.type
    else:
        said = (spec.title or spec.yaml[0]).replace("_", " ")
    return f"{node.name}: {said}" if node.name else said


def port_texts(node: Node) -> list[str]:
    """A node's ports, each with its value."""
    spec = NODES.get(node.type)
    if spec is not None and spec.port_words is not None:
        return spec.port_words(node)
    return ports_in_words(node, node.ports)


def _has_words(node: Node) -> bool:
    """Whether it is a decorator that stands on its child's line."""
    spec = NODES.get(node.type)
    return spec is not None and spec.around is not None


def _in_words(node: Node) -> str:
    words = NODES[node.type].around
    assert words is not None
    return words(node)
