"""Leaves that cut, join, read and measure paths."""

from __future__ import annotations

import math

from momantu_bt.engine.node import Parts, TreeNode
from momantu_bt.engine.status import SUCCESS, Status
from momantu_bt.failure import FAILED, FRAME_UNKNOWN
from momantu_bt.frames import MAP
from momantu_bt.geometry import Path, Pose2D, nearest_index, path_lengths, wrap_angle
from momantu_bt.nodes.goals import peek
from momantu_bt.nodes.nav2.pose import BASE_FRAME, robot_pose
from momantu_bt.skill import MISSING
from momantu_bt.tree.catalogue.codes import and_also
from momantu_bt.tree.catalogue.spec import Dialect, input_port, leaf, output_port

PATH = tuple[Pose2D, ...]
"""The type of a path at a port; see `geometry.Path`."""


class _OnPaths(TreeNode):
    """The base of these leaves: reads paths, of which a key without a value is an empty one."""

    def __init__(self, parts: Parts) -> None:
        super().__init__(parts)
        self.inputs, self.outputs = parts.inputs(), parts.outputs()

    def path(self, port: str) -> Path:
        """The path at an input."""
        path = peek(self.inputs, port)
        return () if path is MISSING or path is None else path

    def write(self, port: str, value: object) -> Status:
        """SUCCESS, with a value for an output that the tree may have left out."""
        if port in self.outputs:
            self.outputs[port].write(value)
        return SUCCESS


class TruncatePath(_OnPaths):
    """Cuts the end off a path, so that it ends `distance` before its goal and looks at it."""

    spec = leaf(
        "TruncatePath",
        "truncate_path",
        "Cuts the end off a path.",
        input_port("input_path", PATH, "the path", None),
        input_port("distance", float, "how far before the goal it ends", 1.0, "m", least=0),
        output_port("output_path", PATH, "the shorter path", None),
        may_be_empty=("input_path",),
        dialect=Dialect.NAV2,
    )

    def step(self) -> Status:
        """Cut the path; two poses remain at least."""
        path = self.path("input_path")
        if not path:
            return self.write("output_path", ())
        goal, last = path[-1], len(path) - 1
        while last > 1 and path[last].distance_to(goal) < self.inputs["distance"]:
            last -= 1
        end = path[last]
        yaw = math.atan2(goal.y - end.y, goal.x - end.x)
        return self.write("output_path", (*path[:last], Pose2D(end.x, end.y, yaw)))


class TruncatePathLocal(_OnPaths):
    """Keeps the part of a path around the robot, or around a given pose."""

    spec = leaf(
        "TruncatePathLocal",
        "truncate_path_local",
        "Keeps the part of a path that is near the robot.",
        input_port("input_path", PATH, "the path", None),
        input_port("distance_forward", float, "how far ahead; below 0: all of it", 8.0, "m"),
        input_port("distance_backward", float, "how far behind", 4.0, "m"),
        BASE_FRAME,
        input_port("transform_tolerance", float, "Nav2's; poses here are the newest", 0.2, "s"),
        input_port("pose", Pose2D | None, "instead of the robot's pose", None),
        input_port(
            "angular_distance_weight", float, "metres that a radian counts as", 0.0, least=0
        ),
        input_port(
            "max_robot_pose_search_dist", float, "how far it looks along the path", math.inf, "m"
        ),
        output_port("output_path", PATH, "the part", None),
        may_be_empty=("input_path", "pose"),
        dialect=Dialect.NAV2,
        codes=and_also(FRAME_UNKNOWN),
    )

    def __init__(self, parts: Parts) -> None:
        super().__init__(parts)
        self.known: Path = ()
        self.at = 0

    def step(self) -> Status:
        """Find the place on the path, and keep what is near."""
        path, pose = self.path("input_path"), peek(self.inputs, "pose")
        if pose is MISSING or pose is None:
            pose = robot_pose(self.context, MAP, self.inputs["robot_base_frame"])
        if not path:
            return self.write("output_path", ())
        reach: float = self.inputs["max_robot_pose_search_dist"]
        if path != self.known or not math.isfinite(reach):
            self.known, self.at = path, 0
        self.at = self._nearest(path, pose, reach)
        along = path_lengths(path)
        ahead: float = self.inputs["distance_forward"]
        ahead = math.inf if ahead < 0.0 else ahead
        behind: float = self.inputs["distance_backward"]
        here = along[self.at]
        kept = [
            k
            for k, at in enumerate(along)
            if (k >= self.at and at - here <= ahead) or (k < self.at and here - at <= behind)
        ]
        return self.write("output_path", path[kept[0] : kept[-1] + 1])

    def _nearest(self, path: Path, pose: Pose2D, reach: float) -> int:
        weight: float = self.inputs["angular_distance_weight"]
        if weight == 0.0:
            return nearest_index(path, pose, self.at, reach)
        along = path_lengths(path)

        def away(k: int) -> float:
            turn = abs(wrap_angle(path[k].yaw - pose.yaw))
            return math.hypot(path[k].distance_to(pose), weight * turn)

        among = (k for k in range(self.at, len(path)) if along[k] - along[self.at] <= reach)
        return min(among, key=away)


