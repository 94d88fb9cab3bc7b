"""Steps of a tree in the flat world, on a map that the robot makes itself."""

from __future__ import annotations

from typing import Any

from momantu_bt.geometry import Pose, Transform
from momantu_bt.messages import BaseVelocity, SupportPlane
from momantu_bt.robot import Robot
from momantu_bt.skill import Needs, Out, Run, Skill
from momantu_bt.testing import scripted_site
from tests.skills.scenery.flat import DESK, ROOMS, START, FlatRobot

TOP = ((-0.3, -0.6), (0.3, -0.6), (0.3, 0.6), (-0.3, 0.6))
"""Outline of a bench's top, m."""


class Ahead(Skill):
    """Drive ahead for two seconds, on a map of its own."""

    mapping: Any = Needs()
    failures = {}
    uses = {"base"}

    def run(self, robot: Robot) -> Run:
        """Command it."""
        end = self.clock.now() + 2.0
        while self.clock.now() < end:
            robot.command("base", BaseVelocity(0.5, 0.2))
            yield "ahead"


def measured(outline: tuple[tuple[float, float], ...]) -> type[Skill]:
    """A skill that has measured a surface."""

    class Measured(Skill):
        """Give it."""

        plane: SupportPlane = Out(doc="the surface")
        failures = {}

        def run(self, robot: Robot) -> Run:
            """Give it."""
            yield "measured"
            self.plane = SupportPlane(Pose(Transform((2.0, 1.0, 0.7)), "odom", 0.0), outline)

    return Measured


def code(report: Any) -> str:
    return "" if report.failure is None else innermost(report.failure).code


def innermost(failure: Any) -> Any:
    return failure if failure.cause is None else innermost(failure.cause)


def building_of(run_tree: Any) -> Any:
    """`building(steps, **skills)`: a tree's steps in the flat world, on a map of its own."""

    def run(steps: str, **skills: type[Skill]) -> Any:
        robot = FlatRobot(START)
        robot.boxes = [*ROOMS, DESK]
        robot.dead.add("wrench")
        body = "".join(f"    - {step}\n" for step in steps.strip().split("\n"))
        tree = f"momantu_bt: 1\nmain: M\nvalues: {{plane: none}}\ntrees:\n  M:\n{body}"
        site = scripted_site(start=START)
        return run_tree(tree, robot=robot, site=site, skills={"ahead": Ahead, **skills})

    return run
