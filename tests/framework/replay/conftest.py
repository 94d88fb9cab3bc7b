"""Runs of the tests' own skills, recorded and read back."""

from __future__ import annotations

from itertools import count

import pytest

from momantu_bt.messages import BaseVelocity
from momantu_bt.record.reader import read_record
from momantu_bt.running.api import run
from momantu_bt.service import Service
from momantu_bt.skill import Failure, In, Needs, Out, Run, Skill
from momantu_bt.testing import ScriptedWorld
from momantu_bt.tree.registry import Registry


class Work(Skill):
    """Does what a text says, a letter a tick: R goes on, S succeeds, F fails."""

    script: str = In("RS", doc="letters")
    to: int = Out(doc="ticks so far", live=True)
    failures = {"OH": "as it was told"}

    def run(self, robot) -> Run:
        for number, letter in enumerate(self.script):
            self.to = number
            if letter == "F":
                raise Failure("OH", f"after {number} ticks", ticks=number)
            if letter == "S":
                return
            yield f"part {number}"


class Odometer(Service):
    """Publishes how far the robot is."""

    rate = 20.0
    publishes = {"x": float}
    x = 0.0

    def start(self, context):
        pass

    def update(self, robot, now):
        self.x = float(robot.state().odom_from_base.position[0])

    def published(self):
        return {"x": self.x}


class Drive(Skill):
    """Drives straight on for some ticks."""

    ticks: int = In(20, doc="how many")
    speed: float = In(1.0, doc="how fast", unit="m/s")
    odometer: Odometer = Needs()
    uses = {"base"}

    def run(self, robot) -> Run:
        for _ in range(self.ticks):
            robot.command("base", BaseVelocity(self.speed, 0.0))
            yield "driving"


REGISTRY = Registry(skills={"work": Work, "drive": Drive}, services={"odometer": Odometer})


@pytest.fixture(scope="session")
def registry():
    return REGISTRY


@pytest.fixture(scope="session")
def recorded(tmp_path_factory):
    """Runs the trees in a text and gives the record."""
    numbers = count()

    def start(text, *, folder=None, **options):
        folder = folder or tmp_path_factory.mktemp(f"run{next(numbers)}")
        file = folder / "tree.yaml"
        file.write_text(f"momantu_bt: 1\nmain: Main\n{text}", encoding="utf-8")
        world = options.pop("world", None) or ScriptedWorld()
        run(file, world=world, registry=REGISTRY, record=folder / "record", **options)
        return read_record(folder / "record")

    return start
