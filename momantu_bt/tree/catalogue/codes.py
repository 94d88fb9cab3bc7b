"""Which failure codes can come out of a node, from those that its children can fail with."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeAlias

from momantu_bt.failure import FAILED, INPUT_MISSING, SCRIPT_ERROR, WRONG_TYPE
from momantu_bt.tree.model import Node

Codes: TypeAlias = frozenset[str]
"""Failure codes, plain (`TOO_FAR`) or with the node (`grip.TOO_FAR`). UNKNOWN means any code."""
UNKNOWN = "?"
NO_CODES: Codes = frozenset()

ANY_NODE: Codes = frozenset({FAILED, INPUT_MISSING, WRONG_TYPE, SCRIPT_ERROR})
"""Every node of the language can fail with these."""


@dataclass(frozen=True, slots=True)
class Failing:
    """What is known about the nodes below a node.

    children: codes with which its children can fail. handlers: codes with which its handlers can
    fail. named: the codes that its port `code` can have.
    """

    children: Codes
    handlers: Codes
    named: Codes


CodeFlow: TypeAlias = Callable[[Node, Failing], Codes]
"""The codes that a node can fail with."""


def joined(*parts: Codes) -> Codes:
    """The union of some sets; if one contains all others, that set itself, to avoid a copy."""
    distinct = set(parts)
    largest = max(distinct, key=len, default=NO_CODES)
    if all(part <= largest for part in distinct):
        return largest
    return NO_CODES.union(*distinct)


def passed_on(node: Node, failing: Failing) -> Codes:
    """The codes of the children and handlers, and those of every node."""
    return joined(failing.children, failing.handlers, ANY_NODE)


def and_also(*codes: str) -> CodeFlow:
    """As `passed_on`, with further codes of the node itself."""
    own = ANY_NODE | frozenset(codes)
    return lambda node, failing: joined(failing.children, failing.handlers, own)
