"""Warnings of conditions that assign where they probably mean to compare."""

from __future__ import annotations

from momantu_bt.formats.places import Place, within
from momantu_bt.tree.catalogue import NODES, PRE_CONDITIONS
from momantu_bt.tree.check.signatures import Context
from momantu_bt.tree.model import Literal, Node
from momantu_bt.tree.script import ScriptSyntaxError, assigned


def check_conditions(context: Context, node: Node) -> None:
    """Warn of a condition such as `n = 3`, which BehaviorTree.CPP allows.

    In YAML the reader refuses it, unless it is kept in BehaviorTree.CPP's spelling.
    """
    spec = NODES.get(node.type)
    for name in spec.asks if spec is not None else ():
        code = node.ports.get(name)
        if isinstance(code, Literal):
            _check(context, str(code.value), node.port_places.get(name, node.place))
    for name in PRE_CONDITIONS:
        if name in node.conditions:
            _check(context, node.conditions[name], node.condition_places.get(name, node.place))


def _check(context: Context, text: str, place: Place) -> None:
    try:
        slip = assigned(text, dollar=False)
    except ScriptSyntaxError:
        return  # reported where keys are checked
    if slip is not None:
        operator = text[slip[0] : sum(slip)]
        message = f"`{operator}` assigns here, and the assigned value counts as the answer"
        where = within(place, text, context.document.source)
        if where.length == len(text):
            where = Place(where.file, where.line, where.column + slip[0], slip[1])
        context.problems.warning("assigns", where, message, "did you mean `==`?")
