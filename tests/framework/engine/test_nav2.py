"""Nav2's nodes in whole runs: with a robot that drives, with changing goals, in Nav2's own tree."""

from __future__ import annotations

import pytest

from momantu_bt.failure import Failure
from momantu_bt.messages import BaseVelocity
from momantu_bt.running.api import run
from momantu_bt.skill import In, Out, Run, Skill
from momantu_bt.testing import ScriptedRobot, ScriptedWorld
from momantu_bt.tree.registry import Registry


class Drive(Skill):
    """Drives straight on for some ticks."""

    ticks: int = In(40, doc="how many")
    speed: float = In(1.0, doc="how fast", unit="m/s")
    uses = {"base"}

    def run(self, robot) -> Run:
        for _ in range(self.ticks):
            robot.command("base", BaseVelocity(self.speed, 0.0))
            yield "driving"


def counting(decorator, drive="drive"):
    """Drive, and count how often a decorator starts its child meanwhile."""
    return f"""
values: {{n: 0}}
trees:
  Main:
    - parallel:
        success_count: 1
        children:
          - {drive}
          - keep_running_until_failure:
              child:
                pipeline_sequence:
                  - script: $n += 1
                    {decorator}
                  - repeat: {{cycles: -1, child: succeed}}
"""


@pytest.mark.parametrize(("distance", "starts"), [(0.5, 3), (1.0, 2), (5.0, 1)])
def test_a_distance_controller_starts_its_child_each_time_the_way_is_long_enough(
    run_yaml, distance, starts
):
    robot = ScriptedRobot()
    report = run_yaml(
        counting(f"distance_controller: {distance}"), Drive, world=ScriptedWorld(robot)
    )
    assert 1.4 < robot.base.x < 2.1
    assert report.blackboard["n"] == starts


def test_a_frame_that_nobody_knows_fails_with_its_code(run_yaml):
    text = counting("distance_controller: {distance: 1, global_frame: map}")
    report = run_yaml(text, Drive)
    assert report.failure.code == "FRAME_UNKNOWN"


def test_a_speed_controller_starts_its_child_the_more_often_the_faster_the_robot_drives(run_yaml):
    rates = "speed_controller: {min_rate: 1, max_rate: 5, min_speed: 0, max_speed: 1}"
    texts = [counting(rates, f"drive: {{speed: {speed}}}") for speed in (0.0, 0.3, 1.0)]
    still, slow, fast = (run_yaml(text, Drive).blackboard["n"] for text in texts)
    assert still == 3  # at 0 s, after the shortest period of 0.2 s and the longest of 1 s
    assert still < slow < fast < 11


class ComputePath(Skill):
    """Finds a path to the goal, where there is one."""

    goal: object = In(doc="where to")
    path: tuple[int, ...] = Out(doc="the path")
    failures = {"NO_VALID_PATH": "there is none"}
    calls: list[object] = []
    broken = 0

    def run(self, robot) -> Run:
        yield "planning"
        ComputePath.calls.append(self.goal)
        if len(ComputePath.calls) <= ComputePath.broken:
            raise Failure("NO_VALID_PATH", "blocked")
        self.path = (1, 2)


class FollowPath(Skill):
    """Follows a path for two seconds."""

    path: tuple[int, ...] = In(doc="the path", live=True)

    def run(self, robot) -> Run:
        for _ in range(40):
            yield "following"


class ClearCostmap(Skill):
    """Forgets the obstacles."""

    cleared = 0

    def run(self, robot) -> Run:
        ClearCostmap.cleared += 1
        yield "clearing"


class Spin(Skill):
    """Turns on the spot."""

    turns = 0

    def run(self, robot) -> Run:
        Spin.turns += 1
        yield "spinning"


NAVIGATE = """
values: {goal: 7}
trees:
  Main:
    recovery_node:
      number_of_retries: 6
      children:
        - pipeline_sequence:
            - recovery_node:
                number_of_retries: 1
                children:
                  - compute_path: {goal: $goal, path: $path}
                  - clear_costmap
              rate_controller: 1 Hz
            - recovery_node:
                number_of_retries: 1
                children:
                  - follow_path: $path
                  - clear_costmap
        - reactive_fallback:
            - goal_updated
            - round_robin:
                - clear_costmap
                - spin
                - wait: 0.1 s
"""


