"""Fuzzing of what reads and checks tree files.

    python benchmarks/fuzz.py
    python benchmarks/fuzz.py --inputs 100000 --seed 0
    python benchmarks/fuzz.py --first 50000 --inputs 50000
    python benchmarks/fuzz.py --first 1234 --inputs 1 --keep /tmp/found

Each input is written to a file that is loaded and checked as `momantu-bt check` does it. A file
may be found good, or refused with its problems; any other exception, more than a second of
processor time (that of this process, so that what else runs on the machine does not count) and more
than 200 MB of further memory are bugs. Inputs depend on the seed and their number alone. The inputs
that show a bug are kept in a folder.
"""

from __future__ import annotations

import argparse
import resource
import signal
import sys
import tempfile
import time
import traceback
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path

from fuzzing.checking import check_file
from fuzzing.good import good_trees
from fuzzing.inputs import Input, Inputs
from fuzzing.words import Words

from momantu_bt.tree.registry import Registry

LONGEST = 1.0
"""Seconds of processor time that one input may take."""
HANGS = 30
"""Seconds of processor time after which an input is given up."""
MOST_MEMORY = 200.0
"""Megabytes by which the peak of memory may grow in the whole run."""
ADDRESSES = 4 << 30
"""Bytes of address space of the process: more is a MemoryError."""


class Hangs(Exception):
    """An input that takes so long that it is given up."""


@dataclass
class Found:
    """What all inputs showed."""

    kinds: Counter[str] = field(default_factory=Counter)
    problems: int = 0
    refused: int = 0
    bugs: list[str] = field(default_factory=list)
    slowest: list[tuple[float, str]] = field(default_factory=list)

    def took(self, seconds: float, what: str) -> None:
        """Keep the slowest ten."""
        self.slowest = sorted([*self.slowest, (seconds, what)], reverse=True)[:10]


def peak() -> float:
    """Megabytes of memory that the process has had at most."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024


def load_plugins(registry: Registry, folder: Path) -> None:
    """Have everything imported that a check imports; that is done once, not by each input."""
    path = folder / "first.yaml"
    path.write_text("momantu_bt: 1\nworld: four_rooms\ntrees: {Main: [relocalize]}\n")
    check_file(path, registry)
    for name in registry.skills:
        registry.skills[name]


def give_up(signum: int, frame: object) -> None:
    raise Hangs


def try_one(one: Input, number: int, folder: Path, registry: Registry, found: Found) -> str | None:
    """Check one input. Returns: what is wrong with that, if anything."""
    path = folder / f"{number}{one.suffix}"
    path.write_bytes(one.data)
    started, before = time.process_time(), peak()
    signal.setitimer(signal.ITIMER_VIRTUAL, HANGS)
    try:
        count = check_file(path, registry)
    except Exception:
        return traceback.format_exc(limit=-6)
    finally:
        signal.setitimer(signal.ITIMER_VIRTUAL, 0)
        path.unlink()
    seconds, grown = time.process_time() - started, peak() - before
    found.kinds[one.kind + one.suffix] += 1
    found.problems += count
    found.refused += count > 0
    found.took(seconds, f"input {number} ({one.kind}{one.suffix}, {len(one.data)} bytes)")
    if seconds > LONGEST:
        return f"took {seconds:.2f} s"
    return f"took {grown:.0f} MB" if grown > MOST_MEMORY else None


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--inputs", type=int, default=100_000)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--keep", type=Path, default=Path(tempfile.gettempdir()) / "fuzz_found")
    asked = parser.parse_args()
    resource.setrlimit(resource.RLIMIT_AS, (ADDRESSES, ADDRESSES))
    signal.signal(signal.SIGVTALRM, give_up)
    registry, found = Registry.installed(), Found()
    inputs = Inputs(asked.seed, good_trees(), Words(registry.skills))
    started = time.perf_counter()
    with tempfile.TemporaryDirectory() as folder:
        load_plugins(registry, Path(folder))
        memory = peak()
        for number in range(asked.first, asked.first + asked.inputs):
            one = inputs.make(number)
            wrong = try_one(one, number, Path(folder), registry, found)
            if wrong is not None:
                asked.keep.mkdir(parents=True, exist_ok=True)
                (asked.keep / f"{number}{one.suffix}").write_bytes(one.data)
                found.bugs.append(f"input {number} ({one.kind}{one.suffix}): {wrong}")
                print(found.bugs[-1], flush=True)
    grown = peak() - memory
    report(found, asked.inputs, time.perf_counter() - started, memory, grown)
    return 1 if found.bugs or grown > MOST_MEMORY else 0


def report(found: Found, inputs: int, seconds: float, memory: float, grown: float) -> None:
    print(f"{inputs} inputs in {seconds:.0f} s: {dict(sorted(found.kinds.items()))}")
    print(f"{found.refused} with problems, {found.problems} problems in all")
    print(f"memory {memory:.0f} MB, at its peak {grown:.0f} MB more")
    print("slowest:")
    for took, what in found.slowest:
        print(f"  {took:.3f} s  {what}")
    print(f"{len(found.bugs)} bugs")


if __name__ == "__main__":
    sys.exit(main())
