"""A script from its tokens, by precedence; within a bound on brackets."""

from __future__ import annotations

from dataclasses import dataclass

from momantu_bt.tree.script.nodes import (
    Assignment,
    Board,
    Chain,
    Choice,
    Comparison,
    Constant,
    Expression,
    Unary,
    Variable,
)
from momantu_bt.tree.script.tokens import ScriptSyntaxError, Token

MAX_DEPTH = 40
"""The most brackets within brackets. The limit protects the reader's own stack."""

_MATHS = ({"+": 1, "-": 1, "*": 2, "/": 2}, {"|": 1, "^": 1, "&": 2}, {"..": 1})
# each group's operators with their rank; groups mix only with brackets
_COMPARE = ("==", "!=", "<", ">", "<=", ">=")
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
        value = self.choice()
        self.writes.append(left)
        self.made |= {left.key}
        return Assignment(left, operator.text, value)

    def choice(self) -> Expression:
        condition = self.logic()
        if self.accept("?") is None:
            return condition
        made = self.made
        yes = self.nested()
        if self.accept(":") is None:
            raise self.unexpected("`:`")
        made_by_yes, self.made = self.made, made
        no = self.logic()
        self.made &= made_by_yes
        return Choice(condition, yes, no)

    def logic(self) -> Expression:
        first = self.comparison()
        rest: list[tuple[str, Expression]] = []
        while operator := self.accept("&&", "||"):
            if self.strict and rest and rest[-1][0] != operator.text:
                raise ScriptSyntaxError(
                    "`and` and `or` together need brackets",
                    operator.offset,
                    operator.length,
                    "write ($a and $b) or $c",
                )
            rest.append((operator.text, self.comparison()))
        return Chain(first, tuple(rest)) if rest else first

    def comparison(self) -> Expression:
        start = self.now
        operands = [self.maths()]
        operators: list[str] = []
        while operator := self.accept(*_COMPARE):
            if self.strict and start.word and start.text == "!":
                raise ScriptSyntaxError(
                    "`not` before a comparison needs brackets",
                    start.offset,
                    start.length,
                    "write not ($a == $b)",
                )
            operators.append(operator.text)
            operands.append(self.maths())
        if not operators:
            return operands[0]
        return Comparison(tuple(operands), tuple(operators))

    def maths(self) -> Expression:
        first = self.operand()
        for group in _MATHS:
            if self.now.kind == "operator" and self.now.text in group:
                chain = self.chain(first, group, 1)
                self.no_other_group(group)
                return chain
        return first

    def chain(self, first: Expression, group: dict[str, int], rank: int) -> Expression:
        rest: list[tuple[str, Expression]] = []
        if rank == 1 and 2 in group.values():
            first = self.chain(first, group, 2)
        ranked = [name for name, its in group.items() if its == rank]
        while operator := self.accept(*ranked):
            right = self.operand()
            if rank == 1 and 2 in group.values():
                right = self.chain(right, group, 2)
            rest.append((operator.text, right))
        return Chain(first, tuple(rest)) if rest else first

    def no_other_group(self, group: dict[str, int]) -> None:
        others = [name for other in _MATHS if other is not group for name in other]
        if self.now.kind == "operator" and self.now.text in others:
            raise ScriptSyntaxError(
                f"`{self.now.text}` cannot follow without brackets", self.now.offset, 1
            )

    def operand(self) -> Expression:
        if operator := self.accept("-", "~", "!"):
            return Unary(operator.text, self.atom())
        if self.now.text == "+" and self.tokens[self.index + 1].kind == "number":
            self.take()
        return self.atom()

    def atom(self) -> Expression:
        token = self.take()
        if token.kind == "operator" and token.text == "(":
            inside = self.nested()
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

    def nested(self) -> Expression:
        self.depth += 1
        if self.depth > MAX_DEPTH:
            raise ScriptSyntaxError(f"more than {MAX_DEPTH} brackets deep", self.now.offset)
        inside = self.statement()
        self.depth -= 1
        return inside

    def unexpected(self, wanted: str) -> ScriptSyntaxError:
        token = self.now
        what = "the script ends" if token.kind == "end" else f"`{token.text}` stands"
        return ScriptSyntaxError(f"{what} where {wanted} should be", token.offset, token.length)


def _number(text: str) -> int | float:
    if text[:2].lower() == "0x":
        return int(text, 16)
    return float(text) if any(mark in text for mark in ".eE") else int(text)
