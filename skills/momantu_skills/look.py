"""look: point the camera at something and hold it there."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Literal

from momantu_bt.claim import CameraOn, Claim
from momantu_bt.failure import FailureValue
from momantu_bt.frames import ODOM
from momantu_bt.geometry import Array, Pose
from momantu_bt.robot import CAMERA_CARRIER, Robot
from momantu_bt.skill import Failure, In, Needs, Run, Skill
from momantu_bt.symptom import Symptom
from momantu_skills.gaze.look_at import WITHIN, look_at
from momantu_skills.manipulation.scene.arm_scene import ArmScene

AHEAD = 3.0
"""Distance of the point to look at ahead of the base, m, at the camera's height."""
DOWN = 1.0
"""Distance of the point on the floor ahead of the base, m: close enough to see the next
obstacle."""
SLACK = 0.03
"""Largest pointing error from the joint encoders and the camera's mounting, rad."""


class Look(Skill):
    """Point the camera at a pose, at a surface, or ahead. It succeeds once the camera is still."""

    at: Pose | None = In(None, doc="look at the origin of this pose (odom or map)")
    surface: str | None = In(None, names="surface", doc="look at the middle of this surface")
    direction: Literal["ahead", "down"] | None = In(
        None, doc="look ahead, or down at the floor ahead"
    )
    also_called = ("look_at", "point_camera", "gaze", "point_head", "move_head")
    failures = {
        "BAD_TARGET": "not exactly one of at, surface, direction is given, or no such surface",
        "OUT_OF_VIEW": "the camera's carrier cannot turn that far, or is stuck",
    }
    uses = {CAMERA_CARRIER}
    senses = {"camera"}
    activities = {}
    symptoms = {
        "OUT_OF_VIEW": {Symptom.ARM_OFF_COURSE},
    }
    planning_scene: ArmScene = Needs()
    one_of = (("at", "surface", "direction"),)

    @classmethod
    def rehearsal(cls, seed: int) -> Mapping[str, Any]:
        """Use one of the three kinds of target."""
        return {"inputs": {"surface": "table_a"}}

    def __init__(self) -> None:
        """Start without a target point."""
        super().__init__()
        self._target: tuple[float, float, float] | None = None

    def run(self, robot: Robot) -> Run:
        """Compute the target point, then look at it."""
        x, y, z = (float(v) for v in self._point(robot))
        self._target = x, y, z
        yield from look_at(self, robot, self._target)

    def claim(self, robot: Robot, failure: FailureValue | None) -> Claim | None:
        """Claim that the camera looks at the point; a failure denies it."""
        if self._target is None or (failure is not None and failure.code != "OUT_OF_VIEW"):
            return None
        return CameraOn(robot.description.camera()[1].frame, self._target, WITHIN + SLACK)

    def _point(self, robot: Robot) -> Array:
        given = [name for name in ("at", "surface", "direction") if getattr(self, name) is not None]
        if len(given) != 1:
            raise Failure(
                "BAD_TARGET",
                f"look takes exactly one of at, surface, direction; given: "
                f"{', '.join(given) or 'none'}",
            )
        if self.at is not None:
            return self.frames.lookup(ODOM, self.at.frame).apply(self.at.position)
        if self.surface is not None:
            return self._middle_of(self.surface)
        return self._ahead(robot)

    def _middle_of(self, name: str) -> Array:
        surface = self.site.surfaces.get(name)
        if surface is None:
            known = ", ".join(self.site.surfaces) or "none"
            raise Failure("BAD_TARGET", f"the site has no surface {name!r}; surfaces: {known}")
        top = surface.map_from_surface.transform(surface.height)
        return self.frames.lookup(ODOM, "map").apply(top.position)

    def _ahead(self, robot: Robot) -> Array:
        base, camera = robot.description.base_frame, robot.description.camera()[1].frame
        if self.direction == "ahead":
            height = float(self.frames.lookup(base, camera).position[2])
            point_base = (AHEAD, 0.0, height)
        else:
            point_base = (DOWN, 0.0, 0.0)
        return self.frames.lookup(ODOM, base).apply(point_base)
