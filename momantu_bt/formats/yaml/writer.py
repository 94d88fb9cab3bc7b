"""Writes texts as YAML 1.2 scalars, with quotes only if needed."""

from __future__ import annotations

import re

from momantu_bt.formats.yaml.core import resolve

_NEVER_FIRST = "-?:,[]{}#&*!|>'\"%@`"
_NEVER_INSIDE = re.compile(r": |:$| #")
_NEVER_IN_FLOW = re.compile(r"[,\[\]{}]")
_ESCAPES = {"\n": "\\n", "\t": "\\t", "\r": "\\r", '"': '\\"', "\\": "\\\\", "\0": "\\0"}


def scalar(text: str, *, flow: bool = False, typed: bool = True) -> str:
    """Write a text as a scalar that reads back as the same text.

    flow: the scalar is inside brackets or braces. typed: a number would be valid there too, so a
    text that looks like a number needs quotes.
    """
    return text if _is_plain(text, flow, typed) else quoted(text)


def quoted(text: str) -> str:
    """A text in double quotes, or in single quotes if that needs fewer escapes."""
    if text.isprintable() and ('"' in text or "\\" in text) and "'" not in text:
        return f"'{text}'"
    return '"' + "".join(map(_escaped, text)) + '"'


def _escaped(character: str) -> str:
    if character in _ESCAPES:
        return _ESCAPES[character]
    if character.isprintable():
        return character
    code = ord(character)
    if code <= 0xFF:
        return f"\\x{code:02x}"
    return f"\\u{code:04x}" if code <= 0xFFFF else f"\\U{code:08x}"


def _is_plain(text: str, flow: bool, typed: bool) -> bool:
    if not text or text[0] in _NEVER_FIRST or text.startswith("..."):
        return False
    if text != text.strip() or not text.isprintable():
        return False
    if _NEVER_INSIDE.search(text) or (flow and _NEVER_IN_FLOW.search(text)):
        return False
    found = resolve(text)
    return isinstance(found, str) if typed else found is not None
