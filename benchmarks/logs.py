"""How far the way through a public log is from its corrected trajectory, with odometry made wrong.

    python benchmarks/logs.py intel-corrected.log csail-corrected.log --seeds 0:9

The logs are CARMEN's whose FLASER lines have the corrected poses, as those of the Radish collection
that were corrected with GMapping. Drift is added to these: a wrong scale, a bend and noise, drawn
anew for each seed; `--seeds none` leaves them as they are. Off is the root mean square distance to
the corrected trajectory after the two are laid on each other; odometry, how far off the drift is.
Compiled kernels are loaded before the time is taken.
"""

from __future__ import annotations

import argparse
import itertools
import json
import math
import statistics
import sys
import time
from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path

import numpy as np
from momantu_skills.mapping.logs.log import LoggedScan
from momantu_skills.mapping.logs.reading import read_log
from momantu_skills.mapping.survey import Survey

from momantu_bt.bench.reports.table import columns
from momantu_bt.formats.seeds import parse_seeds
from momantu_bt.geometry import Array, Pose2D
from momantu_bt.world import seeded

SCALE, BEND = 0.02, 0.006
"""Standard deviations of the wrong scale, and of the bend in rad per metre."""
SLIP, SKID = 0.03, 0.03
"""Standard deviations of a step's noise, as shares of its way and of its turn."""
TURN = 0.01
"""The same of its turn per metre, rad."""
WARM = 300
"""Scans that are mapped before the time is taken: with them, submaps are searched for loops."""
HEAD = ("log", "scans", "way m", "seeds", "odometry m", "off m", "median", "ms a scan")


@dataclass(frozen=True, slots=True)
class Found:
    """One log with one drift. odometry, off: m rms; milliseconds: of CPU time for a scan."""

    log: str
    seed: int | None
    scans: int
    way: float
    odometry: float
    off: float
    milliseconds: float


def main(arguments: Sequence[str] | None = None) -> int:
    """Map each log with each drift, and print a table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("logs", nargs="+", type=Path)
    parser.add_argument("--seeds", default="0:9", help="of the drifts; none: as it is")
    parser.add_argument("-o", "--out", type=Path, default=Path("runs/logs.jsonl"))
    told = parser.parse_args(arguments)
    told.out.parent.mkdir(parents=True, exist_ok=True)
    seeds: list[int | None] = [None] if told.seeds == "none" else [*parse_seeds(told.seeds)]
    rows: list[Sequence[str]] = [HEAD]
    _warm_up(read_log(told.logs[0]).scans)
    for log in told.logs:
        scans, found = read_log(log).scans, []
        for seed in seeds:
            found.append(mapped(log.stem, scans, seed))
            with told.out.open("a", encoding="utf-8") as file:
                file.write(json.dumps(asdict(found[-1])) + "\n")
            print(found[-1], flush=True)
        rows.append(_row(found))
    print("\n".join(columns(rows)))
    return 0


def _warm_up(scans: Sequence[LoggedScan]) -> None:
    survey = Survey()
    for scan in scans[:WARM]:
        survey.add(scan)
    survey.finished()


def mapped(name: str, scans: Sequence[LoggedScan], seed: int | None) -> Found:
    """Map a log with the drift of a seed."""
    right = [scan.odom_from_base for scan in scans]
    told = right if seed is None else drifted(right, seeded(seed, "drift", name))
    began = time.process_time()
    survey = Survey()
    for scan, pose in zip(scans, told, strict=True):
        survey.add(replace(scan, odom_from_base=pose))
    ended = survey.finished()
    took = time.process_time() - began
    way = sum(map(Pose2D.distance_to, right[:-1], right[1:]))
    poses = [pose for _, pose in ended.trajectory()]
    return Found(
        name, seed, len(scans), way, off(told, right), off(poses, right), 1e3 * took / len(scans)
    )


def drifted(poses: Sequence[Pose2D], random: np.random.Generator) -> list[Pose2D]:
    """A trajectory as an odometry with errors would tell it."""
    scale, bend = 1.0 + SCALE * random.standard_normal(), BEND * random.standard_normal()
    told = [poses[0]]
    for before, after in itertools.pairwise(poses):
        step = before.inverse() @ after
        way, noise = math.hypot(step.x, step.y), random.standard_normal(4)
        turn = bend * way + TURN * way * noise[0] + SKID * abs(step.yaw) * noise[1]
        slip = SLIP * way * noise[2:]
        wrong = Pose2D(scale * step.x + slip[0], scale * step.y + slip[1], step.yaw + turn)
        told.append(told[-1] @ wrong)
    return told


def off(poses: Sequence[Pose2D], right: Sequence[Pose2D]) -> float:
    """Root mean square distance, m, after the one is laid on the other (Horn, Umeyama)."""
    one, other = (np.array([[pose.x, pose.y] for pose in way]) for way in (poses, right))
    return float(np.sqrt(np.mean(np.sum(_laid(one, other) ** 2, axis=1))))


def _laid(one: Array, other: Array) -> Array:
    """What is left between points (n, 2) and others, m, where the first are moved onto them."""
    one, other = one - one.mean(axis=0), other - other.mean(axis=0)
    across = one[:, 0] @ other[:, 1] - one[:, 1] @ other[:, 0]
    yaw = math.atan2(float(across), float((one * other).sum()))
    c, s = math.cos(yaw), math.sin(yaw)
    return np.asarray(one @ np.array([[c, s], [-s, c]]) - other)


def _row(found: Sequence[Found]) -> Sequence[str]:
    first, offs = found[0], [each.off for each in found]
    wrong = [each.odometry for each in found]
    return (
        first.log,
        str(first.scans),
        f"{first.way:.0f}",
        str(len(found)),
        f"{min(wrong):.1f} to {max(wrong):.1f}",
        f"{min(offs):.3f} to {max(offs):.3f}",
        f"{statistics.median(offs):.3f}",
        f"{statistics.mean(each.milliseconds for each in found):.1f}",
    )


if __name__ == "__main__":
    sys.exit(main())
