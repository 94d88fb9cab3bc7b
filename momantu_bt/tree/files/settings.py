"""Values from outside a tree file: `--values FILE` and `--set key=value`, with their places."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from momantu_bt.formats.places import Place, lines_of
from momantu_bt.formats.problems import Problem
from momantu_bt.formats.yaml.reader import YamlSyntaxError
from momantu_bt.formats.yaml.values import Entries, plain_value
from momantu_bt.tree.files.port_values import KEY
from momantu_bt.tree.files.syntax import compose
from momantu_bt.tree.problems import TreeError

SET = "--set"
"""The file name for values given by `--set`. Its text has one setting a line."""


class Given(Mapping[str, Any]):
    """Values by key, raw as in a tree file.

    places: where the values are. key_places: where their keys are. source: the text of each
    file, for displays.
    """

    def __init__(self) -> None:
        self._values: dict[str, Any] = {}
        self.places: dict[str, Place] = {}
        self.key_places: dict[str, Place] = {}
        self.source: dict[str, str] = {}

    def __getitem__(self, key: str) -> Any:
        return self._values[key]

    def __iter__(self) -> Iterator[str]:
        return iter(self._values)

    def __len__(self) -> int:
        return len(self._values)

    def give(self, key: str, value: Any, key_place: Place, place: Place) -> None:
        """Set a value. It replaces the value that the key has."""
        self._values[key] = value
        self.key_places[key], self.places[key] = key_place, place

    def read(self, text: str, file: str) -> None:
        """Read everything in a file of values: one YAML mapping.

        Raises:
            TreeError: it is not a YAML mapping, or has a key twice.
        """
        self.source[file] = text
        try:
            raw = compose(text, file)
        except YamlSyntaxError as error:
            raise TreeError([error.problem], self.source) from None
        if not isinstance(raw, Entries):
            problem = Problem("wrong-value", "a file of values is a mapping", Place(file, 1, 1))
            raise TreeError([problem], self.source)
        first: dict[str, int] = {}
        for key, value in raw.entries:
            if key.text in first:
                message = f"the key {key.text!r} stands here twice"
                hint = f"the first is in line {first[key.text]}"
                raise TreeError([Problem("duplicate-key", message, key.place, hint)], self.source)
            first[key.text] = key.place.line
            self.give(key.text, plain_value(value), key.place, value.place)

    def set(self, texts: Sequence[str]) -> None:
        """Settings `key=value`, each as `setting` reads it.

        Raises:
            ValueError: one is not KEY=VALUE; the message names it.
        """
        self.source[SET] = "\n".join(" ".join(lines_of(text)) for text in texts)
        for number, text in enumerate(texts, 1):
            try:
                key, value = setting(text)
            except ValueError as error:
                raise ValueError(f"{SET} {text}: {error}") from None
            start = text.index(key) + 1
            equals = text.index("=") + 1
            written = text[equals:].strip()
            column = text.index(written, equals) + 1 if written else equals
            place = Place(SET, number, column, max(1, len(written)))
            self.give(key, value, Place(SET, number, start, len(key)), place)


def setting(text: str) -> tuple[str, Any]:
    """A key and its value, raw as in a file: `height=66 mm` gives `("height", "66 mm")`.

    Raises:
        ValueError: there is no `=`, the key is not a key, or the value is not YAML.
    """
    key, equals, value = text.partition("=")
    key = key.strip()
    if not equals:
        raise ValueError("expected key=value, such as from=table_b")
    if not KEY.fullmatch(key):
        raise ValueError(f"{key!r} is not a key; a key is a word such as tag_id")
    try:
        return key, plain_value(compose(value.strip() or '""', SET))
    except YamlSyntaxError as error:
        raise ValueError(error.problem.message) from None