class ConcatenatePaths(_OnPaths):
    """Joins two paths."""

    spec = leaf(
        "ConcatenatePaths",
        "concatenate_paths",
        "Joins two paths.",
        input_port("input_path1", PATH, "the first path", None),
        input_port("input_path2", PATH, "the second path", None),
        output_port("output_path", PATH, "both", None),
        may_be_empty=("input_path1", "input_path2"),
        dialect=Dialect.NAV2,
    )

    def step(self) -> Status:
        """Join them."""
        both = self.path("input_path1") + self.path("input_path2")
        if not both:
            return self.fail(FAILED, "both paths are empty")
        return self.write("output_path", both)


class GetPoseFromPath(_OnPaths):
    """Reads one pose of a path."""

    spec = leaf(
        "GetPoseFromPath",
        "get_pose_from_path",
        "Reads one pose of a path.",
        input_port("path", PATH, "the path", None),
        input_port("index", int, "which pose, from 0; -1 is the last", 0),
        output_port("pose", Pose2D, "the pose", None),
        may_be_empty=("path",),
        dialect=Dialect.NAV2,
    )

    def step(self) -> Status:
        """Read the pose."""
        path, index = self.path("path"), self.inputs["index"]
        if not -len(path) <= index < len(path):
            return self.fail(FAILED, f"the path has {len(path)} poses, and none at {index}")
        return self.write("pose", path[index])


class IsGoalNearby(_OnPaths):
    """SUCCESS when the rest of the path, from the robot on, is shorter than the threshold."""

    spec = leaf(
        "IsGoalNearby",
        "is_goal_nearby",
        "Succeeds when the rest of the path is short.",
        input_port("path", PATH, "the path", None),
        input_port("proximity_threshold", float, "what counts as short", 1.0, "m"),
        input_port(
            "max_robot_pose_search_dist",
            float,
            "how far along the path the robot is looked for; below 0: on all of it",
            -1.0,
            "m",
        ),
        input_port("global_frame", str, "Nav2's; paths here are in the map", MAP),
        BASE_FRAME,
        may_be_empty=("path",),
        dialect=Dialect.NAV2,
        condition=True,
        codes=and_also(FRAME_UNKNOWN),
    )

    def __init__(self, parts: Parts) -> None:
        super().__init__(parts)
        self.known: Path = ()
        self.at = 0

    def step(self) -> Status:
        """Measure the rest of the path."""
        path, reach = self.path("path"), self.inputs["max_robot_pose_search_dist"]
        if not path:
            return self.fail(FAILED, "the path has no poses")
        pose = robot_pose(self.context, MAP, self.inputs["robot_base_frame"])
        if path != self.known or reach < 0.0:
            self.known, self.at = path, 0
        self.at = nearest_index(path, pose, self.at, math.inf if reach < 0.0 else reach)
        along = path_lengths(path)
        rest = along[-1] - along[self.at]
        if rest < self.inputs["proximity_threshold"]:
            return SUCCESS
        return self.fail(FAILED, f"{rest:.1f} m of the path are left")
