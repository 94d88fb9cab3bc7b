"""A tree in Nav2's words, shaped like its default one, drives to where it was sent."""

from collections.abc import Iterator
from typing import cast

import pytest
from momantu_worlds.robots import fetch
from momantu_worlds.simulated_world import SapienWorld
from momantu_worlds.worlds import four_rooms

from momantu_bt import run
from momantu_bt.geometry import Pose2D

TREE = """<root BTCPP_format="4" main_tree_to_execute="Drive">
  <BehaviorTree ID="Drive">
    <RecoveryNode number_of_retries="2">
      <PipelineSequence>
        <PlannerSelector selected_planner="{planner}" default_planner="GridBased"/>
        <RateController hz="2.0">
          <RecoveryNode number_of_retries="1">
            <ComputePathToPose goal="{goal}" path="{path}" planner_id="{planner}"/>
            <ClearEntireCostmap service_name="global"/>
          </RecoveryNode>
        </RateController>
        <RecoveryNode number_of_retries="1">
          <FollowPath path="{path}"/>
          <ClearEntireCostmap service_name="local"/>
        </RecoveryNode>
      </PipelineSequence>
      <ReactiveFallback>
        <GoalUpdated/>
        <RoundRobin>
          <Spin spin_dist="1.57"/>
          <Wait wait_duration="1.0"/>
        </RoundRobin>
      </ReactiveFallback>
    </RecoveryNode>
  </BehaviorTree>
</root>
"""
AHEAD = Pose2D(1.5, 0.3, 0.0)
"""The goal, seen from where the robot believes that it starts, m and rad."""


@pytest.fixture
def world() -> Iterator[SapienWorld]:
    opened = cast(SapienWorld, four_rooms.open(fetch(), 0))
    yield opened
    opened.close()


def test_it_stands_at_its_goal(world: SapienWorld) -> None:
    goal = world.site.start @ AHEAD
    report = run(TREE, world=world, values={"goal": goal}, referee=False, max_time=30.0)
    assert report.status == "SUCCESS", report.failure
    reached = world.simulator.truth.base()
    assert reached.distance_to(goal) < 0.3
    assert abs((goal.inverse() @ reached).yaw) < 0.3
