"""Things that are not cans that stand: a world for each, and how often it is brought.

    python benchmarks/things.py --seeds 0:20                    # all of them, in four_rooms
    python benchmarks/things.py lying_bottle mug_handle --seeds 0:20 --robot kinova_jackal
    python benchmarks/things.py mug_handle --write     # write its world, and say how to run it

Each world is four_rooms with another item, what the robot is told of it, the detector `learned`,
and, for a mug, the part by which it is to be held. Each bench goes on where it was stopped.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from ruamel.yaml import YAML

from momantu_bt.bench.reports.table import columns

BASE = Path("worlds/momantu_worlds/scenes/four_rooms.yaml")
TREE = "trees/bring_object.yaml"
HEAD = (
    "thing",
    "robot",
    "brought",
    "95 % interval",
    "median s",
    "false claims",
    "seeds that failed",
)


@dataclass(frozen=True, slots=True)
class Thing:
    """What is brought. diameter, height: mm. services: tunables beside the detector."""

    kind: str
    diameter: int
    height: int
    mass: float
    color: tuple[float, float, float]
    lying: bool = False
    services: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)

    @property
    def told(self) -> dict[str, str]:
        """The value `object` of the tree."""
        return {
            "category": self.kind,
            "diameter": f"{self.diameter} mm",
            "height": f"{self.height} mm",
        }

    def world(self, name: str) -> dict[str, Any]:
        """The content of its world file."""
        world: dict[str, Any] = YAML(typ="safe").load(BASE)
        world["name"] = name
        item = world["item"]
        world["item"] = {key: item[key] for key in ("on", "at", "shift", "friction")} | {
            "name": "thing",
            "kind": self.kind,
            "radius": f"{self.diameter / 2:g} mm",
            "height": f"{self.height} mm",
            "mass": self.mass,
            "color": list(self.color),
            "lying": self.lying,
        }
        world["goal"] |= {"item": "thing", "lying": self.lying}
        world["site"]["objects"] = {"thing": self.told}
        world["site"]["services"] = {"detect_object": {"detector": "learned"}, **self.services}
        return world


WHITE, GREEN, BLUE = (0.86, 0.85, 0.82), (0.16, 0.42, 0.24), (0.16, 0.42, 0.62)
THINGS = {
    "lying_bottle": Thing("bottle", 66, 230, 0.4, GREEN, lying=True),
    "lying_can": Thing("can", 66, 120, 0.35, BLUE, lying=True),
    "mug": Thing("mug", 82, 92, 0.3, WHITE),
    "mug_handle": Thing("mug", 82, 92, 0.3, WHITE, services={"pick": {"by": "handle"}}),
    "mug_rim": Thing("mug", 84, 92, 0.3, WHITE, services={"pick": {"by": "rim"}}),
    "bowl": Thing("bowl", 150, 62, 0.3, BLUE),
}


def main(arguments: Sequence[str] | None = None) -> int:
    """Write the worlds, bench the tree in each, print a table; the code of a bench that failed."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("things", nargs="*", choices=[*THINGS, []], metavar="THING")
    parser.add_argument("--robot", default="fetch")
    parser.add_argument("--seeds", default="0:20")
    parser.add_argument("--jobs", default="1")
    parser.add_argument("--out", type=Path, default=Path("runs/things"))
    parser.add_argument("--write", action="store_true", help="only write the worlds and values")
    told = parser.parse_args(arguments)
    told.out.mkdir(parents=True, exist_ok=True)
    rows = [HEAD]
    for name in told.things or THINGS:
        run = [TREE, *written(name, told.out), "--robot", told.robot]
        if told.write:
            print("momantu-bt run", *run)
            continue
        folder = told.out / f"{name}-{told.robot}"
        report = folder.with_suffix(".json")
        command = [sys.executable, "-m", "momantu_bt", "bench", *run, "--seeds", told.seeds]
        command += ["--jobs", told.jobs, "--out", str(folder), "--report", str(report)]
        code = subprocess.run(command, check=False).returncode
        if code:
            return code
        rows.append(_row(name, told.robot, json.loads(report.read_text(encoding="utf-8"))))
    if not told.write:
        print("\n".join(columns(rows)))
    return 0


def written(name: str, folder: Path) -> list[str]:
    """Write a thing's world and the values of the tree; the options of a run with them."""
    thing = THINGS[name]
    world, values = folder / f"{name}.yaml", folder / f"{name}.values.yaml"
    YAML().dump(thing.world(name), world)
    YAML().dump({"object": thing.told}, values)
    return ["--world", str(world), "--values", str(values)]


def _row(name: str, robot: str, found: Mapping[str, Any]) -> tuple[str, ...]:
    """One line: how often, how sure, how long, what was claimed wrongly, where it failed."""
    low, high = found["interval"]
    median = found["sim_time_s"]["median"]
    failed = [row["seed"] for row in found["rows"] if not row["success"]]
    return (
        name,
        robot,
        f"{found['successes']} of {found['episodes']}",
        f"{100 * low:.1f} % to {100 * high:.1f} %",
        "-" if median is None else f"{median:.1f}",
        str(sum(claims["false_successes"] for claims in found["claims"].values())),
        " ".join(map(str, sorted(failed))) or "-",
    )


if __name__ == "__main__":
    sys.exit(main())
