"""Ground truth, for the referee and for tests only."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
import sapien

from momantu_bt.geometry import Array, Pose2D, Transform
from momantu_bt.world import TICK
from momantu_worlds.sapien.build.robot_model import RobotModel
from momantu_worlds.sapien.config import SUB_STEPS
from momantu_worlds.sapien.poses import transform_of
from momantu_worlds.scenes.geometry.solids import FLOOR

DOWN = np.array([0.0, 0.0, -1.0], dtype=np.float32)
THROUGH = 0.001
"""Step, m, by which a ray continues behind an ignored body; heights have this error."""


Impulse: TypeAlias = tuple[float, float, float]
"""Ns, in the map."""


@dataclass(frozen=True, slots=True)
class Contact:
    """Two bodies or links in contact during the last tick.

    first, second: names of bodies, or of the robot's links (which come first). force: length of the
    contact force, averaged over the tick (between two bodies: over its last physics step), N.
    """

    first: str
    second: str
    force: float


@dataclass(frozen=True, slots=True)
class JointSpeed:
    """Speed of a joint: m/s if `linear`, else rad/s; never negative."""

    speed: float
    linear: bool


class Truth:
    """True poses of everything, and all contacts."""

    def __init__(self, system: Any, model: RobotModel, base_link: str) -> None:
        self._system, self._model, self._base_link = system, model, base_link
        self._entities: dict[str, Any] = {}
        self._poses: dict[str, tuple[bytes, Transform]] = {}
        self._impulses: dict[tuple[str, str], Impulse] = {}
        self._joints_before = model.positions()
        self.watching = False
        self.robot_links = frozenset(model.links)
        self._links = frozenset(model.links.values())

    def add(self, name: str, entity: Any) -> None:
        """Register a body by name."""
        self._entities[name] = entity

    def forget(self, name: str) -> None:
        """Forget a removed body."""
        del self._entities[name]
        self._poses.pop(name, None)

    def entity(self, name: str) -> Any:
        """A body's SAPIEN entity; KeyError lists the known names if there is none."""
        if name not in self._entities:
            raise KeyError(f"no body {name!r}; bodies: {', '.join(self._entities)}")
        return self._entities[name]

    @property
    def bodies(self) -> tuple[str, ...]:
        """Names of all bodies, robot excluded."""
        return tuple(self._entities)

    def pose(self, body: str) -> Transform:
        """`map_from_body`; KeyError lists the known names if there is none.

        It is the same object as long as the body does not move.
        """
        pose = self.entity(body).pose
        numbers = pose.p.tobytes() + pose.q.tobytes()
        known = self._poses.get(body)
        if known is None or known[0] != numbers:
            known = self._poses[body] = numbers, transform_of(pose)
        return known[1]

    def speed(self, body: str) -> tuple[float, float]:
        """Speed of a moving body, m/s and rad/s; (0, 0) for a static one."""
        part = self.entity(body).find_component_by_type(sapien.physx.PhysxRigidDynamicComponent)
        if part is None:
            return 0.0, 0.0
        linear, angular = part.get_linear_velocity(), part.get_angular_velocity()
        return float(np.linalg.norm(linear)), float(np.linalg.norm(angular))

    def link(self, name: str) -> Transform:
        """`map_from_link` of one of the robot's links; KeyError if there is none."""
        return transform_of(self._model.links[name].entity_pose)

    def joint(self, name: str) -> float:
        """Position of one of the robot's joints, rad or m; KeyError if there is none."""
        return float(self._model.positions()[self._model.index[name]])

    def height_below(self, body: str, points: Array) -> tuple[float, str]:
        """Height of the lowest of points (n, 3) of the map above what is under it, m, its name.

        The body itself and the robot are ignored; the floor is under everything.
        """
        best = (float(points[:, 2].min()), FLOOR)
        for point in points:
            below, fallen = np.array(point, dtype=np.float32), 0.0
            while fallen < best[0]:
                hit = self._system.raycast(below, DOWN, best[0] - fallen)
                if hit is None:
                    break
                fallen += float(hit.distance)
                if hit.component.entity.name != body and hit.component not in self._links:
                    best = min(best, (fallen, hit.component.entity.name))
                    break
                fallen += THROUGH
                below = below + DOWN * np.float32(hit.distance + THROUGH)
        return best

    def base_speed(self) -> tuple[float, float]:
        """Speed of the base along the floor and about the vertical, m/s and rad/s."""
        link = self._model.links[self._base_link]
        linear, angular = link.get_linear_velocity(), link.get_angular_velocity()
        return float(np.hypot(linear[0], linear[1])), abs(float(angular[2]))

    def joint_speeds(self) -> dict[str, JointSpeed]:
        """Speeds of all active joints of the robot during the last tick, by name.

        They come from the positions: the physics gives a joint that is blocked, as a finger by what
        it holds, a velocity although it does not move.
        """
        speeds = (np.abs(self._model.positions() - self._joints_before) / TICK).tolist()
        return {
            name: JointSpeed(speeds[self._model.index[name]], joint.type == "prismatic")
            for name, joint in self._model.joints.items()
        }

    def base(self) -> Pose2D:
        """`map_from_base` on the floor."""
        return Pose2D.from_transform(self.link(self._base_link))

    def watch_contacts(self) -> None:
        """Collect contact forces from the next tick on; takes time, does not affect the physics."""
        self.watching = True

    def contacts(self) -> tuple[Contact, ...]:
        """Contacts during the last tick; `watch_contacts` must have been called.

        Raises:
            RuntimeError: `watch_contacts` was not called.
        """
        if not self.watching:
            raise RuntimeError("contacts are not collected; call watch_contacts() before stepping")
        return tuple(
            Contact(first, second, _length(impulse) / TICK)
            for (first, second), impulse in self._impulses.items()
        )

    def begin_tick(self) -> None:
        """Forget the contacts of the previous tick; remember where the joints are."""
        self._impulses.clear()
        self._joints_before = self._model.positions()

    def collect(self, *, last: bool) -> None:
        """Add the contact impulses of the last physics step.

        Contacts of the robot are summed over all steps of a tick, as they may be impacts. Contacts
        between bodies are taken from the last step, which is enough to know what rests on what.
        """
        links = self._links
        for contact in self._system.get_contacts():
            a, b = contact.bodies
            if a in links or b in links:
                self._add(a.name, b.name, _impulse(contact, 1))
            elif last:
                self._add(a.name, b.name, _impulse(contact, SUB_STEPS))

    def _add(self, a: str, b: str, impulse: Impulse) -> None:
        x, y, z = impulse
        if x == y == z == 0.0:
            return
        if (a not in self.robot_links, a) > (b not in self.robot_links, b):
            a, b, x, y, z = b, a, -x, -y, -z
        before = self._impulses.get((a, b))
        if before is not None:
            x, y, z = before[0] + x, before[1] + y, before[2] + z
        self._impulses[a, b] = x, y, z


def _impulse(contact: Any, steps: int) -> Impulse:
    """The impulse of all points of a contact, as if it lasted for some steps."""
    x = y = z = 0.0
    for point in contact.points:
        px, py, pz = point.impulse.tolist()
        x, y, z = x + px, y + py, z + pz
    return x * steps, y * steps, z * steps


def _length(impulse: Impulse) -> float:
    vector = np.array(impulse)
    return math.sqrt(vector.dot(vector))
