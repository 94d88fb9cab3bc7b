"""Nav2's leaves on the blackboard: selectors, error codes, timers, paths and lists of goals."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from momantu_bt.engine.build import build
from momantu_bt.engine.context import RunContext
from momantu_bt.engine.outside import Outside
from momantu_bt.engine.status import SUCCESS
from momantu_bt.geometry import Pose2D
from momantu_bt.messages import TrackingFeedback
from momantu_bt.running.api import run
from momantu_bt.skill import In, Out, Run, Skill
from momantu_bt.testing import ManualClock, ScriptedWorld
from momantu_bt.tree.load import load
from momantu_bt.tree.registry import Registry

LINE = tuple(Pose2D(0.5 * k, 0.0, 0.0) for k in range(9))
"""A path of 4 m along x."""


class Show(Skill):
    """Remember what came in."""

    value: Any = In(None, may_be_empty=True, doc="anything")
    seen: list[Any] = []

    def run(self, robot) -> Run:
        Show.seen.append(self.value)
        return
        yield ""


class Give(Skill):
    """Give a path and other values."""

    path: tuple[Pose2D, ...] = Out(doc="a path")
    feedback: TrackingFeedback = Out(doc="a report")
    off = 0.1

    def run(self, robot) -> Run:
        self.path = LINE
        pose = Pose2D(0.0, Give.off)
        self.feedback = TrackingFeedback(Give.off, 0.1, 0, pose, 4.0, 0.0, 4.0)
        return
        yield ""


@pytest.fixture(autouse=True)
def _anew():
    Show.seen, Give.off = [], 0.1


@pytest.fixture
def tree(tmp_path):
    """`tree(nodes, …)` runs the main tree of these nodes in a scripted world."""

    def start(nodes: str, *, world: Any = None, values: str = "", **options: Any) -> Any:
        file = tmp_path / "tree.xml"
        file.write_text(
            '<root BTCPP_format="4" main_tree_to_execute="A"><BehaviorTree ID="A">'
            f"<Sequence>{values}{nodes}</Sequence></BehaviorTree></root>",
            encoding="utf-8",
        )
        registry = Registry(skills={"Show": Show, "Give": Give})
        place = world or ScriptedWorld()
        return run(file, world=place, registry=registry, **options)

    return start


NEARBY = 'max_robot_pose_search_dist="1"'
GIVE = '<Give path="{path}" feedback="{feedback}"/>'
SHOW = '<Show value="{out}"/>'


@pytest.mark.parametrize(
    ("tag", "what"),
    [
        ("PlannerSelector", "planner"),
        ("ControllerSelector", "controller"),
        ("SmootherSelector", "smoother"),
        ("GoalCheckerSelector", "goal_checker"),
        ("ProgressCheckerSelector", "progress_checker"),
        ("PathHandlerSelector", "path_handler"),
    ],
)
def test_a_selector_writes_its_default(tree, tag: str, what: str) -> None:
    node = f'<{tag} default_{what}="that" selected_{what}="{{out}}" topic_name="t"/>'
    assert tree(node + SHOW).status == "SUCCESS"
    assert Show.seen == ["that"]
    assert tree(f'<{tag} selected_{what}="{{out}}"/>{SHOW}').failure.code == "FAILED"


@pytest.mark.parametrize(
    ("tag", "helps", "not_"),
    [
        ("WouldAControllerRecoveryHelp", (100, 104, 105, 106), (0, 101, 103, 200)),
        ("WouldAPlannerRecoveryHelp", (200, 207, 208, 300, 307, 308), (0, 204, 206, 100)),
        ("WouldASmootherRecoveryHelp", (500, 502, 503, 504), (0, 501, 505)),
    ],
)
def test_which_codes_a_recovery_helps_against(tree, tag: str, helps: Any, not_: Any) -> None:
    for code in (*helps, *not_):
        status = tree(f'<{tag} error_code="{code}"/>').status
        assert status == ("SUCCESS" if code in helps else "FAILURE"), code


def test_error_codes_that_a_tree_names_and_a_key_without_a_value(tree) -> None:
    node = '<AreErrorCodesPresent error_code="{}" error_codes_to_check="101;107"/>'
    assert tree(node.format(107)).status == "SUCCESS"
    assert tree(node.format(102)).status == "FAILURE"
    assert tree('<WouldAPlannerRecoveryHelp error_code="{nothing_yet}"/>').status == "FAILURE"


def test_a_path_expires_when_it_is_not_replaced(tree) -> None:
    wait = (
        '<RetryUntilSuccessful num_attempts="-1"><Sequence><Sleep msec="100"/>{}</Sequence>'
        "</RetryUntilSuccessful>"
    )
    report = tree(wait.format('<PathExpiringTimer seconds="1" path="{path}"/>'), values=GIVE)
    assert report.status == "SUCCESS"
    assert 1.0 <= report.sim_time_s < 1.5


@pytest.mark.parametrize(("distance", "count", "x"), [(1.0, 7, 3.0), (0.0, 9, 4.0), (9.0, 2, 0.5)])
def test_truncate_path(tree, distance: float, count: int, x: float) -> None:
    node = f'<TruncatePath input_path="{{path}}" distance="{distance}" output_path="{{out}}"/>'
    assert tree(GIVE + node + SHOW).status == "SUCCESS"
    path = Show.seen[0]
    assert (len(path), path[-1].x) == (count, x)
    assert path[-1].yaw == 0.0


@pytest.mark.parametrize(
    ("ports", "first", "last"),
    [
        ('distance_forward="1" distance_backward="0.6" pose="2;0.3;0"', 1.5, 3.0),
        ('distance_forward="-1" distance_backward="0" pose="2;0.3;0"', 2.0, 4.0),
        ('distance_forward="-1" distance_backward="0" pose="0.9;0;0" ' + NEARBY, 1.0, 4.0),
    ],
)
def test_truncate_path_local(tree, ports: str, first: float, last: float) -> None:
    node = f'<TruncatePathLocal input_path="{{path}}" output_path="{{out}}" {ports}/>'
    assert tree(GIVE + node + SHOW).status == "SUCCESS"
    assert (Show.seen[0][0].x, Show.seen[0][-1].x) == (first, last)


def test_paths_are_joined_and_read(tree) -> None:
    node = '<ConcatenatePaths input_path1="{path}" input_path2="{path}" output_path="{out}"/>'
    assert tree(GIVE + node + SHOW).status == "SUCCESS"
    assert Show.seen == [LINE + LINE]
    for index, pose in ((0, LINE[0]), (-1, LINE[-1]), (-9, LINE[0])):
        Show.seen.clear()
        node = f'<GetPoseFromPath path="{{path}}" index="{index}" pose="{{out}}"/>'
        assert tree(GIVE + node + SHOW).status == "SUCCESS"
        assert Show.seen == [pose]
    for index in (9, -10):
        node = f'<GetPoseFromPath path="{{path}}" index="{index}" pose="{{out}}"/>'
        assert tree(GIVE + node).failure.code == "FAILED"
    assert tree('<ConcatenatePaths output_path="{out}"/>').failure.code == "FAILED"


def test_goals_are_appended_and_the_first_few_taken(tree) -> None:
    nodes = (
        '<AppendGoalPoseToGoals goal_pose="1;2;3" output_goals="{goals}"/>'
        '<AppendGoalPoseToGoals goal_pose="home" input_goals="{goals}" output_goals="{goals}"/>'
        '<GetNextFewGoals num_goals="1" input_goals="{goals}" output_goals="{out}"/>'
    )
    assert tree(nodes + SHOW + '<Show value="{goals}"/>').status == "SUCCESS"
    assert Show.seen == [("1;2;3",), ("1;2;3", "home")]
    assert tree('<GetNextFewGoals num_goals="1" output_goals="{out}"/>').failure.code == "FAILED"


def test_a_goal_counts_as_updated_the_first_time_only(tree) -> None:
    nodes = (
        "<GlobalUpdatedGoal/>"
        '<Repeat num_cycles="2"><Inverter><GlobalUpdatedGoal name="b"/></Inverter></Repeat>'
    )
    assert tree(nodes).failure.code == "FAILED"  # each node looks for the first time once
    again = (
        '<Repeat num_cycles="2"><ForceSuccess><Sequence><GlobalUpdatedGoal/>'
        "<Show/></Sequence></ForceSuccess></Repeat>"
    )
    assert tree(again).status == "SUCCESS"
    assert len(Show.seen) == 1


@pytest.mark.parametrize(("off", "status"), [(0.1, "SUCCESS"), (0.3, "FAILURE"), (-0.3, "SUCCESS")])
def test_within_the_bounds_of_the_path(tree, off: float, status: str) -> None:
    Give.off = off
    node = (
        '<IsWithinPathTrackingBounds max_error_left="0.2" max_error_right="0.4" '
        'tracking_feedback="{feedback}"/>'
    )
    assert tree(GIVE + node).status == status


def test_without_feedback_it_is_within_bounds(tree) -> None:
    node = '<IsWithinPathTrackingBounds tracking_feedback="{nothing_yet}"/>'
    assert tree(node).status == "SUCCESS"


@pytest.mark.parametrize(("value", "status"), [("true", "SUCCESS"), ("false", "FAILURE")])
def test_initial_pose_received(tree, value: str, status: str) -> None:
    key = f'<SetBlackboard value="{value}" output_key="initial_pose_received"/>'
    assert tree(key + "<InitialPoseReceived/>").status == status
    assert tree("<InitialPoseReceived/>").status == "FAILURE"


def test_a_robot_at_rest_is_stopped_and_not_stuck(tree) -> None:
    report = tree('<CheckStopStatus duration_stopped="500"/><Inverter><IsStuck/></Inverter>')
    assert report.status == "SUCCESS"
    assert report.sim_time_s == pytest.approx(0.55, abs=0.11)


def test_transforms_are_known_or_not(tree) -> None:
    assert tree('<TransformAvailable child="base_link" parent="odom"/>').status == "SUCCESS"
    assert tree('<TransformAvailable child="moon" parent="odom"/>').status == "FAILURE"


class Standing(Outside):
    """A robot that stands where the test puts it."""

    x = 0.0

    def ask(self, key: str, ask: Any) -> Any:
        return np.array([self.x, 0.0, 0.0])


@pytest.mark.parametrize(
    ("node", "step", "every"),
    [('<TimeExpired seconds="1"/>', 0.0, 10), ('<DistanceTraveled distance="0.5"/>', 0.0625, 8)],
)
def test_time_and_distance_count_from_the_first_look_and_again_after_success(
    tmp_path, node: str, step: float, every: int
) -> None:
    file = tmp_path / "tree.xml"
    file.write_text(f'<root BTCPP_format="4"><BehaviorTree ID="A">{node}</BehaviorTree></root>')
    clock, outside = ManualClock(), Standing()
    context = RunContext(clock, outside=outside)
    root = build(load(str(file), Registry()).document, context, {}.__getitem__).root
    found = []
    for _ in range(3 * every):
        context.begin_tick()
        found.append(root.execute())
        clock.advance(0.1)
        outside.x += step
    assert [k for k, status in enumerate(found) if status is SUCCESS] == [every, 2 * every]
