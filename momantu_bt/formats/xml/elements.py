"""The elements and attributes of an XML text, each with its place."""

from __future__ import annotations

from dataclasses import dataclass, field

from momantu_bt.formats.places import Place


@dataclass(frozen=True, slots=True)
class Attribute:
    """One attribute. name: without prefix; space: its namespace, "" without a prefix.

    place: of the value, quotes aside; as long as the value where it is written without entities.
    """

    name: str
    space: str
    value: str
    name_place: Place
    place: Place


@dataclass(slots=True)
class Element:
    """One element. name: without prefix; space: its namespace; said: the tag as it is written.

    place: of the tag's name.

    text: what stands inside it before its first child; text_place: where the first letter
    directly inside it stands. comments: those before it and beside it; end_comments: those after
    everything that is inside it.
    """

    name: str
    space: str
    said: str
    place: Place
    attributes: list[Attribute]
    children: list[Element] = field(default_factory=list)
    text: str = ""
    text_place: Place | None = None
    comments: tuple[str, ...] = ()
    end_comments: tuple[str, ...] = ()

    def get(self, name: str, space: str = "") -> Attribute | None:
        """The attribute of that name."""
        return next((a for a in self.attributes if a.name == name and a.space == space), None)


@dataclass(frozen=True, slots=True)
class Parsed:
    """A file's root, and the comments after it."""

    root: Element
    comments: tuple[str, ...]
