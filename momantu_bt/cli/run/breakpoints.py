"""`run --break NODE`: stop before a node starts, and let a person inspect the run.

The nodes are wrapped when a run begins; a run without breakpoints has nothing of this.
"""

from __future__ import annotations

import json
import signal
from collections.abc import Callable, Iterator, Sequence
from fnmatch import fnmatchcase
from typing import Any

import typer

from momantu_bt.cli.run.terminal import Terminal
from momantu_bt.engine.blackboard import Board
from momantu_bt.engine.executor import Executor, NodeStarting
from momantu_bt.engine.node import TreeNode
from momantu_bt.engine.ports import Inputs
from momantu_bt.engine.subtree import SubTree
from momantu_bt.errors import InputError
from momantu_bt.failure import Failure
from momantu_bt.formats.names import nearest, valid_names
from momantu_bt.messages import plain
from momantu_bt.record.text.lines import tree_lines
from momantu_bt.skill import MISSING
from momantu_bt.tree.catalogue.wording import value_text
from momantu_bt.tree.model import Document, Node
from momantu_bt.tree.script.nodes import part
from momantu_bt.tree.substitute.substitution import Substitution, names, reached

PROMPT = "break> "
COMMANDS = {
    "continue": "go on to the next breakpoint",
    "step": "go on to the next node that starts",
    "keys": "every key that the node sees",
    "print": "print KEY: one key, or a part of it",
    "tree": "the tree and what it is at",
    "quit": "end the run; everything is halted and stopped",
}
WIDEST = 100


class Breakpoints:
    """Breakpoints. wanted: names, types, skills, trees, patterns, or lines.

    Raises:
        InputError: one of them names no node that the run can reach.
    """

    def __init__(
        self,
        wanted: Sequence[str],
        document: Document,
        terminal: Terminal,
        substitution: Substitution,
    ) -> None:
        nodes = list(reached(document, substitution.results))
        self._models = {id(node) for text in wanted for node in _named(text, nodes)}
        self._terminal = terminal
        self._stepping = False

    def attach(self, run: Executor) -> None:
        """Stop where nodes of a run start that has not begun."""
        run.context.events.subscribe(NodeStarting, lambda event: self._starting(run, event.node))

    def _starting(self, run: Executor, node: TreeNode) -> None:
        if self._stepping or id(node.model) in self._models:
            with run.context.watchdog.paused():
                self._stop(run, node)

    def _stop(self, run: Executor, node: TreeNode) -> None:
        """Show where the run is, and obey until it is to go on."""
        with self._terminal.drawing():
            for line in _where(run, node):
                typer.echo(line)
            going = False
            while not going:
                said = self._terminal.try_read(PROMPT)
                if said is None:
                    return
                going = self._obey(said.split(), run, node)

    def _obey(self, words: list[str], run: Executor, node: TreeNode) -> bool:
        """Carry out a person's command; returns whether the run goes on."""
        verb = _command(words[0]) if words else "step" if self._stepping else "continue"
        if verb in ("continue", "step"):
            self._stepping = verb == "step"
            return True
        if verb == "quit":
            signal.raise_signal(signal.SIGINT)
            return True
        for line in _answer(verb, words[1:], run, node):
            typer.echo(line)
        return False


def _command(word: str) -> str | None:
    begun = [name for name in COMMANDS if name.startswith(word.lower())]
    return begun[0] if begun else None


def _named(wanted: str, nodes: Sequence[Node]) -> list[Node]:
    if wanted.isdigit():
        at = [node for node in nodes if node.place.line == int(wanted)]
        if not at:
            lines = sorted({node.place.line for node in nodes})
            line = min(lines, key=lambda line: abs(line - int(wanted)))
            raise InputError(f"--break {wanted}: no node begins there; one does in line {line}")
        return at[:1]
    found = [n for n in nodes if any(fnmatchcase(name, wanted) for name in names(n))]
    if not found:
        known = [name for node in nodes for name in names(node)]
        near = nearest(wanted, known)
        hint = f"did you mean {near}?" if near else valid_names(wanted, known, "nodes")
        raise InputError(f"--break {wanted}: no node that runs is called so; {hint}")
    return found


def _where(run: Executor, node: TreeNode) -> Iterator[str]:
    """Time, node, the way to it, its inputs, and the commands."""
    yield f"-- {run.context.now:.2f} s: before {node.where}"
    way = [above.name for above in _above(node)]
    if way:
        yield f"   in {' > '.join(reversed(way))}"
    for name, value in _ports(node):
        yield f"   {name}: {value}"
    yield f"   {', '.join(COMMANDS)}"


def _above(node: TreeNode) -> Iterator[TreeNode]:
    parent = node.above
    while isinstance(parent, TreeNode):
        yield parent
        parent = parent.above


def _ports(node: TreeNode) -> Iterator[tuple[str, str]]:
    """Each port as it is written, with its current value."""
    for name, written in node.model.ports.items():
        words, read = value_text(written), _reader(node, name)
        yield name, words if read is None else _and_value(words, read)


def _reader(node: TreeNode, name: str) -> Callable[[], Any] | None:
    inputs = getattr(node, "inputs", None)
    if isinstance(inputs, Inputs):
        return inputs.readers.get(name)
    if not isinstance(node, SubTree):
        return None
    if name in node.given:
        return node.given[name][1]
    cell = node.wires.get(name)
    return None if cell is None else lambda: cell.value


def _and_value(written: str, read: Callable[[], Any]) -> str:
    try:
        value = read()
    except Failure as failure:
        return f"{written}  ({failure.value.message})"
    shown = "no value yet" if value is MISSING else _short(value)
    return written if shown == written else f"{written} = {shown}"


def _short(value: Any, widest: int | None = WIDEST) -> str:
    if isinstance(value, str):
        return value
    text = json.dumps(plain(value), default=str)
    return text if widest is None or len(text) <= widest else text[: widest - 1] + "…"


def _board(run: Executor, node: TreeNode) -> Board:
    """The blackboard that the node sees: that of its tree."""
    inside = next((above for above in _above(node) if isinstance(above, SubTree)), None)
    return run.built.board if inside is None else inside.board


def _answer(verb: str | None, words: list[str], run: Executor, node: TreeNode) -> Iterator[str]:
    if verb == "keys":
        yield from (f"   {k} = {_short(v)}" for k, v in _board(run, node).values().items())
    elif verb == "print" and words:
        yield _one(words[0].removeprefix("$"), _board(run, node))
    elif verb == "tree":
        for line in tree_lines(run.built.root):
            yield f"   {'  ' * line.depth}{line.text}  {line.status}"
    else:
        yield from (f"   {name:9}{meaning}" for name, meaning in COMMANDS.items())


def _one(word: str, board: Board) -> str:
    key, *fields = word.split(".")
    if key.removeprefix("@") not in (board.root if key.startswith("@") else board).cells:
        known = [*board.cells, *(f"@{name}" for name in board.root.cells)]
        return f"   there is no key {key!r}; {valid_names(key, known, 'keys')}"
    try:
        return f"   {word} = {_short(part(board.get(key), tuple(fields)), None)}"
    except KeyError:
        return f"   {word} has no value yet"
    except Exception as error:  # whatever a value's own code raises
        return f"   {word}: {error}"
