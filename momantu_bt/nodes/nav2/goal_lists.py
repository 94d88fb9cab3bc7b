"""AppendGoalPoseToGoals, GetNextFewGoals: lists of goals."""

from __future__ import annotations

from momantu_bt.engine.node import Parts, TreeNode
from momantu_bt.engine.status import SUCCESS, Status
from momantu_bt.failure import FAILED
from momantu_bt.geometry import Pose2D
from momantu_bt.nodes.goals import peek
from momantu_bt.skill import MISSING
from momantu_bt.tree.catalogue.spec import Dialect, input_port, leaf, output_port

GOALS = tuple[Pose2D | str, ...]
"""Poses of the map, or names of places."""


class _OnGoals(TreeNode):
    def __init__(self, parts: Parts) -> None:
        super().__init__(parts)
        self.inputs, self.outputs = parts.inputs(), parts.outputs()

    def goals(self) -> tuple[Pose2D | str, ...]:
        """The list; a key without a value is an empty one."""
        found = peek(self.inputs, "input_goals")
        return () if found is MISSING or found is None else found

    def write(self, goals: tuple[Pose2D | str, ...]) -> Status:
        """SUCCESS with a list."""
        if "output_goals" in self.outputs:
            self.outputs["output_goals"].write(goals)
        return SUCCESS


class AppendGoalPoseToGoals(_OnGoals):
    """Writes a list with one more goal at its end."""

    spec = leaf(
        "AppendGoalPoseToGoals",
        "append_goal_pose_to_goals",
        "Adds a goal to the end of a list.",
        input_port("goal_pose", Pose2D | str, "the goal"),
        input_port("input_goals", GOALS, "the list", None),
        output_port("output_goals", GOALS, "the list with the goal", None),
        may_be_empty=("input_goals",),
        dialect=Dialect.NAV2,
    )

    def step(self) -> Status:
        """Add the goal."""
        return self.write((*self.goals(), self.inputs["goal_pose"]))


class GetNextFewGoals(_OnGoals):
    """Writes the first few goals of a list."""

    spec = leaf(
        "GetNextFewGoals",
        "get_next_few_goals",
        "Takes the first few goals of a list.",
        input_port("num_goals", int, "how many", least=1),
        input_port("input_goals", GOALS, "the list", None),
        output_port("output_goals", GOALS, "the first few", None),
        may_be_empty=("input_goals",),
        dialect=Dialect.NAV2,
    )

    def step(self) -> Status:
        """Take them."""
        goals = self.goals()
        if not goals:
            return self.fail(FAILED, "the list of goals is empty")
        return self.write(goals[: self.inputs["num_goals"]])
