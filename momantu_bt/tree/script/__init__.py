"""Conditions and scripts: reading them in either spelling, and running them.

The canonical spelling is BehaviorTree.CPP's (`!at_a && n > 2; n += 1`); in YAML variables have
a `$` and words may stand for signs (`not $at_a and $n > 2`). Nothing is ever given to Python's
own `eval`.
"""

from __future__ import annotations

from momantu_bt.tree.script.nodes import Board, ScriptError, part, truth
from momantu_bt.tree.script.parser import Script, script_of
from momantu_bt.tree.script.tokens import ScriptSyntaxError, respell, tokens

__all__ = [
    "Board",
    "Script",
    "ScriptError",
    "ScriptSyntaxError",
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


def canonical(text: str) -> str:
    """Our YAML spelling in canonical form.

    Raises:
        ScriptSyntaxError: it cannot be read; also where `and` and `or` are mixed without
            brackets, and where `not` stands before a comparison, because the canonical form
            means something else than it seems to say there.
    """
    found = tokens(text, dollar=True)
    script_of(found, text, strict=True)
    return respell(text, found, dollar=False)


def yaml_spelling(text: str, *, words: bool = True) -> str:
    """The canonical form in our YAML spelling; ScriptSyntaxError when it cannot be read.

    words: write `and`, `or` and `not` for the signs.
    """
    return respell(text, tokens(text, dollar=False), dollar=True, words=words)
