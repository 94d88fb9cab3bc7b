"""Zones as files write them: `{kind: slow, speed: 0.3 m/s, corners: [[1, 0], [2, 0], [2, 3]]}`."""

from __future__ import annotations

from itertools import combinations
from typing import Annotated, Self, TypeAlias

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, model_validator

from momantu_bt.descriptions.quantities import Length, LinearSpeed
from momantu_bt.zone import Zone, ZoneKind

MOST_ZONES, MOST_CORNERS = 200, 200
SLOWEST = 0.05
"""Least speed limit, m/s: slower, a base hardly moves at all."""
LEAST_AREA = 1e-4
"""m2; what is smaller is a line."""

_Corner: TypeAlias = tuple[Length, Length]
_Corners: TypeAlias = tuple[tuple[float, float], ...]


def _simple(corners: _Corners) -> _Corners:
    """The corners, if they surround an area; ValueError says which are wrong."""
    for number, (corner, after) in enumerate(
        zip(corners, (*corners[1:], corners[0]), strict=True), 1
    ):
        if corner == after:
            other = number % len(corners) + 1
            raise ValueError(f"corners {number} and {other} are the same; give each of them once")
    sides = list(zip(corners, (*corners[1:], corners[0]), strict=True))
    for (i, one), (j, other_side) in combinations(enumerate(sides, 1), 2):
        beside = j == i + 1 or (i == 1 and j == len(sides))
        if not beside and _meet(*one, *other_side):
            raise ValueError(
                f"its sides cross: that from corner {i} and that from corner {j}; give the corners "
                "one after the other around the zone"
            )
    if abs(_area(corners)) < LEAST_AREA:
        raise ValueError("its corners lie on one line; a zone needs an area")
    return corners


def _area(corners: _Corners) -> float:
    """The area, m2, above 0 if the corners go round counter-clockwise (the shoelace formula)."""
    pairs = zip(corners, (*corners[1:], corners[0]), strict=True)
    return 0.5 * sum(a[0] * b[1] - b[0] * a[1] for a, b in pairs)


_Point: TypeAlias = tuple[float, float]


def _meet(a: _Point, b: _Point, c: _Point, d: _Point) -> bool:
    """Whether the segments from a to b and from c to d have a point in common."""

    def side(p: _Point, q: _Point, r: _Point) -> float:
        return (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0])

    def on(p: _Point, q: _Point, r: _Point) -> bool:
        return all(min(p[k], q[k]) <= r[k] <= max(p[k], q[k]) for k in (0, 1))

    turns = side(a, b, c), side(a, b, d), side(c, d, a), side(c, d, b)
    if turns[0] * turns[1] < 0.0 and turns[2] * turns[3] < 0.0:
        return True
    ends = ((a, b, c), (a, b, d), (c, d, a), (c, d, b))
    return any(turn == 0.0 and on(*end) for turn, end in zip(turns, ends, strict=True))


class ZoneNote(BaseModel):
    """A zone of the floor: what it is for, its corners, and the speed limit of a slow one."""

    model_config = ConfigDict(frozen=True, extra="forbid", defer_build=True)

    kind: ZoneKind
    corners: Annotated[
        tuple[_Corner, ...],
        Field(min_length=3, max_length=MOST_CORNERS),
        AfterValidator(_simple),
    ]
    speed: Annotated[LinearSpeed, Field(ge=SLOWEST)] | None = None

    @model_validator(mode="after")
    def _speed_of_slow(self) -> Self:
        if self.kind == "slow" and self.speed is None:
            raise ValueError("a slow zone needs its `speed`, such as `speed: 0.3 m/s`")
        if self.kind != "slow" and self.speed is not None:
            raise ValueError(
                f"`speed` is for slow zones; this one is {self.kind}: leave it out, or write "
                "`kind: slow`"
            )
        return self

    @property
    def zone(self) -> Zone:
        """The zone as a site has it."""
        return Zone(self.kind, self.corners, self.speed)
