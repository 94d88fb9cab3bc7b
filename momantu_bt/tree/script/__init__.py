"""Conditions and scripts: reading them in either spelling, and running them.

The canonical spelling is BehaviorTree.CPP's (`!at_a && n > 2; n += 1`). In YAML, variables have
a `$`, and words may replace signs (`not $at_a and $n > 2`). Python's `eval` is never used.
"""

from __future__ import annotations

from momantu_bt.tree.script.nodes import Assignment, Board, ScriptError, part, truth
from momantu_bt.tree.script.parser import Script, script_of
from momantu_bt.tree.script.tokens import ScriptSyntaxError, respell, tokens

__all__ = [
    "Board",
    "Script",
    "ScriptError",
    "ScriptSyntaxError",
    "assigned",
    "canonical",
    "parse",
    "part",
    "truth",
    "yaml_spelling",
]


def parse(text: str) -> Script:
    """Read the canonical spelling.

    Raises:
        ScriptSyntaxError: with the offset of the first thing that is wrong.
    """
    return script_of(tokens(text, dollar=False), text)


def assigned(text: str, *, dollar: bool) -> tuple[int, int] | None:
    """The place of `=` or `:=` in a condition that ends with an assignment, or None.

    In `$n = 3` a person most likely means `==`. An earlier statement, as in `$n := 1; $n > 0`, and
    `+=` may assign. dollar: whether the text is in our YAML spelling.

    Returns the offset and the length.

    Raises:
        ScriptSyntaxError: the text cannot be read.
    """
    last = script_of(tokens(text, dollar=dollar), text).statements[-1]
    if not isinstance(last, Assignment) or last.operator not in ("=", ":="):
        return None
    after = last.target.offset + last.target.length
    return text.index(last.operator, after), len(last.operator)


def canonical(text: str) -> str:
    """Change our YAML spelling to the canonical form.

    Raises:
        ScriptSyntaxError: it cannot be read, or it mixes `and` and `or` without brackets, or it
            has `not` before a comparison. The canonical form of the last two does not mean what
            they seem to say.
    """
    found = tokens(text, dollar=True)
    script_of(found, text, strict=True)
    return respell(text, found, dollar=False)


def yaml_spelling(text: str, *, words: bool = True) -> str:
    """Change the canonical form to our YAML spelling; ScriptSyntaxError if it cannot be read.

    words: write `and`, `or` and `not` instead of the signs.
    """
    return respell(text, tokens(text, dollar=False), dollar=True, words=words)
