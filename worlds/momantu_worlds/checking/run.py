"""All checks of a world, in the episodes of some seeds."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from pathlib import Path

from momantu_bt.findings import Finding, FindingAtKeys, worst_first
from momantu_bt.formats.places import KeyPath
from momantu_bt.formats.problems import Severity
from momantu_bt.robot import RobotDescription
from momantu_bt.world import WorldError
from momantu_worlds.checking.access import doorways, places, start, surfaces
from momantu_worlds.checking.actors import actors
from momantu_worlds.checking.goals import goals
from momantu_worlds.checking.measures import Measures, measured
from momantu_worlds.checking.overlaps import overlaps
from momantu_worlds.checking.scenario import Scenario
from momantu_worlds.checking.tags import tags
from momantu_worlds.checking.upright import upright
from momantu_worlds.checking.where import Where
from momantu_worlds.checking.zones import zones
from momantu_worlds.scenes.arrange.mesh_files import MeshError
from momantu_worlds.scenes.geometry.bodies import Episode

CHECKS: tuple[Callable[[Scenario], Iterable[FindingAtKeys]], ...] = (
    overlaps,
    start,
    places,
    doorways,
    surfaces,
    zones,
    actors,
    tags,
    upright,
    goals,
)


def check_world(
    path: Path,
    draw: Callable[[int], Episode],
    description: RobotDescription,
    seeds: Sequence[int],
    begun: Callable[[int], None] = lambda seed: None,
) -> list[Finding]:
    """Everything that is wrong with a world for a robot.

    path: the world file. draw: gives the episode of a seed. begun: is told each seed first.

    Raises:
        WorldError: the world file, or a mesh that it names, cannot be read.
    """
    where, robot = Where(path), measured(description)
    remarks = []
    for seed in seeds:
        begun(seed)
        remarks += [(seed, remark) for remark in _of_seed(draw, seed, robot, where.body)]
    return worst_first(_together(remarks, where))


def _of_seed(
    draw: Callable[[int], Episode], seed: int, robot: Measures, place: Callable[[str], KeyPath]
) -> Iterator[FindingAtKeys]:
    try:
        episode = draw(seed)
    except MeshError:
        raise
    except WorldError as error:
        cure = "make room in the world, or let less of it vary"
        yield FindingAtKeys(
            Severity.ERROR,
            "no-episode",
            str(error),
            cure,
            (),
            about=(),
        )
        return
    scenario = Scenario(episode, robot, place)
    for check in CHECKS:
        yield from check(scenario)


def _together(remarks: Iterable[tuple[int, FindingAtKeys]], where: Where) -> Iterator[Finding]:
    """Merge equal findings of several episodes; the message is that of the worst."""
    alike: dict[tuple[str, KeyPath, tuple[str, ...]], list[tuple[int, FindingAtKeys]]] = {}
    for seed, remark in remarks:
        alike.setdefault((remark.code, remark.keys, remark.about), []).append((seed, remark))
    for each in alike.values():
        worst = max((remark for _, remark in each), key=lambda remark: remark.amount)
        yield worst.at(where.at(worst.keys), (seed for seed, _ in each))
