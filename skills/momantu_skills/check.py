"""check: whether something holds true right now."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any, Literal, TypeAlias

from momantu_bt.claim import BaseAt, Claim, GripperOpen, Holding
from momantu_bt.failure import Failure, FailureValue
from momantu_bt.geometry import Pose2D
from momantu_bt.lazy import lazily
from momantu_bt.robot import Robot
from momantu_bt.service import Localization
from momantu_bt.skill import In, Needs, Run, Skill
from momantu_bt.symptom import Symptom
from momantu_skills.manipulation.scene.arm_scene import ArmScene
from momantu_skills.navigation.localize.confidence import estimate, is_localized, sigmas

with lazily():
    from momantu_skills.manipulation.hand import evidence, weighing


NEAR = 1.5
"""Distance from a place, or from the edge of a surface, that counts as near, m."""
OPEN = 0.9
"""Share of the widest opening at which the gripper counts as open."""
GAUGE = 0.003
"""Largest error of the gripper's measured opening, m."""
ASTRAY = 0.10
"""Largest error of the robot's own position when it reports its distance from a place, m."""
NO = ("NOT_HOLDING", "HOLDING", "NOT_LOCALIZED", "NOT_NEAR", "NOT_OPEN")
"""Failure codes that mean that the answer is no."""
Question: TypeAlias = Literal["holding", "not_holding", "localized", "near", "gripper_open"]


class Check(Skill):
    """Check something that the robot believes. It moves nothing.

    Whether the hand holds something is weighed from fingers, weight and picture. Where the first
    readings do not decide, it feels for half a second and takes a picture of the hand as it is;
    after that it says HOLDING_UNKNOWN, and `examine_hand` finds out.
    """

    what: Question = In(doc='what to check; "near" needs `place`')
    place: str | None = In(None, doc='for "near": a place or surface of the site', names="place")
    also_called = ("check_holding", "is_holding", "is_localized", "verify")
    failures = {
        "NOT_HOLDING": "the hand holds nothing",
        "HOLDING": "the hand holds something",
        "HOLDING_UNKNOWN": "fingers, weight and picture do not tell what the hand holds",
        "NOT_LOCALIZED": "the robot is not sure where it is",
        "NOT_NEAR": "the robot is not near the place",
        "NOT_OPEN": "the gripper is not open",
        "BAD_QUESTION": "the site has no such place",
    }
    activities = {}
    symptoms = {
        "NOT_HOLDING": {Symptom.NOT_HELD},
        "HOLDING_UNKNOWN": {Symptom.NOT_HELD, Symptom.HAND_STUCK},
        "NOT_LOCALIZED": {Symptom.NOT_LOCALIZED},
        "NOT_OPEN": {Symptom.HAND_STUCK},
    }
    localization: Localization = Needs()
    planning_scene: ArmScene = Needs()

    @classmethod
    def rehearsal(cls, seed: int) -> Mapping[str, Any]:
        """Ask a question that is answered with yes."""
        return {"inputs": {"what": "gripper_open"}}

    def run(self, robot: Robot) -> Run:
        """Answer at once, but for a hand that needs a closer look."""
        if self.what in ("holding", "not_holding"):
            yield from self._hand(robot)
        elif self.what == "gripper_open":
            self._gripper_open(robot)
        else:
            getattr(self, f"_{self.what}")()

    def claim(self, robot: Robot, failure: FailureValue | None) -> Claim | None:
        """Claim that the answer is yes; a failure that can be checked denies it."""
        said = failure is None
        if failure is not None and failure.code not in NO:
            return None
        if self.what in ("holding", "not_holding"):
            return Holding(self.what == "holding")
        if self.what == "localized":
            return estimate(self.localization)
        if self.what == "near":
            nearest = self._nearest(self.localization.map_from_base)
            return BaseAt(nearest, NEAR + (ASTRAY if said else -ASTRAY), math.pi)
        if robot.description.end_effector is None:
            return None
        slack = -GAUGE if said else GAUGE
        return GripperOpen(OPEN * robot.description.hand.max_width + slack)

    def _hand(self, robot: Robot) -> Run:
        """Weigh what the senses say of the hand."""
        if robot.description.end_effector is None:
            self._answer(evidence.Grip.EMPTY, [])
            return
        found = yield from weighing.weigh(self, robot, self.planning_scene)
        self._answer(evidence.weighed(found), found)

    def _answer(self, grip: evidence.Grip, found: Sequence[evidence.Evidence]) -> None:
        said, data = weighing.told(found), weighing.odds(found)
        if grip is evidence.Grip.UNKNOWN:
            raise Failure(
                "HOLDING_UNKNOWN",
                f"{said}; to find out, run examine_hand: it looks at the hand, presses the fingers "
                "together and lifts the hand off what it leans on",
                **data,
            )
        if self.what == "holding" and grip is evidence.Grip.EMPTY:
            raise Failure("NOT_HOLDING", said, **data)
        if self.what == "not_holding" and grip is evidence.Grip.HELD:
            held = self.planning_scene.held
            what = "something" if held is None else f"a {held.object.category}"
            raise Failure("HOLDING", f"the hand holds {what}: {said}", **data)

    def _localized(self) -> None:
        if is_localized(self.localization):
            return
        sigma, sigma_yaw = sigmas(self.localization.covariance)
        quality = float(self.localization.quality)
        raise Failure(
            "NOT_LOCALIZED",
            f"the position is known to {sigma:.2f} m and {math.degrees(sigma_yaw):.0f} "
            f"degrees, and {quality:.0%} of the scan fits the map",
            sigma=sigma,
            sigma_yaw=sigma_yaw,
            quality=quality,
        )

    def _near(self) -> None:
        here = self.localization.map_from_base
        distance = here.distance_to(self._nearest(here))
        if distance > NEAR:
            raise Failure(
                "NOT_NEAR",
                f"{self.place} is {distance:.1f} m away, near is at most {NEAR} m",
                distance=distance,
            )

    def _nearest(self, here: Pose2D) -> Pose2D:
        """Return the place itself, or the point of the surface nearest to `here`, in the map."""
        place = self.place or ""
        if place in self.site.places:
            return self.site.places[place]
        if place in self.site.surfaces:
            surface = self.site.surfaces[place]
            local = surface.map_from_surface.inverse() @ here
            x, y = (
                min(max(v, -edge / 2), edge / 2)
                for v, edge in zip((local.x, local.y), surface.size, strict=True)
            )
            away = math.hypot(local.x, local.y)
            if surface.round and away > surface.size[0] / 2:
                x, y = (v * surface.size[0] / 2 / away for v in (local.x, local.y))
            return surface.map_from_surface @ Pose2D(x, y)
        known = ", ".join(self.site.known_places()) or "none"
        raise Failure("BAD_QUESTION", f"the site has no place {self.place!r}; it has: {known}")

    def _gripper_open(self, robot: Robot) -> None:
        if robot.description.end_effector is None:
            raise Failure("BAD_QUESTION", f"{robot.description.name} has no hand that opens")
        width, widest = robot.state().gripper_width, robot.description.hand.max_width
        if width < OPEN * widest:
            raise Failure(
                "NOT_OPEN",
                f"the gripper is {width * 1000:.0f} mm open, its widest is {widest * 1000:.0f} mm",
                width=width,
            )
