"""Reads YAML 1.2 as plain values, and keeps the place of each value."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar, TypeAlias

from momantu_bt.errors import MomantuError
from momantu_bt.formats import text
from momantu_bt.formats.places import KeyPath, Place, excerpt
from momantu_bt.formats.problems import Problem
from momantu_bt.formats.yaml.errors import YamlRules
from momantu_bt.formats.yaml.reader import YamlSyntaxError, compose
from momantu_bt.formats.yaml.values import Entries, Items, Raw, Scalar

MOST_BYTES = 1_000_000
"""A description is written by hand; a longer one is a mistake, or an attack on the reader."""
MOST_ERRORS = 30

KeyMessage: TypeAlias = tuple[KeyPath, str]
"""The keys that lead to a value, and what is wrong with it."""


@dataclass(frozen=True, slots=True)
class KeyProblem(Problem):
    """A problem of a value in a file. keys: the keys and indices that lead to the value."""

    keys: KeyPath = ()


class DescriptionError(MomantuError):
    """A description is wrong; the message lists every problem with its line and a caret."""

    what: ClassVar[str] = "description"
    """What the file describes, for messages, such as "robot"."""

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
    """Read the text of a file.

    Raises:
        DescriptionError: the file cannot be read, is too long or not UTF-8; of the class `error`.
    """
    try:
        return text.read_text(path, str(path), f"{error.what} file", MOST_BYTES)
    except OSError as trouble:
        message = f"the {error.what} file cannot be read: {trouble.strerror}"
        raise error(path, "", [KeyProblem("", message, Place(str(path)))]) from trouble
    except text.TextError as trouble:
        found = trouble.problem
        problem = KeyProblem(found.code, found.message, found.place, found.hint)
        raise error(path, "", [problem]) from None


class Reading:
    """A file's values with their places. plain: the values as mappings, lists and scalars."""

    def __init__(self, path: Path, text: str, error: type[DescriptionError]) -> None:
        """Read a text. path: the file's path, for messages.

        Raises:
            DescriptionError: the text is not YAML, is empty, has a key twice or is nested too
                deep; of the class `error`.
        """
        self.path, self.text, self._error = path, text, error
        self._values: dict[KeyPath, Place] = {}
        self._keys: dict[KeyPath, Place] = {}
        self._twice: list[KeyProblem] = []
        self.plain: Any = self._plain(self._composed(), ())
        if self._twice:
            raise error(path, text, self._twice)

    def refuse(self, wrong: Iterable[KeyMessage]) -> None:
        """Raise a DescriptionError with the given problems, if there are any."""
        found = [self.problem(keys, message) for keys, message in wrong]
        if found:
            raise self._error(self.path, self.text, found)

    def problem(self, keys: KeyPath, message: str, *, key: bool = False) -> KeyProblem:
        """The problem at some keys, at its place in the file; `key` as in `at`."""
        return KeyProblem("", message, self.at(keys, key=key), keys=keys)

    def at(self, keys: KeyPath, *, key: bool = False) -> Place:
        """The place of the value at some keys; if it does not exist, of the nearest one around it.

        key: return the place of the last key instead of its value.
        """
        while keys:
            place = (self._keys if key else self._values).get(keys) or self._values.get(keys)
            if place is not None:
                return place
            keys = keys[:-1]
        return Place(str(self.path))

    def value(self, keys: KeyPath) -> Any:
        """The plain value at some keys; KeyError or IndexError if there is none."""
        here = self.plain
        for part in keys:
            here = here[part]
        return here

    def _composed(self) -> Raw:
        rules = YamlRules(
            f"{self._error.what} file", most_bytes=MOST_BYTES, most_depth=20, most_values=100_000
        )
        try:
            return compose(self.text, str(self.path), rules)
        except YamlSyntaxError as error:
            found = error.problem
            problem = KeyProblem(found.code, found.message, found.place, found.hint)
            raise self._error(self.path, self.text, [problem]) from None

    def _plain(self, raw: Raw, keys: KeyPath) -> Any:
        # The recursion is safe: the reader limits the depth of a file.
        self._values.setdefault(keys, raw.place)
        if isinstance(raw, Entries):
            return self._mapping(raw, keys)
        if isinstance(raw, Items):
            return [self._plain(item, (*keys, i)) for i, item in enumerate(raw.items)]
        return raw.value

    def _mapping(self, raw: Entries, keys: KeyPath) -> dict[str, Any]:
        found: dict[str, Any] = {}
        for key, value in raw.entries:
            here = (*keys, key.text)
            if key.text in found:
                message = f"{key.text!r} is here twice; first in line {self._keys[here].line}"
                self._twice.append(KeyProblem("", message, key.place))
                continue
            self._keys[here] = key.place
            if isinstance(value, Scalar) and value.text == "" and not value.quoted:
                # An empty value has no place of its own: use that of its key.
                self._values[here] = key.place
            found[key.text] = self._plain(value, here)
        return found