@pytest.fixture(autouse=True)
def _anew():
    ComputePath.calls, ComputePath.broken = [], 0
    ClearCostmap.cleared = Spin.turns = 0


def navigated(run_yaml):
    return run_yaml(NAVIGATE, ComputePath, FollowPath, ClearCostmap, Spin)


def test_nav2s_tree_follows_a_path_and_plans_anew_once_a_second(run_yaml):
    report = navigated(run_yaml)
    assert report.status == "SUCCESS"
    assert len(ComputePath.calls) == 2
    assert (ClearCostmap.cleared, Spin.turns) == (0, 0)


def test_nav2s_tree_recovers_in_turn_and_goes_on(run_yaml):
    ComputePath.broken = 5
    report = navigated(run_yaml)
    assert report.status == "SUCCESS"
    # each try plans twice, with a clearing in between; the recoveries in turn clear and spin
    assert (ClearCostmap.cleared, Spin.turns) == (3 + 1, 1)


def test_nav2s_tree_gives_up_after_its_retries_with_the_planners_failure(run_yaml):
    ComputePath.broken = 99
    report = navigated(run_yaml)
    assert report.status == "FAILURE"
    assert report.failure.code == "NO_VALID_PATH"
    assert len(ComputePath.calls) == 7 * 2
    assert report.failure.most_tries == 7


NAVIGATE_XML = """<root BTCPP_format="4" main_tree_to_execute="MainTree">
  <BehaviorTree ID="MainTree">
    <RecoveryNode number_of_retries="6" name="NavigateRecovery">
      <PipelineSequence name="NavigateWithReplanning">
        <RateController hz="1.0">
          <RecoveryNode number_of_retries="1" name="ComputePathToPose">
            <ComputePathToPose goal="{goal}" path="{path}" error_code_id="{compute_path_error}"/>
            <ClearEntireCostmap service_name="global_costmap/clear"/>
          </RecoveryNode>
        </RateController>
        <RecoveryNode number_of_retries="1" name="FollowPath">
          <FollowPath path="{path}"/>
          <ClearEntireCostmap service_name="local_costmap/clear"/>
        </RecoveryNode>
      </PipelineSequence>
      <ReactiveFallback name="RecoveryFallback">
        <GoalUpdated goals="{goals}" goal="{goal}"/>
        <RoundRobin name="RecoveryActions">
          <Sequence name="ClearingActions">
            <ClearEntireCostmap name="ClearLocalCostmap" service_name="local_costmap/clear"/>
          </Sequence>
          <Spin spin_dist="1.57"/>
        </RoundRobin>
      </ReactiveFallback>
    </RecoveryNode>
  </BehaviorTree>
</root>
"""


class ComputePathToPose(ComputePath):
    """Says, too, what went wrong."""

    error_code_id: int = Out(doc="0 for nothing")

    def run(self, robot) -> Run:
        yield from super().run(robot)
        self.error_code_id = 0


class ClearEntireCostmap(ClearCostmap):
    """Of one service."""

    service_name: str = In(doc="which")


class SpinAround(Spin):
    """By an angle."""

    spin_dist: float = In(doc="how far", unit="rad")


def test_nav2s_tree_in_xml_loads_and_runs_once_its_leaves_are_registered(tmp_path):
    file = tmp_path / "navigate.xml"
    file.write_text(NAVIGATE_XML, encoding="utf-8")
    leaves = (ComputePathToPose, ClearEntireCostmap, FollowPath)
    registry = Registry(skills={"Spin": SpinAround} | {leaf.__name__: leaf for leaf in leaves})
    ComputePath.broken = 3
    report = run(file, world=ScriptedWorld(), registry=registry, values={"goal": 7})
    assert report.status == "SUCCESS"
    assert ComputePath.calls == [7] * len(ComputePath.calls)
    # twice two plans with a clearing between, a clearing to recover, a third try that succeeds
    assert (len(ComputePath.calls), ClearCostmap.cleared, Spin.turns) == (5, 3, 0)
