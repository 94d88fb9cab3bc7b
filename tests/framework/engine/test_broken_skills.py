"""Skills that break in every way: the robot stands, the run ends with a report, never with 0."""

from __future__ import annotations

import os
import signal
import sys
from pathlib import Path

import pytest

from momantu_bt.messages import BaseVelocity
from momantu_bt.running.leftovers import no_sudden_exit
from momantu_bt.service import Service
from momantu_bt.skill import Needs, Run, Skill, compute
from momantu_bt.testing import ScriptedWorld
from momantu_bt.world import Verdict


class Odd(BaseException):
    """Of no kind that anybody expects."""


class Mute(Exception):
    """An exception without a text."""

    def __str__(self) -> str:
        raise ValueError("no words")


def _raise(error):
    raise error


def _deeper():
    _deeper()


RAISES = {
    "sys.exit(0)": (lambda: sys.exit(0), "SystemExit: 0"),
    "os._exit(0)": (lambda: os._exit(0), "SystemExit: os._exit(0)"),
    "GeneratorExit": (lambda: _raise(GeneratorExit()), "GeneratorExit"),
    "StopIteration": (lambda: _raise(StopIteration(3)), "RuntimeError: generator raised Stop"),
    "KeyboardInterrupt": (lambda: _raise(KeyboardInterrupt()), "KeyboardInterrupt"),
    "BaseException": (lambda: _raise(Odd("odd")), "Odd: odd"),
    "no text": (lambda: _raise(Mute()), "Mute: its text cannot be made"),
    "recursion": (_deeper, "RecursionError: maximum recursion"),
    "MemoryError": (lambda: _raise(MemoryError()), "MemoryError"),
    "an exception": (lambda: 1 / 0, "ZeroDivisionError: division by zero"),
}
"""What a skill does while it drives, and the words for it."""
ONE = "trees: {Main: [{break_down: {}}]}"


def breaking(act, *, when="drives"):
    """A skill that drives and then calls `act`, in a phase of its life."""

    class BreakDown(Skill):
        """Drives, and breaks."""

        uses = {"base"}

        def __init__(self):
            super().__init__()
            if when == "is made":
                act()

        def run(self, robot) -> Run:
            try:
                for tick in range(8):
                    robot.command("base", BaseVelocity(0.5, 0.0))
                    if tick == 3 and when == "drives":
                        act()
                    if tick == 3 and when == "computes":
                        yield from compute(act, budget=0.1)
                    yield "driving"
            finally:
                if when == "is halted":
                    act()

    return BreakDown


def stands(world):
    """Whether the newest command of the base is a stop, and it does not move."""
    base = [goal for _, name, goal in world.robot.commands if name == "base"]
    return world.robot.linear == 0.0 and base[-1:] in ([], [None])


@pytest.mark.parametrize("when", ["is made", "drives", "computes"])
@pytest.mark.parametrize("how", RAISES)
def test_whatever_a_skill_raises_is_its_failure_and_the_robot_stands(run_yaml, how, when):
    act, words = RAISES[how]
    if when == "is made":
        words = words.replace("RuntimeError: generator raised Stop", "StopIteration")
    world = ScriptedWorld()
    with no_sudden_exit():
        report = run_yaml(ONE, breaking(act, when=when), world=world)
    assert (report.status, report.exit_code) == ("FAILURE", 1)
    assert report.failure.code == "SKILL_ERROR"
    assert words in report.failure.message
    assert stands(world)


@pytest.mark.parametrize("how", sorted(RAISES.keys() - {"GeneratorExit"}))
def test_whatever_a_skill_raises_while_it_is_halted_is_a_remark(run_yaml, how):
    act, words = RAISES[how]
    world = ScriptedWorld()
    text = "trees: {Main: [{timeout: {duration: 0.2 s, child: {break_down: {}}}}]}"
    with no_sudden_exit():
        report = run_yaml(text, breaking(act, when="is halted"), world=world)
    assert (report.status, report.failure.code) == ("FAILURE", "TIMEOUT")
    assert any(words.replace("generator raised Stop", "") in said for said in report.remarks)
    assert stands(world)


def test_the_tree_goes_on_after_a_skill_that_would_end_the_process(run_yaml):
    text = "trees: {Main: {fallback: [{break_down: {}}, {always_success: {}}]}}"
    report = run_yaml(text, breaking(lambda: sys.exit(0)))
    assert (report.status, report.exit_code) == ("SUCCESS", 0)


class Bad(Service):
    """Raises what `error` makes."""

    rate = 20.0
    error: type[BaseException] = SystemExit
    moment = "update"

    def _perhaps(self, moment):
        if moment == self.moment:
            raise self.error(0)

    def start(self, context):
        self._perhaps("start")

    def update(self, robot, now):
        if now > 0.2:
            self._perhaps("update")


class Needing(breaking(lambda: None)):
    """Drives, and needs a service."""

    bad: Bad = Needs()


@pytest.mark.parametrize("moment", ["start", "update"])
@pytest.mark.parametrize("kind", [SystemExit, GeneratorExit, KeyboardInterrupt, Odd, OSError])
def test_whatever_a_service_raises_ends_the_run_with_an_error(run_yaml, kind, moment):
    service = type("Worse", (Bad,), {"error": kind, "moment": moment})
    world = ScriptedWorld()
    report = run_yaml(
        "trees: {Main: [{needing: {}}]}", Needing, world=world, services={"bad": service}
    )
    assert (report.status, report.exit_code) == ("ERROR", 4)
    assert kind.__name__ in report.error
    assert stands(world)


@pytest.mark.parametrize("kind", [SystemExit, Odd])
def test_whatever_the_referee_raises_ends_the_run_with_an_error(run_yaml, kind):
    def judge(robot) -> Verdict:
        raise kind(0)

    world = ScriptedWorld(verdict_of=judge)
    report = run_yaml(ONE, breaking(lambda: None), world=world)
    assert (report.status, report.exit_code) == ("ERROR", 4)
    assert stands(world)


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_a_skill_cannot_take_ctrl_c_away(run_yaml, number):
    def take():
        signal.signal(number, signal.SIG_IGN)

    def press(robot):
        if robot.now() > 0.29:
            os.kill(os.getpid(), number)

    world = ScriptedWorld(on_step=lambda robot: press(robot) if robot.now() < 0.31 else None)
    report = run_yaml(ONE, breaking(take), world=world)
    assert (report.status, report.interrupted_by) == ("INTERRUPTED", number.name)
    assert f"changed {number.name}" in report.remarks[0]
    assert stands(world)


def test_a_low_recursion_limit_does_not_last(run_yaml):
    before = sys.getrecursionlimit()
    text = "trees: {Main: [{break_down: {}}, {break_down: {}}]}"
    report = run_yaml(text, breaking(lambda: sys.setrecursionlimit(before // 4)))
    assert (report.status, sys.getrecursionlimit()) == ("SUCCESS", before)
    assert "the recursion limit" in report.remarks[0]


def test_the_folder_and_the_output_are_as_before_after_a_run(run_yaml, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    out = sys.stdout
    gone = tmp_path / "elsewhere"
    gone.mkdir()

    def change():
        os.chdir(gone)
        sys.stdout = sys.stderr

    report = run_yaml(ONE, breaking(change))
    assert report.status == "SUCCESS"
    assert (Path.cwd(), sys.stdout) == (tmp_path, out)
    assert len(report.remarks) == 2
