"""Tunables: parameters of a service or skill that a site can set, with unit, range and default.

A plug-in declares its tunables as a subclass of `Tunables` in the entry point group
`momantu_bt.tunables`, by the service's or skill's name. A world file sets them under
`site.services.NAME`; problems are reported at their place in that file.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any, TypeVar, get_args, get_origin

from pydantic import BaseModel, ConfigDict, ValidationError
from pydantic.fields import FieldInfo

from momantu_bt.descriptions.quantities import Measured
from momantu_bt.descriptions.reading import KeyProblem, Reading
from momantu_bt.descriptions.validation import problems_at
from momantu_bt.descriptions.wording import said
from momantu_bt.formats.names import valid_names
from momantu_bt.formats.places import KeyPath
from momantu_bt.plugins import Group, PluginError, installed_names


class Tunables(BaseModel):
    """The tunables of one service or skill. Each is a field with a default and a description.

    Use the types of `quantities` for quantities, and `pydantic.Field(ge=…, le=…)` for ranges. A
    field can be a `Tunables` too; it is then a group of tunables.
    """

    model_config = ConfigDict(extra="forbid", frozen=True, defer_build=True)


def _objection(name: str, plugin: Any) -> str | None:
    if not (isinstance(plugin, type) and issubclass(plugin, Tunables)):
        return f"{plugin!r} is not a subclass of momantu_bt.descriptions.tunables.Tunables"
    needed = [key for key, field in plugin.model_fields.items() if field.is_required()]
    return f"it has no default for {', '.join(needed)}" if needed else None


TUNABLES: Group[type[Tunables]] = Group("momantu_bt.tunables", "set of tunables", _objection)

Kind = TypeVar("Kind", bound=Tunables)


def configured(kind: type[Kind], parameters: Mapping[str, Any], owner: str) -> Kind:
    """Make tunables with the values that a site sets.

    Raises:
        ValueError: a name is unknown, a unit is wrong, or a value is out of range; the message
            lists all problems.
    """
    try:
        return kind.model_validate(dict(parameters))
    except ValidationError as error:
        raise ValueError("; ".join(_told(kind, owner, dict(e)) for e in error.errors())) from None


def _told(kind: type[Tunables], owner: str, finding: dict[str, Any]) -> str:
    *groups, name = finding["loc"] or ("",)
    if finding["type"] != "extra_forbidden":
        return f"{'.'.join(map(str, (owner, *groups, name)))}: {said(finding, ())}"
    for group in groups:
        kind = dict(groups_of(kind))[group]
    names = valid_names(name, kind.model_fields, "tunables")
    return f"{'.'.join((owner, *groups))} has no tunable {name!r}; {names}"


def tunable_problems(reading: Reading, keys: KeyPath) -> Iterator[KeyProblem]:
    """The problems of the tunables that a file sets, each with its keys."""
    given: Any = reading.plain
    for part in keys:
        given = given.get(part) if isinstance(given, dict) else None
    if not isinstance(given, dict):
        return
    for name, values in given.items():
        if name in TUNABLES:
            if isinstance(values, dict):
                yield from _problems_of(reading, (*keys, name))
        elif name in installed_names("momantu_bt.services"):
            message = f"the service {name!r} declares no tunables, so a site cannot set any of it"
            yield reading.problem((*keys, name), message, key=True)
        else:
            hint = valid_names(str(name), sorted(TUNABLES), "with tunables")
            message = f"no service or skill {name!r} has tunables; {hint}"
            yield reading.problem((*keys, name), message, key=True)


def _problems_of(reading: Reading, keys: KeyPath) -> Iterator[KeyProblem]:
    """The problems of the tunables of one service or skill; its name is the last of `keys`."""
    try:
        kind = TUNABLES.load(str(keys[-1]))
    except PluginError as error:
        yield reading.problem(keys, f"{error}; run momantu-bt doctor", key=True)
        return
    yield from problems_at(reading, keys, kind)


@dataclass(frozen=True, slots=True)
class Tunable:
    """One tunable as texts for a table."""

    name: str
    unit: str
    default: str
    range: str
    meaning: str


def groups_of(kind: type[Tunables]) -> Iterator[tuple[str, type[Tunables]]]:
    """The groups in a set of tunables, by name."""
    for key, field in kind.model_fields.items():
        inner = field.annotation
        if isinstance(inner, type) and issubclass(inner, Tunables):
            yield key, inner


def tunables_of(kind: type[Tunables]) -> Iterator[Tunable]:
    """The tunables of a set in the order of their declaration, without its groups."""
    groups = dict(groups_of(kind))
    for key, field in kind.model_fields.items():
        if key not in groups:
            default, meaning = _plain(field.default), field.description or ""
            yield Tunable(key, _unit(field), default, _range(field), meaning)


def _plain(value: Any) -> str:
    return ", ".join(map(str, value)) if isinstance(value, tuple) else str(value)


def _unit(field: FieldInfo) -> str:
    parts = [p for p in get_args(field.annotation) if p is not ...]
    inner = [_measured(get_args(part)) for part in parts if get_origin(part) is not None]
    found = [_measured(field.metadata), *inner]
    return ", ".join(dict.fromkeys(each for each in found if each))


def _measured(metadata: Any) -> str:
    return next((each.si[0] for each in metadata if isinstance(each, Measured)), "")


def _range(field: FieldInfo) -> str:
    bounds = _bounds(field.metadata)
    for part in get_args(field.annotation):
        bounds = bounds or _bounds(get_args(part))
    return ", ".join(bounds)


_BOUNDS = {"gt": "above", "ge": "at least", "lt": "below", "le": "at most"}


def _bounds(metadata: Any) -> list[str]:
    """The tightest lower and upper bound, in words: a field may narrow its quantity's."""
    stated = [bound for each in metadata for bound in (each, *getattr(each, "metadata", ()))]
    given = [(getattr(bound, key), key) for bound in stated for key in _BOUNDS if _has(bound, key)]
    lower = max((each for each in given if each[1] in ("ge", "gt")), default=None)
    upper = min((each for each in given if each[1] in ("le", "lt")), default=None)
    return [f"{_BOUNDS[key]} {value:g}" for value, key in filter(None, (lower, upper))]


def _has(bound: Any, key: str) -> bool:
    return getattr(bound, key, None) is not None
