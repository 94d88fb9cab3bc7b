"""A script from its tokens, by precedence; within a bound on brackets."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass

from momantu_bt.tree.script.nodes import (
    Assignment,
    Board,
    Chain,
    Choice,
    Comparison,
    Constant,
    Expression,
    ScriptError,
    Unary,
    Variable,
)
from momantu_bt.tree.script.tokens import ScriptSyntaxError, Token

MAX_DEPTH = 40
"""The most levels of brackets, signs, assignments and choices. It protects the reader's stack."""

_COMPARE = ("==", "!=", "<", ">", "<=", ">=")
_LEVELS = (("||",), ("&&",), _COMPARE, ("|", "^"), ("&",), ("+", "-", ".."), ("*", "/"))
_RANKS = {operator: rank for rank, level in enumerate(_LEVELS) for operator in level}
"""How tightly an operator binds, as in BehaviorTree.CPP 4.10."""
_ASSIGN = (":=", "=", "+=", "-=", "*=", "/=")


@dataclass(frozen=True, slots=True)
class Script:
    """A script ready to run. text: its canonical spelling.

    reads: variables it reads. writes: keys it assigns. Both are in the order of the text.
    needs: variables that must have a value before it runs, without those that it creates first.
    """

    text: str
    statements: tuple[Expression, ...]
    reads: tuple[Variable, ...]
    writes: tuple[Variable, ...]
    needs: tuple[Variable, ...]

    def run(self, board: Board) -> object:
        """Run all statements. Returns the value of the last one (None if it has none).

        Raises:
            ScriptError: a variable has no value, or an operation does not fit its operands.
        """
        value: object = None
        for statement in self.statements:
            value = statement.evaluate(board)
        return value

    def values(self, board: Board) -> list[tuple[str, object]]:
        """The variables that it reads, as `found.pose`, with their values; no empty ones."""
        found: dict[str, object] = {}
        for variable in self.reads:
            with suppress(ScriptError):
                found[".".join((variable.key, *variable.parts))] = variable.evaluate(board)
        return list(found.items())


def script_of(found: list[Token], text: str, *, strict: bool = False) -> Script:
    """The script that tokens form. strict: refuse what people easily misread.

    Raises:
        ScriptSyntaxError: with the offset of the first thing that is wrong.
    """
    return _Parser(found, text, strict=strict).script()


