"""One tree with several robots in several worlds, on the same seeds, in one table.

    python benchmarks/everywhere.py --seeds 1000:1060 four_rooms/fetch four_rooms/kinova_jackal
    python benchmarks/everywhere.py --seeds 1000:1040 small_flat/fetch warehouse/fetch
    python benchmarks/everywhere.py --seeds 0:20 benchmarks/homes/corners.yaml/fetch

A world is a name or a file. Each pair is a bench of its own (`momantu-bt bench`), so that it goes
on where it was stopped. A world that needs other values than the tree's own has them in
`trees/values/<world>.yaml`.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from momantu_bt.bench.reports.table import columns

VALUES = Path("trees/values")
HEAD = (
    "world",
    "robot",
    "brought",
    "95 % interval",
    "median s",
    "p95 s",
    "false claims",
    "harm",
    "force N",
)


def main(arguments: Sequence[str] | None = None) -> int:
    """Bench each pair, then print the table; the exit code of the first bench that failed."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("pairs", nargs="+", metavar="WORLD/ROBOT", type=_pair)
    parser.add_argument("--seeds", default="1000:1060")
    parser.add_argument("--tree", default="trees/bring_object.yaml")
    parser.add_argument("--jobs", default="2")
    parser.add_argument("--out", type=Path, default=Path("runs/everywhere"))
    told = parser.parse_args(arguments)
    told.out.mkdir(parents=True, exist_ok=True)
    rows = [HEAD]
    for world, robot in told.pairs:
        name = Path(world).stem
        folder = told.out / f"{name}-{robot}"
        report = folder.with_suffix(".json")
        command = [sys.executable, "-m", "momantu_bt", "bench", told.tree, "--seeds", told.seeds]
        command += ["--world", world, "--robot", robot, "--jobs", told.jobs]
        command += ["--out", str(folder), "--report", str(report)]
        if (values := VALUES / f"{name}.yaml").is_file():
            command += ["--values", str(values)]
        code = subprocess.run(command, check=False).returncode
        if code:
            return code
        rows.append(_row(name, robot, json.loads(report.read_text(encoding="utf-8"))))
    print("\n".join(columns(rows)))
    return 0


def _pair(text: str) -> tuple[str, str]:
    world, slash, robot = text.rpartition("/")
    if not (world and slash and robot):
        raise argparse.ArgumentTypeError(f"{text}: expected WORLD/ROBOT, as in four_rooms/fetch")
    return world, robot


def _row(world: str, robot: str, found: dict[str, Any]) -> tuple[str, ...]:
    """One line: how often, how sure, how long, what was claimed wrongly, and what was dangerous."""
    low, high = found["interval"]
    times = found["sim_time_s"]
    false = sum(claims["false_successes"] for claims in found["claims"].values())
    return (
        world,
        robot,
        f"{found['successes']} of {found['episodes']}",
        f"{100 * low:.1f} % to {100 * high:.1f} %",
        *("-" if times[k] is None else f"{times[k]:.1f}" for k in ("median", "p95")),
        str(false),
        str(sum(len(seeds) for seeds in found["incidents"].values())),
        "-" if found["force"] is None else f"{found['force']['largest']:.0f}",
    )


if __name__ == "__main__":
    sys.exit(main())
