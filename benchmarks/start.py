"""What it takes to start: from a command to its output, and to the robot's first motion.

    python benchmarks/start.py
    python benchmarks/start.py --against ../older --rounds 9
    python benchmarks/start.py --only motion check

help     `momantu-bt --help`
check    `momantu-bt check trees/bring_object.yaml`
show     `momantu-bt show trees/bring_object.yaml`
clock    a run of a tree without a world, to its end
motion   `momantu-bt run trees/bring_object.yaml`, until the end of the first step of the world in
         which the robot moves: a joint by 1 mm or 1 mrad, or the base at 5 cm/s or 5 crad/s

The CPU time of the whole process counts, user and system, on one core; wall times beside it mean
something only on a machine with nothing else to do. Every process is a new one. The first round
warms the caches (files, bytecode, compiled kernels) and does not count; after that the checkouts
take turns, and of all rounds the median counts. A checkout is run with the Python in its own
`.venv`, or else with this one.
"""

from __future__ import annotations

import argparse
import os
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

HERE = Path(__file__).resolve().parents[1]
TREE = "trees/bring_object.yaml"
CLOCK = "momantu_bt: 1\ntrees:\n  Main:\n    - wait: 1 s\n"
MAIN = "import sys; from momantu_bt.cli import main; sys.exit(main())"
MOTION = """
import os, signal, sys
from momantu_bt.cli import main
from momantu_bt.engine.executor import Executor

ticked = Executor.tick
first = []

def tick(run):
    status = ticked(run)
    first.append(run.state)
    moved = abs(run.state.positions - first[0].positions).max() > 1e-3
    if moved or max(abs(run.state.linear), abs(run.state.angular)) > 0.05:
        print("moved", flush=True)
        os.kill(os.getpid(), signal.SIGKILL)
    return status

Executor.tick = tick
sys.exit(main())
"""


@dataclass(frozen=True)
class Cost:
    """Seconds of one process."""

    cpu: float
    wall: float


def commands(clock: Path) -> dict[str, tuple[str, ...]]:
    """What is measured: the program and its arguments."""
    return {
        "help": (MAIN, "--help"),
        "check": (MAIN, "check", TREE),
        "show": (MAIN, "show", TREE),
        "clock": (MAIN, "run", str(clock), "-q"),
        "motion": (MOTION, "run", TREE, "-q"),
    }


def cost(checkout: Path, program: str, *arguments: str) -> Cost:
    """Run one command in a checkout, on one core."""
    own = checkout / ".venv" / "bin" / "python"
    python = str(own) if own.exists() else sys.executable
    environment = dict(os.environ)
    environment.pop("PYTHONDONTWRITEBYTECODE", None)
    core = min(os.sched_getaffinity(0))
    begun = time.perf_counter()
    child = subprocess.Popen(
        [python, "-c", program, *arguments],
        cwd=checkout,
        env=environment,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        preexec_fn=lambda: os.sched_setaffinity(0, {core}),
    )
    assert child.stderr is not None
    said = child.stderr.read()
    _, status, used = os.wait4(child.pid, 0)
    wall = time.perf_counter() - begun
    child.returncode = os.waitstatus_to_exitcode(status)
    wanted = -9 if program is MOTION else 0
    if child.returncode != wanted:
        sys.exit(
            f"{checkout}: {' '.join(arguments)} ended with {child.returncode}\n{said.decode()}"
        )
    return Cost(used.ru_utime + used.ru_stime, wall)


def compare(name: str, command: tuple[str, ...], checkouts: list[Path], rounds: int) -> None:
    """One line of the table."""
    found: dict[Path, list[Cost]] = {checkout: [] for checkout in checkouts}
    for round_ in range(rounds + 1):
        for checkout in checkouts:
            spent = cost(checkout, *command)
            if round_:
                found[checkout].append(spent)
    middle: Callable[[list[float]], float] = statistics.median
    cells = [
        f"{middle([c.cpu for c in costs]):8.3f} {middle([c.wall for c in costs]):8.3f}"
        for costs in found.values()
    ]
    ours, *others = found.values()
    ratios = [
        f"{middle([a.cpu / b.cpu for a, b in zip(ours, other, strict=True)]):10.2f}"
        for other in others
    ]
    print(f"{name:8}", *cells, *ratios, flush=True)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--against", type=Path, nargs="+", default=[], help="other checkouts")
    parser.add_argument("--only", nargs="+", help="some of the measurements")
    parser.add_argument("--rounds", type=int, default=5)
    asked = parser.parse_args()
    checkouts = [HERE, *(each.resolve() for each in asked.against)]
    print("seconds ", *(f"{each.name[-17:]:>17}" for each in checkouts), "  ratio of CPU times")
    print("        ", *("     cpu     wall" for _ in checkouts))
    with tempfile.TemporaryDirectory() as folder:
        clock = Path(folder) / "clock.yaml"
        clock.write_text(CLOCK, encoding="utf-8")
        for name, command in commands(clock).items():
            if asked.only is None or name in asked.only:
                compare(name, command, checkouts, asked.rounds)


if __name__ == "__main__":
    main()
