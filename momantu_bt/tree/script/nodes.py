"""The expressions of a script, which evaluate themselves on a blackboard.

The meaning is BehaviorTree.CPP 4's: both sides of `&&` and `||` are evaluated, comparisons
chain (`1 < n < 3`), and numbers are equal within `EPSILON`. A number meets a text in two places:
`..` joins it as it is written, and a comparison reads the text as a number.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields, is_dataclass
from typing import Any, Protocol, TypeAlias

from momantu_bt.values.words import in_words

EPSILON = 1.1920929e-07
"""Numbers nearer than this are equal. As in BehaviorTree.CPP, a single-precision ulp."""


class ScriptError(RuntimeError):
    """A script that cannot be evaluated: an unknown variable, an operation on wrong types."""


class Board(Protocol):
    """The keys that a script can use. `@key` is a key of the root's board."""

    def get(self, key: str) -> Any:
        """The key's value; KeyError when it has none."""
        ...

    def set(self, key: str, value: Any) -> None:
        """Write a key."""
        ...

    def has(self, key: str) -> bool:
        """Whether the key has a value."""
        ...


@dataclass(frozen=True, slots=True)
class Constant:
    """A number, a text, true or false."""

    value: Any

    def evaluate(self, board: Board) -> Any:
        """Its value."""
        return self.value


@dataclass(frozen=True, slots=True)
class Variable:
    """A key of the board, or a part of its value: `found.pose`."""

    key: str
    parts: tuple[str, ...]
    offset: int
    length: int

    def evaluate(self, board: Board) -> Any:
        """The key's value; ScriptError if it has none."""
        if not board.has(self.key):
            raise ScriptError(f"${self.key} has no value")
        return part(board.get(self.key), self.parts)


@dataclass(frozen=True, slots=True)
class Unary:
    """`-x`, `~x`, `!x`."""

    operator: str
    operand: Expression

    def evaluate(self, board: Board) -> Any:
        """The result, `~` of the whole part; ScriptError if the operand is not a number."""
        value = _number(self.operand.evaluate(board), self.operator)
        if self.operator == "!":
            return not value
        if self.operator == "~":
            return ~_whole_part(value)
        return -value


@dataclass(frozen=True, slots=True)
class Chain:
    """Operands joined from the left by operators of the same rank: `a - b + c`, `a && b`."""

    first: Expression
    rest: tuple[tuple[str, Expression], ...]

    def evaluate(self, board: Board) -> Any:
        """The result; ScriptError if the operands do not fit together."""
        value = self.first.evaluate(board)
        for operator, operand in self.rest:
            value = apply(operator, value, operand.evaluate(board))
        return value


@dataclass(frozen=True, slots=True)
class Comparison:
    """`a < b`, `a <= b < c`: true if each pair of neighbours is."""

    operands: tuple[Expression, ...]
    operators: tuple[str, ...]

    def evaluate(self, board: Board) -> Any:
        """Whether it is true; ScriptError if a number meets a text that reads as none."""
        left = self.operands[0].evaluate(board)
        for operator, operand in zip(self.operators, self.operands[1:], strict=True):
            right = operand.evaluate(board)
            if not _compare(operator, left, right):
                return False
            left = right
        return True


@dataclass(frozen=True, slots=True)
class Choice:
    """`condition ? yes : no`."""

    condition: Expression
    yes: Expression
    no: Expression

    def evaluate(self, board: Board) -> Any:
        """The chosen side."""
        chosen = self.yes if truth(self.condition.evaluate(board)) else self.no
        return chosen.evaluate(board)


@dataclass(frozen=True, slots=True)
class Assignment:
    """`key := value` creates or overwrites; `=`, `+=`, `-=`, `*=`, `/=` need an existing key."""

    target: Variable
    operator: str
    value: Expression

    def evaluate(self, board: Board) -> Any:
        """Write the key and return its new value."""
        key = self.target.key
        if self.operator != ":=" and not board.has(key):
            raise ScriptError(f"${key} does not exist; `:=` creates it")
        value = self.value.evaluate(board)
        if self.operator not in (":=", "="):
            value = apply(self.operator[0], board.get(key), value)
        board.set(key, value)
        return value


Expression: TypeAlias = Constant | Variable | Unary | Chain | Comparison | Choice | Assignment


def part(value: Any, parts: tuple[str, ...]) -> Any:
    """A part of a value, by the names of its fields.

    Raises:
        ScriptError: there is no such part; the message lists those there are.
    """
    for name in parts:
        if isinstance(value, Mapping) and name in value:
            value = value[name]
        elif not name.startswith("_") and name in _names(value):
            value = getattr(value, name)
        else:
            having = ", ".join(_names(value)) or "none"
            raise ScriptError(f"{type(value).__name__} has no part {name!r}; parts: {having}")
    return value


