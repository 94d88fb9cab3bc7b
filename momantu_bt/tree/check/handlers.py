"""Checks of handlers: one that can never run is an error."""

from __future__ import annotations

from collections.abc import Mapping

from momantu_bt.failure import (
    CALL_FAILED,
    ENGINE_CODES,
    FAILED,
    HALTED,
    SCRIPT_ERROR,
    TIMEOUT,
)
from momantu_bt.formats.names import nearest
from momantu_bt.formats.places import Place, within
from momantu_bt.tree.catalogue import SUBTREE
from momantu_bt.tree.catalogue.codes import UNKNOWN, Codes, Failing, joined
from momantu_bt.tree.check.cases import HANDLED_CODE, check_handled_cases
from momantu_bt.tree.check.refusals import check_refusals, refuses
from momantu_bt.tree.check.signatures import Context
from momantu_bt.tree.language import ANY
from momantu_bt.tree.model import Handler, Literal, Node, Tree

_ANY_SKILL = frozenset(ENGINE_CODES) - {TIMEOUT, FAILED, HALTED, SCRIPT_ERROR, CALL_FAILED}
"""Codes with which the engine fails a skill, in addition to those that the skill declares."""


def check_handlers(context: Context, order: list[Tree]) -> None:
    """Check every handler of every tree. order: the trees, each after those that it runs."""
    of_tree: dict[str, Codes] = {}
    refusing: set[str] = set()
    for tree in order:
        of_node: dict[int, Codes] = {}
        handled = _handled(tree)
        for node in reversed(list(tree.root.walk())):
            of_node[id(node)] = _codes(context, node, of_node, of_tree, handled)
            if node.handlers and node.children:
                _check(context, node, of_node[id(node.children[0])])
                check_handled_cases(context, node, of_node[id(node.children[0])])
        check_refusals(context, tree.root, of_node, refusing)
        if refuses(tree.root, of_node, refusing):
            refusing.add(tree.name)
        of_tree[tree.name] = of_node[id(tree.root)]


def _handled(tree: Tree) -> dict[int, Codes]:
    """For each node in a handler, the possible values of `$failure.code`."""
    found: dict[int, Codes] = {}
    for node in tree.root.walk():
        for handler in node.handlers:
            codes = frozenset(UNKNOWN if c == ANY else c.split(".")[-1] for c in handler.codes)
            below = handler.node.walk() if handler.node is not None else ()
            found.update((id(each), codes) for each in below)
    return found


def _codes(
    context: Context,
    node: Node,
    of_node: Mapping[int, Codes],
    of_tree: Mapping[str, Codes],
    meant: Mapping[int, Codes],
) -> Codes:
    if node.handlers and not node.children:  # its `try` is missing, which is reported
        return frozenset({UNKNOWN})
    below = joined(*(of_node[id(child)] for child in node.children))
    handled = joined(*(of_node[id(h.node)] for h in node.handlers if h.node is not None))
    found = _own(context, node, Failing(below, handled, _named(node, meant.get(id(node)))), of_tree)
    if node.conditions:
        asked = {FAILED, SCRIPT_ERROR} if "fail_if" in node.conditions else {SCRIPT_ERROR}
        found = joined(found, frozenset(asked))
    return frozenset() if node.disabled else found


def _own(context: Context, node: Node, failing: Failing, of_tree: Mapping[str, Codes]) -> Codes:
    if node.type == SUBTREE:
        return of_tree.get(node.target or "", frozenset({UNKNOWN}))
    signature = context.signature(node)
    if signature is None:
        return frozenset({UNKNOWN})
    if signature.spec is not None:
        return signature.spec.codes(node, failing)
    assert signature.skill is not None
    own = {*signature.skill.failures, *_ANY_SKILL}
    if signature.skill.calls:
        own.add(CALL_FAILED)
    return frozenset(own | {f"{node.type}.{code}" for code in own})


def _named(node: Node, handled: Codes | None) -> Codes:
    """The possible values of a node's port `code`."""
    code = node.ports.get("code")
    if code == HANDLED_CODE and handled is not None:
        return handled
    return frozenset({str(code.value) if isinstance(code, Literal) else UNKNOWN})


def _check(context: Context, node: Node, possible: Codes) -> None:
    first: dict[str, Handler] = {}
    for handler in node.handlers:
        for code in handler.codes:
            if code in first:
                message = f"{code} has a handler already"
                hint = f"in line {first[code].place.line}; the first one is taken"
                context.problems.error(
                    "dead-handler", _place(context, handler, code), message, hint
                )
            elif code != ANY and UNKNOWN not in possible and code not in possible:
                _report_dead(context, handler, code, possible)
            first.setdefault(code, handler)


def _report_dead(context: Context, handler: Handler, code: str, possible: Codes) -> None:
    bare = sorted(c for c in possible if "." not in c and c not in _ANY_SKILL)
    near = nearest(code, sorted(possible))
    message = f"nothing in `try` fails with {code}"
    hint = f"did you mean {near}?" if near else f"it can fail with: {', '.join(bare) or 'nothing'}"
    context.problems.error("dead-handler", _place(context, handler, code), message, hint)


def _place(context: Context, handler: Handler, code: str) -> Place:
    return within(handler.place, code, context.document.source)
