"""How often, how fast and how heavy: the main job over many seeds, each in a process of its own.

    python benchmarks/bring_object.py --seeds 0:30
    python benchmarks/bring_object.py --seeds 100:200 --plain 50 --out results

Prints a table with Wilson intervals, a table of what failed, and leaves one report per episode
in the output folder. Episodes that already have a report there are not run again.
"""

from __future__ import annotations

import argparse
import collections
import json
import math
import os
import statistics
import subprocess
import sys
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parent.parent
WATCHDOG = 600.0
"""Seconds of wall time after which an episode counts as hung and is killed."""
CONFIDENCE = 1.959964
"""Two-sided 95 % quantile of the normal distribution."""


@dataclass(frozen=True)
class Episode:
    """One finished process: its report (None when it left none), peak memory in MB, exit code."""

    tree: str
    seed: int
    report: dict[str, Any] | None
    memory: float
    exit_code: int

    @property
    def success(self) -> bool:
        """What the referee said; an episode without a report failed."""
        return bool(self.report and self.report["success"])


def wilson(successes: int, episodes: int) -> tuple[float, float]:
    """95 % interval of a success rate (Wilson 1927)."""
    if episodes == 0:
        return 0.0, 1.0
    rate, z2 = successes / episodes, CONFIDENCE**2 / episodes
    centre = (rate + z2 / 2) / (1 + z2)
    spread = CONFIDENCE * math.sqrt(rate * (1 - rate) / episodes + z2 / (4 * episodes)) / (1 + z2)
    return centre - spread, centre + spread


@dataclass
class _Running:
    tree: str
    seed: int
    process: subprocess.Popen[bytes]
    folder: Path
    started: float


def _start(tree: Path, seed: int, out: Path) -> _Running:
    folder = out / f"{tree.stem}-{seed:04d}"
    folder.mkdir(parents=True, exist_ok=True)
    command = [sys.executable, "-m", "momantu_bt", "run", str(tree), "--seed", str(seed)]
    command += ["--report", str(folder / "report.json")]
    environment = {**os.environ, "OMP_NUM_THREADS": "1", "LP_NUM_THREADS": "1"}
    log = (folder / "output.txt").open("wb")
    process = subprocess.Popen(command, stdout=log, stderr=subprocess.STDOUT, env=environment)
    log.close()
    return _Running(tree.stem, seed, process, folder, time.monotonic())


def _finished(running: _Running) -> Episode | None:
    pid, status, usage = os.wait4(running.process.pid, os.WNOHANG)
    if pid == 0:
        if time.monotonic() - running.started > WATCHDOG:
            running.process.kill()
        return None
    code = os.waitstatus_to_exitcode(status)
    running.process.returncode = code
    (running.folder / "process.json").write_text(
        json.dumps({"exit_code": code, "memory_mb": usage.ru_maxrss / 1024.0})
    )
    return _load(running.tree, running.seed, running.folder)


def _load(tree: str, seed: int, folder: Path) -> Episode | None:
    try:
        process = json.loads((folder / "process.json").read_text())
    except (OSError, ValueError):
        return None
    try:
        report = json.loads((folder / "report.json").read_text())
    except (OSError, ValueError):
        report = None
    return Episode(tree, seed, report, process["memory_mb"], process["exit_code"])


def episodes(jobs: Sequence[tuple[Path, int]], out: Path, processes: int) -> Iterator[Episode]:
    """Run every (tree, seed), `processes` at a time; those with a result in `out` are read."""
    waiting = collections.deque(jobs)
    running: list[_Running] = []
    try:
        while waiting or running:
            while waiting and len(running) < processes:
                tree, seed = waiting.popleft()
                done = _load(tree.stem, seed, out / f"{tree.stem}-{seed:04d}")
                if done is not None:
                    yield done
                else:
                    running.append(_start(tree, seed, out))
            for each in list(running):
                episode = _finished(each)
                if episode is not None:
                    running.remove(each)
                    yield episode
            time.sleep(0.1)
    finally:
        for each in running:
            each.process.kill()


def describe(episode: Episode) -> str:
    """One line: seed, outcome, times, and why it failed."""
    report = episode.report
    if report is None:
        return f"{episode.tree} seed {episode.seed}: no report, exit code {episode.exit_code}"
    outcome = "success" if episode.success else "FAILED "
    line = (
        f"{episode.tree} seed {episode.seed}: {outcome} {report['sim_time_s']:6.1f} s simulated, "
        f"x{report['real_time_factor']:.1f}, {episode.memory:.0f} MB"
    )
    return line if episode.success else f"{line}  {reason(episode)}"


def reason(episode: Episode) -> str:
    """Why it failed: the innermost code of the chain, or what the referee found unmet."""
    report = episode.report
    if report is None:
        return f"exit code {episode.exit_code}"
    failure = report.get("failure")
    if failure:
        codes = []
        while failure:
            codes.append(f"{failure['code']} in {failure['node']}")
            failure = failure.get("cause")
        return codes[-1]
    return "; ".join(report.get("unmet") or [report["status"]])


def table(name: str, rows: Sequence[Episode]) -> str:
    """The figures of one tree as text."""
    good = sum(row.success for row in rows)
    low, high = wilson(good, len(rows))
    reports = [row.report for row in rows if row.report]
    times = [report["sim_time_s"] for report in reports if report["success"]]
    factors = [report["real_time_factor"] for report in reports]
    lines = [
        f"{name}: {good} of {len(rows)} by the referee, 95 % interval {low:.1%} to {high:.1%}",
        f"  simulated time of successes, s: median {_median(times):.1f}, "
        f"longest {max(times, default=math.nan):.1f}",
        f"  real-time factor: median {_median(factors):.2f}, "
        f"least {min(factors, default=math.nan):.2f}",
        f"  peak memory, MB: largest {max((row.memory for row in rows), default=0):.0f}",
    ]
    blame = collections.Counter(reason(row) for row in rows if not row.success)
    lines += [f"  {count} x {why}" for why, count in blame.most_common()]
    return "\n".join(lines)


def _median(values: Sequence[float]) -> float:
    return statistics.median(values) if values else math.nan


def main() -> None:
    """Read the arguments, run, print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seeds", default="0:30", help="first:end, end not included")
    parser.add_argument("--plain", type=int, default=0, help="seeds for the plain tree as well")
    parser.add_argument("--processes", type=int, default=2)
    parser.add_argument("--out", type=Path, default=ROOT / "runs" / "benchmark")
    arguments = parser.parse_args()
    first, end = (int(part) for part in arguments.seeds.split(":"))
    trees = ROOT / "trees"
    jobs = [(trees / "bring_object.yaml", seed) for seed in range(first, end)]
    jobs += [
        (trees / "bring_object_plain.yaml", seed)
        for seed in range(first, min(end, first + arguments.plain))
    ]
    rows = []
    for episode in episodes(jobs, arguments.out, arguments.processes):
        rows.append(episode)
        print(describe(episode), flush=True)
    for name in dict.fromkeys(row.tree for row in rows):
        print("\n" + table(name, [row for row in rows if row.tree == name]))


if __name__ == "__main__":
    main()
