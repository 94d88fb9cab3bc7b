"""What a record costs: CPU time inside the recorder, beside that of the whole run.

    python benchmarks/record.py
    python benchmarks/record.py --seeds 0:5 --pairs 3
    python benchmarks/record.py --tree trees/examples/jobs.yaml --profile

Each run is a process of its own. The first figure is the share of the process's CPU time, start
and imports included, that passes inside the recorder; the second is that of the run alone, from
the first tick to the last. With `--pairs` each seed is also run without a record and with one in
turn, and the median ratio of the two CPU times is told. The demand: at most 2 %.
"""

from __future__ import annotations

import argparse
import cProfile
import json
import os
import pstats
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

ONE_THREAD = {"OMP_NUM_THREADS": "1", "LP_NUM_THREADS": "1"}
MEASURED = ("begin", "ticked", "finish")


def episode(tree: str, seed: int, folder: Path | None, profile: bool) -> dict[str, Any]:
    """Run once in this process; CPU seconds."""
    import momantu_bt
    from momantu_bt.record.recorder import Recorder

    inside = [0.0]
    profiler = cProfile.Profile(time.process_time) if profile else None

    def timed(work: Callable[..., None]) -> Callable[..., None]:
        def measured(*arguments: Any) -> None:
            if profiler is not None:
                profiler.enable()
            started = time.process_time()
            work(*arguments)
            inside[0] += time.process_time() - started
            if profiler is not None:
                profiler.disable()

        return measured

    for name in MEASURED:
        setattr(Recorder, name, timed(getattr(Recorder, name)))
    ticking = [0.0]

    def watch(run: Any) -> tuple[()]:
        ticking[0] = time.process_time()
        return ()

    report = momantu_bt.run(tree, seed=seed, record=folder, watch=watch)
    whole = time.process_time()
    if profiler is not None:
        pstats.Stats(profiler).sort_stats("tottime").print_stats(25)
    return {
        "inside": inside[0],
        "whole": whole,
        "run": whole - ticking[0],
        "ticks": report.ticks,
        "fingerprint": report.fingerprint,
    }


def measure(asked: argparse.Namespace, seed: int, *, record: bool) -> dict[str, Any]:
    """The same in a process of its own."""
    command = [sys.executable, __file__, "--tree", asked.tree, "--one", str(seed)]
    command += ["--recorded"] if record else []
    command += ["--profile"] if asked.profile else []
    environment = {**os.environ, **ONE_THREAD}
    done = subprocess.run(command, check=True, capture_output=True, text=True, env=environment)
    *rest, last = done.stdout.splitlines()
    if asked.profile:
        print("\n".join(rest))
    found: dict[str, Any] = json.loads(last)
    return found


def line(seed: int, found: dict[str, Any]) -> str:
    inside, whole, run = found["inside"], found["whole"], found["run"]
    return (
        f"seed {seed}: {inside:.3f} s of {whole:.2f} s ({inside / whole:.2%}), of the run alone "
        f"{run:.2f} s ({inside / run:.2%}); {found['bytes'] / 1e6:.2f} MB, {found['ticks']} ticks"
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--tree", default="bring_object")
    parser.add_argument("--seeds", default="0:3", help="first:end, end not included")
    parser.add_argument("--pairs", type=int, default=0, help="runs with and without, per seed")
    parser.add_argument("--profile", action="store_true", help="print where the time goes")
    parser.add_argument("--one", type=int, help=argparse.SUPPRESS)
    parser.add_argument("--recorded", action="store_true", help=argparse.SUPPRESS)
    asked = parser.parse_args()
    if asked.one is not None:
        with tempfile.TemporaryDirectory() as folder:
            place = Path(folder) / "record" if asked.recorded else None
            found = episode(asked.tree, asked.one, place, asked.profile)
            found["bytes"] = (place / "run.mcap").stat().st_size if place is not None else 0
        print(json.dumps(found))
        return
    first, end = (int(part) for part in asked.seeds.split(":"))
    shares, ratios = [], []
    for seed in range(first, end):
        found = measure(asked, seed, record=True)
        shares.append(found["inside"] / found["whole"])
        print(line(seed, found), flush=True)
        for _ in range(asked.pairs):
            without = measure(asked, seed, record=False)
            recorded = measure(asked, seed, record=True)
            assert without["fingerprint"] == recorded["fingerprint"]
            ratios.append(recorded["run"] / without["run"])
            print(f"  with {recorded['run']:.2f} s, without {without['run']:.2f} s", flush=True)
    print(f"share inside the recorder: median {statistics.median(shares):.2%}")
    if ratios:
        print(f"CPU time with a record / without: median {statistics.median(ratios):.4f}")


if __name__ == "__main__":
    main()
