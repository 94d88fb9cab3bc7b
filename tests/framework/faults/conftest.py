from __future__ import annotations

from typing import Any

import pytest

from momantu_bt.geometry import Pose, Transform
from momantu_bt.messages import BaseVelocity
from momantu_bt.running.api import run
from momantu_bt.skill import In, Out, Run, Skill
from momantu_bt.testing import ScriptedWorld
from momantu_bt.tree.registry import Registry


class Drive(Skill):
    """Drives for some ticks."""

    ticks: int = In(10, doc="how many")
    uses = {"base"}

    def run(self, robot) -> Run:
        for number in range(self.ticks):
            robot.command("base", BaseVelocity(0.5, 0.0))
            yield "starting" if number < 3 else "driving"


class Detect(Skill):
    """Sees something, after a thought."""

    seen: Pose = Out(doc="where")
    sizes: tuple[float, ...] = Out(doc="how large")
    count: int = Out(doc="how many")

    def run(self, robot) -> Run:
        yield "looking"
        yield "measuring"
        self.seen = Pose(Transform((1.0, 2.0, 3.0)), "odom", self.clock.now())
        self.sizes, self.count = (0.1, 0.2), 1


class Approach(Skill):
    """Moves by a pose."""

    pose: Pose = In(doc="where to")
    uses = {"base"}

    def run(self, robot) -> Run:
        robot.command("base", BaseVelocity(0.1 * float(self.pose.position[0]), 0.0))
        yield "going"


SKILLS = {"drive": Drive, "detect": Detect, "approach": Approach}


@pytest.fixture
def run_tree(tmp_path):
    """Run a tree written in the test, with the skills above, in a scripted world or another."""

    def start(text: str, *faults: str, world: Any = None, skills: Any = None, **more: Any) -> Any:
        file = tmp_path / "tree.yaml"
        file.write_text(f"momantu_bt: 1\nmain: Main\ntrees:\n{text}", encoding="utf-8")
        registry = Registry(skills={**SKILLS, **(skills or {})})
        place = ScriptedWorld() if world is None else world
        return run(file, world=place, registry=registry, faults=faults, **more)

    return start
