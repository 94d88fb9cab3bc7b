"""YAML 1.2 as plain values, and where each of them stood."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar, TypeAlias

from ruamel.yaml import YAML
from ruamel.yaml.error import MarkedYAMLError, YAMLError
from ruamel.yaml.nodes import MappingNode, Node, SequenceNode

from momantu_bt.errors import MomantuError

Place: TypeAlias = tuple[str | int, ...]
"""Keys and indices from the top of a file down to a value."""

MOST_BYTES = 1_000_000
"""A description is written by hand; a longer one is a mistake, or an attack on the reader."""
MOST_DEPTH = 20
MOST_VALUES = 100_000
"""Values after aliases are followed: a few lines of aliases of aliases stand for billions."""
MOST_ERRORS = 30


@dataclass(frozen=True, slots=True)
class Problem:
    """One thing that is wrong. line and column count from 1; place: whose they are."""

    line: int
    column: int
    message: str
    place: Place = ()


class DescriptionError(MomantuError):
    """A description is wrong; the message lists every problem with its line and a caret."""

    what: ClassVar[str] = "description"
    """What the file describes, as a person would say it."""

    def __init__(self, path: Path, text: str, problems: Iterable[Problem]) -> None:
        self.path, self.text = path, text
        self.problems = tuple(sorted(problems, key=lambda p: (p.line, p.column)))
        lines = text.splitlines()
        shown = []
        for problem in self.problems[:MOST_ERRORS]:
            shown.append(f"{path}:{problem.line}:{problem.column}: {problem.message}")
            if 0 < problem.line <= len(lines):
                shown.append(f"    {lines[problem.line - 1]}")
                shown.append(f"    {' ' * (problem.column - 1)}^")
        left = len(self.problems) - MOST_ERRORS
        if left > 0:
            shown.append(f"... and {left} more")
        super().__init__("\n".join(shown))


def read_text(path: Path, error: type[DescriptionError]) -> str:
    """The text of a file.

    Raises:
        DescriptionError: it cannot be read, or is too long; of the class `error`.
    """
    try:
        data = path.read_bytes()
    except OSError as trouble:
        message = f"the {error.what} file cannot be read: {trouble.strerror}"
        raise error(path, "", [Problem(1, 1, message)]) from trouble
    if len(data) > MOST_BYTES:
        message = f"the {error.what} file has {len(data)} bytes; at most {MOST_BYTES}"
        raise error(path, "", [Problem(1, 1, message)])
    return data.decode("utf-8", errors="replace")


class Reading:
    """A file's values, and where they stood.

    plain: mappings, lists and scalars. problems: what is wrong with the YAML itself.
    """

    def __init__(self, path: Path, text: str, error: type[DescriptionError]) -> None:
        """Read a text; `path` is for the messages.

        Raises:
            DescriptionError: it is no YAML, is empty, has a key twice or nests too deep; of the
                class `error`.
        """
        self.path, self.text, self._error = path, text, error
        self._problems: list[Problem] = []
        self._places: dict[Place, Node] = {}
        self._keys: dict[Place, Node] = {}
        self._values = 0
        self.plain: Any = self._plain(self._compose(), (), 0)
        if self._problems:
            raise error(path, text, self._problems)

    def refuse(self, problems: Iterable[tuple[Place, str]]) -> None:
        """Raise a DescriptionError for what is wrong at these places, if anything is."""
        found = [Problem(*self.at(place), message) for place, message in problems]
        if found:
            raise self._error(self.path, self.text, found)

    def at(self, place: Place, *, key: bool = False) -> tuple[int, int]:
        """Line and column of a place, or of the nearest thing around it that stands there."""
        while place:
            node = (self._keys if key else self._places).get(place) or self._places.get(place)
            if node is not None:
                return node.start_mark.line + 1, node.start_mark.column + 1
            place = place[:-1]
        return 1, 1

    def value(self, place: Place) -> Any:
        """The plain value at a place; KeyError or IndexError when there is none."""
        here = self.plain
        for part in place:
            here = here[part]
        return here

    def _compose(self) -> Node:
        try:
            root: Node | None = YAML(typ="safe", pure=True).compose(self.text)
        except MarkedYAMLError as error:
            mark = error.problem_mark or error.context_mark
            line, column = (mark.line + 1, mark.column + 1) if mark else (1, 1)
            message = f"this is not YAML: {error.problem or error.context}"
            raise self._error(self.path, self.text, [Problem(line, column, message)]) from None
        except (YAMLError, RecursionError) as error:
            message = f"this is not YAML: {str(error) or 'it nests too deep'}".splitlines()[0]
            raise self._error(self.path, self.text, [Problem(1, 1, message)]) from None
        if root is None:
            message = f"the file is empty; expected a {self._error.what}"
            raise self._error(self.path, self.text, [Problem(1, 1, message)])
        return root

    def _plain(self, node: Node, place: Place, depth: int) -> Any:
        self._places.setdefault(place, node)
        self._values += 1
        if self._values > MOST_VALUES:
            message = f"more than {MOST_VALUES} values, counted where aliases repeat them"
            mark = node.start_mark
            raise self._error(
                self.path, self.text, [Problem(mark.line + 1, mark.column + 1, message)]
            )
        if depth > MOST_DEPTH:
            self._complain(node, f"more than {MOST_DEPTH} levels deep")
            return None
        if isinstance(node, MappingNode):
            return self._mapping(node, place, depth)
        if isinstance(node, SequenceNode):
            return [self._plain(n, (*place, i), depth + 1) for i, n in enumerate(node.value)]
        return self._scalar(node)

    def _mapping(self, node: MappingNode, place: Place, depth: int) -> dict[str, Any]:
        found: dict[str, Any] = {}
        for key_node, value_node in node.value:
            key = str(key_node.value)
            if key in found:
                first = self._keys[(*place, key)].start_mark.line + 1
                self._complain(key_node, f"{key!r} is here twice; first in line {first}")
                continue
            self._keys[(*place, key)] = key_node
            if value_node.start_mark.index == value_node.end_mark.index:
                # what is not there stands where the next thing does: its key tells more
                self._places[(*place, key)] = key_node
            found[key] = self._plain(value_node, (*place, key), depth + 1)
        return found

    def _scalar(self, node: Node) -> Any:
        tag = str(node.tag).rsplit(":", 1)[-1]
        text = str(node.value)
        try:
            if tag == "int":
                return int(text)
            if tag == "float":
                return float(text)
        except ValueError:
            self._complain(node, f"{text!r} is not a number that can be read; write it in decimals")
            return None
        if tag == "bool":
            return text.lower() == "true"
        return None if tag == "null" else text

    def _complain(self, node: Node, message: str) -> None:
        mark = node.start_mark
        self._problems.append(Problem(mark.line + 1, mark.column + 1, message))
