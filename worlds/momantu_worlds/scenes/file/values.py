"""Types of values that all sections of a world file use."""

from __future__ import annotations

from typing import Annotated, TypeAlias

from pydantic import AfterValidator, BaseModel, BeforeValidator, ConfigDict, Field, WithJsonSchema

from momantu_bt.descriptions.quantities import ANGLE, LENGTH, Angle, Length, Size
from momantu_bt.geometry import Pose2D, Transform

Channel: TypeAlias = Annotated[float, Field(ge=0, le=1)]
Rgb: TypeAlias = tuple[Channel, Channel, Channel]
Point: TypeAlias = tuple[Length, Length]
Point3: TypeAlias = tuple[Length, Length, Length]
Size3D: TypeAlias = tuple[Size, Size, Size]
PlanarPose: TypeAlias = tuple[Length, Length, Angle]
_Strength: TypeAlias = Annotated[float, Field(ge=0, le=1000)]


def _ordered(value: tuple[float, float]) -> tuple[float, float]:
    if value[0] > value[1]:
        raise ValueError(f"the least, {value[0]:g}, is more than the most, {value[1]:g}")
    return value


Range: TypeAlias = Annotated[tuple[_Strength, _Strength], AfterValidator(_ordered)]
"""Smallest and largest value of a brightness."""
Name: TypeAlias = Annotated[str, Field(pattern=r"^[a-z][a-z0-9_]*$", max_length=60)]
Friction: TypeAlias = Annotated[float, Field(gt=0, le=1)]
Count: TypeAlias = Annotated[int, Field(ge=0, le=50)]
Sides: TypeAlias = Annotated[tuple[Angle, ...], Field(min_length=1, max_length=8)]
"""Directions of approach in a top's own frame; the first is preferred."""
NotNegative: TypeAlias = Annotated[Length, Field(ge=0)]
"""A length of 0 or more, m."""
Turn: TypeAlias = Annotated[Angle, Field(ge=0)]
"""An angle of 0 or more, rad."""

_POSE = "expected [x, y, z], [x, y, z, yaw] or [x, y, z, roll, pitch, yaw]"


def _six(value: object) -> object:
    """A pose with all its six numbers."""
    if not isinstance(value, list | tuple) or len(value) not in (3, 4, 6):
        raise ValueError(f"{_POSE}, found {value!r}")
    turns: list[object] = [ANGLE.read(v) for v in value[3:]]
    if len(turns) < 3:
        turns = [0.0, 0.0, *(turns or [0.0])]
    return (*(LENGTH.read(v) for v in value[:3]), *turns)


_Finite: TypeAlias = Annotated[float, Field(allow_inf_nan=False)]
Pose3D: TypeAlias = Annotated[
    tuple[_Finite, _Finite, _Finite, _Finite, _Finite, _Finite],
    BeforeValidator(_six),
    WithJsonSchema({"type": "array", "minItems": 3, "maxItems": 6, "description": _POSE}),
]
"""x, y, z (m), roll, pitch, yaw (rad, about fixed axes in this order)."""


class Part(BaseModel):
    """Base of the sections of a world file: immutable, unknown keys are errors."""

    model_config = ConfigDict(frozen=True, extra="forbid", defer_build=True)


def pose2d(pose: tuple[float, float, float]) -> Pose2D:
    """Convert a pose of the file to the type used by all other modules."""
    return Pose2D(*pose)


def transform(pose: tuple[float, float, float, float, float, float]) -> Transform:
    """Convert a 3D pose of the file to the type used by all other modules."""
    return Transform.from_rpy(pose[:3], pose[3:])


def with_one_diameter(size: tuple[float, float]) -> None:
    """Raise ValueError if the size of a round top is longer than wide."""
    if abs(size[0] - size[1]) > 1e-9:
        raise ValueError(
            f"a round top is as deep as wide, its diameter; this one is {size[0]:g} x {size[1]:g} m"
        )
