"""Whether runs are still the same, bit for bit: their fingerprints beside a table kept on disk.

    python benchmarks/fingerprints.py                      # run all cases, compare with the table
    python benchmarks/fingerprints.py examples             # only cases whose line holds this word
    python benchmarks/fingerprints.py --out mine.json      # write a table instead of comparing
    python benchmarks/fingerprints.py --against mine.json  # compare with a table of your own

The table is fingerprints.json beside this file. A fingerprint holds for one version of the
numerical libraries on one kind of processor: where the table does not fit your machine, write your
own from the commit before your change. A change of structure must leave every line as it was.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import tempfile
from collections.abc import Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

TREES = Path("trees")
TABLE = Path(__file__).with_suffix(".json")
MAIN = "trees/bring_object.yaml"


@dataclass(frozen=True, slots=True)
class Case:
    """One run: a tree in a world with a robot and a seed."""

    tree: str
    world: str
    robot: str
    seed: int

    def __str__(self) -> str:
        return f"{self.tree} {self.world} {self.robot} {self.seed}"

    def command(self, report: Path) -> list[str]:
        """The command line that runs it and writes its report."""
        told = [sys.executable, "-m", "momantu_bt", "run", self.tree, "--unattended"]
        told += ["--world", self.world, "--robot", self.robot, "--seed", str(self.seed)]
        told += ["--report", str(report)]
        values = TREES / "values" / f"{self.world}.yaml"
        return [*told, "--values", str(values)] if values.is_file() else told


def cases() -> list[Case]:
    """Every case: both robots in four_rooms, the other worlds, each example, the plain tree.

    Calibrations are left out: they need a board, or a person.
    """
    found = (path for path in (TREES / "examples").glob("*.yaml") if "calibrate" not in path.name)
    examples = sorted(str(path) for path in found if not path.name.endswith(".faults.yaml"))
    return [
        *(Case(MAIN, "four_rooms", "fetch", seed) for seed in range(10)),
        *(Case(MAIN, "four_rooms", "kinova_jackal", seed) for seed in range(5)),
        *(Case(MAIN, world, "fetch", s) for world in ("small_flat", "warehouse") for s in range(5)),
        *(Case(tree, "four_rooms", "fetch", 0) for tree in examples),
        Case("trees/bring_object_plain.yaml", "four_rooms", "fetch", 0),
    ]


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the cases; 1 when one differs from the table or is not in it."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("words", nargs="*", help="only cases whose line holds one of these")
    parser.add_argument("--out", type=Path, help="write a table here, compare with none")
    parser.add_argument("--against", type=Path, default=TABLE, help="the table to compare with")
    parser.add_argument("--jobs", type=int, default=2, help="runs side by side")
    told = parser.parse_args(arguments)
    wanted = [c for c in cases() if not told.words or any(word in str(c) for word in told.words)]
    known: Mapping[str, str] = {}
    if told.out is None:
        known = json.loads(told.against.read_text(encoding="utf-8"))
    table: dict[str, str] = {}
    differing = 0
    with ThreadPoolExecutor(told.jobs) as pool:
        for case, found in zip(wanted, pool.map(fingerprint, wanted), strict=True):
            table[str(case)] = found
            same = not known or known.get(str(case)) == found
            differing += not same
            print(f"{found}  {case}{'' if same else '  DIFFERS'}", flush=True)
    if told.out is not None:
        told.out.write_text(json.dumps(table, indent=1) + "\n", encoding="utf-8")
    if known:
        print(f"{differing} of {len(table)} differ")
    return int(differing > 0)


def fingerprint(case: Case) -> str:
    """How the run ended and its fingerprint; what went wrong where there was no report."""
    with tempfile.TemporaryDirectory() as folder:
        report = Path(folder) / "report.json"
        ran = subprocess.run(
            case.command(report), stdin=subprocess.DEVNULL, capture_output=True, text=True
        )
        if not report.is_file():
            return f"exit {ran.returncode} without a report: {ran.stderr.strip()[-200:]}"
        found = json.loads(report.read_text(encoding="utf-8"))
    return f"{found['status']} {found['fingerprint']}"


if __name__ == "__main__":
    sys.exit(main())
