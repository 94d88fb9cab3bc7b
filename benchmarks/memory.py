"""What episodes leave behind: many of one tree in one process, and its memory after each.

    python benchmarks/memory.py
    python benchmarks/memory.py --tree bring_object_plain --episodes 50 --out memory.jsonl

Resident memory counts, as the kernel tells it, split as it does: anonymous (Python's and native
heaps), of files (libraries), shared (the software renderer's). Between two episodes nothing is
tidied that a program which runs episodes would not tidy either. Growth is from the median of three
episodes around the tenth to that of the last three; the demand is at most 5 % from 10 to 100.
"""

from __future__ import annotations

import argparse
import json
import statistics
from collections.abc import Sequence
from pathlib import Path

import momantu_bt

FIRST = 10
"""Episodes until everything has been loaded, compiled and cached."""
MOST = 5.0
"""Per cent of growth that are allowed."""
PARTS = {"VmRSS": "all", "RssAnon": "heaps", "RssFile": "files", "RssShmem": "shared"}


def resident() -> dict[str, float]:
    """Resident memory of this process in MB, all of it and its parts."""
    lines = Path("/proc/self/status").read_text(encoding="ascii").splitlines()
    told = dict(line.split(":", 1) for line in lines)
    return {name: int(told[key].split()[0]) / 1024.0 for key, name in PARTS.items()}


def growth(memory: Sequence[float], first: int = FIRST) -> float:
    """Per cent from around the `first` episode (counted from 1) to the last ones."""
    early = statistics.median(memory[max(0, first - 2) : first + 1])
    return 100.0 * (statistics.median(memory[-3:]) / early - 1.0)


def main() -> int:
    """Run the episodes; exit code 1 when memory grows more than is allowed."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--tree", default="bring_object")
    parser.add_argument("--episodes", type=int, default=100)
    parser.add_argument("--seed", type=int, default=0, help="of the first episode")
    parser.add_argument("--out", type=Path, help="a JSON object for each episode, added to it")
    given = parser.parse_args()
    if given.episodes <= FIRST + 2:
        parser.error(f"--episodes {given.episodes}: more than {FIRST + 2} are needed for growth")
    memory: list[dict[str, float]] = []
    print("episode  seed  result     all MB  heaps  files  shared")
    for number in range(1, given.episodes + 1):
        seed = given.seed + number - 1
        report = momantu_bt.run(given.tree, seed=seed)
        memory.append(resident())
        row = {"episode": number, "seed": seed, "success": report.success, **memory[-1]}
        result = report.status if report.success is not False else "denied"
        figures = "".join(f"{memory[-1][name]:8.0f}" for name in PARTS.values())
        print(f"{number:7d} {seed:5d}  {result:8s}{figures}", flush=True)
        if given.out is not None:
            with given.out.open("a", encoding="utf-8") as file:
                file.write(json.dumps(row) + "\n")
    for name in PARTS.values():
        part = [each[name] for each in memory]
        if min(part) > 0.0:
            print(f"growth of {name} from {FIRST} to {given.episodes}: {growth(part):+.1f} %")
    return int(growth([each["all"] for each in memory]) > MOST)


if __name__ == "__main__":
    raise SystemExit(main())
