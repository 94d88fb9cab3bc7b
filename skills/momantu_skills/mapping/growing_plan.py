"""The floor plan of a survey that goes on, kept up to date scan by scan."""

from __future__ import annotations

from momantu_skills.mapping.occupancy import Occupancy
from momantu_skills.mapping.survey import Survey
from momantu_skills.navigation.map.maps import GridMap


class GrowingPlan:
    """Counts the beams of new scans, and those of all scans when their poses have changed.

    resolution: m per cell. step: by how much the raster grows, m. stands: see `Occupancy.add`.
    """

    def __init__(self, resolution: float, step: float, stands: float = 0.0) -> None:
        self._resolution, self._step, self._stands = resolution, step, stands
        self._counts: Occupancy | None = None
        self._counted = self._revision = 0

    def follow(self, survey: Survey) -> bool:
        """Take in what is new; whether there was anything."""
        mapper = survey.mapper
        if self._counted == len(mapper.poses):
            return False
        if self._counts is None:
            longest = mapper.config.matching.longest
            self._counts = Occupancy(self._resolution, longest, self._step)
        if mapper.revision != self._revision:
            self._revision, self._counted = mapper.revision, 0
            self._counts.forget()
        self._counts.add(survey.placed(self._counted), self._stands)
        self._counted = len(mapper.poses)
        return True

    def grid(self) -> GridMap:
        """The plan so far; there has been a scan."""
        assert self._counts is not None
        return self._counts.grid()
