"""Trees in plain words: for `momantu-bt show` and for the live display."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

from momantu_bt.tree.catalogue import BUILT_IN, SUBTREE
from momantu_bt.tree.model import (
    Document,
    Handler,
    Literal,
    Node,
    PortValue,
    Reference,
    Scope,
    Template,
    Tree,
)
from momantu_bt.tree.script import ScriptSyntaxError, yaml_spelling

_WIDEST = 96
"""Characters of one node's text; longer values are cut."""


@dataclass(frozen=True, slots=True)
class Line:
    """One line of a printed tree. node: None for a heading or a handler's codes."""

    depth: int
    text: str
    node: Node | None


def lines(document: Document) -> Iterator[Line]:
    """The main tree and, below it, every other tree that the document has."""
    others = [tree for name, tree in document.trees.items() if name != document.main]
    for tree in (document.trees[document.main], *others):
        yield Line(0, heading(tree), None)
        yield from tree_lines(tree.root, 1)


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
        inner, around = unwrap(item)
        yield Line(level, (f"{role}: " if role else "") + text(inner, around), inner)
        stack.extend((each, level + 1, its_role) for its_role, each in reversed(below(inner)))


def below(node: Node) -> list[tuple[str, Node | Handler]]:
    """A node's children and handlers; children that are not just a list come with what they are."""
    roles = _roles(node)
    roles += [""] * (len(node.children) - len(roles))
    children: list[tuple[str, Node | Handler]] = [*zip(roles, node.children, strict=False)]
    return children + [("", handler) for handler in node.handlers]


def handler_text(handler: Handler) -> str:
    """The codes of a handler: `on A or B`."""
    return "on " + " or ".join("anything else" if c == "any" else c for c in handler.codes)


def unwrap(node: Node) -> tuple[Node, list[Node]]:
    """A node without the decorators around it, and those, outermost first."""
    around: list[Node] = []
    while _is_decorator(node) and len(node.children) == 1 and not node.conditions:
        around.append(node)
        node = node.children[0]
    return node, around


def text(node: Node, around: list[Node] | None = None) -> str:
    """One node in one line: what it is, its ports, and what is wrapped around it."""
    words = title(node)
    ports = ", ".join(port_texts(node))
    if ports:
        words += f" {ports}" if len(ports) <= _WIDEST else f" {ports[: _WIDEST - 1]}…"
    extras = extra_texts(node, around)
    if extras:
        words += f"  ({', '.join(extras)})"
    return words


def extra_texts(node: Node, around: list[Node] | None = None) -> list[str]:
    """What is wrapped around a node, innermost first, and its conditions, in words."""
    extras = [_decorator(outer) for outer in reversed(around or [])]
    extras += [f"{name} {_script(script)}" for name, script in node.conditions.items()]
    return [*extras, "disabled"] if node.disabled else extras


def value_text(value: PortValue) -> str:
    """A port's value as a tree file writes it."""
    if isinstance(value, Reference):
        return "$" + _key(value)
    if isinstance(value, Template):
        parts = (p if isinstance(p, str) else f"${{{_key(p)}}}" for p in value.parts)
        return '"' + "".join(parts) + '"'
    return _plain(value.value)


def _key(reference: Reference) -> str:
    at = "@" if reference.scope is Scope.ROOT else ""
    return at + ".".join((reference.key, *reference.fields))


