"""What varies between episodes besides tables and objects: start, light, unknown furniture."""

from __future__ import annotations

from typing import Annotated, Self, TypeAlias

from pydantic import AfterValidator, Field, model_validator

from momantu_bt.descriptions.quantities import Length, Size
from momantu_worlds.scenes.file.furniture import FurnitureKind
from momantu_worlds.scenes.file.values import (
    Count,
    NotNegative,
    Part,
    PlanarPose,
    Point,
    Point3,
    Range,
    Turn,
)

MOST_LAMPS = 60
_Channel: TypeAlias = Annotated[float, Field(ge=0, le=1000)]
Strength: TypeAlias = tuple[_Channel, _Channel, _Channel]
"""Strengths of red, green and blue light."""
_Finite: TypeAlias = Annotated[float, Field(allow_inf_nan=False)]


def _somewhere(value: tuple[float, float, float]) -> tuple[float, float, float]:
    if not any(value):
        raise ValueError("[0, 0, 0] is not a direction")
    return value


Direction: TypeAlias = Annotated[tuple[_Finite, _Finite, _Finite], AfterValidator(_somewhere)]


class Start(Part):
    """The robot's start pose, how far an episode shifts it, what the robot is told.

    turn: largest deviation from the yaw of `at`; any yaw if omitted. clear: half the edge of the
    free square around it, m.
    """

    at: PlanarPose
    shift: NotNegative = 0.0
    turn: Turn | None = None
    clear: Size = 0.55
    belief_shift: NotNegative = 0.0
    belief_turn: Turn = 0.0


class Between(Part):
    """An inclusive range of counts."""

    least: Count = 0
    most: Count

    @model_validator(mode="after")
    def _ordered(self) -> Self:
        if self.least > self.most:
            raise ValueError(f"least ({self.least}) is more than most ({self.most})")
        return self


NONE = Between(most=0)


class Unknown(Part):
    """Differences from the map: moved pieces, and extra pieces in some areas.

    passage: radius of a disc that can still move from the start to every table and through every
    doorway; by default the widest up to 0.4 m that the file leaves. stand: depth
    of the floor before tables that is kept free, m.
    """

    shift: NotNegative = 0.2
    turn: Turn = 0.25
    moved: Between = NONE
    extra: Between = NONE
    kinds: Annotated[tuple[FurnitureKind, ...], Field(min_length=1)] = ("crate", "chair", "plant")
    passage: Size | None = None
    stand: Size = 1.0
    areas: tuple[tuple[Length, Length, Length, Length], ...] = ()


class SunNote(Part):
    """Parallel light that is the same in all episodes. direction: where it shines to."""

    direction: Direction
    color: Strength = (1.0, 1.0, 1.0)


class Bulb(Part):
    """A lamp that is the same in all episodes; color: its strength at 1 m."""

    at: Point3
    color: Strength


class Light(Part):
    """Ranges of brightness, positions of lamps, and lights that are the same in all episodes.

    Without `sun` there is one of the usual strength, unless `suns` are given.
    """

    ambient: Range = (0.3, 0.45)
    sun: Range | None = None
    lamp: Range = (4.0, 8.0)
    lamps: Annotated[tuple[Point, ...], Field(max_length=MOST_LAMPS)] = ()
    suns: Annotated[tuple[SunNote, ...], Field(max_length=8)] = ()
    bulbs: Annotated[tuple[Bulb, ...], Field(max_length=MOST_LAMPS)] = ()
