"""How often the main job works among people who walk about, and whether anybody is pushed.

    python benchmarks/people.py four_rooms/fetch --walkers 2 4 --seeds 0:50 -o runs/people

Walkers are added to the world's file: each goes between stops all over the building, and two of
four in a group. Seeds that the folder has already are not run again. pushed is the largest force
on anybody while the robot moved, met while it stood: somebody walked into it.
"""

from __future__ import annotations

import argparse
import json
import statistics
import sys
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

from momantu_worlds.scenes.loading import world_path

import momantu_bt
from momantu_bt.bench.reports.table import columns
from momantu_bt.bench.statistics.intervals import wilson
from momantu_bt.formats.seeds import parse_seeds

TREE = "trees/bring_object.yaml"
CROWDS = {
    "four_rooms": {
        2: "anna: {stops: [[-6, -3], [4.5, 0.3], [-5.2, 4.2], [-0.4, -3]]}\n"
        "  ben: {stops: [[-9, 0.4], [-1, -2.2], [7, 0.4], [-6.5, 5]]}",
        4: "anna: {stops: [[-6, -3], [4.5, 0.3], [-5.2, 4.2], [-0.4, -3]]}\n"
        "  ben: {stops: [[-9, 0.4], [-1, -2.2], [7, 0.4], [-6.5, 5]]}\n"
        "  visitors: {stops: [[-9, 0.4], [7, 0.4], [-5.2, -2.5], [-5.5, 3.6]], group: 2}",
    }
}
"""Stops lie where the main job leads: rooms, doors, the corridor."""
HEAD = ("walkers", "brought", "95 % interval", "median s", "largest s", "pushed N", "met N", "harm")


@dataclass(frozen=True, slots=True)
class Episode:
    """One run. why: the failure's code or what the referee misses; pushed, met: N."""

    seed: int
    brought: bool
    why: str
    seconds: float
    pushed: float
    met: float
    incidents: tuple[str, ...]


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the seeds with each number of walkers, and print a table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("pair", metavar="WORLD/ROBOT")
    parser.add_argument("--walkers", type=int, nargs="+", default=[2, 4])
    parser.add_argument("--seeds", default="0:50")
    parser.add_argument("-o", "--out", type=Path, default=Path("runs/people"))
    told = parser.parse_args(arguments)
    world, _, robot = told.pair.partition("/")
    rows: list[Sequence[str]] = [HEAD]
    for walkers in told.walkers:
        file = crowded(world, walkers, told.out / f"{world}_{walkers}.yaml")
        kept = told.out / f"{world}_{walkers}_{robot}.jsonl"
        found = {each.seed: each for each in _read(kept)}
        for seed in parse_seeds(told.seeds):
            if seed not in found:
                found[seed] = episode(file, robot, seed)
                with kept.open("a", encoding="utf-8") as lines:
                    lines.write(json.dumps(asdict(found[seed])) + "\n")
            print(walkers, found[seed], flush=True)
        rows.append(_row(walkers, [found[seed] for seed in parse_seeds(told.seeds)]))
    print("\n".join(columns(rows)))
    return 0


def crowded(world: str, walkers: int, file: Path) -> Path:
    """The world's file with walkers in it; 0: as it is."""
    text = world_path(world).read_text(encoding="utf-8")
    file.parent.mkdir(parents=True, exist_ok=True)
    actors = f"\nactors:\n  {CROWDS[world][walkers]}\n" if walkers else ""
    file.write_text(text.replace(f"name: {world}", f"name: {file.stem}", 1) + actors)
    return file


def episode(file: Path, robot: str, seed: int) -> Episode:
    """The main job once."""
    report = momantu_bt.run(Path(TREE), world=str(file), robot=robot, seed=seed)
    failure = "" if report.failure is None else f"{report.failure.code}: {report.failure.message}"
    return Episode(
        seed,
        bool(report.success),
        failure or "; ".join(report.unmet) or report.error or "",
        report.sim_time_s,
        report.measures.get("person_pushed", 0.0),
        report.measures.get("person_met", 0.0),
        tuple(f"{each.time:.1f} s: {each.sentence}" for each in report.incidents),
    )


def _read(file: Path) -> list[Episode]:
    if not file.exists():
        return []
    return [Episode(**json.loads(line)) for line in file.read_text(encoding="utf-8").splitlines()]


def _row(walkers: int, found: list[Episode]) -> Sequence[str]:
    brought = [each for each in found if each.brought]
    low, high = wilson(len(brought), len(found))
    times = [each.seconds for each in brought] or [float("nan")]
    return (
        str(walkers),
        f"{len(brought)} of {len(found)}",
        f"{100 * low:.1f} % to {100 * high:.1f} %",
        f"{statistics.median(times):.1f}",
        f"{max(times):.1f}",
        f"{max(each.pushed for each in found):.0f}",
        f"{max(each.met for each in found):.0f}",
        str(sum(len(each.incidents) for each in found)),
    )


if __name__ == "__main__":
    sys.exit(main())
