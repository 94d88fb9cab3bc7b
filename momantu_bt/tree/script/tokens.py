"""Scripts as tokens, in both spellings: BehaviorTree.CPP's, and ours with `$` and words."""

from __future__ import annotations

import re
from dataclasses import dataclass

from momantu_bt.formats.text import NOT_TEXT

MAX_LENGTH = 4000
"""The most characters of one script: more than people write, and few enough to be safe."""


class ScriptSyntaxError(ValueError):
    """A script that cannot be read. offset, length: the place in the text, from 0."""

    def __init__(self, message: str, offset: int, length: int = 1, hint: str = "") -> None:
        super().__init__(message)
        self.message, self.offset, self.length, self.hint = message, offset, max(length, 1), hint


@dataclass(frozen=True, slots=True)
class Token:
    """kind: name, number, text, operator, end. text: canonical. offset, length: as written."""

    kind: str
    text: str
    offset: int
    length: int
    word: bool = False


_TOKEN = re.compile(
    r"""
    (?P<space>\s+)
  | (?P<dollar>\$@?[^\W\d]\w*(?:\.[^\W\d]\w*)*)
  | (?P<name>@?[^\W\d]\w*(?:\.[^\W\d]\w*)*)
  | (?P<number>0[xX][0-9a-fA-F]+\b|\d+(?:\.\d+)?(?:[eE][-+]?\d+)?)
  | (?P<text>'[^']*'|"[^"]*")
  | (?P<operator>:=|\+=|-=|\*=|/=|==|!=|<=|>=|&&|\|\||\.\.|[-+*/&|^~!<>=?:;()])
    """,
    re.VERBOSE,
)

_WORDS = {"and": "&&", "or": "||", "not": "!"}


def tokens(text: str, *, dollar: bool) -> list[Token]:
    """The tokens of a script. dollar: our spelling, where variables begin with `$`.

    Raises:
        ScriptSyntaxError: at the first character that no token begins with.
    """
    if len(text) > MAX_LENGTH:
        raise ScriptSyntaxError(f"a script of more than {MAX_LENGTH} characters", MAX_LENGTH)
    found: list[Token] = []
    position = 0
    while position < len(text):
        match = _TOKEN.match(text, position)
        if match is None or (match.lastgroup == "text" and NOT_TEXT.search(match[0])):
            raise _stray(text, position)
        position = match.end()
        if match.lastgroup != "space":
            found.append(_token(match, dollar))
    found.append(Token("end", "", len(text), 1))
    return found


def _token(match: re.Match[str], dollar: bool) -> Token:
    kind, text, offset = str(match.lastgroup), match[0], match.start()
    if kind == "dollar":
        if not dollar:
            raise ScriptSyntaxError("`$` does not belong here", offset, len(text), "write the name")
        if text[1:] in ("true", "false"):
            hint = f"write {text[1:]}"
            raise ScriptSyntaxError(f"{text} is a value, not a key", offset, len(text), hint)
        return Token("name", text[1:], offset, len(text))
    if kind == "name" and dollar:
        if text in _WORDS:
            return Token("operator", _WORDS[text], offset, len(text), word=True)
        if text not in ("true", "false"):
            raise ScriptSyntaxError(
                f"{text!r} is neither a variable nor a text",
                offset,
                len(text),
                f"did you mean ${text}, or '{text}' in quotes?",
            )
    if kind == "number" and _glued(match):
        raise ScriptSyntaxError(
            "a number with letters behind it", offset, len(text) + 1, "units are not read here"
        )
    return Token(kind, text, offset, len(text))


def _glued(match: re.Match[str]) -> bool:
    following = match.string[match.end() : match.end() + 1]
    return following.isalpha() or following == "_"


def _stray(text: str, position: int) -> ScriptSyntaxError:
    character = text[position]
    control = NOT_TEXT.search(text, position)
    if control is not None:
        message = f"the character U+{ord(control[0]):04X} cannot stand in a script"
        return ScriptSyntaxError(message, control.start(), 1, "remove it")
    if character in "'\"":
        return ScriptSyntaxError("a text that is never closed", position, len(text) - position)
    if character == "$":
        return ScriptSyntaxError("`$` without a name", position, 1, "write $key")
    if character == "{":
        return ScriptSyntaxError("braces do not belong here", position, 1, "write $key")
    return ScriptSyntaxError(f"{character!r} means nothing here", position)


def _apart(before: list[str], word: str, following: str) -> str:
    """A word for a sign, with the spaces that separate it from its neighbours."""
    last = "".join(before)[-1:]
    if word == "not":
        return word + ("" if following.isspace() else " ")
    left = "" if last.isspace() else " "
    return left + word + ("" if following.isspace() else " ")


def respell(text: str, found: list[Token], *, dollar: bool, words: bool = True) -> str:
    """The same script in the other spelling, with the same spaces and brackets.

    found: its tokens. dollar: whether our spelling is wanted. words: write words for signs there.
    """
    spelled = {operator: word for word, operator in _WORDS.items()}
    pieces: list[str] = []
    position = 0
    for token in found:
        pieces.append(text[position : token.offset])
        position = token.offset + token.length
        if token.kind == "name" and token.text not in ("true", "false"):
            pieces.append(("$" if dollar else "") + token.text)
        elif token.kind == "operator" and dollar and words and token.text in spelled:
            pieces.append(_apart(pieces, spelled[token.text], text[position : position + 1]))
        elif token.kind == "operator" and token.word:
            pieces.append(token.text)
            while token.text == "!" and text[position : position + 1] == " ":
                position += 1
        elif token.kind != "end":
            pieces.append(text[token.offset : position])
    return "".join(pieces).strip()
