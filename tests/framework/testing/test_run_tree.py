"""The fixture `run_tree`, and `momantu_bt.run` that it stands on."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

import momantu_bt
from momantu_bt import Failure, In, Out, Report, Robot, Run, Skill
from momantu_bt.geometry import Pose2D
from momantu_bt.messages import BaseVelocity
from momantu_bt.pytest_plugin import RunTree
from momantu_bt.testing import ScriptedRobot, ScriptedWorld, scripted_site
from momantu_bt.tree.problems import TreeError
from momantu_bt.tree.registry import Registry


class Roll(Skill):
    """Roll a little, by chance how fast."""

    distance: float = In(unit="m", doc="how far")
    speed: float = Out(doc="how fast")
    failures = {"NO_WAY": "there is no way of that length"}
    uses = {"base"}

    def run(self, robot: Robot) -> Run:
        if self.distance > 3.0:
            raise Failure("NO_WAY", "too far")
        self.speed = 0.2 + 0.2 * self.random.random()
        while float(robot.state().odom_from_base.position[0]) < self.distance:
            robot.command("base", BaseVelocity(self.speed, 0.0))
            yield "rolling"


YAML = """
momantu_bt: 1
trees:
  Main:
    - roll: {distance: $way, speed: $fast}
values: {way: 20 cm}
"""
NO_WORLD = "momantu_bt: 1\ntrees: {Main: [{set: {key: $n, value: 2}}, succeed]}\n"


@pytest.mark.parametrize("spelling", ["text", "path", "name"])
def test_a_text_a_path_or_a_name(run_tree: RunTree, tmp_path: Path, spelling: str) -> None:
    file = tmp_path / "mine.yaml"
    file.write_text(YAML, encoding="utf-8")
    given = {"text": YAML, "path": file, "name": str(file)}[spelling]
    report = run_tree(given, skills={"roll": Roll})
    assert isinstance(report, Report)
    assert report.status == "SUCCESS"
    assert 0.2 <= report.blackboard["fast"] <= 0.4


def test_values_robot_and_site(run_tree: RunTree) -> None:
    robot = ScriptedRobot(base=Pose2D(0.3, 0.0, 0.0))
    report = run_tree(YAML, skills={"roll": Roll}, robot=robot, site=scripted_site(places={}))
    assert report.ticks == 1
    report = run_tree(YAML, skills={"roll": Roll}, values={"way": 5.0})
    assert report.status == "FAILURE"
    assert report.failure is not None
    assert report.failure.code == "NO_WAY"


def test_the_seed_decides(run_tree: RunTree) -> None:
    prints = [run_tree(YAML, skills={"roll": Roll}, seed=seed).fingerprint for seed in (1, 2, 1)]
    assert prints[0] == prints[2] != prints[1]


def test_a_world_of_ones_own(run_tree: RunTree) -> None:
    world = ScriptedWorld()
    run_tree(YAML, skills={"roll": Roll}, world=world)
    assert world.robot.commands
    assert not world.closed


def test_a_wrong_tree_is_told(run_tree: RunTree) -> None:
    with pytest.raises(TreeError, match="roll"):
        run_tree(YAML, skills={"rolle": Roll})


def test_max_time_ends_it(run_tree: RunTree) -> None:
    report = run_tree(YAML, skills={"roll": Roll}, max_time=0.2)
    assert report.failure is not None
    assert report.failure.code == "TIMEOUT"


def test_run_returns_the_report_and_writes_it(tmp_path: Path) -> None:
    file = tmp_path / "mine.yaml"
    file.write_text(YAML, encoding="utf-8")
    out = tmp_path / "report.json"
    report = momantu_bt.run(
        file,
        world=ScriptedWorld(),
        seed=4,
        values={"way": 0.1},
        registry=Registry(skills={"roll": Roll}),
        report=out,
    )
    assert (report.status, report.seed, report.world) == ("SUCCESS", 4, "scripted")
    assert report.nodes
    assert json.loads(out.read_text(encoding="utf-8"))["fingerprint"] == report.fingerprint


def test_run_without_a_world(tmp_path: Path) -> None:
    file = tmp_path / "mine.yaml"
    file.write_text(NO_WORLD, encoding="utf-8")
    report = momantu_bt.run(file, world="none")
    assert report.status == "SUCCESS"
    assert report.blackboard["n"] == 2
    assert report.robot is None
