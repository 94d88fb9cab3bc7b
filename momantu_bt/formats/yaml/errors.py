"""YAML syntax errors in plain words."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

from ruamel.yaml.error import MarkedYAMLError, StringMark

from momantu_bt.formats.places import Place, lines_of
from momantu_bt.formats.problems import Problem

_FLOW_MAPPING = "a flow mapping"


@dataclass(frozen=True, slots=True)
class YamlRules:
    """How to read one kind of file: its limits, and its words in messages.

    what: what messages call this kind of file. most_values: limit of values; a value behind an
    alias counts each time the alias is used. Comments have the same limit.
    beginning: the hint for an empty file. tag_hint: the hint for a tag, `!x`. braces_hint: the hint
    for a mapping as a key, `{x}:`. scripts: keys whose values are expressions that YAML may
    misread.
    """

    what: str
    most_bytes: int
    most_depth: int
    most_values: int
    most_aliases: int = 500
    beginning: str = ""
    tag_hint: str = "put the whole value in quotes"
    braces_hint: str = "put the key in quotes"
    scripts: tuple[str, ...] = ()


_UNQUOTED = r""":\s+([^\s"'{}\[][^"{}]*?)\s*(?:,\s+\w+:|}|$)"""
"""A script without quotes inside braces, up to the next key or the closing brace."""
_OPENED_QUOTE = re.compile(r"""[^"'#]*(?:[:-]\s+|[\[{,]\s*)(?:"(?:[^"\\]|\\.)*|'[^']*)""")
"""A line on which a value begins with a quote that is not closed on that line."""


def in_our_words(error: MarkedYAMLError, text: str, file: str, rules: YamlRules) -> Problem:
    """Turn the error of the YAML parser into a problem."""
    problem = str(error.problem or "")
    context = str(error.context or "")
    at = error.problem_mark or error.context_mark
    for known, where, message, hint in _WORDS:
        if known in problem or known in context:
            mark = error.context_mark if where == "start" and error.context_mark else at
            hint = _cause_above(text, at) or hint
            if known == _FLOW_MAPPING:
                hint = hint or _script_within(text, error.context_mark, at, rules.scripts)
            if known.startswith("a block") and error.context_mark is not None:
                hint += _indented_above(text, error.context_mark, at)
            return Problem("syntax", message, _mark(mark, file), hint)
    if "cannot start any token" in problem:
        return _bad_start(problem, _mark(at, file))
    return Problem("syntax", f"this is not YAML: {problem or context}", _mark(at, file))


def _indented_above(text: str, begin: StringMark, at: StringMark | None) -> str:
    """Text that says where a mapping or list begins, and which lines above may be misindented.

    The wrong line would fit if the line above it had another indentation, or if the first line of
    the mapping or list had.
    """
    said = f"; line {begin.line + 1} begins it in column {begin.column + 1}"
    lines = lines_of(text)
    if at is None or at.line >= len(lines):
        return said
    indent = _indent(lines[at.line])
    above = [
        n for n in range(at.line) if lines[n].strip() and not lines[n].lstrip().startswith("#")
    ]
    outer = next((n for n in reversed(above) if _indent(lines[n]) < indent), None)
    inner = next((n for n in above if outer is not None and n > outer), None)
    if outer is None or inner is None or _indent(lines[inner]) == indent:
        return said
    return f"{said}; or the indentation of line {outer + 1} or of line {inner + 1} is wrong"


def _cause_above(text: str, mark: StringMark | None) -> str:
    """The hint if an earlier line is wrong: a quote that is not closed, or a missing `:`."""
    above = lines_of(text)[: mark.line + 1 if mark is not None else 0]
    for number, line in enumerate(above[:-1], 1):
        opened = _OPENED_QUOTE.fullmatch(line)
        if opened is not None:
            return f"line {number} opens a quote that it does not close"
    start = _start_of_text(above)
    if start is None:
        return ""
    bare = re.fullmatch(r"\s*-\s+(\w+)\s*", above[start])
    hint = (
        f"write `{bare[1]}:` when more follows below it" if bare else "a `:` may be missing there"
    )
    return f"line {start + 1}: {hint}"


def _script_within(
    text: str, begin: StringMark | None, at: StringMark | None, keys: Sequence[str]
) -> str:
    """The hint if an unquoted script inside braces has a `?`, `:` or `,` that YAML interprets."""
    if begin is None or at is None or not keys or begin.line >= len(lines_of(text)):
        return ""
    line = lines_of(text)[begin.line]
    found = re.compile(rf"[{{,]\s*({'|'.join(keys)}){_UNQUOTED}").search(line, begin.column)
    if found is not None and re.search(r"[?:]\s", found[2]):
        return f'put the script in quotes: {found[1]}: "{found[2]}"'
    return ""


def _start_of_text(lines: Sequence[str]) -> int | None:
    """Index of the line without `:` whose text YAML continues in the last line."""
    start, least = None, _indent(lines[-1]) if lines else 0
    for index in range(len(lines) - 2, -1, -1):
        line = lines[index]
        if not line.strip() or line.lstrip().startswith("#") or re.search(r":(\s|$)", line):
            break
        if _indent(line) < least:
            start, least = index, _indent(line)
    return start


def _indent(line: str) -> int:
    return len(line) - len(line.lstrip(" "))


def _bad_start(problem: str, place: Place) -> Problem:
    if r"'\t'" in problem:
        return Problem("syntax", "a tab", place, "indent with spaces")
    character = problem.split("'")[1] if "'" in problem else "this"
    return Problem(
        "syntax", f"a value cannot begin with {character}", place, "put the whole value in quotes"
    )


_WORDS = (
    (
        "mapping values are not allowed",
        "here",
        "a `:` that does not belong here",
        "check the indentation, or put the whole value in quotes",
    ),
    ("a quoted scalar", "start", "a quote that is never closed", "close it on the same line"),
    ("a flow sequence", "start", "a `[` that is never closed, or a `,` that is missing", ""),
    (_FLOW_MAPPING, "start", "a `{` that is never closed, or a `,` that is missing", ""),
    (
        "a block collection",
        "here",
        "this line is neither the list's next item nor further in",
        "items of one list begin with `- ` in one column",
    ),
    (
        "a block mapping",
        "here",
        "this line does not continue the mapping above",
        "keys of one mapping begin in one column",
    ),
    (
        "could not find expected ':'",
        "start",
        "a key without `:`",
        "write `key: value`, or indent the line",
    ),
    (
        "sequence entries are not allowed",
        "here",
        "a list cannot begin here",
        "put it on a line of its own",
    ),
    (
        "unknown escape character",
        "here",
        "a backslash that means nothing here",
        "write it twice, or use 'single quotes'",
    ),
    ("<document start>", "here", "this follows the end of the file's value", "write one mapping"),
    ("scanning an directive", "start", "a line cannot begin with `%`", "put it in quotes"),
    ("scanning a directive", "start", "a line cannot begin with `%`", "put it in quotes"),
)


def _mark(mark: StringMark | None, file: str) -> Place:
    return Place(file, 1, 1) if mark is None else Place(file, mark.line + 1, mark.column + 1)
