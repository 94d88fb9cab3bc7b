"""How often a robot that was set down anywhere finds itself, and how often it is sure and wrong.

    python benchmarks/lost.py four_rooms/fetch warehouse/fetch --starts 100

In each episode the robot is set down at poses drawn from the floor that it can reach, told nothing,
and runs `relocalize: {everywhere: true}`, or with `--believing` plain `relocalize` while it
believes to be at the start. Ground truth says how right the estimate is at the end: right is
within 0.15 m and 10 degrees. A success elsewhere is sure and wrong; NOT_LOCALIZED is "I do not
know". The world has no physics (`rolling/world.py`); touched counts what stopped the base.
"""

from __future__ import annotations

import argparse
import json
import math
import statistics
import sys
import time
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path

from momantu_skills.manipulation.scene.service import PlanningSceneService
from momantu_skills.navigation.localize.service import LocalizationService
from momantu_skills.relocalize import Relocalize
from rolling.world import RollingRobot, open_rolling, somewhere

from momantu_bt.bench.reports.table import columns
from momantu_bt.bench.statistics.intervals import wilson
from momantu_bt.geometry import Pose2D
from momantu_bt.testing import ScriptedWorld, run_skill
from momantu_bt.world import seeded

NEAR = (0.15, math.radians(10.0))
"""Errors up to which an estimate is right, m and rad."""
LONGEST = 30.0
"""Time that the robot may drive, s."""
STARTS = 10
"""Starts in one episode."""
EPISODES = 50_000
"""The first episode's seed: no other measurement uses these."""
HEAD = ("world", "robot", "right", "95 % interval", "sure and wrong", "does not know", "too late")
HEAD += ("median s", "p95 s", "touched")


@dataclass(frozen=True, slots=True)
class Start:
    """One start: where, what it ended with, how far off the estimate is (m, rad), how long, s."""

    world: str
    robot: str
    seed: int
    number: int
    at: Pose2D
    verdict: str = ""
    off: float = 0.0
    turned: float = 0.0
    seconds: float = 0.0
    touched: int = 0
    ended: str = ""
    wall: float = 0.0


def main(arguments: Sequence[str] | None = None) -> int:
    """Measure each pair, and print a table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("pairs", nargs="+", metavar="WORLD/ROBOT")
    parser.add_argument("--starts", type=int, default=100)
    parser.add_argument("--first", type=int, default=0, help="the first start's number")
    parser.add_argument("--believing", action="store_true", help="believe to be at the start")
    parser.add_argument("--out", type=Path, default=Path("runs/lost.jsonl"))
    told = parser.parse_args(arguments)
    told.out.parent.mkdir(parents=True, exist_ok=True)
    rows = [HEAD]
    for pair in told.pairs:
        world, _, robot = pair.rpartition("/")
        found = []
        numbers = range(told.first, told.first + told.starts)
        for start in measured(world, robot, numbers, everywhere=not told.believing):
            found.append(start)
            with told.out.open("a", encoding="utf-8") as file:
                file.write(json.dumps(asdict(start)) + "\n")
            print(_line(start), flush=True)
        rows.append(_row(world, robot, found))
    print("\n".join(columns(rows)))
    return 0


def measured(world: str, robot: str, numbers: range, *, everywhere: bool) -> Iterator[Start]:
    """Set the robot down once for each number, in episodes of `STARTS` starts each."""
    for number in numbers:
        seed = EPISODES + number // STARTS
        place, episode = open_rolling(world, robot, seed)
        rolling = place.robot
        assert isinstance(rolling, RollingRobot)
        at = somewhere(episode, rolling.description, seeded(number, "lost", Path(world).stem))
        rolling.carry(at)
        yield _one(place, rolling, Start(Path(world).stem, robot, seed, number, at), everywhere)


def _one(place: ScriptedWorld, rolling: RollingRobot, start: Start, everywhere: bool) -> Start:
    service = LocalizationService()
    began = time.monotonic()
    result = run_skill(
        Relocalize,
        world=place,
        inputs={"everywhere": everywhere},
        services={"localization": service, "planning_scene": PlanningSceneService()},
        seed=start.number,
        max_time=90.0,
    )
    error = rolling.base.inverse() @ service.map_from_base
    off, turned = math.hypot(error.x, error.y), abs(error.yaw)
    verdict = "does not know"
    if result.status == "SUCCESS":
        right = off <= NEAR[0] and turned <= NEAR[1]
        verdict = "right" if right else "sure and wrong"
        verdict = "too late" if right and result.duration > LONGEST else verdict
    return replace(
        start,
        verdict=verdict,
        off=off,
        turned=turned,
        seconds=result.duration,
        touched=rolling.touched,
        ended=result.status if result.failure is None else str(result.failure),
        wall=time.monotonic() - began,
    )


def _line(start: Start) -> str:
    x, y, yaw = start.at.x, start.at.y, start.at.yaw
    return (
        f"{start.world} {start.robot} {start.number:4d} ({x:6.2f}, {y:6.2f}, {yaw:5.2f}) "
        f"{start.verdict:14s} {start.off:6.2f} m {math.degrees(start.turned):5.1f} deg "
        f"{start.seconds:5.1f} s, {start.touched} touched, {start.wall:4.1f} s here; {start.ended}"
    )


def _row(world: str, robot: str, found: list[Start]) -> tuple[str, ...]:
    count = {
        verdict: sum(start.verdict == verdict for start in found)
        for verdict in ("right", "sure and wrong", "does not know", "too late")
    }
    low, high = wilson(count["right"], len(found))
    times = sorted(start.seconds for start in found)
    return (
        Path(world).stem,
        robot,
        f"{count['right']} of {len(found)}",
        f"{100 * low:.1f} % to {100 * high:.1f} %",
        str(count["sure and wrong"]),
        str(count["does not know"]),
        str(count["too late"]),
        f"{statistics.median(times):.1f}",
        f"{times[min(len(times) - 1, int(0.95 * len(times)))]:.1f}",
        f"{sum(start.touched for start in found)}",
    )


if __name__ == "__main__":
    sys.exit(main())
