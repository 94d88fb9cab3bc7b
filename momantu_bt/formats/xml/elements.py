"""The elements and attributes of an XML text, each with its place."""

from __future__ import annotations

from dataclasses import dataclass, field

from momantu_bt.formats.places import Place


@dataclass(frozen=True, slots=True)
class Attribute:
    """One attribute. name: without prefix. space: its namespace, "" without a prefix.

    said: the name as written, with its prefix.

    place: of the value without its quotes. Its length is that of the value, unless the file writes
    the value with entities.
    """

    name: str
    space: str
    value: str
    name_place: Place
    place: Place
    said: str = ""


@dataclass(slots=True)
class Element:
    """One element. name: without prefix. space: its namespace. said: the tag as written.

    place: of the tag's name.

    text: the text inside it before its first child. tail: the text after it, before the next tag.
    text_place: the place of the first character of text directly inside it. comments: those before
    it, and those after it on its line (`Beside`); of an element with children, those after its
    start tag. end_comments: those inside it, after its last child. prefixes: the namespaces that
    it declares.
    """

    name: str
    space: str
    said: str
    place: Place
    attributes: list[Attribute]
    children: list[Element] = field(default_factory=list)
    text: str = ""
    tail: str = ""
    text_place: Place | None = None
    comments: tuple[str, ...] = ()
    end_comments: tuple[str, ...] = ()
    prefixes: dict[str, str] = field(default_factory=dict)

    def get(self, name: str, space: str = "") -> Attribute | None:
        """The attribute of a name, or None."""
        return next((a for a in self.attributes if a.name == name and a.space == space), None)


@dataclass(frozen=True, slots=True)
class Parsed:
    """A file's root element, and the comments after it."""

    root: Element
    comments: tuple[str, ...]
