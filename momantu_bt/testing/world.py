"""A world without physics, its site, and a clock that the test advances."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from momantu_bt.geometry import Pose2D, Transform
from momantu_bt.messages import ObjectClass
from momantu_bt.tags import USUAL_FAMILY, TagBundle, TagPlate
from momantu_bt.testing.robot import ScriptedRobot
from momantu_bt.world import TICK, Site, Surface, TreeLine, Verdict, Video, View

DOCK = TagBundle(
    USUAL_FAMILY,
    (TagPlate(1, 0.15),),
    Transform.from_rpy((3.0, 0.0, 0.5), (math.pi / 2, 0.0, -math.pi / 2)),
)
"""A tag that hangs behind the first table of `scripted_site`."""


def scripted_site(
    *,
    places: Mapping[str, Pose2D] | None = None,
    surfaces: Mapping[str, Surface] | None = None,
    map_file: Path | None = None,
    start: Pose2D | None = None,
    tags: Mapping[str, TagBundle] | None = None,
) -> Site:
    """A site with two tables at (2, 0) and (-2, 0) and a tag, unless others are given."""
    tables = {
        "table_a": Surface(Pose2D(2.0, 0.0, 0.0), (0.8, 1.2), 0.7, (3.141592653589793, 0.0)),
        "table_b": Surface(Pose2D(-2.0, 0.0, 0.0), (0.8, 1.2), 0.5, (0.0, 3.141592653589793)),
    }
    return Site(
        name="scripted",
        map_file=map_file,
        start=start or Pose2D(0.0, 0.0, 0.0),
        places=places or {"start": Pose2D(0.0, 0.0, 0.0)},
        surfaces=tables if surfaces is None else surfaces,
        tags={"dock": DOCK} if tags is None else tags,
        objects={"can": ObjectClass("can", diameter=0.07, height=0.13)},
    )


class ScriptedWorld:
    """Implements `World`. on_step: called after each step, to script what happens in it.

    verdict_of: computes the referee's verdict; None: no referee. pictures: number of frames in an
    open video.
    """

    def __init__(
        self,
        robot: ScriptedRobot | None = None,
        site: Site | None = None,
        *,
        on_step: Callable[[ScriptedRobot], None] | None = None,
        verdict_of: Callable[[ScriptedRobot], Verdict] | None = None,
    ) -> None:
        self.name = "scripted"
        self.robot = robot or ScriptedRobot()
        self.site = site or scripted_site()
        self.closed = False
        self._on_step = on_step
        self._verdict_of = verdict_of
        self._start = self.robot.now()

    def now(self) -> float:
        """Seconds since the episode began."""
        return self.robot.now() - self._start

    def step(self) -> None:
        """Advance by one tick."""
        self.robot.advance(TICK)
        if self._on_step is not None:
            self._on_step(self.robot)

    def verdict(self) -> Verdict | None:
        """The verdict of the scripted referee."""
        return None if self._verdict_of is None else self._verdict_of(self.robot)

    def open_video(self, path: Path, title: str) -> Video:
        """Open a text file with one line per frame instead of a film."""
        return _TextVideo(path, title)

    def open_view(self, port: int) -> View:
        """Raise: a scripted world has no view."""
        raise NotImplementedError("a scripted world has no view")

    def close(self) -> None:
        """Do nothing: there is nothing to free."""
        self.closed = True


class _TextVideo:
    def __init__(self, path: Path, title: str) -> None:
        self._file = path.open("w", encoding="utf-8")
        self._file.write(f"{title}\n")

    def add(self, lines: Sequence[TreeLine], headline: str) -> None:
        shown = "; ".join(f"{line.text} {line.status}" for line in lines)
        self._file.write(f"{headline}: {shown}\n")

    def close(self) -> None:
        self._file.close()


@dataclass(slots=True)
class ManualClock:
    """A clock that the test advances. time: seconds since the run began."""

    time: float = 0.0

    def now(self) -> float:
        """Seconds since the run began."""
        return self.time

    def advance(self, seconds: float) -> None:
        """Let time pass."""
        self.time += seconds
