"""However a run ends, its end waits until the robot is measured to stand still."""

from __future__ import annotations

import os
import signal

import pytest

from momantu_bt.engine.executor import LONGEST_SETTLE, SETTLE
from momantu_bt.engine.standstill import WINDOW, Standstill
from momantu_bt.failure import Failure
from momantu_bt.geometry import Pose2D
from momantu_bt.messages import BaseVelocity, GripperCommand
from momantu_bt.service import Service
from momantu_bt.skill import Needs, Run, Skill
from momantu_bt.testing import ScriptedRobot, ScriptedWorld, small_robot
from momantu_bt.world import TICK, Verdict

BRAKING = 4.0
"""How long the heavy base brakes, s."""


def heavy() -> ScriptedRobot:
    """A robot whose base needs BRAKING to stop from 0.6 m/s."""
    description = small_robot()
    base = description.base.model_copy(update={"linear_acceleration": 0.6 / BRAKING})
    return ScriptedRobot(description.model_copy(update={"base": base}))


class Rolling(Service):
    """Breaks as soon as the base is fast."""

    broken = False

    def start(self, context):
        pass

    def update(self, robot, now):
        if self.broken and robot.state().linear > 0.55:
            raise RuntimeError("the service breaks")


class Drive(Skill):
    """Accelerates, then ends in one of several ways."""

    rolling: Rolling = Needs()
    how = "success"
    failures = {"ENOUGH": "it is fast"}
    uses = {"base", "gripper"}

    def run(self, robot) -> Run:
        while robot.state().linear < 0.59:
            robot.command("base", BaseVelocity(0.6, 0.0))
            yield "driving"
        if self.how == "failure":
            raise Failure("ENOUGH", "it is fast")
        if self.how == "crash":
            raise ZeroDivisionError("by zero")
        if self.how == "interrupt":
            os.kill(os.getpid(), signal.SIGINT)
        while self.how != "success":
            robot.command("base", BaseVelocity(0.6, 0.0))
            yield "driving"


ENDS = {
    "success": "SUCCESS",
    "failure": "FAILURE",
    "crash": "FAILURE",
    "too long": "FAILURE",
    "interrupt": "INTERRUPTED",
    "service": "ERROR",
}


@pytest.mark.parametrize("how", ENDS)
def test_a_run_ends_with_the_robot_at_rest_however_it_ends(run_yaml, monkeypatch, how):
    monkeypatch.setattr(Drive, "how", how)
    monkeypatch.setattr(Rolling, "broken", how == "service")
    speeds = []

    def judged(robot):
        speeds.append(robot.linear)
        return Verdict(True, "", ())

    world = ScriptedWorld(heavy(), verdict_of=judged)
    report = run_yaml(
        "trees: {Main: [drive]}", Drive, services={"rolling": Rolling}, world=world, max_time=8.0
    )
    assert report.status == ENDS[how]
    assert world.robot.linear == 0.0
    assert speeds == ([] if how == "service" else [0.0])
    after = world.now() - report.sim_time_s
    assert BRAKING - 2 * TICK < after < BRAKING + WINDOW + 2 * TICK


def test_a_closing_gripper_is_waited_for(run_yaml, monkeypatch):
    class Close(Skill):
        """Starts to close the hand and ends at once."""

        uses = {"gripper"}

        def run(self, robot) -> Run:
            robot.command("gripper", GripperCommand(0.0, 20.0))
            yield "closing"

    monkeypatch.setattr("momantu_bt.testing.robot.GRIPPER_SPEED", 0.03)
    world = ScriptedWorld()
    widest = world.robot.gripper_width
    report = run_yaml("trees: {Main: [close]}", Close, world=world)
    assert world.robot.gripper_width == 0.0
    assert world.now() - report.sim_time_s > max(SETTLE, widest / 0.03)


def test_a_robot_that_never_stops_is_told_after_a_bounded_time(run_yaml):
    def creep(robot):
        robot.base = Pose2D(robot.base.x + 0.02 * TICK, 0.0)

    world = ScriptedWorld(on_step=creep)
    report = run_yaml("trees: {Main: [succeed]}", world=world)
    assert world.now() - report.sim_time_s == pytest.approx(LONGEST_SETTLE)
    assert [r for r in report.remarks if "the base still moves" in r]
    stops = [t for t, actuator, goal in world.robot.commands if actuator == "base" and goal is None]
    assert len(stops) > 100, "it is told to stop again and again"


def test_standing_still_takes_a_whole_window():
    robot, standstill = ScriptedRobot(), Standstill()
    for _ in range(round(WINDOW / TICK)):
        assert not standstill.still
        standstill.add(robot.state())
        robot.advance(TICK)
    standstill.add(robot.state())
    assert standstill.still
    robot.gripper_width -= 0.004
    robot.advance(TICK)
    standstill.add(robot.state())
    assert standstill.moving == "the gripper"