def _plain(value: Any) -> str:
    if value is None:
        return "nothing"
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, dict):
        return "{" + ", ".join(f"{k}: {_plain(v)}" for k, v in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(_plain(item) for item in value) + "]"
    return str(value)


def heading(tree: Tree) -> str:
    """A tree's name, what it takes and what it gives."""
    words = tree.name
    for direction, verb in (("in", "takes"), ("inout", "shares"), ("out", "gives")):
        ports = [p for p in tree.ports.values() if p.direction == direction]
        if ports:
            words += f" {verb} " + ", ".join(f"{p.name} ({p.type_name})" for p in ports)
    return words


def _is_decorator(node: Node) -> bool:
    return node.type in _IN_WORDS


def _roles(node: Node) -> list[str]:
    """What each child is to the node."""
    spec = BUILT_IN.get(node.type)
    if spec is None or spec.handlers:
        return []
    if spec.switch:
        cases = (node.ports.get(f"case_{i}", Literal("?")) for i in range(1, spec.switch + 1))
        return [*(value_text(case) for case in cases), "else"]
    if node.type == "TryCatch":
        return [*[""] * (len(node.children) - 1), "in any failure"]
    if node.type == "RecoveryNode":
        return ["", "to recover"]
    return ["" if role == "child" else role.replace("_do", "") for role in spec.positions]


def title(node: Node) -> str:
    """What a node is, after its name where it has one."""
    words = {
        "Recover": "recover",
        "IfThenElse": "if",
        "WhileDoElse": "while",
    }
    spec = BUILT_IN.get(node.type)
    plain = words.get(node.type) or (spec.yaml[0] if spec is not None else node.type)
    said = (node.target or plain) if node.type == SUBTREE else plain.replace("_", " ")
    if spec is None:
        said = node.target or node.type
    return f"{node.name}: {said}" if node.name else said


def port_texts(node: Node) -> list[str]:
    """A node's ports, each with its value."""
    if node.type == "Recover":
        attempts = node.ports.get("attempts")
        return [f"with {_tries(attempts)}"] if attempts is not None else []
    if node.type in ("Script", "ScriptCondition", "Precondition"):
        return [_script(str(v.value)) for v in node.ports.values() if isinstance(v, Literal)]
    return [
        value_text(value) if _is_bare(node, name) else f"{name} {value_text(value)}"
        for name, value in node.ports.items()
        if not name.startswith("case_") or node.type == SUBTREE
    ]


def _is_bare(node: Node, port: str) -> bool:
    """Whether the value was written without the port's name (`reset_pose: home`)."""
    place = node.port_places.get(port)
    return place is None or node.port_name_places.get(port) == place


def _tries(value: PortValue) -> str:
    if value == Literal(1):
        return "1 try"
    if value == Literal(-1):
        return "tries without end"
    return f"{value_text(value)} tries"


def _script(script: str) -> str:
    try:
        return yaml_spelling(script)
    except ScriptSyntaxError:
        return script


def _count(node: Node, port: str) -> str:
    return _tries(node.ports.get(port, Literal("?")))


def _duration(node: Node) -> str:
    if "msec" in node.ports:
        return f"{value_text(node.ports['msec'])} ms"
    value = node.ports.get("duration", Literal("?"))
    shown = value_text(value)
    bare = isinstance(value, Literal) and isinstance(value.value, int | float)
    return f"{shown} s" if bare else shown


def _entry(node: Node) -> str:
    return value_text(node.ports.get("entry", Literal("?")))


_IN_WORDS: dict[str, Callable[[Node], str]] = {
    "RetryUntilSuccessful": lambda n: _count(n, "attempts"),
    "Repeat": lambda n: _count(n, "cycles").replace("tries", "rounds").replace("try", "round"),
    "Timeout": lambda n: f"at most {_duration(n)}",
    "Delay": lambda n: f"after {_duration(n)}",
    "Inverter": lambda n: "inverted",
    "ForceSuccess": lambda n: "success in any case",
    "ForceFailure": lambda n: "failure in any case",
    "ElseFail": lambda n: f"else {value_text(n.ports.get('code', Literal('?')))}",
    "KeepRunningUntilFailure": lambda n: "again and again until it fails",
    "RunOnce": lambda n: "once only",
    "SkipUnlessUpdated": lambda n: f"only when {_entry(n)} is new",
    "WaitValueUpdate": lambda n: f"waits until {_entry(n)} is written",
    "SingleTrigger": lambda n: "once at each start",
}


def _decorator(node: Node) -> str:
    return _IN_WORDS[node.type](node)
