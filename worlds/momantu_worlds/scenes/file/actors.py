"""Actors of a world file: people who walk about."""

from __future__ import annotations

from typing import Annotated, Self, TypeAlias

from pydantic import AfterValidator, Field, model_validator

from momantu_bt.descriptions.quantities import LinearSpeed, Time
from momantu_worlds.scenes.catalogue.person import CLOTHES
from momantu_worlds.scenes.file.values import Part, Point, Rgb

FASTEST = 2.0
"""m/s; faster, people run."""
LONGEST = 3600.0
"""s; longest pause."""

_Speed: TypeAlias = Annotated[LinearSpeed, Field(ge=0.1, le=FASTEST)]
_Pause: TypeAlias = Annotated[Time, Field(le=LONGEST)]


def _rising(bounds: tuple[float, float]) -> tuple[float, float]:
    if bounds[0] > bounds[1]:
        raise ValueError(f"the least, {bounds[0]:g}, is more than the most, {bounds[1]:g}")
    return bounds


class ActorNote(Part):
    """Somebody, or a group one behind the other, who walks between stops in an order that varies.

    speed, pause: the least and the most; each way and each stop draws its own.
    """

    stops: Annotated[tuple[Point, ...], Field(min_length=2, max_length=50)]
    speed: Annotated[tuple[_Speed, _Speed], AfterValidator(_rising)] = (0.7, 1.1)
    pause: Annotated[tuple[_Pause, _Pause], AfterValidator(_rising)] = (1.0, 5.0)
    group: Annotated[int, Field(ge=1, le=5)] = 1
    color: Rgb = CLOTHES

    @model_validator(mode="after")
    def _two_stops(self) -> Self:
        if len(set(self.stops)) < len(self.stops):
            raise ValueError("two of its `stops` are the same; give each of them once")
        return self
