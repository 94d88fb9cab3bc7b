"""How often a robot that is told no map reaches a pose, by odometry and what it sees.

    python benchmarks/no_map.py four_rooms/fetch --goals 50

Each run is an episode of its own, with physics and pictures: `navigate: {goal: …}` under `--map
none`, to a pose at random on the floor that the robot can reach. Arrived is what the skill says;
off is how far the base truly stands from the goal, which odometry's drift decides.
"""

from __future__ import annotations

import argparse
import math
import statistics
import sys
import time
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from momantu_worlds.scenes.loading import draw_episode
from rolling.world import ROBOTS, somewhere

import momantu_bt
from momantu_bt.bench.reports.table import columns
from momantu_bt.bench.statistics.intervals import wilson
from momantu_bt.engine.executor import Executor
from momantu_bt.geometry import Pose2D
from momantu_bt.world import seeded

EPISODES = 60_000
"""The first episode's seed: no other measurement uses these."""
TREE = "momantu_bt: 1\ntrees: {{Main: [{{navigate: {{goal: {{x: {x}, y: {y}, yaw: {yaw}}}}}}}]}}\n"
HEAD = ("world", "robot", "arrived", "95 % interval", "median m", "median s", "off m", "force N")


@dataclass(frozen=True, slots=True)
class Drive:
    """One drive. straight: to the goal, m. off: true distance from it at the end, m."""

    straight: float
    code: str
    off: float
    seconds: float
    force: float
    wall: float


@dataclass
class _End:
    base: Pose2D | None = None

    def ticked(self, run: Executor) -> None:
        """Remember where the robot truly is."""
        world: Any = run.world
        self.base = world.simulator.truth.base()

    def close(self) -> None:
        """Nothing is open."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Measure each pair, and print a table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("pairs", nargs="+", metavar="WORLD/ROBOT")
    parser.add_argument("--goals", type=int, default=50)
    parser.add_argument("--first", type=int, default=0)
    told = parser.parse_args(arguments)
    rows = [HEAD]
    for pair in told.pairs:
        world, _, robot = pair.rpartition("/")
        drives = []
        for number in range(told.first, told.first + told.goals):
            drives.append(driven(world, robot, number))
            print(_line(number, drives[-1]), flush=True)
        rows.append(_row(world, robot, drives))
    print("\n".join(columns(rows)))
    return 0


def driven(world: str, robot: str, number: int) -> Drive:
    """One drive to a goal at random, from where the episode begins."""
    seed, description = EPISODES + number, ROBOTS[robot]()
    episode = draw_episode(world, seed)
    goal = somewhere(episode, description, seeded(number, "no map", Path(world).stem))
    there = episode.start.inverse() @ goal
    end, began = _End(), time.monotonic()
    tree = TREE.format(x=there.x, y=there.y, yaw=there.yaw)
    report = momantu_bt.run(
        tree, world=world, robot=robot, seed=seed, map="none", max_time=300.0, watch=lambda _: [end]
    )
    assert end.base is not None
    return Drive(
        math.hypot(there.x, there.y),
        report.status if report.failure is None else report.failure.code,
        end.base.distance_to(goal),
        report.sim_time_s,
        max([report.measures.get("force", 0.0), *(i.value for i in report.incidents)]),
        time.monotonic() - began,
    )


def _line(number: int, drive: Drive) -> str:
    return (
        f"{number:3d} {drive.straight:5.1f} m {drive.code:14s} {drive.seconds:6.1f} s, "
        f"{drive.off:5.2f} m off, {drive.force:4.0f} N, {drive.wall:5.1f} s here"
    )


def _row(world: str, robot: str, drives: list[Drive]) -> tuple[str, ...]:
    arrived = [drive for drive in drives if drive.code == "SUCCESS"]
    low, high = wilson(len(arrived), len(drives))
    kept = arrived or [replace(drives[0], off=math.nan)]
    return (
        Path(world).stem,
        robot,
        f"{len(arrived)} of {len(drives)}",
        f"{100 * low:.1f} % to {100 * high:.1f} %",
        f"{statistics.median(drive.straight for drive in drives):.1f}",
        f"{statistics.median(drive.seconds for drive in kept):.1f}",
        f"{statistics.median(d.off for d in kept):.2f}, {max(d.off for d in kept):.2f} at most",
        f"{max(drive.force for drive in drives):.0f}",
    )


if __name__ == "__main__":
    sys.exit(main())
