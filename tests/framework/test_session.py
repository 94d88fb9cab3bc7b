"""Sessions: the page's code runs, calls do the same as in a tree, and nothing is left moving."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import momantu_bt
from momantu_bt.errors import MomantuError
from momantu_bt.failure import Failure
from momantu_bt.geometry import Pose2D
from momantu_bt.messages import BaseVelocity
from momantu_bt.running.launch import LaunchError
from momantu_bt.session import SessionError
from momantu_bt.skill import In, Needs, Out, Run, Skill
from momantu_bt.testing import ExampleWorld, ScriptedWorld
from momantu_bt.tree.load import TreeError
from momantu_bt.tree.registry import Registry

PAGE = Path(__file__).resolve().parents[2] / "docs" / "notebooks.md"


class Drive(Skill):
    """Drives, and draws a number."""

    steps: int = In(3, doc="how many ticks")
    how: str = In("well", doc="`badly` crashes, `falsely` fails")
    where: Pose2D = In(Pose2D(0.0, 0.0, 0.0), doc="handed on")
    number: float = Out(doc="drawn")
    there: Pose2D = Out(doc="the input")
    failures = {"LOST": "it is told to fail"}
    uses = {"base"}

    def run(self, robot: Any) -> Run:
        for _ in range(self.steps):
            robot.command("base", BaseVelocity(0.5, 0.0))
            yield "driving"
        if self.how == "badly":
            raise KeyboardInterrupt
        if self.how == "falsely":
            raise Failure("LOST", "as told", way=3)
        self.number, self.there = float(self.random.random()), self.where


REGISTRY = Registry(skills={"drive": Drive})


def session(world: Any = None, **options: Any) -> Any:
    return momantu_bt.open_session(world or ScriptedWorld(), registry=REGISTRY, **options)


def moving(world: ScriptedWorld) -> bool:
    for _ in range(20):
        world.step()
    return abs(world.robot.linear) > 1e-9


def test_the_code_of_the_page_runs(monkeypatch: pytest.MonkeyPatch) -> None:
    world, opening = ExampleWorld(3), momantu_bt.open_session

    def example(world_name: str = "", **options: Any) -> Any:
        assert (options.pop("world"), options.pop("robot")) == ("four_rooms", "fetch")
        return opening(world, **options)

    monkeypatch.setattr(momantu_bt, "open_session", example, raising=False)
    scope: dict[str, Any] = {}
    for block in re.findall(r"```python\n(.*?)```", PAGE.read_text("utf-8"), re.DOTALL):
        exec(block, scope)
    assert scope["picture"].dtype == np.uint8
    assert not moving(world)
    with pytest.raises(SessionError, match="closed"):
        scope["session"].tick()


def test_a_call_returns_the_outputs_and_takes_those_of_another() -> None:
    with session() as opened:
        first = opened.call("drive", where={"x": 1, "y": "50 cm", "yaw": 0})
        assert first["there"] == Pose2D(1.0, 0.5, 0.0)
        assert opened.call("drive", where=first["there"])["there"] == first["there"]
        assert opened.robot.state().odom_from_base.position[0] > 0.01


def test_equal_sessions_do_the_same_and_the_seed_counts() -> None:
    def numbers(seed: int) -> list[float]:
        with session(seed=seed) as opened:
            return [opened.call("drive", steps=n)["number"] for n in (1, 2)]

    assert numbers(1) == numbers(1) != numbers(2)


def test_each_call_draws_numbers_of_its_own_in_a_fixed_sequence() -> None:
    def numbers() -> list[float]:
        with session(seed=3) as opened:
            return [opened.call("drive", steps=1)["number"] for _ in range(4)]

    first = numbers()
    assert len(set(first)) == 4
    assert numbers() == first


def test_a_tree_in_a_session_does_what_a_run_does() -> None:
    tree = {"momantu_bt": 1, "trees": {"Main": [{"drive": {"steps": 5, "number": "$n"}}]}}
    report = momantu_bt.run(tree, world=ScriptedWorld(), registry=REGISTRY, seed=4)
    with session(seed=4) as opened:
        opened.load(tree)
        assert opened.run() == "SUCCESS"
        assert opened.values["n"] == report.blackboard["n"]
        assert opened.now == pytest.approx(report.sim_time_s)


def test_a_failure_is_raised_with_its_code_and_data() -> None:
    world = ScriptedWorld()
    with session(world) as opened:
        with pytest.raises(Failure) as failed:
            opened.call("drive", how="falsely")
        assert (failed.value.code, failed.value.value.data["way"]) == ("LOST", 3)
        with pytest.raises(Failure) as slow:
            opened.call("drive", steps=1000, max_time=0.3)
        assert slow.value.code == "TIMEOUT"
        assert not moving(world)
        assert opened.tick() == "IDLE"


def test_whatever_raises_leaves_nothing_moving() -> None:
    world = ScriptedWorld()
    with session(world) as opened:
        opened.load({"momantu_bt": 1, "trees": {"Main": [{"drive": {"steps": 100}}]}})
        for _ in range(10):
            assert opened.tick() == "RUNNING"
        assert world.robot.linear > 0.1

        def broken() -> None:
            raise OSError("the simulator is gone")

        step, world.step = world.step, broken  # type: ignore[method-assign]
        with pytest.raises(OSError, match="simulator"):
            opened.tick()
        world.step = step  # type: ignore[method-assign]
        assert not moving(world)


def test_closing_in_the_middle_stops_the_robot_and_is_safe_twice() -> None:
    world = ScriptedWorld()
    opened = session(world)
    opened.load({"momantu_bt": 1, "trees": {"Main": [{"drive": {"steps": 100}}]}})
    for _ in range(10):
        opened.tick()
    opened.close()
    opened.close()
    assert not moving(world)
    assert not world.closed, "an open world stays open"


@pytest.mark.parametrize(
    ("wrong", "kind", "said"),
    [
        (lambda s: s.call("driv"), TreeError, "did you mean drive?"),
        (lambda s: s.call("drive", step=3), TreeError, "did you mean steps?"),
        (lambda s: s.call("drive", steps=[1]), TreeError, "'steps' of drive"),
        (lambda s: s.load("nothing.yaml"), MomantuError, "there is no file nothing.yaml"),
        (lambda s: s.load(3), MomantuError, "not int"),
        (lambda s: s.picture("hed_camera"), SessionError, "did you mean camera?"),
        (lambda s: s.read("lazer"), SessionError, "did you mean laser?"),
        (lambda s: s.published("battery"), SessionError, "there are no running services"),
    ],
)
def test_what_is_wrong_is_told_and_the_session_goes_on(
    wrong: Any, kind: type[Exception], said: str
) -> None:
    with session() as opened:
        with pytest.raises(kind) as error:
            wrong(opened)
        assert said in str(error.value)
        assert opened.call("drive")["number"] >= 0.0


def test_without_a_world_there_are_trees_and_no_robot() -> None:
    with momantu_bt.open_session(registry=REGISTRY) as opened:
        opened.load("momantu_bt: 1\ntrees: {Main: [{wait: 0.1 s}, {fail: {code: OOPS}}]}")
        assert opened.run() == "FAILURE"
        assert opened.failure.code == "OOPS"
        with pytest.raises(SessionError, match="no robot"):
            opened.state()
        with pytest.raises(LaunchError, match="needs a world"):
            opened.call("drive")


def test_no_such_world() -> None:
    with pytest.raises(TreeError, match="did you mean four_rooms"):
        momantu_bt.open_session("four_room")


class Ask(Skill):
    """Asks a service."""

    count: Any = Needs("counter")
    updates: int = Out(doc="how often it was updated")

    def run(self, robot: Any) -> Run:
        self.updates = self.count.updates
        yield "asking"


class Counter(momantu_bt.Service):
    """Counts its updates, and fails when it is started twice."""

    publishes = {"updates": int}

    def start(self, context: Any) -> None:
        assert not hasattr(self, "updates")
        self.updates = 0

    def update(self, robot: Any, now: float) -> None:
        self.updates += 1

    def published(self) -> dict[str, int]:
        return {"updates": self.updates}


def test_a_service_starts_when_it_is_needed_and_then_runs_on() -> None:
    registry = Registry(skills={"ask_counter": Ask}, services={"counter": Counter})
    with momantu_bt.open_session(ScriptedWorld(), registry=registry) as opened:
        first = opened.call("ask_counter")["updates"]
        opened.tick()
        second = opened.call("ask_counter")["updates"]
        assert second > first
        opened.load("momantu_bt: 1\ntrees: {Main: [{condition: $@counter.updates > 3}]}")
        assert opened.run() == "SUCCESS"
        assert opened.published("counter")["updates"] > second
