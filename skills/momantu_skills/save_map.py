"""save_map: write the map that the robot makes, and the names that it was taught, to a folder."""

from __future__ import annotations

from collections.abc import Mapping as Entries
from functools import partial
from pathlib import Path
from typing import Any, ClassVar

from momantu_bt.formats.names import counted
from momantu_bt.lazy import lazily
from momantu_bt.robot import Robot
from momantu_bt.skill import Failure, In, Needs, Out, Run, Skill, compute
from momantu_skills.mapping.own import Mapping

with lazily():
    from momantu_bt.formats.files import OutputError
    from momantu_skills.mapping import building, rehearsed, results

BUDGET = 0.5
"""Time allowed for the last loops and the floor plan, s."""
FEWEST = 2
"""Fewest scans of a map."""


class SaveMap(Skill):
    """Write the map so far, as `momantu-bt map` does; the robot can go on with it.

    The folder gets map.yaml and map.pgm, map.png to look at, trajectory.tum, site.yaml with the
    names that the robot was taught, and report.json: all of them or none. Loops between neighbours
    are looked for once more, so the file may be better than the map in use.
    """

    folder: str = In(doc="the folder, as seen from where the run was started; it is made")
    resolution: float = In(0.05, unit="m", least=0.01, most=0.5, doc="edge of the map's cells")
    replace: bool = In(False, doc="replace the map that the folder holds")
    known: float = Out(unit="m2", doc="free floor on the saved map")

    also_called: ClassVar = ("map_saver", "write_map", "store_map")
    failures: ClassVar = {
        "NOTHING_MAPPED": "there is no map yet: the laser has not shown anything",
        "MAP_NOT_WRITTEN": "the folder holds other files or a map already, or cannot be written",
    }
    activities: ClassVar = {}
    symptoms: ClassVar = {}

    mapping: Mapping = Needs()

    @classmethod
    def rehearsal(cls, seed: int) -> Entries[str, Any]:
        """A map of two scans, and a folder that is removed afterwards."""
        mapping = rehearsed.BegunMapping()
        return {
            "inputs": {"folder": str(mapping.folder), "replace": True},
            "services": {"mapping": mapping},
        }

    def run(self, robot: Robot) -> Run:
        """Finish a copy of the survey, and write it."""
        folder = Path(self.folder)
        try:
            results.check_folder(folder, replace=self.replace)
        except OutputError as error:
            raise Failure("MAP_NOT_WRITTEN", _told(error, folder, self.replace)) from None
        survey = self.mapping.survey
        if len(survey.used) < FEWEST:
            has = counted(len(survey.used), "scan")
            raise Failure("NOTHING_MAPPED", f"the map has {has}, {FEWEST} needed")
        self.mapping.anchors.note(survey.mapper.poses)
        work = partial(building.built_of, survey, self.resolution, stands=self.mapping.stands)
        built: building.Built = yield from compute(work, BUDGET)
        names = self.mapping.anchors.names(built.survey.mapper.poses)
        try:
            building.write(folder, built, names)
        except OutputError as error:
            raise Failure("MAP_NOT_WRITTEN", str(error)) from None
        self.known = float(built.report["free_m2"])
        self.log(f"{self.known:.1f} square metres of free floor saved in {folder}")


def _told(error: OutputError, folder: Path, replace: bool) -> str:
    """What is wrong with a folder; a map in it may be replaced."""
    said = str(error)
    if replace or results.read_report(folder) is None:
        return said
    return f"{said}, or say `replace: true`"