class _Parser:
    def __init__(self, found: list[Token], text: str, *, strict: bool = False) -> None:
        self.tokens, self.text, self.strict = found, text, strict
        self.index = 0
        self.depth = 0
        self.logic = ""
        self.reads: list[Variable] = []
        self.writes: list[Variable] = []
        self.needs: list[Variable] = []
        self.made: frozenset[str] = frozenset()

    @property
    def now(self) -> Token:
        return self.tokens[self.index]

    def take(self) -> Token:
        token = self.now
        self.index += 1
        return token

    def accept(self, *operators: str) -> Token | None:
        if self.now.kind == "operator" and self.now.text in operators:
            return self.take()
        return None

    def script(self) -> Script:
        statements: list[Expression] = []
        while self.now.kind != "end":
            statements.append(self.statement())
            if self.now.kind != "end" and not self.accept(";"):
                raise self.unexpected("`;`, an operator or the end")
            while self.accept(";"):
                pass
        if not statements:
            raise ScriptSyntaxError("an empty script", 0)
        return Script(
            self.text,
            tuple(statements),
            tuple(self.reads),
            tuple(self.writes),
            tuple(self.needs),
        )

    def statement(self) -> Expression:
        start = self.now
        reads, needs = len(self.reads), len(self.needs)
        left = self.choice()
        operator = self.accept(*_ASSIGN)
        if operator is None:
            return left
        if not isinstance(left, Variable) or left.parts:
            raise ScriptSyntaxError(
                f"only a variable can stand left of `{operator.text}`", start.offset, start.length
            )
        if operator.text in (":=", "="):
            del self.reads[reads:]
        if operator.text == ":=":
            del self.needs[needs:]
        value = self.deeper(self.statement)
        self.writes.append(left)
        self.made |= {left.key}
        return Assignment(left, operator.text, value)

    def choice(self) -> Expression:
        condition = self.joined()
        if self.accept("?") is None:
            return condition
        made = self.made
        yes = self.deeper(self.statement)
        if self.accept(":") is None:
            raise self.unexpected("`:`")
        made_by_yes, self.made = self.made, made
        no = self.deeper(self.choice)
        self.made &= made_by_yes
        return Choice(condition, yes, no)

    def joined(self, least: int = 0) -> Expression:
        """Operands joined by operators that bind at least as tightly as rank `least`."""
        start = self.now
        left = self.operand()
        while (rank := self.rank()) >= least:
            operators, operands = [], [left]
            while self.rank() == rank:
                operator = self.take()
                if self.strict:
                    self.refuse_misread(start, operator)
                operators.append(operator.text)
                operands.append(self.joined(rank + 1))
            if operators[0] in _COMPARE:
                left = Comparison(tuple(operands), tuple(operators))
            else:
                left = Chain(left, tuple(zip(operators, operands[1:], strict=True)))
        return left

    def rank(self) -> int:
        """The rank of the operator that follows; -1 if none does."""
        return _RANKS.get(self.now.text, -1) if self.now.kind == "operator" else -1

    def refuse_misread(self, start: Token, operator: Token) -> None:
        """Refuse what people and other readers of such scripts may take for something else."""
        if operator.text in ("&&", "||"):
            if self.logic not in ("", operator.text):
                raise ScriptSyntaxError(
                    "`and` and `or` together need brackets",
                    operator.offset,
                    operator.length,
                    "write ($a and $b) or $c",
                )
            self.logic = operator.text
        if operator.text in _COMPARE and start.word and start.text == "!":
            raise ScriptSyntaxError(
                "`not` before a comparison needs brackets",
                start.offset,
                start.length,
                "write not ($a == $b)",
            )

    def operand(self) -> Expression:
        if operator := self.accept("-", "~", "!"):
            return Unary(operator.text, self.deeper(self.operand))
        if self.now.text == "+" and self.tokens[self.index + 1].kind == "number":
            self.take()
        return self.atom()

    def atom(self) -> Expression:
        token = self.take()
        if token.kind == "operator" and token.text == "(":
            inside = self.deeper(self.statement)
            if self.accept(")") is None:
                raise self.unexpected("`)`")
            return inside
        if token.kind == "number":
            return Constant(_number(token.text))
        if token.kind == "text":
            return Constant(token.text[1:-1])
        if token.kind == "name" and token.text in ("true", "false"):
            return Constant(token.text == "true")
        if token.kind == "name":
            key, *parts = token.text.split(".")
            variable = Variable(key, tuple(parts), token.offset, token.length)
            self.reads.append(variable)
            if key not in self.made:
                self.needs.append(variable)
            return variable
        self.index -= 1
        raise self.unexpected("a variable, a number, a text in quotes or `(`")

    def deeper(self, part: Callable[[], Expression]) -> Expression:
        """A part inside brackets, or behind a sign, an assignment or a choice."""
        self.depth += 1
        if self.depth > MAX_DEPTH:
            raise ScriptSyntaxError(f"more than {MAX_DEPTH} levels deep", self.now.offset)
        logic, self.logic = self.logic, ""
        inside = part()
        self.depth, self.logic = self.depth - 1, logic
        return inside

    def unexpected(self, wanted: str) -> ScriptSyntaxError:
        token = self.now
        what = "the script ends" if token.kind == "end" else f"`{token.text}` stands"
        return ScriptSyntaxError(f"{what} where {wanted} should be", token.offset, token.length)


def _number(text: str) -> int | float:
    if text[:2].lower() == "0x":
        return int(text, 16)
    return float(text) if any(mark in text for mark in ".eE") else int(text)
