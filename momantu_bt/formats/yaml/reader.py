"""Reads YAML 1.2 as values with their places in the file, without recursion, with size limits.

A mapping keeps all its keys, so that every duplicate can be reported. Only `true` and `false` are
booleans; numbers are those of YAML 1.2.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from typing import Any

from ruamel.yaml import YAML
from ruamel.yaml import events as yaml_events
from ruamel.yaml.error import MarkedYAMLError
from ruamel.yaml.reader import ReaderError

from momantu_bt.formats.places import Place, lines_of
from momantu_bt.formats.problems import Problem
from momantu_bt.formats.yaml.comments import Comment, comments, span
from momantu_bt.formats.yaml.core import resolve
from momantu_bt.formats.yaml.errors import YamlRules, in_our_words
from momantu_bt.formats.yaml.values import Entries, Items, Raw, Scalar

_SURROGATE = re.compile("[\ud800-\udfff]")


class YamlSyntaxError(Exception):
    """A file is not YAML, or exceeds a limit."""

    def __init__(self, problem: Problem) -> None:
        super().__init__(f"{problem.place}: {problem.message}")
        self.problem = problem


def compose(text: str, file: str, rules: YamlRules) -> Raw:
    """Read a text.

    Raises:
        YamlSyntaxError: the text is not YAML, or exceeds a limit.
    """
    return compose_with_comments(text, file, rules)[0]


def compose_with_comments(text: str, file: str, rules: YamlRules) -> tuple[Raw, list[Comment]]:
    """Read a text and its comments.

    Raises:
        YamlSyntaxError: the text is not YAML, or exceeds a limit.
    """
    size = len(text.encode("utf-8", "surrogatepass"))
    if size > rules.most_bytes:
        message = f"{size} bytes; a {rules.what} has at most {rules.most_bytes}"
        raise _bound(Place(file, 1, 1), message)
    builder = _Builder(file, rules)
    reader = YAML(typ="safe", pure=True)
    try:
        for event in reader.parse(text):
            builder.take(event)
    except MarkedYAMLError as error:
        raise YamlSyntaxError(in_our_words(error, text, file, rules)) from None
    except ReaderError as error:
        before = lines_of(text[: error.position])
        line, column = len(before), len(before[-1]) + 1
        message = f"the character U+{ord(text[error.position]):04X} cannot stand in a {rules.what}"
        raise YamlSyntaxError(
            Problem("syntax", message, Place(file, line, column), "remove it")
        ) from None
    if builder.root is None:
        place = Place(file, 1, 1)
        raise YamlSyntaxError(
            Problem("syntax", f"the file is empty; expected a {rules.what}", place, rules.beginning)
        )
    found = comments(text, builder.spans) if "#" in text else []
    if len(found) > rules.most_values:
        first = found[rules.most_values]
        place = Place(file, first.line, first.column)
        raise _bound(place, f"more than {rules.most_values} comments")
    return builder.root, found


@dataclass(slots=True)
class _Open:
    """A list or mapping that is being read. key: the key whose value comes next."""

    raw: Items | Entries
    anchor: str | None
    key: Scalar | None = None


@dataclass(slots=True)
class _Builder:
    file: str
    rules: YamlRules
    root: Raw | None = None
    stack: list[_Open] = field(default_factory=list)
    anchors: dict[str, Raw] = field(default_factory=dict)
    nodes: int = 0
    aliases: int = 0
    documents: int = 0
    spans: list[tuple[int, int]] = field(default_factory=list)

    def take(self, event: Any) -> None:
        if isinstance(event, yaml_events.DocumentStartEvent):
            self.documents += 1
            if self.documents > 1:
                message = f"a second document; a {self.rules.what} is one"
                raise self.error("syntax", event, message, "remove the line `---`")
        elif isinstance(event, yaml_events.ScalarEvent):
            self.refuse_tag(event)
            self.put(self.scalar(event), event.anchor)
        elif isinstance(event, yaml_events.SequenceStartEvent):
            self.refuse_tag(event)
            self.open(Items([], self.place(event)), event)
        elif isinstance(event, yaml_events.MappingStartEvent):
            self.refuse_tag(event)
            self.open(Entries([], self.place(event), bool(event.flow_style)), event)
        elif isinstance(event, yaml_events.AliasEvent):
            self.put_alias(event)
        elif isinstance(event, yaml_events.CollectionEndEvent):
            closed = self.stack.pop()
            closed.raw.place = self.up_to(closed.raw.place, event)
            self.put(closed.raw, closed.anchor)

    def place(self, event: Any) -> Place:
        start, end = event.start_mark, event.end_mark
        length = end.column - start.column if end.line == start.line else 1
        return Place(self.file, start.line + 1, start.column + 1, max(1, length))

    def up_to(self, place: Place, event: Any) -> Place:
        """The place of a whole list or mapping if it is on one line; else of its start."""
        mark = event.end_mark
        if mark.line + 1 != place.line or mark.column < place.column:
            return place
        return Place(place.file, place.line, place.column, mark.column + 1 - place.column)

    def error(self, code: str, event: Any, message: str, hint: str = "") -> YamlSyntaxError:
        return YamlSyntaxError(Problem(code, message, self.place(event), hint))

    def refuse_tag(self, event: Any) -> None:
        tag = getattr(event, "tag", None)
        if tag:
            message = f"`!` begins a YAML tag, which a {self.rules.what} does not use"
            raise self.error("syntax", event, message, self.rules.tag_hint)

    def scalar(self, event: Any) -> Scalar:
        if _SURROGATE.search(event.value):
            message = "an escape that is half a character"
            raise self.error("syntax", event, message, "write the character itself")
        quoted = event.style is not None
        self.spans += span(event)
        value = event.value if quoted else resolve(event.value)
        return Scalar(value, str(event.value), quoted, self.scalar_place(event))

    def scalar_place(self, event: Any) -> Place:
        """The place of a scalar; for an empty one that of its key, as YAML puts it further down."""
        place = self.place(event)
        key = self.stack[-1].key if self.stack else None
        missing = event.style is None and event.value == "" and key is not None
        return key.place if key is not None and missing and key.place.line != place.line else place

    def open(self, raw: Items | Entries, event: Any) -> None:
        if len(self.stack) >= self.rules.most_depth:
            raise _bound(self.place(event), f"nested more than {self.rules.most_depth} levels deep")
        self.stack.append(_Open(raw, event.anchor))

    def put_alias(self, event: Any) -> None:
        self.aliases += 1
        if self.aliases > self.rules.most_aliases:
            raise _bound(self.place(event), f"more than {self.rules.most_aliases} aliases")
        if event.anchor not in self.anchors:
            inside = any(opened.anchor == event.anchor for opened in self.stack)
            message = f"`*{event.anchor}` stands for nothing"
            if inside:
                message = f"`*{event.anchor}` stands for something that contains it"
            hint = f'name it with `&{event.anchor}` before, or put "*{event.anchor}" in quotes'
            raise self.error("syntax", event, message, hint)
        self.put(self.anchors[event.anchor], None)

    def put(self, raw: Raw, anchor: str | None) -> None:
        self.nodes += raw.size if anchor is None and isinstance(raw, Scalar) else 1
        if anchor is not None:
            self.anchors[anchor] = raw
        if not self.stack:
            self.root = raw
            return
        top = self.stack[-1]
        top.raw.size += raw.size
        top.raw.depth = max(top.raw.depth, raw.depth + 1)
        self.bound(top.raw, raw.place)
        if isinstance(top.raw, Items):
            top.raw.items.append(raw)
        elif top.key is None:
            top.key = self.key(raw)
        else:
            top.raw.entries.append((top.key, raw))
            top.key = None

    def bound(self, whole: Items | Entries, place: Place) -> None:
        rules = self.rules
        if whole.depth > rules.most_depth:
            message = f"nested more than {rules.most_depth} levels deep, aliases included"
            raise _bound(place, message)
        if max(whole.size, self.nodes) > rules.most_values:
            raise _bound(place, f"more than {rules.most_values} values, aliases included")

    def key(self, raw: Raw) -> Scalar:
        if isinstance(raw, Scalar):
            return raw
        hint = self.rules.braces_hint if isinstance(raw, Entries) else ""
        raise YamlSyntaxError(
            Problem("syntax", "a list or mapping cannot be a key", raw.place, hint)
        )


def _bound(place: Place, message: str) -> YamlSyntaxError:
    return YamlSyntaxError(Problem("too-large", message, place))
