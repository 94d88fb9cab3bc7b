"""Checks of switches: a case that the variable can never equal is an error."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import Any, TypeAlias

from momantu_bt.failure import ENGINE_CODES
from momantu_bt.formats.names import valid_names
from momantu_bt.tree.catalogue.codes import UNKNOWN, Codes
from momantu_bt.tree.check.signatures import Context
from momantu_bt.tree.language import ANY
from momantu_bt.tree.model import Literal, Node, Reference
from momantu_bt.tree.script.cases import is_case

Shown: TypeAlias = Callable[[Any], str | None]

HANDLED_CODE = Reference("failure", ("code",))
"""The code of the failure that a handler handles."""


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
                report_dead_cases(
                    context, node, sorted(codes), "the code can be", _hidden_engine_code
                )


def _inside(handler: Node | None) -> Iterator[Node]:
    """The nodes of a handler, without the handlers in it: those have another failure."""
    stack = [] if handler is None else [handler]
    while stack:
        node = stack.pop()
        yield node
        stack.extend(node.children)


def _hidden_engine_code(value: Any) -> str | None:
    return None if value in ENGINE_CODES else str(value)


def report_dead_cases(
    context: Context, switch: Node, possible: Sequence[Any], what: str, shown: Shown = str
) -> None:
    """Report each case of a switch that none of the possible values equals.

    what: begins the list of values. shown: a value in that list; None leaves it out.
    """
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
