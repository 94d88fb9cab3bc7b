"""Check that names and numbers of a robot file fit the robot's URDF and each other."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Iterator

from lxml import etree

from momantu_bt.descriptions.reading import KeyMessage, Reading
from momantu_bt.formats.names import valid_names
from momantu_bt.formats.places import KeyPath
from momantu_bt.formats.units import quantity
from momantu_bt.formats.urdf import Urdf
from momantu_bt.frames import Joint, KinematicTree
from momantu_bt.robot import ARM, REQUIRED_POSES
from momantu_bt.robot_parts import ActuatorKind, CameraSensor, LaserSensor, LidarSensor
from momantu_bt.robots.robot_file import RobotFile

ROLES = {"base": ActuatorKind.BASE, ARM: ActuatorKind.JOINTS, "gripper": ActuatorKind.GRIPPER}
"""Actuators that skills name in their `uses`."""
SLACK = 1e-9
"""rad or m by which a named pose may lie beyond a limit: rounding."""


def findings(robot: RobotFile, root: etree._Element, reading: Reading) -> list[KeyMessage]:
    """Everything that does not fit; empty if nothing is wrong.

    root: the assembled URDF's element. reading: the file, as it is written.
    """
    links = [str(link.get("name")) for link in root.findall("link")]
    if robot.base_frame not in links:
        hint = valid_names(robot.base_frame, links, "links")
        return [(("base_frame",), f"there is no link {robot.base_frame!r}; {hint}")]
    tree = KinematicTree.of_urdf(Urdf(root), robot.base_frame)
    return list(_Checks(robot, tree, root, links, reading).run())


class _Checks:
    def __init__(
        self,
        robot: RobotFile,
        tree: KinematicTree,
        root: etree._Element,
        links: list[str],
        reading: Reading,
    ) -> None:
        self._robot, self._tree, self._links, self._reading = robot, tree, links, reading
        self._frames = tree.frames()
        self._moving: dict[str, Joint] = {j.name: j for j in tree.joints() if j.kind != "fixed"}
        self._every_joint = [str(joint.get("name")) for joint in root.findall("joint")]

    def run(self) -> Iterator[KeyMessage]:
        yield from self._base()
        yield from self._actuators()
        yield from self._roles()
        yield from self._limits()
        yield from self._groups()
        yield from self._sensors()
        yield from self._hand()
        yield from self._poses()
        for i, pair in enumerate(self._robot.ignored_collisions):
            for k, link in enumerate(pair):
                yield from self._in(link, self._links, "link", ("ignored_collisions", i, k))
        yield from self._simulation()

    def _in(
        self, name: str, known: Collection[str], what: str, place: KeyPath
    ) -> Iterator[KeyMessage]:
        if name not in known:
            yield place, f"there is no {what} {name!r}; {valid_names(name, known, f'{what}s')}"

    def _every(
        self, names: Iterable[str], known: Collection[str], what: str, place: KeyPath
    ) -> Iterator[KeyMessage]:
        for i, name in enumerate(names):
            yield from self._in(name, known, what, (*place, i))

    def _base(self) -> Iterator[KeyMessage]:
        drive = self._robot.base.drive
        if drive is not None and drive.joints is not None:
            for key, joint in drive.joints.model_dump().items():
                yield from self._in(
                    joint, self._every_joint, "joint", ("base", "drive", "joints", key)
                )
        corners = self._robot.footprint
        area = sum(
            a[0] * b[1] - b[0] * a[1]
            for a, b in zip(corners, corners[1:] + corners[:1], strict=True)
        )
        if area <= 0:
            yield ("footprint",), "the corners go round clockwise; write them counter-clockwise"

    def _actuators(self) -> Iterator[KeyMessage]:
        for name, actuator in self._robot.actuators.items():
            place: KeyPath = ("actuators", name, "joints")
            yield from self._every(actuator.joints, self._moving, "moving joint", place)
            if actuator.kind is ActuatorKind.JOINTS and not actuator.joints:
                yield ("actuators", name), f"{name} moves joints: write which, `joints: [...]`"
            for i, joint in enumerate(actuator.joints):
                if joint in self._moving and joint not in self._robot.joint_limits:
                    yield (*place, i), f"{joint!r} needs a line in `joint_limits`"

    def _roles(self) -> Iterator[KeyMessage]:
        """Skills know a robot's actuators, and the group that plans for its arm, by name."""
        actuators, groups = self._robot.actuators, self._robot.groups
        for name, kind in ROLES.items():
            if name in actuators and actuators[name].kind is not kind:
                yield ("actuators", name), f"skills take {name!r} for one of kind {kind}"
        yield from self._halves()
        if ARM in groups and ARM in actuators and groups[ARM].joints != actuators[ARM].joints:
            yield (
                ("groups", ARM, "joints"),
                "the group and the actuator of this name need the same joints in the same order",
            )

    def _halves(self) -> Iterator[KeyMessage]:
        """An arm, and a hand, are described in several sections: in all of them, or in none."""
        robot = self._robot
        grips = any(a.kind is ActuatorKind.GRIPPER for a in robot.actuators.values())
        if ARM in robot.actuators and ARM not in robot.groups:
            yield (
                ("groups",),
                f"motions of the actuator {ARM!r} are planned for the group {ARM!r}; write its "
                "joints and its tip",
            )
        if ARM in robot.groups and ARM not in robot.actuators:
            yield (
                ("actuators",),
                f"skills move the group {ARM!r} by an actuator named {ARM!r} of kind joints; this "
                "robot has none",
            )
        if ARM in robot.groups and robot.working.reach is None:
            yield ("working",), "a robot with an arm needs `reach: [nearest, best, farthest]`"
        if grips and robot.end_effector is None:
            yield ("actuators",), "a robot with a gripper needs the section `end_effector`"

    def _limits(self) -> Iterator[KeyMessage]:
        for name, limit in self._robot.joint_limits.items():
            place: KeyPath = ("joint_limits", name)
            if name not in self._moving:
                hint = valid_names(name, self._moving, "moving joints")
                yield place, f"there is no moving joint {name!r}; {hint}"
                continue
            if (limit.lower is None) != (limit.upper is None):
                yield place, f"{name} has one limit; give `lower` and `upper`, or neither"
            elif limit.lower is not None and limit.upper is not None:
                if limit.lower >= limit.upper:
                    yield (
                        place,
                        f"lower ({limit.lower:g}) must be less than upper ({limit.upper:g})",
                    )
            elif self._moving[name].kind == "prismatic":
                yield place, f"{name} slides: it needs `lower` and `upper`"
            yield from self._units(name, place)

    def _units(self, joint: str, place: KeyPath) -> Iterator[KeyMessage]:
        """Lengths are for joints that slide, angles for joints that turn."""
        written = self._reading.value(place)
        values = written.items() if isinstance(written, dict) else [(None, written)]
        slides = self._moving[joint].kind == "prismatic"
        for key, value in values:
            found = quantity(value) if isinstance(value, str) else None
            if found is not None and (found.unit.partition("/")[0] == "m") != slides:
                fitting = "slides: write it in m" if slides else "turns: write it in rad or deg"
                yield (*place, key) if key else place, f"{value!r}, but {joint} {fitting}"

    def _groups(self) -> Iterator[KeyMessage]:
        for name, group in self._robot.groups.items():
            place: KeyPath = ("groups", name)
            yield from self._every(group.joints, self._moving, "moving joint", (*place, "joints"))
            yield from self._in(group.tip, self._frames, "link", (*place, "tip"))
            if group.tip not in self._frames:
                continue
            chain = [j.name for j in self._tree.chain(group.tip) if j.name in group.joints]
            known = [joint for joint in group.joints if joint in self._moving]
            if known != chain:
                way = ", ".join(j.name for j in self._tree.chain(group.tip) if j.kind != "fixed")
                yield (
                    (*place, "joints"),
                    f"these are not joints on the way to {group.tip!r}, from the base outwards; "
                    f"the moving joints on that way are: {way or 'none'}",
                )
            for i, joint in enumerate(group.joints):
                if joint in self._moving and joint not in self._robot.joint_limits:
                    yield (*place, "joints", i), f"{joint!r} needs a line in `joint_limits`"

    def _sensors(self) -> Iterator[KeyMessage]:
        sensors = self._robot.sensors
        for name, sensor in sensors.items():
            place: KeyPath = ("sensors", name)
            yield from self._in(sensor.frame, self._frames, "link", (*place, "frame"))
            if isinstance(sensor, CameraSensor) and sensor.carrier is not None:
                yield from self._in(
                    sensor.carrier, self._robot.actuators, "actuator", (*place, "carrier")
                )
            if isinstance(sensor, LaserSensor) and sensor.source is not None:
                lidars = [k for k, s in sensors.items() if isinstance(s, LidarSensor)]
                yield from self._in(sensor.source, lidars, "lidar", (*place, "source"))

    def _hand(self) -> Iterator[KeyMessage]:
        hand = self._robot.end_effector
        if hand is None:
            return
        grippers = {
            k: a for k, a in self._robot.actuators.items() if a.kind is ActuatorKind.GRIPPER
        }
        yield from self._in(
            hand.actuator, grippers, "actuator of kind gripper", ("end_effector", "actuator")
        )
        yield from self._in(hand.frame, self._frames, "link", ("end_effector", "frame"))
        yield from self._every(
            hand.touch_links, self._links, "link", ("end_effector", "touch_links")
        )
        joints = grippers[hand.actuator].joints if hand.actuator in grippers else ()
        for joint in hand.opening:
            place: KeyPath = ("end_effector", "opening", joint)
            yield from self._in(joint, joints, f"joint of {hand.actuator}", place)
        missing = [joint for joint in joints if hand.opening and joint not in hand.opening]
        if missing:
            yield ("end_effector", "opening"), f"there is no table for {', '.join(missing)}"

    def _poses(self) -> Iterator[KeyMessage]:
        missing = [name for name in REQUIRED_POSES if name not in self._robot.named_poses]
        if missing and ARM in self._robot.groups:
            yield (
                ("named_poses",),
                f"every robot with an arm has the poses {', '.join(REQUIRED_POSES)}; missing: "
                f"{', '.join(missing)}",
            )
        limits = self._robot.joint_limits
        for name, pose in self._robot.named_poses.items():
            for joint, value in pose.items():
                place: KeyPath = ("named_poses", name, joint)
                if joint not in limits:
                    hint = valid_names(joint, limits, "joints with limits")
                    yield place, f"there is no joint {joint!r}; {hint}"
                    continue
                limit = limits[joint]
                low = -math.inf if limit.lower is None else limit.lower
                high = math.inf if limit.upper is None else limit.upper
                if not low - SLACK <= value <= high + SLACK:
                    yield place, f"{value:g} lies outside {joint}'s limits {low:g} to {high:g}"
                if joint in self._moving:
                    yield from self._units(joint, place)

    def _simulation(self) -> Iterator[KeyMessage]:
        drives = {*self._robot.actuators, *self._moving}
        for name in self._robot.drives:
            yield from self._in(name, drives, "actuator or moving joint", ("drives", name))
        contacts = self._robot.simulation
        if contacts is None:
            return
        if self._robot.base.drive is None:
            yield ("base",), "a robot that is simulated needs `drive: {force: N, torque: Nm}`"
        for key in ("floor_links", "no_collision_links", "finger_links"):
            yield from self._every(getattr(contacts, key), self._links, "link", ("simulation", key))
        for link in contacts.convex_cells:
            yield from self._in(link, self._links, "link", ("simulation", "convex_cells", link))
        for i, pair in enumerate(contacts.ignored_collisions):
            for k, link in enumerate(pair):
                at: KeyPath = ("simulation", "ignored_collisions", i, k)
                yield from self._in(link, self._links, "link", at)
        effector = self._robot.end_effector
        hand = None if effector is None else self._robot.actuators.get(effector.actuator)
        fingers = () if hand is None else hand.joints
        for joint, linkage in contacts.linkages.items():
            place: KeyPath = ("simulation", "linkages", joint)
            yield from self._in(joint, self._moving, "moving joint", place)
            yield from self._in(linkage.motor, fingers, "finger joint", (*place, "motor"))
