"""The types in a script: numbers and texts are joined by `..` alone.

What surely fails when it is evaluated is reported, and a number that is compared with a variable
whose type is text. A variable of unknown type fits everywhere.
"""

from __future__ import annotations

from collections.abc import Callable
from enum import Enum, auto
from typing import TypeAlias

from momantu_bt.tree.script.nodes import (
    Assignment,
    Chain,
    Choice,
    Comparison,
    Constant,
    Expression,
    Unary,
    Variable,
    number_in,
)
from momantu_bt.values import kinds
from momantu_bt.values.kinds import ValueType, kind_of


class Kind(Enum):
    """The type of an operand, as far as operators need it."""

    NUMBER = auto()
    TEXT = auto()
    OTHER = auto()
    UNKNOWN = auto()


TypeOf: TypeAlias = Callable[[Variable], ValueType]
"""The type of a variable's value; `object` if it is not known."""

_WORDS = {Kind.NUMBER: "a number", Kind.TEXT: "a text", Kind.OTHER: "neither number nor text"}


class Mismatch(Exception):
    """Operands that do not fit together. variable: the one with the wrong type, if any."""

    def __init__(self, message: str, variable: Variable | None) -> None:
        super().__init__(message)
        self.variable = variable


def check_types(statement: Expression, type_of: TypeOf) -> Kind:
    """The kind of a statement's value.

    Raises:
        Mismatch: evaluating it would fail, whatever the values are.
    """
    if isinstance(statement, Constant):
        return operand_kind(type(statement.value))
    if isinstance(statement, Variable):
        return operand_kind(type_of(statement))
    if isinstance(statement, Unary):
        _must_be_number(statement.operator, statement.operand, type_of)
        return Kind.NUMBER
    if isinstance(statement, Assignment):
        return check_types(statement.value, type_of)
    if isinstance(statement, Choice):
        check_types(statement.condition, type_of)
        sides = {check_types(side, type_of) for side in (statement.yes, statement.no)}
        return sides.pop() if len(sides) == 1 else Kind.UNKNOWN
    if isinstance(statement, Comparison):
        return _comparison(statement, type_of)
    return _chain(statement, type_of)


def operand_kind(type_: ValueType) -> Kind:
    """The kind of a type's values."""
    match kind_of(type_):
        case kinds.Choice(values=values):
            found = {operand_kind(type(value)) for value in values}
            return found.pop() if len(found) == 1 else Kind.UNKNOWN
        case kinds.Truth() | kinds.Number():
            return Kind.NUMBER
        case kinds.Text():
            return Kind.TEXT
        case kinds.Enumeration():
            return Kind.TEXT if issubclass(type_, str) else Kind.OTHER
        case kinds.Nothing() | kinds.Record() | kinds.Array() | kinds.Instance():
            return Kind.OTHER
        case _:
            return Kind.UNKNOWN


def _must_be_number(operator: str, operand: Expression, type_of: TypeOf) -> None:
    kind = check_types(operand, type_of)
    if kind in (Kind.TEXT, Kind.OTHER):
        raise Mismatch(f"`{operator}` needs a number, not {_WORDS[kind]}", _variable(operand))


def _comparison(comparison: Comparison, type_of: TypeOf) -> Kind:
    kinds = [check_types(operand, type_of) for operand in comparison.operands]
    pairs = zip(comparison.operands, comparison.operands[1:], strict=False)
    neighbours = zip(kinds, kinds[1:], comparison.operators, pairs, strict=False)
    for left, right, operator, (before, operand) in neighbours:
        known = Kind.UNKNOWN not in (left, right)
        ordered = operator not in ("==", "!=")
        if known and Kind.TEXT in (left, right) and left is not right:
            texts = (each for each in (before, operand) if isinstance(each, Constant))
            if Kind.OTHER not in (left, right) and any(map(_reads_as_number, texts)):
                continue
            message = f"`{operator}` compares {_WORDS[left]} with {_WORDS[right]}"
            raise Mismatch(message, _variable(operand) or _variable(comparison.operands[0]))
        if ordered and Kind.OTHER in (left, right):
            message = (
                f"`{operator}` compares {_WORDS[left]} with {_WORDS[right]}"
                if known
                else (f"`{operator}` needs numbers or texts")
            )
            raise Mismatch(message, _variable(operand))
    return Kind.NUMBER


def _chain(chain: Chain, type_of: TypeOf) -> Kind:
    left = check_types(chain.first, type_of)
    wrong = _variable(chain.first)
    for operator, operand in chain.rest:
        right = check_types(operand, type_of)
        left = _joined(operator, left, right, _variable(operand) or wrong)
    return left


def _joined(operator: str, left: Kind, right: Kind, variable: Variable | None) -> Kind:
    both = (left, right)
    if Kind.OTHER in both:
        raise Mismatch(f"`{operator}` needs numbers or texts", variable)
    if Kind.TEXT in both and Kind.NUMBER in both and operator != "..":
        raise Mismatch(f"`{operator}` joins {_WORDS[left]} and {_WORDS[right]}", variable)
    if both == (Kind.TEXT, Kind.TEXT) and operator not in ("+", ".."):
        raise Mismatch(f"`{operator}` does not work on texts", variable)
    if operator == "..":
        if both == (Kind.NUMBER, Kind.NUMBER):
            raise Mismatch("`..` needs a text on one side, not two numbers", variable)
        return Kind.TEXT
    if Kind.UNKNOWN in both and operator == "+":
        return left if right is Kind.UNKNOWN else right
    return Kind.TEXT if Kind.TEXT in both else Kind.NUMBER


def _reads_as_number(constant: Constant) -> bool:
    return isinstance(constant.value, str) and number_in(constant.value) is not None


def _variable(expression: Expression) -> Variable | None:
    return expression if isinstance(expression, Variable) else None
