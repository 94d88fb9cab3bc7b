"""Reads XML as elements with their places in the file, without recursion and with size limits.

lxml parses the text and decides whether it is valid XML. A second pass over the text finds the line
and column of each tag and attribute.
"""

from __future__ import annotations

import re
from bisect import bisect_right
from collections.abc import Iterator
from dataclasses import dataclass, field

from lxml import etree

from momantu_bt.formats.places import Place
from momantu_bt.formats.problems import Problem
from momantu_bt.formats.text import Beside
from momantu_bt.formats.xml.comments import show_dashes
from momantu_bt.formats.xml.elements import Attribute, Element, Parsed
from momantu_bt.formats.xml.errors import XmlRules, first_error, in_our_words


class XmlSyntaxError(Exception):
    """A file is not XML, or exceeds a limit."""

    def __init__(self, problem: Problem) -> None:
        super().__init__(f"{problem.place}: {problem.message}")
        self.problem = problem


def parse(text: str, file: str, rules: XmlRules) -> Parsed:
    """Read a text.

    Raises:
        XmlSyntaxError: the text is not XML, or exceeds a limit.
    """
    size = len(text.encode("utf-8", "surrogatepass"))
    if size > rules.most_bytes:
        message = f"{size} bytes; a {rules.what} has at most {rules.most_bytes}"
        raise _bound(Place(file, 1, 1), message)
    text = text.removeprefix("\ufeff").replace("\r\n", "\n").replace("\r", "\n")
    scan = _Scan(text, file, rules)
    scan.refuse_doctype()
    parser = etree.XMLParser(
        encoding="utf-8",
        resolve_entities=False,
        no_network=True,
        load_dtd=False,
        huge_tree=False,
        remove_pis=True,
        remove_comments=True,
    )
    try:
        root = etree.fromstring(text.encode("utf-8", "surrogatepass"), parser)
    except etree.XMLSyntaxError as error:
        raise XmlSyntaxError(in_our_words(first_error(error, parser), text, file, rules)) from None
    return scan.parsed(root)


def _bound(place: Place, message: str) -> XmlSyntaxError:
    return XmlSyntaxError(Problem("too-large", message, place))


_NAME = r"[^\s<>/=\"'&!?][^\s<>/=\"'&]*"
_ATTRIBUTE = re.compile(rf"\s+({_NAME})\s*=\s*(?:\"([^\"]*)\"|'([^']*)')")
_START = re.compile(rf"<({_NAME})")
_ENDS = (("<!--", "-->"), ("<![CDATA[", "]]>"), ("<?", "?>"))


