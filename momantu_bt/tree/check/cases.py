"""Checks of switches: a case that the variable can never equal is an error."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from contextlib import suppress
from enum import Enum
from typing import Any

from momantu_bt.failure import ENGINE_CODES
from momantu_bt.formats.names import valid_names
from momantu_bt.tree.catalogue.codes import UNKNOWN, Codes
from momantu_bt.tree.catalogue.known import Key, Known, part_type
from momantu_bt.tree.check.keys.shared import scripts_of
from momantu_bt.tree.check.signatures import Context
from momantu_bt.tree.language import ANY
from momantu_bt.tree.model import Literal, Node, Reference, Scope, Tree
from momantu_bt.tree.script.cases import is_case
from momantu_bt.values import kinds
from momantu_bt.values.kinds import ValueKind, kind_of, without_none

HANDLED_CODE = Reference("failure", ("code",))
"""The code of the failure that a handler handles."""


def check_switch(context: Context, tree: Tree, switch: Node, known: Known) -> None:
    """Check that each case of a switch on a key of the tree is a possible value of the key."""
    value = switch.ports.get("variable")
    key = known.get(value.key) if isinstance(value, Reference) else None
    if key is None or not isinstance(value, Reference) or value.scope is Scope.ROOT:
        return
    if value.fields:
        with suppress(KeyError):  # reported where the wire is checked
            _check_key(context, switch, Key(part_type(key.type, value.fields), key.place))
    elif key.choices and value.key in _written_by_scripts(context, tree):
        pass  # in a loop, a script further down may have written something else
    else:
        _check_key(context, switch, key)


def _written_by_scripts(context: Context, tree: Tree) -> set[str]:
    scripts = (script for node in tree.root.walk() for script in scripts_of(context, node))
    return {variable.key for script in scripts for variable in script.writes}


def _check_key(context: Context, switch: Node, key: Key) -> None:
    possible = [choice.value for choice in key.choices]
    if not possible and not key.either:
        possible = list(_values(without_none(kind_of(key.type))))
    if possible:
        _check(context, switch, possible, "the value can be", str)


def check_handled_cases(context: Context, catching: Node, possible: Codes) -> None:
    """Check switches on `$failure.code` in the handlers of a node.

    possible: the codes that can arrive at the handlers.
    """
    for handler in catching.handlers:
        codes = {code.split(".")[-1] for code in handler.codes}
        if ANY in codes:
            if UNKNOWN in possible:
                continue
            codes = {code for code in possible if "." not in code}
        for node in _inside(handler.node):
            if node.ports.get("variable") == HANDLED_CODE:
                _check(context, node, sorted(codes), "the code can be", _hidden_engine_code)


def _inside(handler: Node | None) -> Iterator[Node]:
    """The nodes of a handler, without the handlers in it: those have another failure."""
    stack = [] if handler is None else [handler]
    while stack:
        node = stack.pop()
        yield node
        stack.extend(node.children)


def _hidden_engine_code(value: Any) -> str | None:
    return None if value in ENGINE_CODES else str(value)


def _check(context: Context, switch: Node, possible: Sequence[Any], what: str, shown: Any) -> None:
    for name, case in switch.ports.items():
        if not name.startswith("case_") or not isinstance(case, Literal):
            continue
        if any(is_case(value, case.value) for value in possible):
            continue
        place = switch.port_places.get(name, switch.place)
        names = [text for text in map(shown, possible) if text is not None]
        hint = valid_names(str(case.value), names, what)
        message = f"no value equals the case {str(case.value)!r}"
        context.problems.error("dead-case", place, message, hint)


def _values(options: Iterable[ValueKind]) -> Iterator[Any]:
    """Every value of some kinds; none if there are too many to list."""
    found: list[Any] = []
    for kind in options:
        match kind:
            case kinds.Choice(values=values):
                found += values
            case kinds.Enumeration():
                found += [item.value for item in kind.type if isinstance(item, Enum)]
            case _:
                return
    yield from found
