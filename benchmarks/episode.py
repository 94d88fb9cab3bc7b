"""How fast an episode runs: simulated time by CPU time and by wall time, from first tick to last.

    python benchmarks/episode.py
    python benchmarks/episode.py --rounds 5 --beside ../before
    python benchmarks/episode.py --world small_flat --robot kinova_jackal

Each run is a process of its own; start and imports do not count. With `--beside` the same run is
made in turn in another checkout, by the Python in its `.venv`, and the median ratio of the CPU
times is told. CPU time holds on a busy machine; wall time only where nothing else runs. The demand:
on an otherwise idle machine at least 9 s simulated in 1 s of wall time.
"""

from __future__ import annotations

import argparse
import json
import os
import statistics
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

HERE = Path(__file__).resolve().parents[1]
MEASURED = """
import json, sys, time
import momantu_bt.threads
import momantu_bt
from momantu_bt.engine.executor import Executor

run, spent = Executor.run, {}

def measured(*given):
    cpu, wall = time.process_time(), time.perf_counter()
    try:
        return run(*given)
    finally:
        spent.update(cpu=time.process_time() - cpu, wall=time.perf_counter() - wall)

Executor.run = measured
asked = json.loads(sys.argv[1])
report = momantu_bt.run(asked.pop("tree"), **asked)
print(json.dumps({**spent, "simulated": report.sim_time_s, "fingerprint": report.fingerprint}))
"""
ONE_THREAD = {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "LP_NUM_THREADS": "1"}


@dataclass(frozen=True, slots=True)
class Spent:
    """What one run took, s, and its fingerprint."""

    cpu: float
    wall: float
    simulated: float
    fingerprint: str

    def __str__(self) -> str:
        return (
            f"{self.simulated:.1f} s simulated in {self.cpu:.2f} s CPU, {self.wall:.2f} s wall: "
            f"factor {self.simulated / self.cpu:.2f}, {self.simulated / self.wall:.2f}"
        )


def spent(checkout: Path, asked: dict[str, object]) -> Spent:
    """One run in a process of its own."""
    python = sys.executable if checkout == HERE else str(checkout / ".venv/bin/python")
    ran = subprocess.run(
        [python, "-c", MEASURED, json.dumps(asked)],
        check=True,
        cwd=checkout,
        env={**os.environ, **ONE_THREAD},
        stdout=subprocess.PIPE,
        text=True,
    )
    return Spent(**json.loads(ran.stdout.splitlines()[-1]))


def main() -> None:
    """Run the rounds and print the factors."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--tree", default="trees/bring_object.yaml")
    parser.add_argument("--world", help="default: that of the tree")
    parser.add_argument("--robot", help="default: that of the world")
    parser.add_argument("--seed", type=int, default=3)
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--beside", type=Path, help="another checkout, with a .venv of its own")
    told = parser.parse_args()
    asked = {"tree": told.tree, "world": told.world, "robot": told.robot, "seed": told.seed}
    sides = {"here": HERE}
    if told.beside is not None:
        sides["beside"] = told.beside.resolve()
    found: dict[str, list[Spent]] = {side: [] for side in sides}
    for _ in range(told.rounds):
        for side, checkout in sides.items():
            found[side].append(spent(checkout, asked))
            print(f"{side:7} {found[side][-1]}", flush=True)
    for side, runs in found.items():
        cpu = statistics.median(run.simulated / run.cpu for run in runs)
        wall = statistics.median(run.simulated / run.wall for run in runs)
        print(f"median {side}: factor {cpu:.2f} by CPU time, {wall:.2f} by wall time")
    if told.beside is not None:
        pairs = list(zip(found["here"], found["beside"], strict=True))
        ratio = statistics.median(a.cpu / b.cpu for a, b in pairs)
        same = all(a.fingerprint == b.fingerprint for a, b in pairs)
        print(f"CPU time of an episode here / beside: {ratio:.3f}", end="; ")
        print("the runs are the same" if same else "the runs DIFFER")


if __name__ == "__main__":
    main()
