"""What a goal demands: an object on a surface, as world files, tree files and `--goal` write it."""

from __future__ import annotations

import math
import re
from typing import Annotated, Any, TypeAlias

from pydantic import (
    AfterValidator,
    BaseModel,
    ConfigDict,
    Discriminator,
    Field,
    Tag,
    TypeAdapter,
    ValidationError,
    model_validator,
)

from momantu_bt.descriptions.quantities import Angle, Force, Size, Time
from momantu_bt.descriptions.wording import said

_NAME = r"[a-z][a-z0-9_]*"
_WORDS = re.compile(rf"\s*({_NAME})(\s+lying)?\s+on\s+({_NAME})(?:\s+beside\s+({_NAME}))?\s*")
EXAMPLE = "can on table_b beside tag"
EXAMPLE_LYING = "bottle lying on table_b"
MOST = 50
"""Largest number of demands in a goal."""

_Name: TypeAlias = Annotated[str, Field(pattern=f"^{_NAME}$", max_length=60)]


class GoalDemand(BaseModel):
    """An object on a surface, optionally within `distance` of a tag or body.

    It is written as a mapping, or in short as `can on table_b beside tag`. lying: it is to lie on
    its side, its axis level within `tilt`, as in `bottle lying on table_b`; else it is to stand.
    """

    model_config = ConfigDict(frozen=True, extra="forbid", defer_build=True)

    item: _Name
    on: _Name
    beside: _Name | None = None
    lying: bool = False
    tilt: Angle = math.radians(5)
    distance: Size = 0.4
    still: Time = 1.0
    gripper: Size = 0.1
    others_tilt: Angle = math.radians(30)
    others_shift: Size = 0.1
    force: Force = 150.0

    @model_validator(mode="before")
    @classmethod
    def _in_short(cls, value: Any) -> Any:
        if not isinstance(value, str):
            return value
        words = _WORDS.fullmatch(value)
        if words is None:
            raise ValueError(
                f"expected OBJECT on SURFACE or OBJECT on SURFACE beside TAG, such as {EXAMPLE!r} "
                f"or {EXAMPLE_LYING!r}, found {value!r}"
            )
        item, lying, on, beside = words.groups()
        return {"item": item, "on": on, "beside": beside, "lying": lying is not None}

    def __str__(self) -> str:
        beside = "" if self.beside is None else f" beside {self.beside}"
        lying = " lying" if self.lying else ""
        return f"{self.item}{lying} on {self.on}{beside}"


def _each_once(demands: tuple[GoalDemand, ...]) -> tuple[GoalDemand, ...]:
    seen: set[str] = set()
    for demand in demands:
        if demand.item in seen:
            raise ValueError(f"{demand.item!r} has two demands; an object has one")
        seen.add(demand.item)
    return demands


_Several: TypeAlias = Annotated[
    tuple[GoalDemand, ...], Field(min_length=1, max_length=MOST), AfterValidator(_each_once)
]
GoalDemands: TypeAlias = Annotated[
    Annotated[GoalDemand, Tag("one")] | Annotated[_Several, Tag("several")],
    Discriminator(lambda value: "several" if isinstance(value, list | tuple) else "one"),
]
"""One demand, or a list of them."""


def demands(value: GoalDemand | tuple[GoalDemand, ...] | None) -> tuple[GoalDemand, ...]:
    """The demands of a checked value, as a tuple; none for None."""
    if value is None:
        return ()
    return (value,) if isinstance(value, GoalDemand) else value


def parse_demands(value: Any) -> tuple[GoalDemand, ...]:
    """The demands that a plain value (text, mapping, or a list of these) writes.

    Raises:
        ValueError: it is not a goal; the message lists everything that is wrong.
    """
    try:
        return demands(_ADAPTER.validate_python(value))
    except ValidationError as error:
        raise ValueError("; ".join(dict.fromkeys(map(_told, error.errors())))) from None


_ADAPTER: TypeAdapter[GoalDemand | tuple[GoalDemand, ...]] = TypeAdapter(GoalDemands)


def _told(finding: Any) -> str:
    keys = [part for part in finding["loc"] if part not in ("one", "several")]
    where = ".".join(f"demand {part + 1}" if isinstance(part, int) else str(part) for part in keys)
    if finding["type"] == "missing":
        words = f"the key {keys[-1]!r} is missing"
        where = where.rpartition(".")[0]
    elif finding["type"] == "extra_forbidden":
        words = f"unknown key; keys: {', '.join(GoalDemand.model_fields)}"
    else:
        words = said(finding, list(GoalDemand.model_fields))
    return f"{where}: {words}" if where else words