@dataclass(slots=True)
class _Scan:
    """Goes through a text that is known to be valid XML, tag by tag."""

    text: str
    file: str
    rules: XmlRules
    starts: list[int] = field(default_factory=list)
    nodes: int = 0
    stack: list[Element] = field(default_factory=list)
    waiting: list[str] = field(default_factory=list)
    ended: tuple[int, Element | None] = (0, None)
    """The line in which the last tag ended, and the element that a comment beside it is about."""

    def __post_init__(self) -> None:
        self.starts = [0, *(match.end() for match in re.finditer("\n", self.text))]

    def place(self, start: int, end: int) -> Place:
        line = bisect_right(self.starts, start)
        begin = self.starts[line - 1]
        stop = self.starts[line] - 1 if line < len(self.starts) else len(self.text)
        return Place(self.file, line, start - begin + 1, max(1, min(end, stop) - start))

    def refuse_doctype(self) -> None:
        for start, kind, _ in self.tokens():
            if kind == "declaration":
                message = f"a {self.rules.what} has no <!DOCTYPE> and no entities of its own"
                raise XmlSyntaxError(
                    Problem("syntax", message, self.place(start, start + 9), "remove it")
                )
            if kind == "start":
                return

    def tokens(self) -> Iterator[tuple[int, str, int]]:
        """Start, kind and end of everything that begins with `<`, and of the texts in between."""
        text, position = self.text, 0
        while True:
            start = text.find("<", position)
            if start < 0:
                return
            if start > position:
                yield position, "text", start
            kind, end = self.token(start)
            yield start, kind, end
            position = end

    def token(self, start: int) -> tuple[str, int]:
        for opening, closing in _ENDS:
            if self.text.startswith(opening, start):
                end = self.text.find(closing, start + len(opening))
                return opening, len(self.text) if end < 0 else end + len(closing)
        following = self.text[start + 1 : start + 2]
        if following in ("!", "/"):
            end = self.text.find(">", start)
            kind = "declaration" if following == "!" else "end"
            return kind, len(self.text) if end < 0 else end + 1
        match = _START.match(self.text, start)
        if match is None:  # not XML; lxml reports it
            return "start", start + 1
        end = match.end()
        while attribute := _ATTRIBUTE.match(self.text, end):
            end = attribute.end()
        close = self.text.find(">", end)
        return "start", len(self.text) if close < 0 else close + 1

    def parsed(self, root: etree._Element) -> Parsed:
        elements = iter(root.iter("*"))
        found: Element | None = None
        for start, kind, end in self.tokens():
            if kind == "start":
                element = self.element(next(elements), start)
                found = found or element
                self.open(element, start, end)
            elif kind == "end":
                self.close(end)
            elif kind == "<!--":
                self.comment(start, end)
            elif kind in ("text", "<![CDATA["):
                self.inner_text(start, end, kind)
        assert found is not None
        return Parsed(found, tuple(self.waiting))

    def element(self, made: etree._Element, start: int) -> Element:
        tag = etree.QName(made)
        match = _START.match(self.text, start)
        assert match is not None
        element = Element(
            tag.localname, tag.namespace or "", match[1], self.place(*match.span(1)), []
        )
        every = list(self.attributes(match.end()))
        written = [m for m in every if not _declares_prefix(m[1])]
        element.prefixes = {m[1]: m[2] or m[3] or "" for m in every if _declares_prefix(m[1])}
        self.count(1 + len(written), element.place)
        if len(written) > self.rules.most_attributes:
            raise _bound(element.place, f"more than {self.rules.most_attributes} attributes")
        for (name, value), found in zip(made.attrib.items(), written, strict=True):
            key = etree.QName(str(name))
            at = found.span(2) if found[2] is not None else found.span(3)
            element.attributes.append(
                Attribute(
                    key.localname,
                    key.namespace or "",
                    str(value),
                    self.place(*found.span(1)),
                    self.place(*at),
                    found[1],
                )
            )
        element.text, element.tail = str(made.text or ""), str(made.tail or "")
        return element

    def attributes(self, position: int) -> Iterator[re.Match[str]]:
        while match := _ATTRIBUTE.match(self.text, position):
            yield match
            position = match.end()

    def count(self, more: int, place: Place) -> None:
        self.nodes += more
        if self.nodes > self.rules.most_nodes:
            raise _bound(place, f"more than {self.rules.most_nodes} elements and attributes")

    def open(self, element: Element, start: int, end: int) -> None:
        element.comments = tuple(self.waiting)
        self.waiting = []
        if self.stack:
            self.stack[-1].children.append(element)
        if len(self.stack) >= self.rules.most_depth:
            raise _bound(element.place, f"nested more than {self.rules.most_depth} levels deep")
        if not self.text.endswith("/>", start, end):
            self.stack.append(element)
        self.ended = (self.line(end), element)

    def close(self, end: int) -> None:
        element = self.stack.pop()
        element.end_comments = tuple(self.waiting)
        self.waiting = []
        if element.children or element.end_comments:
            self.ended = (0, None)  # a comment beside it belongs to what follows
            return
        inside = tuple(str(text) for text in element.comments if isinstance(text, Beside))
        element.comments = element.comments[: len(element.comments) - len(inside)]
        element.end_comments = inside
        self.ended = (0, None) if inside else (self.line(end), element)

    def line(self, position: int) -> int:
        return bisect_right(self.starts, position)

    def comment(self, start: int, end: int) -> None:
        inside = show_dashes(self.text[start + 4 : end - 3])
        several = "\n" in inside.strip()
        text = inside.strip() if several else inside.removeprefix(" ").rstrip()
        self.count(1, self.place(start, end))
        line, element = self.ended
        if element is not None and line == self.line(start) and not several and not self.waiting:
            element.comments += (Beside(text),)
        else:
            self.waiting.append(text)

    def inner_text(self, start: int, end: int, kind: str) -> None:
        if not self.stack:
            return
        element = self.stack[-1]
        skipped = len(self.text[start:end]) - len(self.text[start:end].lstrip())
        if element.text_place is None and (kind != "text" or start + skipped < end):
            element.text_place = self.place(start + skipped, start + skipped + 1)


def _declares_prefix(name: str) -> bool:
    return name == "xmlns" or name.startswith("xmlns:")
