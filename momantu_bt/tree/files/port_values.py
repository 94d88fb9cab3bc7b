"""Port values in YAML: literals, wires (`$key`) and text with keys inside (`"${key} cans"`)."""

from __future__ import annotations

import re
from typing import Any

from momantu_bt.formats.places import Place
from momantu_bt.formats.text import NOT_TEXT
from momantu_bt.formats.yaml.values import Entries, Items, Raw, Scalar
from momantu_bt.tree.model import Literal, PortValue, Reference, Scope, Template
from momantu_bt.tree.problems import Problems

_NAME = r"[^\W\d]\w*"
KEY = re.compile(_NAME)
"""A blackboard key: letters, digits and underscores, no digit first."""
_WIRE = re.compile(rf"\$(@?)({_NAME})((?:\.{_NAME})*)")
_INSIDE = re.compile(rf"\$\$|\$\{{(@?)({_NAME})((?:\.{_NAME})*)\}}|\$")


def port_value(raw: Raw, same_name: str, problems: Problems) -> PortValue | None:
    """A port's value; None if a problem was reported.

    same_name: the key that `$=` stands for.
    """
    if isinstance(raw, Scalar):
        return _scalar(raw, same_name, problems)
    if reported_braces(raw, problems):
        return None
    value = _nested(raw, problems)
    return None if value is _BROKEN else Literal(value)


def words(raw: Raw, problems: Problems, what: str) -> str:
    """A name or a sentence, as it is written; empty if a problem was reported."""
    text = raw.text if isinstance(raw, Scalar) and raw.value is not None else ""
    forbidden = NOT_TEXT.search(text)
    if not isinstance(raw, Scalar) or (raw.value is None and not raw.quoted):
        problems.error("wrong-value", raw.place, f"{what} is a text")
    elif forbidden is not None:
        message = f"the character U+{ord(forbidden[0]):04X} cannot stand in {what}"
        problems.error("wrong-value", raw.place, message, "remove it")
        return ""
    return text


def reference(raw: Raw, problems: Problems, what: str) -> Reference | None:
    """A value that must be a wire; None if a problem was reported."""
    value = port_value(raw, "", problems)
    if isinstance(value, Reference):
        return value
    if value is not None:
        text = raw.text if isinstance(raw, Scalar) else "key"
        hint = f"did you mean ${text}?" if KEY.fullmatch(text) else "write $key"
        problems.error("not-a-key", raw.place, f"{what} is a key", hint)
    return None


def _scalar(raw: Scalar, same_name: str, problems: Problems) -> PortValue | None:
    if not isinstance(raw.value, str) or "$" not in raw.value:
        return Literal(raw.value)
    text = raw.value
    if text == "$=":
        return Reference(same_name)
    wire = _WIRE.fullmatch(text)
    if wire is not None:
        return _reference(wire)
    parts = _parts(text, raw.place, problems)
    if parts is None:
        return None
    if all(isinstance(part, str) for part in parts):
        return Literal("".join(str(part) for part in parts))
    return Template(tuple(parts))


def _reference(match: re.Match[str]) -> Reference:
    scope = Scope.ROOT if match[1] else Scope.LOCAL
    fields = tuple(match[3].split(".")[1:]) if match[3] else ()
    return Reference(match[2], fields, scope)


def _parts(text: str, place: Place, problems: Problems) -> list[str | Reference] | None:
    parts: list[str | Reference] = []
    plain = ""
    position = 0
    for match in _INSIDE.finditer(text):
        plain += text[position : match.start()]
        position = match.end()
        if match[0] == "$$":
            plain += "$"
        elif match[2]:
            parts += [plain, _reference(match)] if plain else [_reference(match)]
            plain = ""
        else:
            hint = "write ${key} inside text, $$ for a dollar"
            problems.error("dollar", place, "`$` here is not a wire", hint)
            return None
    plain += text[position:]
    return [*parts, plain] if plain else parts


_SIGN = re.compile(r"([=:])")


def reported_braces(raw: Raw, problems: Problems) -> bool:
    """Whether the file has `{key}` where it should have `$key`. If so, report it."""
    if not isinstance(raw, Entries) or not raw.flow or len(raw.entries) != 1:
        return False
    key, value = raw.entries[0]
    if not isinstance(value, Scalar) or value.value is not None or value.text:
        return False
    message = f"{{{key.text}}} is a mapping in YAML"
    name, sign, rest = _SIGN.split(key.text, maxsplit=1) if _SIGN.search(key.text) else ("", "", "")
    hint = f"write {{{name}: {rest}}}" if sign else f"did you mean ${key.text}?"
    problems.error("braces", raw.place, message, hint)
    return True


_BROKEN = object()


def _nested(raw: Raw, problems: Problems) -> Any:
    # as deep as the file; `source` limits that depth
    if isinstance(raw, Items):
        items = [_nested(item, problems) for item in raw.items]
        return _BROKEN if any(item is _BROKEN for item in items) else items
    if isinstance(raw, Entries):
        drop_duplicates(raw, problems)
        values = {key.text: _nested(value, problems) for key, value in raw.entries}
        return _BROKEN if any(value is _BROKEN for value in values.values()) else values
    value = _scalar(raw, "", problems)
    if isinstance(value, Literal):
        return value.value
    if value is not None:
        problems.error(
            "wire-inside",
            raw.place,
            "a wire cannot stand inside a list or mapping",
            "give the whole value by one key, set under `values:`",
        )
    return _BROKEN


def drop_duplicates(raw: Entries, problems: Problems) -> None:
    """Report every key that a mapping repeats, and keep the first of each that has a value."""
    first: dict[str, tuple[Scalar, Raw]] = {}
    for key, value in raw.entries:
        if key.text in first:
            message = f"the key {key.text!r} stands here twice"
            hint = f"the first is in line {first[key.text][0].place.line}"
            problems.error("duplicate-key", key.place, message, hint)
            if _is_empty(first[key.text][1]):
                first[key.text] = (first[key.text][0], value)
        else:
            first[key.text] = (key, value)
    raw.entries = list(first.values())


def _is_empty(raw: Raw) -> bool:
    return isinstance(raw, Scalar) and raw.value is None and not raw.text


def mapping(raw: Raw, name: str, example: str, problems: Problems) -> list[tuple[Scalar, Raw]]:
    """The entries of a mapping under a key; none if the key has no value."""
    if isinstance(raw, Entries):
        drop_duplicates(raw, problems)
        return raw.entries
    if not (isinstance(raw, Scalar) and raw.value is None):
        message, hint = f"`{name}` is a mapping", f"write {{{example}}}"
        problems.error("wrong-value", raw.place, message, hint)
    return []


def is_key(key: Scalar, problems: Problems) -> bool:
    """Whether it can be the name of a blackboard key. If not, report a problem."""
    if isinstance(key.value, str) and KEY.fullmatch(key.text):
        return True
    hint = "letters, digits and underscores, no digit first"
    if key.text.startswith("$"):
        hint = f"did you mean {key.text[1:]}?"
    problems.error("bad-name", key.place, f"{key.text!r} cannot be the name of a key", hint)
    return False
