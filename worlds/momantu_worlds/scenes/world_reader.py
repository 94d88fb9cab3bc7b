"""Reading a world file: YAML 1.2 to checked values, with every error at its place."""

from __future__ import annotations

import difflib
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeAlias

from pydantic import ValidationError
from ruamel.yaml import YAML
from ruamel.yaml.error import MarkedYAMLError
from ruamel.yaml.nodes import MappingNode, Node, SequenceNode

from momantu_bt.world import WorldError
from momantu_worlds.scenes.world_file import WorldFile

Place: TypeAlias = tuple[str | int, ...]

MOST_BYTES = 1_000_000
"""A world file is written by hand; a longer one is a mistake, or an attack on the reader."""
MOST_DEPTH = 20
MOST_ERRORS = 30


@dataclass(frozen=True, slots=True)
class Problem:
    """One thing that is wrong. line and column count from 1."""

    line: int
    column: int
    message: str


class WorldFileError(WorldError):
    """A world file is wrong; the message lists every problem with its line and a caret."""

    def __init__(self, path: Path, text: str, problems: list[Problem]) -> None:
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


def read_world(path: Path) -> WorldFile:
    """The world that a file describes.

    Raises:
        WorldFileError: the file cannot be read, is no YAML, or describes no possible world; all
            problems are listed with line and column.
    """
    try:
        data = path.read_bytes()
    except OSError as error:
        raise WorldError(f"the world file {path} cannot be read: {error.strerror}") from error
    if len(data) > MOST_BYTES:
        raise WorldError(f"the world file {path} has {len(data)} bytes; at most {MOST_BYTES}")
    return parse_world(data.decode("utf-8", errors="replace"), path)


def parse_world(text: str, path: Path) -> WorldFile:
    """As `read_world`, from text; `path` is for the messages."""
    try:
        root = YAML(typ="safe", pure=True).compose(text)
    except MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        line, column = (mark.line + 1, mark.column + 1) if mark else (1, 1)
        message = f"this is not YAML: {error.problem or error.context}"
        raise WorldFileError(path, text, [Problem(line, column, message)]) from None
    if root is None:
        raise WorldFileError(path, text, [Problem(1, 1, "the file is empty; expected a world")])
    reading = _Reading()
    plain = reading.plain(root, (), 0)
    if reading.problems:
        raise WorldFileError(path, text, reading.problems)
    try:
        world = WorldFile.model_validate(plain)
    except ValidationError as error:
        raise WorldFileError(path, text, _findings(reading, error)) from None
    problems = [Problem(*reading.at(place), message) for place, message in _dangling(world)]
    if problems:
        raise WorldFileError(path, text, problems)
    return world


def _findings(reading: _Reading, error: ValidationError) -> list[Problem]:
    """Every finding; a key that is missing because it is misspelt is reported once."""
    findings: list[dict[str, Any]] = [dict(finding) for finding in error.errors()]
    misspelt = set()
    for finding in findings:
        place = tuple(finding["loc"])
        if finding["type"] == "extra_forbidden":
            misspelt.add((*place[:-1], _nearest(str(place[-1]), place[:-1])))
    return [
        reading.problem(finding)
        for finding in findings
        if finding["type"] != "missing" or tuple(finding["loc"]) not in misspelt
    ]


class _Reading:
    """Plain values of composed nodes, and where each of them stood."""

    def __init__(self) -> None:
        self.problems: list[Problem] = []
        self._places: dict[Place, Node] = {}
        self._keys: dict[Place, Node] = {}

    def plain(self, node: Node, place: Place, depth: int) -> Any:
        self._places.setdefault(place, node)
        if depth > MOST_DEPTH:
            self._complain(node, f"more than {MOST_DEPTH} levels deep")
            return None
        if isinstance(node, MappingNode):
            return self._mapping(node, place, depth)
        if isinstance(node, SequenceNode):
            return [self.plain(n, (*place, i), depth + 1) for i, n in enumerate(node.value)]
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
            found[key] = self.plain(value_node, (*place, key), depth + 1)
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
        self.problems.append(Problem(mark.line + 1, mark.column + 1, message))

    def at(self, place: Place, *, key: bool = False) -> tuple[int, int]:
        """Line and column of a place, or of the nearest thing around it that stands there."""
        while place:
            node = (self._keys if key else self._places).get(place) or self._places.get(place)
            if node is not None:
                return node.start_mark.line + 1, node.start_mark.column + 1
            place = place[:-1]
        return 1, 1

    def problem(self, error: dict[str, Any]) -> Problem:
        """A finding of pydantic in our words, at its place in the file."""
        place: Place = tuple(error["loc"])
        kind, name = error["type"], str(place[-1]) if place else ""
        if kind == "extra_forbidden":
            return Problem(*self.at(place, key=True), _unknown_key(name, place))
        if kind == "missing":
            return Problem(*self.at(place[:-1]), f"{_dotted(place[:-1])} needs a key {name!r}")
        message = str(error["msg"]).removeprefix("Value error, ")
        if kind == "literal_error":
            message = f"{error['input']!r} is not possible here; {message[0].lower()}{message[1:]}"
        return Problem(*self.at(place), f"{_dotted(place)}: {message}")


def _dotted(place: Place) -> str:
    return ".".join(str(part) for part in place) or "the world"


def _unknown_key(name: str, place: Place) -> str:
    """Says what would have been right beside an unknown key."""
    near = _nearest(name, place[:-1])
    hint = f"did you mean {near!r}? Keys" if near else "keys"
    known = ", ".join(_known_keys(place[:-1]))
    return f"unknown key {name!r} in {_dotted(place[:-1])}; {hint}: {known}"


def _nearest(name: str, place: Place) -> str:
    near = difflib.get_close_matches(name, _known_keys(place), n=1)
    return near[0] if near else ""


def _known_keys(place: Place) -> list[str]:
    schema: dict[str, Any] = WorldFile.model_json_schema()
    here: dict[str, Any] = schema
    for part in place:
        inner = here.get("properties", {}).get(part)
        inner = inner if inner is not None else here.get("additionalProperties")
        inner = inner if isinstance(inner, dict) else here.get("items", {})
        here = schema["$defs"][inner["$ref"].rsplit("/", 1)[-1]] if "$ref" in inner else inner
    return list(here.get("properties", {}))


def _dangling(world: WorldFile) -> Iterator[tuple[Place, str]]:
    """Names that point at nothing, and things that do not fit on their tables."""
    tables = ", ".join(world.tables)
    for what, on in (("item", world.item.on), ("tag", world.tag.on), ("goal", world.goal.on)):
        if on not in world.tables:
            yield (what, "on"), f"there is no table {on!r}; tables: {tables}"
    if world.goal.item != world.item.name:
        yield ("goal", "item"), f"there is no item {world.goal.item!r}; it is {world.item.name!r}"
    if world.goal.beside != world.tag.name:
        yield (
            ("goal", "beside"),
            f"there is no {world.goal.beside!r}; the tag is {world.tag.name!r}",
        )
    for name in sorted(set(world.tables) & set(world.furniture)):
        yield ("furniture", name), f"{name!r} is a table already; choose another name"
