"""Values of the model as YAML 1.2 text: plain where it can be, in quotes where it must be."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from momantu_bt.errors import MomantuError
from momantu_bt.formats.places import Place
from momantu_bt.formats.yaml.core import resolve
from momantu_bt.formats.yaml.writer import quoted, scalar
from momantu_bt.tree.files.port_values import KEY
from momantu_bt.tree.model import Literal, PortValue, Reference, Scope, Template


class CannotWrite(MomantuError, ValueError):
    """A value or node that cannot be written in a spelling; the message says which.

    place: the node's place, if it is known.
    """

    place: Place | None = None


def literal(value: Any, *, flow: bool = False) -> str:
    """A written-out value; lists and mappings in flow style, `$` in texts doubled.

    Raises:
        CannotWrite: YAML has no such value (infinities).
    """
    # as deep as the value; the readers limit that depth
    if value is None:
        return "null"
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return scalar(value.replace("$", "$$"), flow=flow)
    if isinstance(value, int | float):
        return _number(value)
    if isinstance(value, Mapping):
        inside = (
            f"{scalar(k, flow=True, typed=False)}: {literal(v, flow=True)}"
            for k, v in value.items()
        )
        return "{" + ", ".join(inside) + "}"
    if isinstance(value, list | tuple):
        return "[" + ", ".join(literal(item, flow=True) for item in value) + "]"
    raise CannotWrite(f"a {type(value).__name__} cannot be written out")


def _number(value: float) -> str:
    text = repr(value)
    found = resolve(text)
    if type(found) is not type(value):
        raise CannotWrite(f"the number {text} cannot be written out")
    return text


def port_text(value: PortValue, *, flow: bool = False) -> str:
    """A port's value: a literal, `$key`, or a text with `${key}` inside.

    Raises:
        CannotWrite: the value, or the name of a key, has no spelling in YAML.
    """
    if isinstance(value, Literal):
        return literal(value.value, flow=flow)
    if isinstance(value, Reference):
        return "$" + _key(value)
    return quoted(template_text(value))


def template_text(value: Template) -> str:
    """A text with keys inside, without quotes."""
    return "".join(
        part.replace("$", "$$") if isinstance(part, str) else f"${{{_key(part)}}}"
        for part in value.parts
    )


def _key(reference: Reference) -> str:
    for name in (reference.key, *reference.fields):
        if not KEY.fullmatch(name):
            raise CannotWrite(f"the key {name!r} is not made of letters, digits and underscores")
    at = "@" if reference.scope is Scope.ROOT else ""
    return at + ".".join((reference.key, *reference.fields))
