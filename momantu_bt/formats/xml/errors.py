"""XML syntax errors in plain words, each at its place."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from lxml import etree

from momantu_bt.formats.names import nearest
from momantu_bt.formats.places import Place, lines_of
from momantu_bt.formats.problems import Problem


@dataclass(frozen=True, slots=True)
class XmlRules:
    """How to read one kind of file: its limits, and its words in messages.

    what: what messages call this kind of file. most_nodes: limit of elements, attributes and
    comments together. most_attributes: limit for one element. beginning: the hint for an empty
    file. prefixes: the namespaces of this kind of file, by their usual prefixes.
    """

    what: str
    most_bytes: int
    most_depth: int
    most_nodes: int
    most_attributes: int = 500
    beginning: str = ""
    prefixes: Mapping[str, str] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class LibraryError:
    """An error from lxml. kind: for example "ERR_TAG_NAME_MISMATCH". line, column: from 1."""

    kind: str
    message: str
    line: int
    column: int


def first_error(error: etree.XMLSyntaxError, parser: etree.XMLParser) -> LibraryError:
    """The first error in a text; later ones are often consequences of it."""
    for entry in parser.error_log:
        if entry.level_name != "WARNING":
            return LibraryError(entry.type_name, entry.message, entry.line, max(1, entry.column))
    return LibraryError("", str(error.msg), error.lineno or 1, max(1, error.offset or 1))


def in_our_words(error: LibraryError, text: str, file: str, rules: XmlRules) -> Problem:
    """Turn an error of lxml into a problem with the code "syntax" (or "too-large")."""
    lines = lines_of(text)
    line = min(max(1, error.line), len(lines))
    place = Place(file, line, min(error.column, len(lines[line - 1]) + 1))
    if error.kind == "ERR_RESOURCE_LIMIT":
        return Problem("too-large", "nested too deeply, or a text that is too long", place)
    if error.kind == "ERR_DOCUMENT_EMPTY":
        return Problem("syntax", "the file holds no XML", place, rules.beginning)
    if error.kind == "NS_ERR_UNDEFINED_NAMESPACE":
        return _prefix(error, place, lines, rules.prefixes)
    for read in (_tags, _attributes, _ampersand, _rest):
        found = read(error, place, lines)
        if found is not None:
            return found
    return Problem("syntax", f"this is not XML: {error.message}", place)


def _tags(error: LibraryError, place: Place, lines: tuple[str, ...]) -> Problem | None:
    mismatch = re.search(r"mismatch: (\S+) line (\d+) and (\S+)", error.message)
    if error.kind == "ERR_TAG_NAME_MISMATCH" and mismatch is not None:
        opened, at, closed = mismatch.groups()
        where = _before(place, lines, f"</{closed}", 2 + len(closed))
        message = f"`</{closed}>` stands where `</{opened}>` should be"
        hint = f"line {at} opens <{opened}>: end it with </{opened}>, or write <{opened} …/>"
        hint = _lost_bracket(lines[: place.line]) or hint
        return Problem("syntax", message, where, hint)
    unfinished = re.search(r"in tag (\S+)(?: line (\d+))?", error.message)
    if error.kind == "ERR_TAG_NOT_FINISHED" and unfinished is not None:
        name, at = unfinished[1], int(unfinished[2] or place.line)
        start = lines[at - 1].find(f"<{name}") if 0 < at <= len(lines) else -1
        where = Place(place.file, at, start + 1, len(name) + 1) if start >= 0 else place
        return Problem("syntax", f"<{name}> is never closed", where, f"end it with </{name}>")
    return None


def _lost_bracket(lines: Sequence[str]) -> str:
    """A hint if an earlier line ends a tag that it does not begin; else empty."""
    for number, line in enumerate(lines, 1):
        if re.fullmatch(r"\s*/?[\w:]+(\s+[\w:]+=\"[^\"<>]*\")*\s*/?>\s*", line):
            return f"line {number} ends a tag that it does not begin: a `<` is missing"
    return ""


def _attributes(error: LibraryError, place: Place, lines: tuple[str, ...]) -> Problem | None:
    redefined = re.match(r"Attribute (\S+) redefined", error.message)
    if redefined is not None:
        where = _before(place, lines, redefined[1], len(redefined[1]))
        return Problem("syntax", f"the attribute {redefined[1]!r} stands here twice", where)
    if error.kind in ("ERR_LT_IN_ATTRIBUTE", "ERR_ATTRIBUTE_NOT_FINISHED"):
        where = _opened_quote(place, lines)
        message = "this text in quotes is not closed, or has a `<` inside"
        return Problem("syntax", message, where, "close the quotes; inside them `<` is &lt;")
    if error.kind == "ERR_ATTRIBUTE_NOT_STARTED":
        hint = 'write name="value"'
        return Problem("syntax", "the value of an attribute stands in quotes", place, hint)
    if error.kind == "ERR_ATTRIBUTE_WITHOUT_VALUE":
        name = error.message.split()[-1]
        where = _before(place, lines, name, len(name))
        return Problem("syntax", f"the attribute {name!r} has no value", where, f'{name}="value"')
    if error.kind in ("ERR_SPACE_REQUIRED", "ERR_GT_REQUIRED"):
        message = "the tag goes on here in a way that XML does not know"
        hint = 'attributes are name="value" with a space between, a tag ends with `>` or `/>`'
        return Problem("syntax", message, place, hint)
    return None


def _prefix(
    error: LibraryError, place: Place, lines: tuple[str, ...], prefixes: Mapping[str, str]
) -> Problem:
    found = re.search(r"prefix (\S+)", error.message)
    name = found[1] if found is not None else next(iter(prefixes), "")
    near = nearest(name, prefixes)
    hint = "remove it"
    if near is not None:
        declared = f'xmlns:{near}="{prefixes[near]}"'
        meant = "" if near == name else f"did you mean {near}? "
        hint = f"{meant}write {declared} in the first element"
    where = _before(place, lines, f"{name}:", len(name))
    return Problem("syntax", f"the prefix `{name}:` is not declared", where, hint)


def _ampersand(error: LibraryError, place: Place, lines: tuple[str, ...]) -> Problem | None:
    entity = re.match(r"Entity '(\S+)' not defined", error.message)
    named = ("ERR_NAME_REQUIRED", "ERR_ENTITYREF_SEMICOL_MISSING")
    line = lines[place.line - 1][: place.column]
    if entity is None and not (error.kind in named and "&" in line):
        return None
    name = f"&{entity[1]};" if entity is not None else "&"
    where = _before(place, lines, name, len(name))
    return Problem("syntax", f"`{name}` means nothing in XML", where, "write &amp; for &")


_SENTENCES = {
    "ERR_DOCUMENT_END": ("something follows the end of the file's element", "remove it"),
    "ERR_HYPHEN_IN_COMMENT": ("`--` cannot stand inside a comment", "write one `-`"),
    "ERR_COMMENT_NOT_FINISHED": ("this comment is never closed", "end it with -->"),
    "ERR_NAME_REQUIRED": ("a name is missing here", "a tag is `<name …>`; in texts `<` is &lt;"),
    "ERR_INVALID_CHAR": ("a character that cannot stand in XML", "remove it"),
    "ERR_XMLDECL_NOT_FINISHED": ("the first line is not closed", "end it with ?>"),
    "ERR_RESERVED_XML_NAME": ("`<?xml …?>` stands at the very start of a file", "move it there"),
}


def _rest(error: LibraryError, place: Place, lines: tuple[str, ...]) -> Problem | None:
    if error.kind not in _SENTENCES:
        return None
    message, hint = _SENTENCES[error.kind]
    return Problem("syntax", message, place, hint)


def _before(place: Place, lines: tuple[str, ...], word: str, length: int) -> Place:
    """The last place of a word in the same line, before a place."""
    found = lines[place.line - 1].rfind(word, 0, place.column + length)
    return place if found < 0 else Place(place.file, place.line, found + 1, length)


def _opened_quote(place: Place, lines: tuple[str, ...]) -> Place:
    """The attribute before a place whose quotes are not closed; it may be on an earlier line."""
    for number in range(place.line, 0, -1):
        line = lines[number - 1]
        end = place.column if number == place.line else len(line)
        found = list(re.finditer(r"[\w:.-]+\s*=\s*[\"']", line[:end]))
        if found:
            start, stop = found[-1].span()
            return Place(place.file, number, start + 1, stop - start)
    return place
