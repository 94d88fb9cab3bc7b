"""Warnings of reactive nodes whose children halt each other and never end.

A reactive node starts its earlier children again on each tick. If one of them takes longer than a
tick whenever it starts, it halts the later child that runs. So only what ends at once, such as a
condition, belongs before the last child.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import TypeAlias

from momantu_bt.tree.catalogue import SUBTREE
from momantu_bt.tree.check.signatures import Context
from momantu_bt.tree.model import Literal, Node, Tree

Ends: TypeAlias = frozenset[str]
"""How a node may end in the tick in which it starts."""
S, F, SKIP = "success", "failure", "skipped"
ANYHOW: Ends = frozenset({S, F, SKIP})
RUNS_ON: Ends = frozenset()
"""Of a node that takes longer than a tick whenever it starts."""


def check_reactive(context: Context, order: list[Tree]) -> None:
    """Check all reactive nodes. order: the trees, each after those that it runs."""
    of_tree: dict[str, Ends] = {}
    for tree in order:
        of_node: dict[int, Ends] = {}
        for node in reversed(list(tree.root.walk())):
            of_node[id(node)] = _ends(context, node, of_node, of_tree)
        of_tree[tree.name] = of_node[id(tree.root)]
        for node in tree.root.walk():
            if node.type in _GOES_ON and not node.disabled:
                _check(context, node, of_node)


_GOES_ON = {"ReactiveSequence": S, "ReactiveFallback": F}
"""The end of a child after which a reactive node goes on to the next one."""


def _check(context: Context, reactive: Node, of_node: Mapping[int, Ends]) -> None:
    wanted = _GOES_ON[reactive.type]
    first: Node | None = None
    for child in reactive.children:
        ends = of_node[id(child)]
        if first is not None and not ends & {S, SKIP}:
            said, other = _said(first), _said(child)
            where = f"{said} (line {first.place.line})"
            message = f"{where} starts again on each tick, and halts {other}"
            plain = "sequence" if wanted == S else "fallback"
            plain = f"<{plain.capitalize()}>" if context.in_xml(child.place) else f"`{plain}:`"
            hint = f"write {plain}, or a condition in place of {said}"
            context.problems.warning("restarts", child.place, message, hint)
            return
        if first is None and not ends & {wanted, SKIP}:
            first = child


def _said(node: Node) -> str:
    return node.name or node.target or node.type


def _ends(
    context: Context, node: Node, of_node: Mapping[int, Ends], of_tree: Mapping[str, Ends]
) -> Ends:
    if node.disabled:
        return frozenset({SKIP})
    below = [of_node[id(child)] for child in node.children]
    handlers = [RUNS_ON if h.node is None else of_node[id(h.node)] for h in node.handlers]
    ends = _own(context, node, below, handlers, of_tree)
    asked = {"skip_if": SKIP, "while": SKIP, "fail_if": F, "succeed_if": S}
    return ends | {asked[name] for name in node.conditions if name in asked}


def _own(
    context: Context,
    node: Node,
    below: Sequence[Ends],
    handlers: Sequence[Ends],
    of_tree: Mapping[str, Ends],
) -> Ends:
    if node.type == SUBTREE:
        return of_tree.get(node.target or "", ANYHOW)
    if node.type == "Handle" and below:
        return (below[0] - {F}).union(*handlers) if F in below[0] else below[0]
    if node.type in _WAITS:
        return ANYHOW if Literal(0) in node.ports.values() else RUNS_ON
    if node.type in _OF and below:
        return _OF[node.type](below)
    signature = context.signature(node)
    moves = signature is not None and signature.skill is not None and signature.skill.uses
    return RUNS_ON if moves else ANYHOW


_WAITS = ("Sleep", "Delay")


def _in_turn(goes_on: str, ends: str) -> Callable[[Sequence[Ends]], Ends]:
    """The ends of a node that goes on after one end of a child and stops after the other."""

    def found(below: Sequence[Ends]) -> Ends:
        result: set[str] = set()
        for child in below:
            result |= child & {ends}
            if not child & {goes_on, SKIP}:
                return frozenset(result)
        all_skipped = all(SKIP in child for child in below)
        return frozenset(result | {goes_on} | ({SKIP} if all_skipped else set()))

    return found


def _first(below: Sequence[Ends]) -> Ends:
    return below[0]


def _swapped(below: Sequence[Ends]) -> Ends:
    other = {S: F, F: S, SKIP: SKIP}
    return frozenset(other[end] for end in below[0])


def _forced(to: str) -> Callable[[Sequence[Ends]], Ends]:
    return lambda below: frozenset(end if end == SKIP else to for end in below[0])


def _branches(below: Sequence[Ends]) -> Ends:
    """Of `if`: what follows an end of the condition; without an else branch it may fail."""
    follows = below[1:] if len(below) > 2 else [*below[1:], frozenset({F})]
    return frozenset().union(*follows) if below[0] else RUNS_ON


_SEQUENCE, _FALLBACK = _in_turn(S, F), _in_turn(F, S)
_OF: Mapping[str, Callable[[Sequence[Ends]], Ends]] = {
    **dict.fromkeys(("Sequence", "AsyncSequence", "SequenceWithMemory"), _SEQUENCE),
    **dict.fromkeys(("ReactiveSequence", "ParallelAll"), _SEQUENCE),
    **dict.fromkeys(("Fallback", "AsyncFallback", "ReactiveFallback"), _FALLBACK),
    **dict.fromkeys(("RetryUntilSuccessful", "Repeat", "Timeout", "ElseFail", "Recover"), _first),
    "Inverter": _swapped,
    "ForceSuccess": _forced(S),
    "ForceFailure": _forced(F),
    "IfThenElse": _branches,
}
"""The ends of a node from those of its children; other nodes may end anyhow."""
