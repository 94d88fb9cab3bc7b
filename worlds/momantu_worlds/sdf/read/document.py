"""An SDF file as elements that know their line and column, read within bounds.

expat builds them in one pass: a building of many megabytes is read six times as fast as by the
reader of `momantu_bt.formats.xml`, which also knows where every attribute and comment stands.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import NoReturn
from xml.parsers import expat

from momantu_bt.formats.places import Place
from momantu_worlds.sdf.errors import SdfError

MOST_BYTES = 32_000_000
"""Largest size of a file, bytes: a large building saved by Gazebo has some megabytes."""
MOST_DEPTH = 100
MOST_ELEMENTS = 400_000


@dataclass(slots=True)
class Element:
    """One element. text: its text without the children, without blanks around."""

    tag: str
    attributes: dict[str, str]
    place: Place
    children: list[Element] = field(default_factory=list)
    text: str = ""

    def child(self, tag: str) -> Element | None:
        """The first child of a tag."""
        return next((child for child in self.children if child.tag == tag), None)

    def all(self, *tags: str) -> Iterator[Element]:
        """Children of some tags, in the file's order."""
        return (child for child in self.children if child.tag in tags)

    def find(self, path: str) -> Element | None:
        """The first element below along `a/b/c`."""
        here: Element | None = self
        for tag in path.split("/"):
            here = here.child(tag) if here is not None else None
        return here

    def error(self, message: str) -> SdfError:
        """An error at this element; raise it."""
        return SdfError(self.place, message)


def read_document(file: Path, asked_at: Place | None = None) -> Element:
    """Read the root element of a file. asked_at: the reference to the file, for messages.

    Raises:
        SdfError: it cannot be read, is too large or too deep, is not XML, or declares entities.
    """
    here = asked_at or Place(str(file))
    try:
        if not file.is_file():
            why = "it is a folder" if file.is_dir() else "there is no such file"
            raise SdfError(here, f"{file} cannot be read: {why}")
        size = file.stat().st_size
        if size > MOST_BYTES:
            raise SdfError(here, f"{file} has {size} bytes; at most {MOST_BYTES} are read")
        data = file.read_bytes()
    except OSError as error:
        raise SdfError(here, f"{file} cannot be read: {error.strerror}") from None
    return parse_document(data, file)


def parse_document(data: bytes, file: Path) -> Element:
    """As `read_document`, from bytes; `file` is for the messages."""
    try:
        return _Parser(data, file).run()
    except _NotXml as error:
        text, cut = _forgiven(data)
        try:
            return _Parser(text, file, cut).run()
        except SdfError:
            raise SdfError(error.place, error.reason) from None


class _NotXml(SdfError):
    """The text breaks a rule of XML itself."""


_COMMENT = re.compile(rb"<!--.*?-->", re.DOTALL)
_BARE_AND = re.compile(rb"&(?!(?:amp|lt|gt|quot|apos|#\d+|#x[0-9a-fA-F]+);)")


def _forgiven(data: bytes) -> tuple[bytes, int]:
    """A text with what Gazebo's reader bears and XML forbids put right; lines cut off at its top.

    That is: blanks before the XML declaration, a bare `&`, two hyphens in a comment, bytes that are
    not UTF-8 though nothing else is declared.
    """
    body = data.removeprefix(b"\xef\xbb\xbf").lstrip()
    cut = data[: len(data) - len(body)].count(b"\n")
    body = _COMMENT.sub(lambda found: b"\n" * found[0].count(b"\n"), body)
    body = _BARE_AND.sub(b"&amp;", body)
    try:
        body.decode("utf-8")
    except UnicodeDecodeError:
        if b"encoding" not in body[:200].lower() or b"utf-8" in body[:200].lower():
            body = body.decode("utf-8", "replace").encode("utf-8")
    return body, cut


class _Parser:
    """Builds elements from expat's events; refuses what is out of bounds as it comes."""

    def __init__(self, data: bytes, file: Path, cut: int = 0) -> None:
        """cut: lines of the file before the data."""
        self._data, self._file, self._cut = data, file, cut
        self._stack: list[Element] = []
        self._texts: list[list[str]] = []
        self._root: Element | None = None
        self._count = 0
        self._expat = expat.ParserCreate()
        self._expat.buffer_text = True
        self._expat.StartElementHandler = self._start
        self._expat.EndElementHandler = self._end
        self._expat.CharacterDataHandler = self._characters
        self._expat.EntityDeclHandler = self._entity
        self._expat.ExternalEntityRefHandler = self._entity

    def run(self) -> Element:
        try:
            self._expat.Parse(self._data, True)
        except expat.ExpatError as error:
            raise _NotXml(
                Place(str(self._file), max(error.lineno, 1) + self._cut, error.offset + 1),
                f"this is not XML: {expat.ErrorString(error.code)}; expected an SDF file, "
                "which begins with <sdf version='1.6'>",
            ) from None
        except (ValueError, LookupError) as error:
            self._refuse(Place(str(self._file)), f"this is not XML: {error}")
        if self._root is None:
            self._refuse(Place(str(self._file)), "the file is empty; expected <sdf version='1.6'>")
        return self._root

    def _here(self) -> Place:
        line, column = self._expat.CurrentLineNumber + self._cut, self._expat.CurrentColumnNumber
        return Place(str(self._file), line, column + 1)

    def _start(self, tag: str, attributes: dict[str, str]) -> None:
        self._count += 1
        if self._count > MOST_ELEMENTS:
            self._refuse(self._here(), f"more than {MOST_ELEMENTS} elements in one file")
        if len(self._stack) >= MOST_DEPTH:
            self._refuse(self._here(), f"more than {MOST_DEPTH} elements within each other")
        element = Element(tag, attributes, self._here())
        if self._stack:
            self._stack[-1].children.append(element)
        else:
            self._root = element
        self._stack.append(element)
        self._texts.append([])

    def _end(self, _: str) -> None:
        self._stack.pop().text = "".join(self._texts.pop()).strip()

    def _characters(self, text: str) -> None:
        self._texts[-1].append(text)

    def _entity(self, *_: object) -> int:
        self._refuse(
            self._here(), "an SDF file declares no entities of its own; remove its <!DOCTYPE>"
        )

    def _refuse(self, place: Place, message: str) -> NoReturn:
        raise SdfError(place, message)
