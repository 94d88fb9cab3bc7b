"""Reading YAML 1.2 as plain values, with the place of each."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar, TypeAlias

from ruamel.yaml import YAML
from ruamel.yaml.error import MarkedYAMLError, YAMLError
from ruamel.yaml.nodes import MappingNode, Node, SequenceNode

from momantu_bt.errors import MomantuError
from momantu_bt.formats.places import KeyPath, Place, excerpt
from momantu_bt.formats.problems import Problem

MOST_BYTES = 1_000_000
"""A description is written by hand; a longer one is a mistake, or an attack on the reader."""
MOST_DEPTH = 20
MOST_VALUES = 100_000
"""Values after aliases are followed: a few lines of aliases of aliases stand for billions."""
MOST_ERRORS = 30


KeyMessage: TypeAlias = tuple[KeyPath, str]
"""Keys, and what is wrong there."""


@dataclass(frozen=True, slots=True)
class KeyProblem(Problem):
    """A problem of a file whose values are known. keys: those that lead to what is wrong."""

    keys: KeyPath = ()


class DescriptionError(MomantuError):
    """A description is wrong; the message lists every problem with its line and a caret."""

    what: ClassVar[str] = "description"
    """What the file describes, as a person would say it."""

    def __init__(self, path: Path, text: str, problems: Iterable[KeyProblem]) -> None:
        self.path, self.text = path, text
        self.problems = tuple(sorted(problems, key=lambda p: p.place))
        shown = []
        for problem in self.problems[:MOST_ERRORS]:
            shown.append(f"{problem.place}: {problem.message}")
            shown += filter(None, [excerpt(problem.place, text, problem.hint)])
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
        raise error(path, "", [KeyProblem("", message, Place(str(path)))]) from trouble
    if len(data) > MOST_BYTES:
        message = f"the {error.what} file has {len(data)} bytes; at most {MOST_BYTES}"
        raise error(path, "", [KeyProblem("", message, Place(str(path)))])
    return data.decode("utf-8", errors="replace")


class Reading:
    """A file's values, and where they stood.

    plain: mappings, lists and scalars. problems: what is wrong with the YAML itself.
    """

    def __init__(self, path: Path, text: str, error: type[DescriptionError]) -> None:
        """Read a text; `path` is for the messages.

        Raises:
            DescriptionError: it is not YAML, is empty, has a key twice or nests too deep; of the
                class `error`.
        """
        self.path, self.text, self._error = path, text, error
        self._problems: list[KeyProblem] = []
        self._places: dict[KeyPath, Node] = {}
        self._keys: dict[KeyPath, Node] = {}
        self._values = 0
        self.plain: Any = self._plain(self._compose(), (), 0)
        if self._problems:
            raise error(path, text, self._problems)

    def refuse(self, wrong: Iterable[KeyMessage]) -> None:
        """Raise a DescriptionError for what is wrong at these keys, if anything is."""
        found = [self.problem(keys, message) for keys, message in wrong]
        if found:
            raise self._error(self.path, self.text, found)

    def problem(self, keys: KeyPath, message: str, *, key: bool = False) -> KeyProblem:
        """What is wrong at some keys, at its place in the file; `key` as of `at`."""
        return KeyProblem("", message, self.at(keys, key=key), keys=keys)

    def at(self, keys: KeyPath, *, key: bool = False) -> Place:
        """The place of the value at some keys, or of the nearest thing around it that is there.

        key: the place of the last key itself.
        """
        while keys:
            node = (self._keys if key else self._places).get(keys) or self._places.get(keys)
            if node is not None:
                return self._place(node)
            keys = keys[:-1]
        return Place(str(self.path))

    def _place(self, node: Node) -> Place:
        return Place(str(self.path), node.start_mark.line + 1, node.start_mark.column + 1)

    def value(self, keys: KeyPath) -> Any:
        """The plain value at some keys; KeyError or IndexError when there is none."""
        here = self.plain
        for part in keys:
            here = here[part]
        return here

    def _compose(self) -> Node:
        try:
            root: Node | None = YAML(typ="safe", pure=True).compose(self.text)
        except MarkedYAMLError as error:
            mark = error.problem_mark or error.context_mark
            at = (mark.line + 1, mark.column + 1) if mark else (1, 1)
            message = f"this is not YAML: {error.problem or error.context}"
            raise self._error(
                self.path, self.text, [KeyProblem("", message, Place(str(self.path), *at))]
            ) from None
        except (YAMLError, RecursionError) as error:
            message = f"this is not YAML: {str(error) or 'it nests too deep'}".splitlines()[0]
            raise self._error(
                self.path, self.text, [KeyProblem("", message, Place(str(self.path)))]
            ) from None
        if root is None:
            message = f"the file is empty; expected a {self._error.what}"
            raise self._error(
                self.path, self.text, [KeyProblem("", message, Place(str(self.path)))]
            )
        return root

    def _plain(self, node: Node, place: KeyPath, depth: int) -> Any:
        self._places.setdefault(place, node)
        self._values += 1
        if self._values > MOST_VALUES:
            message = f"more than {MOST_VALUES} values, counted where aliases repeat them"
            raise self._error(self.path, self.text, [KeyProblem("", message, self._place(node))])
        if depth > MOST_DEPTH:
            self._complain(node, f"more than {MOST_DEPTH} levels deep")
            return None
        if isinstance(node, MappingNode):
            return self._mapping(node, place, depth)
        if isinstance(node, SequenceNode):
            return [self._plain(n, (*place, i), depth + 1) for i, n in enumerate(node.value)]
        return self._scalar(node)

    def _mapping(self, node: MappingNode, place: KeyPath, depth: int) -> dict[str, Any]:
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
        self._problems.append(KeyProblem("", message, self._place(node)))
