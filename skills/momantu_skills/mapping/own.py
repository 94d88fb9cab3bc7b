"""What skills see of the mapping service."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

from momantu_skills.navigation.map.own import OwnMap

if TYPE_CHECKING:
    from momantu_bt.geometry import Pose2D
    from momantu_skills.mapping.anchors import Anchors
    from momantu_skills.mapping.extending import Earlier
    from momantu_skills.mapping.sightings import Sightings
    from momantu_skills.mapping.survey import Survey


class Mapping(OwnMap, Protocol):
    """Localization on a map that the service itself makes."""

    survey: Survey
    """The scans and their poses."""
    anchors: Anchors
    """The names of the run, which move with the scans."""
    stands: float
    """Radius of the base, m: the floor below it is free."""
    sightings: Sightings
    """What the camera was turned to on the map, and the tops that it showed."""

    earlier: Earlier | None
    """A map to go on with."""
    unplaced: str
    """Why the robot does not find itself on it."""
    begun: Pose2D | None
    """`map_from_base` of the first scan on it."""

    @property
    def known(self) -> float:
        """Square metres of free floor that the map has."""
        ...
