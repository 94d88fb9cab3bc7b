"""Checks of switches on a key: each case is one of the key's possible values."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import suppress
from enum import Enum
from typing import Any

from momantu_bt.tree.catalogue.known import Key, Known, part_type
from momantu_bt.tree.check.cases import report_dead_cases
from momantu_bt.tree.check.keys.shared import scripts_of
from momantu_bt.tree.check.signatures import Context
from momantu_bt.tree.model import Node, Reference, Scope, Tree
from momantu_bt.values import kinds
from momantu_bt.values.kinds import ValueKind, kind_of, without_none


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
        report_dead_cases(context, switch, possible, "the value can be")


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