def _names(value: Any) -> tuple[str, ...]:
    if isinstance(value, Mapping):
        return tuple(str(key) for key in value)
    if not is_dataclass(value) or isinstance(value, type):
        return ()
    computed = [n for n, v in vars(type(value)).items() if isinstance(v, property)]
    return (*(item.name for item in fields(value)), *computed)


def truth(value: Any) -> bool:
    """Whether a condition's value is true: a number other than 0, or a text that is not empty.

    Raises:
        ScriptError: the value is neither.
    """
    if isinstance(value, str):
        return value != ""
    return bool(_number(value, "a condition") != 0)


def _number(value: Any, operator: str) -> Any:
    if isinstance(value, bool | int | float):
        return value
    raise ScriptError(f"{operator} needs a number, not {_describe(value)}")


def _integer(value: Any, operator: str) -> int:
    number = _number(value, operator)
    if not isinstance(number, int) and not number.is_integer():
        raise ScriptError(f"{operator} needs whole numbers, not {number}")
    return int(number)


def _whole_part(number: float) -> int:
    try:
        return int(number)
    except (OverflowError, ValueError):
        raise ScriptError(f"~ needs a finite number, not {number}") from None


def _describe(value: Any) -> str:
    return f"the text {value!r}" if isinstance(value, str) else f"{type(value).__name__} {value!r}"


def apply(operator: str, left: Any, right: Any) -> Any:
    """`left operator right`.

    Raises:
        ScriptError: the two do not fit together, or it divides by zero.
    """
    if isinstance(left, str) and isinstance(right, str):
        if operator in ("+", ".."):
            return left + right
        raise ScriptError(f"{operator} does not work on texts")
    if operator == "..":
        return _together(left, right)
    _number(left, operator)
    _number(right, operator)
    if operator == "/" and right == 0:
        raise ScriptError("a division by zero")
    try:
        return _OPERATIONS[operator](left, right)
    except OverflowError:
        raise ScriptError(f"the numbers are too large for {operator}") from None


_OPERATIONS: dict[str, Callable[[Any, Any], Any]] = {
    "+": lambda a, b: a + b,
    "-": lambda a, b: a - b,
    "*": lambda a, b: a * b,
    "/": lambda a, b: a / b,
    "&": lambda a, b: _integer(a, "&") & _integer(b, "&"),
    "|": lambda a, b: _integer(a, "|") | _integer(b, "|"),
    "^": lambda a, b: _integer(a, "^") ^ _integer(b, "^"),
    "&&": lambda a, b: bool(a) and bool(b),
    "||": lambda a, b: bool(a) or bool(b),
}


def _together(left: Any, right: Any) -> str:
    """A text and a number as one text."""
    for value in (left, right):
        if not isinstance(value, str | bool | int | float):
            raise ScriptError(f".. joins texts and numbers, not {_describe(value)}")
    if not isinstance(left, str) and not isinstance(right, str):
        raise ScriptError(".. needs a text on one side, not two numbers")
    return "".join(each if isinstance(each, str) else in_words(each) for each in (left, right))


def number_in(text: str) -> float | None:
    """The number that a text reads as, `true` and `false` too; None if it reads as none."""
    if text in _TRUTHS:
        return _TRUTHS[text]
    return float(text) if _NUMBER.fullmatch(text) else None


_NUMBER = re.compile(r"-?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?")
_TRUTHS = {"true": 1.0, "false": 0.0}


def _compare(operator: str, left: Any, right: Any) -> bool:
    texts = isinstance(left, str), isinstance(right, str)
    if texts[0] != texts[1]:
        left, right = _numeric(operator, left, right), _numeric(operator, right, left)
        texts = False, False
    if operator in ("==", "!="):
        same = bool(left == right) if texts[0] else _same(left, right)
        return same if operator == "==" else not same
    if not texts[0]:
        _number(left, operator)
        _number(right, operator)
    return bool(_ORDER[operator](left, right))


def _numeric(operator: str, value: Any, other: Any) -> Any:
    """A value that is compared with one of another kind: a text must read as a number."""
    number = number_in(value) if isinstance(value, str) else value
    if isinstance(number, bool | int | float):
        return number
    raise ScriptError(
        f"{operator} compares alike with alike, not {_describe(value)} with {_describe(other)}"
    )


def _same(left: Any, right: Any) -> bool:
    if isinstance(left, bool | int | float) and isinstance(right, bool | int | float):
        try:
            return left == right or abs(left - right) <= EPSILON
        except OverflowError:  # a whole number too large for a float
            return False
    return bool(left == right)


_ORDER: dict[str, Callable[[Any, Any], Any]] = {
    "<": lambda a, b: a < b,
    ">": lambda a, b: a > b,
    "<=": lambda a, b: a <= b,
    ">=": lambda a, b: a >= b,
}
