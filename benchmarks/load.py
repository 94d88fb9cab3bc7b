"""What reading, checking and building a tree costs, by its size.

    python benchmarks/load.py
    python benchmarks/load.py --nodes 1000 --rounds 20

The trees are of the kind people write, in YAML: subtrees with inputs, recoveries with handlers,
wires, units, scripts and conditions. The demand: 1,000 nodes are loaded and checked in under
0.5 s. The last column is a whole `momantu-bt check FILE` in a process of its own.
"""

from __future__ import annotations

import argparse
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

from momantu_bt.tree.check.checker import check
from momantu_bt.tree.load import load, read_file
from momantu_bt.tree.registry import Registry

STEP = """\
    - navigate: {{in_front_of: $at, side: {number}}}
      timeout: 2 min
      retry: 2
    - detect_object: {{object: $object, on: $at, found: $found{number}}}
    - pick: {{object: $found{number}}}
      skip_if: $count > {number}
    - fallback:
        - condition: $count < {number} and $@robot.gripper_width > 2
        - script: $count := $count + 1
"""
NODES_OF_A_STEP = 9
TREE = """\
  Part{number}:
    inputs: {{object: object_class, at: text, count: int}}
    recover:
      attempts: 3
      try:
{steps}
      catch:
        OBJECT_NOT_FOUND: again
        any: relocalize
"""
STEPS_OF_A_TREE = 10


def tree(nodes: int) -> str:
    """A tree file of about so many nodes."""
    count = max(1, nodes // (NODES_OF_A_STEP * STEPS_OF_A_TREE + 5))
    steps = "".join(STEP.format(number=number) for number in range(STEPS_OF_A_TREE))
    indented = "".join(f"    {line}\n" for line in steps.splitlines())
    parts = [TREE.format(number=number, steps=indented.rstrip()) for number in range(count)]
    call = "    - Part{number}: {{object: $object, at: table_a, count: 1}}\n"
    main = "".join(call.format(number=number) for number in range(count))
    header = "momantu_bt: 1\nworld: four_rooms\nmain: Main\nvalues: {object: {category: can}}\n"
    return f"{header}trees:\n  Main:\n{main}{''.join(parts)}"


def median(work: Callable[[], object], rounds: int) -> float:
    """Seconds of wall time."""
    found = []
    for _ in range(rounds):
        started = time.perf_counter()
        work()
        found.append(time.perf_counter() - started)
    return statistics.median(found)


def measure(nodes: int, rounds: int, folder: Path) -> None:
    """One line of the table."""
    path = folder / f"{nodes}.yaml"
    path.write_text(tree(nodes), encoding="utf-8")
    registry = Registry.installed()
    checked = load(str(path), registry)
    count = sum(1 for each in checked.document.trees.values() for _ in each.root.walk())
    reading = median(lambda: read_file(path), rounds)

    def whole() -> None:
        document, problems = read_file(path)
        check(document, registry, reading=problems)

    both = median(whole, rounds)
    command = [sys.executable, "-m", "momantu_bt", "check", str(path)]
    process = median(lambda: subprocess.run(command, check=True, capture_output=True), 3)
    print(f"{count:6d} {reading:10.3f} {both - reading:10.3f} {both:10.3f} {process:12.2f}")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--nodes", type=int, nargs="+", default=[100, 1000, 2000])
    parser.add_argument("--rounds", type=int, default=5)
    asked = parser.parse_args()
    print("seconds, median")
    print(" nodes       read      check       both      process")
    with tempfile.TemporaryDirectory() as folder:
        for nodes in asked.nodes:
            measure(nodes, asked.rounds, Path(folder))


if __name__ == "__main__":
    main()
