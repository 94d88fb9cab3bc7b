"""Hints for conditions that are evaluated only once before a long action."""

from __future__ import annotations

from momantu_bt.tree.catalogue import NODES, SUBTREE
from momantu_bt.tree.check.keys.shared import scripts_of
from momantu_bt.tree.check.signatures import Context
from momantu_bt.tree.model import Node, Reference, Scope, Tree


def check_guards(context: Context, order: list[Tree], published: frozenset[str]) -> None:
    """Report conditions in plain sequences whose result may change while a later child runs.

    order: the trees, each after those that it runs. published: keys of the root's board whose
    values change during a run, such as the robot's state.
    """
    long: set[str] = set()
    for tree in order:
        for node in tree.root.walk():
            if _runs_long(context, node, long):
                long.add(tree.name)
            spec = NODES.get(node.type)
            if spec is not None and spec.in_turn and not node.disabled:
                _check_sequence(context, node, published, long)


def _check_sequence(
    context: Context, sequence: Node, published: frozenset[str], long: set[str]
) -> None:
    for index, child in enumerate(sequence.children):
        spec = NODES.get(child.type)
        if spec is None or not spec.condition or child.disabled:
            continue
        changing = sorted(_read_on_root(context, child) & published)
        if not changing:
            continue
        later = _first_long(context, sequence.children[index + 1 :], long)
        if later is None:
            continue
        said = later.name or later.target or later.type
        keys = ", ".join(f"$@{key}" for key in changing)
        message = f"{keys} is asked once here, and not again while {said} runs"
        if context.in_xml(child.place):
            hint = "<ReactiveSequence>, or _while on what follows, asks at every tick"
        else:
            hint = "`reactive_sequence:`, or `while:` on what follows, asks at every tick"
        context.problems.hint("unwatched-guard", child.place, message, hint)


def _first_long(context: Context, nodes: list[Node], long: set[str]) -> Node | None:
    below = (node for root in nodes for node in root.walk())
    return next((node for node in below if _runs_long(context, node, long)), None)


def _runs_long(context: Context, node: Node, long: set[str]) -> bool:
    """Whether a node, or the tree that it runs, commands actuators."""
    if node.disabled:
        return False
    if node.type == SUBTREE:
        return node.target in long
    signature = context.signature(node)
    return signature is not None and signature.skill is not None and bool(signature.skill.uses)


def _read_on_root(context: Context, node: Node) -> set[str]:
    found = {
        value.key
        for value in node.ports.values()
        if isinstance(value, Reference) and value.scope is Scope.ROOT
    }
    for script in scripts_of(context, node):
        found |= {v.key.removeprefix("@") for v in script.reads if v.key.startswith("@")}
    return found
