"""Checks of trees: how they call each other, what runs in parallel, and duplicate names."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TypeAlias

from momantu_bt.formats.places import Place
from momantu_bt.tree.catalogue import NODES, SUBTREE
from momantu_bt.tree.check.signatures import Context
from momantu_bt.tree.model import Document, Node, Tree

MAX_NESTING = 150
"""Deepest nesting of nodes, including decorators; it limits the stack of recursive functions."""


Uses: TypeAlias = dict[str, Node]
"""Names of actuators, each with the node that commands it."""


def calls(tree: Tree) -> dict[str, Place]:
    """The trees that a tree runs, each with the place of the first call."""
    found: dict[str, Place] = {}
    for node in tree.root.walk():
        if node.type == SUBTREE and node.target is not None:
            found.setdefault(node.target, node.place)
    return found


def reached(document: Document, starts: Iterable[str]) -> set[str]:
    """Names of the given trees and of all trees that they run, directly or indirectly."""
    waiting = list(starts)
    found = set(waiting)
    while waiting:
        for name in calls(document.trees[waiting.pop()]):
            if name not in found and name in document.trees:
                found.add(name)
                waiting.append(name)
    return found


def callees_first(context: Context) -> list[Tree] | None:
    """The trees, each after those that it runs; None if they form a circle, which is reported."""
    document = context.document
    order: list[str] = []
    state: dict[str, int] = {}
    for start in document.trees:
        stack: list[tuple[str, list[tuple[str, Place]]]] = []
        if start not in state:
            stack.append((start, list(calls(document.trees[start]).items())))
            state[start] = 1
        while stack:
            name, below = stack[-1]
            if not below:
                state[name] = 2
                order.append(name)
                stack.pop()
                continue
            callee, place = below.pop(0)
            if state.get(callee) == 1:
                _report_circle(context, [entry[0] for entry in stack], callee, place)
                return None
            if callee not in state:
                state[callee] = 1
                stack.append((callee, list(calls(document.trees[callee]).items())))
    return [document.trees[name] for name in order]


def _report_circle(context: Context, path: list[str], callee: str, place: Place) -> None:
    circle = " -> ".join([*path[path.index(callee) :], callee])
    message = f"{callee!r} runs itself: {circle}"
    hint = "a tree cannot contain itself; `repeat` or `recover` runs nodes again"
    context.problems.error("recursion", place, message, hint)


def check_nesting(context: Context, tree: Tree) -> bool:
    """Whether a tree is not nested too deeply for the later checks; reports it if it is."""
    stack = [(tree.root, 1)]
    while stack:
        node, depth = stack.pop()
        if depth > MAX_NESTING:
            message = f"more than {MAX_NESTING} nodes within nodes"
            context.problems.error("too-large", node.place, message, "make a tree of a part")
            return False
        stack.extend((child, depth + 1) for child in node.children)
        stack.extend((h.node, depth + 1) for h in node.handlers if h.node is not None)
    return True


def check_unused(context: Context) -> None:
    """Warn of trees that nothing runs, unless a misspelled name may mean them."""
    if context.problems.grave:
        return
    document = context.document
    run = reached(document, [document.main])
    for name, tree in document.trees.items():
        if name not in run and tree.place.file == document.file:
            message = f"nothing runs the tree {name!r}"
            context.problems.warning("unused-tree", tree.place, message)


def check_given_names(context: Context, tree: Tree) -> None:
    """Check that names given with `name:` are unique in a tree; records and statistics use them.

    BehaviorTree.CPP does not require this, so in XML and for an open tree it is only a warning.
    """
    first: dict[str, Node] = {}
    for node in tree.root.walk():
        if node.name is None:
            continue
        if node.name in first:
            message = f"two nodes of {tree.name} are named {node.name!r}"
            hint = f"the first is in line {first[node.name].place.line}"
            if tree.open or context.in_xml(tree.place):
                context.problems.warning("duplicate-name", node.place, message, hint)
            else:
                context.problems.error("duplicate-name", node.place, message, hint)
        first.setdefault(node.name, node)


def check_parallel(context: Context, order: list[Tree]) -> None:
    """Check that children of a parallel node do not command the same actuator."""
    of_tree: dict[str, Uses] = {}
    for tree in order:
        of_node: dict[int, Uses] = {}
        for node in reversed(list(tree.root.walk())):
            of_node[id(node)] = _uses(context, node, of_node, of_tree)
        of_tree[tree.name] = of_node[id(tree.root)]
        for node in tree.root.walk():
            spec = NODES.get(node.type)
            if spec is not None and spec.concurrent:
                _check_overlap(context, node, of_node)


def _check_overlap(context: Context, parallel: Node, of_node: dict[int, Uses]) -> None:
    """Report each child that commands an actuator of an earlier child."""
    first: Uses = {}
    for child in parallel.children:
        used = of_node[id(child)]
        for actuator in sorted(first.keys() & used.keys()):
            a, b = first[actuator], used[actuator]
            message = f"{_said(a)} (line {a.place.line}) and {_said(b)} both use {actuator}"
            hint = "run them one after the other"
            context.problems.error("overlapping-uses", child.place, message, hint)
        first = {**used, **first}


def _uses(context: Context, node: Node, of_node: dict[int, Uses], of_tree: dict[str, Uses]) -> Uses:
    """The actuators that a node or one below it commands, each with the first such node."""
    if node.disabled:
        return {}
    if node.type == SUBTREE:
        return dict.fromkeys(of_tree.get(node.target or "", {}), node)
    signature = context.signature(node)
    used: Uses = {}
    if signature is not None and signature.skill is not None:
        resolved = (_resolved(context, use) for use in sorted(signature.skill.uses))
        used = {name: node for name in resolved if name is not None}
    handlers = (handler.node for handler in node.handlers if handler.node is not None)
    for below in (*node.children, *handlers):
        used = {**of_node[id(below)], **used}
    return used


def _resolved(context: Context, use: str) -> str | None:
    if context.description is None:
        return use
    try:
        return context.description.resolve_use(use)
    except KeyError:
        return use


def _said(node: Node) -> str:
    return node.name or node.target or node.type
