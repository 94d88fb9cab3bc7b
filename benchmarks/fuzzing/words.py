"""What may stand in a tree file: names, wires, numbers, signs; right ones and strange ones."""

from __future__ import annotations

from collections.abc import Iterable

from momantu_bt.messages import VALUE_TYPES
from momantu_bt.tree.catalogue import MODIFIERS, SPELLED

_HEADER = """
momantu_bt world main values trees include Main Sub Take inputs outputs inouts open doc try catch
then else do cases default children child in as code message
"""
_ODD = """
$a $b.x $@a $= $$ ${a} $ {a} 1 -2 1.5 1e999 0x1F 0o7 010 .5 5. 1_000 true false yes ~ null 5m/s
A_CODE any again (((( a;b;; &x *x << ? | > >- ! !!int % --- ... # @ ` é日 \u202e " ' : - , [ ] { }
\\t \\x00 "\\ud800" "\\U0010ffff"
"""
_PHRASES = ("3 cm", "1 min 30 s", "$n := 1", "not $a", "$a > 1 and $b < 2", "list of pose", "a: b")


class Words:
    """The language's words. skills: names of the installed ones.

    all: everything; plain: names alone; nodes: names of nodes.
    """

    def __init__(self, skills: Iterable[str]) -> None:
        self.nodes = [*SPELLED, *skills, "Sub", "Take", "nonesuch"]
        self.plain = [*self.nodes, *MODIFIERS, *VALUE_TYPES, *_HEADER.split()]
        self.all = [*self.plain, *_ODD.split(), *_PHRASES]
