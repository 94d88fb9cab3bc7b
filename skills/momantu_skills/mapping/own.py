"""What skills see of the mapping service."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

from momantu_skills.navigation.map.own import OwnMap

if TYPE_CHECKING:
    from momantu_skills.mapping.sightings import Sightings
    from momantu_skills.mapping.survey import Survey


class Mapping(OwnMap, Protocol):
    """Localization on a map that the service itself makes."""

    survey: Survey
    """The scans and their poses."""
    stands: float
    """Radius of the base, m: the floor below it is free."""
    sightings: Sightings
    """What the camera was turned to on the map, and the tops that it showed."""

    @property
    def known(self) -> float:
        """Square metres of free floor that the map has."""
        ...
