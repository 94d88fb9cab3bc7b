"""A flat world for navigation, painted solids for perception, a table for manipulation."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from momantu_skills.manipulation.model.hulls import floor_outline
from momantu_skills.manipulation.scene.service import PlanningSceneService
from momantu_worlds.robots import fetch

from momantu_bt.frames import FrameBuffer
from momantu_bt.geometry import Pose, Pose2D, Transform
from momantu_bt.messages import (
    CameraImage,
    DetectedObject,
    GripperCommand,
    LaserScan,
    RobotState,
    WrenchReading,
    frozen,
)
from momantu_bt.robot import RobotDescription
from momantu_bt.service import HeldObject, ServiceContext, Snapshot
from momantu_bt.testing import (
    ScriptedRobot,
    ScriptedWorld,
    eye_in_hand_robot,
    scripted_site,
    small_robot,
)
from momantu_bt.testing.painting import Block, Painter, Round, Solid
from momantu_bt.world import Surface, seeded

Box = tuple[float, float, float, float]
"""x from, y from, x to, y to, in the map, m."""


class FlatRobot(ScriptedRobot):
    """Stands truly at `truth`; its odometry starts at 0 and drifts, its laser is noisy.

    boxes: what stands in the world. nearest: least distance of the base's outline to any, m.
    """

    def __init__(
        self,
        truth: Pose2D,
        seed: int = 0,
        drift: float = 0.02,
        description: RobotDescription | None = None,
    ) -> None:
        super().__init__(description)
        self.truth, self.seed, self.drift = truth, seed, drift
        self.boxes: list[Box] = []
        self.nearest = math.inf
        self.last_scan: LaserScan | None = None
        self.mount = self.description.kinematics().base_from_frame(
            self.description.laser()[1].frame, self.joints
        )
        self.readings = {"laser": _scan, "camera": _blind}

    def advance(self, seconds: float) -> None:
        before = self.base
        super().advance(seconds)
        step = before.inverse() @ self.base
        self.truth = self.truth @ Pose2D(
            step.x * (1 + self.drift), step.y, step.yaw * (1 - self.drift)
        )
        corners = np.array(self.description.footprint)
        outline = np.concatenate(
            [a + np.linspace(0, 1, 9)[:, None] * (b - a) for a, b in _pairs(corners)]
        )
        self.nearest = min(self.nearest, float(self.distance(_placed(self.truth, outline)).min()))

    def distance(self, points: np.ndarray) -> np.ndarray:
        """Distance (n,) of points (n, 2) in the map to the nearest box, 0 inside."""
        best = np.full(len(points), 1e9)
        for x0, y0, x1, y1 in self.boxes:
            dx = np.maximum(np.maximum(x0 - points[:, 0], points[:, 0] - x1), 0.0)
            dy = np.maximum(np.maximum(y0 - points[:, 1], points[:, 1] - y1), 0.0)
            best = np.minimum(best, np.hypot(dx, dy))
        return np.asarray(best)


def _pairs(corners: np.ndarray) -> list[tuple[np.ndarray, np.ndarray]]:
    return list(zip(corners, np.roll(corners, -1, axis=0), strict=True))


def _placed(pose: Pose2D, points: np.ndarray) -> np.ndarray:
    c, s = math.cos(pose.yaw), math.sin(pose.yaw)
    return points @ np.array([[c, s], [-s, c]]) + (pose.x, pose.y)


def _scan(robot: ScriptedRobot) -> LaserScan:
    assert isinstance(robot, FlatRobot)
    if robot.last_scan is not None and robot.last_scan.stamp == robot.time:
        return robot.last_scan
    sensor = robot.description.laser()[1]
    angles = np.linspace(sensor.angle_min, sensor.angle_max, sensor.beams)
    flat = np.stack([np.cos(angles), np.sin(angles), 0 * angles], axis=1)
    ways = (flat @ robot.mount.rotation.T)[:, :2]
    c, s = math.cos(robot.truth.yaw), math.sin(robot.truth.yaw)
    start = _placed(robot.truth, robot.mount.position[None, :2])[0]
    ranges = _cast(start, ways @ np.array([[c, s], [-s, c]]), np.array(robot.boxes))
    noise = seeded(robot.seed, "laser", robot.time).normal(0.0, 0.015, len(ranges))
    ranges = np.where(ranges < sensor.range_max, ranges + noise, sensor.range_max)
    robot.last_scan = LaserScan(
        stamp=robot.time,
        frame=sensor.frame,
        angle_min=sensor.angle_min,
        angle_increment=(sensor.angle_max - sensor.angle_min) / (sensor.beams - 1),
        range_min=sensor.range_min,
        range_max=sensor.range_max,
        ranges=frozen(ranges),
    )
    return robot.last_scan


def _cast(start: np.ndarray, ways: np.ndarray, boxes: np.ndarray) -> np.ndarray:
    """Distance (n,) along rays (n, 2) to the first of boxes (k, 4), by slabs."""
    with np.errstate(divide="ignore"):
        low = (boxes[:, None, :2] - start) / ways[None]
        high = (boxes[:, None, 2:] - start) / ways[None]
    enter = np.minimum(low, high).max(axis=2)
    leave = np.maximum(low, high).min(axis=2)
    met = (enter <= leave) & (leave > 0.0)
    return np.where(met, np.maximum(enter, 0.0), 1e9).min(axis=0)


def _blind(robot: ScriptedRobot) -> CameraImage:
    """A camera that measures no depth anywhere."""
    camera = robot.description.camera()[1]
    size = (camera.height, camera.width)
    focus = 0.5 * camera.width / math.tan(0.5 * camera.horizontal_fov)
    k = np.array([[focus, 0, size[1] / 2], [0, focus, size[0] / 2], [0, 0, 1]])
    color, depth = np.zeros((*size, 3), np.uint8), np.zeros(size, np.float32)
    return CameraImage(robot.time, camera.frame, color, depth, k)


class FlatScene:
    """A planning scene whose footprint is the base's, and to which nothing is the robot.

    load: height of the lowest point and corners (n, 2) of something that sticks out, base frame.
    """

    held = None
    last_contact = -math.inf

    def __init__(self, outline: Sequence[tuple[float, float]]) -> None:
        self.outline = np.array(outline)
        self.load: tuple[float, np.ndarray] | None = None

    def footprint(self, state: RobotState, below: float = math.inf) -> np.ndarray:
        if self.load is None or self.load[0] >= below:
            return self.outline
        return floor_outline(np.vstack([self.outline, self.load[1]]))

    def is_robot(self, points: np.ndarray, state: RobotState) -> np.ndarray:
        return np.zeros(len(points), dtype=bool)


def write_map(folder: Path, known: Sequence[Box], span: Box) -> Path:
    """A map_server map of boxes, 0.05 m per pixel, over `span`."""
    columns, rows = round((span[2] - span[0]) / 0.05), round((span[3] - span[1]) / 0.05)
    y, x = np.mgrid[0:rows, 0:columns]
    x, y = span[0] + (x + 0.5) * 0.05, span[1] + (y + 0.5) * 0.05
    pixels = np.full((rows, columns), 254, np.uint8)
    for x0, y0, x1, y1 in known:
        pixels[(x > x0) & (x < x1) & (y > y0) & (y < y1)] = 0
    header = f"P5\n# drawn\n{columns} {rows}\n255\n".encode()
    (folder / "flat.pgm").write_bytes(header + pixels[::-1].tobytes())
    (folder / "flat.yaml").write_text(
        f"image: flat.pgm\nresolution: 0.05\norigin: [{span[0]}, {span[1]}, 0.0]\n"
        "negate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n"
    )
    return folder / "flat.yaml"


Flat = Callable[..., ScriptedWorld]

ROOMS: tuple[Box, ...] = (
    (-4.0, -3.0, 6.0, -2.9),
    (-4.0, 3.0, 6.0, 3.1),
    (-4.1, -3.0, -4.0, 3.1),
    (6.0, -3.0, 6.1, 3.1),
    (1.0, -3.0, 1.1, 0.4),
    (1.0, 1.5, 1.1, 3.0),
    (-3.2, -2.9, -2.2, -2.3),
)
"""Two rooms with a doorway 1.1 m wide between them, and a cupboard to tell left from right."""

DESK: Box = (3.6, -0.4, 4.2, 0.8)
"""A solid desk in the second room."""


START = Pose2D(-2.0, 0.0, 0.0)
"""In the first room, looking at the doorway's side."""


@pytest.fixture
def flat(tmp_path: Path) -> Flat:
    """`flat(truth, believed=…, hidden=…, moved=…)`: two rooms, a desk and a robot in them."""

    def build(
        truth: Pose2D = START,
        *,
        believed: Pose2D | None = None,
        hidden: Sequence[Box] = (),
        desk: Box = DESK,
        known: Sequence[Box] = (),
        seed: int = 0,
        drift: float = 0.02,
        description: RobotDescription | None = None,
    ) -> ScriptedWorld:
        robot = FlatRobot(truth, seed, drift, description)
        robot.boxes = [*ROOMS, *known, desk, *hidden]
        site = scripted_site(
            map_file=write_map(tmp_path, [*ROOMS, *known, DESK], (-4.5, -3.5, 6.5, 3.5)),
            start=believed or truth,
            places={"left": Pose2D(-2.0, 1.5, 0.0), "right": Pose2D(2.2, -2.0, -1.0)},
            surfaces={
                "desk": Surface(Pose2D(3.9, 0.2, 0.0), (0.6, 1.2), 0.7, (math.pi, -math.pi / 2))
            },
        )
        return ScriptedWorld(robot, site)

    return build


@pytest.fixture
def flat_scene() -> Callable[[ScriptedWorld], FlatScene]:
    """`flat_scene(world)`: the planning scene that navigation needs."""
    return lambda world: FlatScene(world.robot.description.footprint)


class SeenScene:
    """A planning scene to which points in a box (low, high corners in the base) are the robot.

    observed: how many pictures it was shown.
    """

    last_contact = -math.inf

    def __init__(self, held: HeldObject | None = None, robot: Sequence[Box3] = ()) -> None:
        self.held, self.robot = held, robot
        self.observed = 0

    def observe(self, snapshot: Snapshot) -> None:
        self.observed += 1

    def is_robot(self, points: np.ndarray, state: RobotState) -> np.ndarray:
        inside = np.zeros(len(points), dtype=bool)
        for low, high in self.robot:
            inside |= ((points >= low) & (points <= high)).all(axis=1)
        return inside


Box3 = tuple[tuple[float, float, float], tuple[float, float, float]]


@pytest.fixture
def seen_scene() -> type[SeenScene]:
    """`seen_scene(held=…, robot=…)`: the planning scene that perception needs."""
    return SeenScene


@pytest.fixture
def onlooker() -> Callable[..., ScriptedRobot]:
    """`onlooker(solids, …)`: a robot at the origin, its camera 1.15 m high; see `Painter`."""

    def build(solids: Sequence[Solid], **errors: Any) -> ScriptedRobot:
        description = small_robot()
        camera = description.sensors["camera"].model_copy(update={"width": 640, "height": 480})
        description = description.model_copy(
            update={"sensors": {**description.sensors, "camera": camera}}
        )
        return ScriptedRobot(description, readings={"camera": Painter(solids, **errors)})

    return build


TABLE = 0.72
"""m; height of the scripted table's top."""


class Tabletop(ScriptedRobot):
    """Fetch, or another robot, before a table with a can on it; what it grasps moves with it.

    can: odom_from_can, its centre. slips: it stays behind when the hand rises. stays_hidden: the
    camera does not see it. weightless: the wrist feels nothing of it. others: more solids.
    table: height of the top as it is; surface_felt: whether touching it is felt.
    """

    def __init__(
        self,
        can: tuple[float, float] | None = (0.75, 0.0),
        pose: str = "ready",
        description: RobotDescription | None = None,
    ) -> None:
        description = description or fetch()
        joints = description.named_poses[pose]
        super().__init__(description, joints=joints)
        self.can = None if can is None else Transform((*can, TABLE + 0.065))
        self.table, self.others = TABLE, list[Solid]()
        self.slips = self.stays_hidden = self.weightless = self.topples = False
        self.surface_felt = True
        self.hand_from_can: Transform | None = None
        self.readings = {description.camera()[0]: Tabletop._picture, "wrench": Tabletop._wrench}
        self._kinematics = description.kinematics()

    def hold(self, hand_from_can: Transform) -> None:
        """Begin with the can between the fingers."""
        self.hand_from_can = hand_from_can
        self.object_width = self.gripper_width = 0.07
        self.command("gripper", GripperCommand(0.04, 45.0))
        self._follow_hand()

    @property
    def odom_from_hand(self) -> Transform:
        link = self.description.end_effector.frame
        return self.base.transform() @ self._kinematics.base_from_frame(link, self.joints)

    def advance(self, seconds: float) -> None:
        super().advance(seconds)
        if self.can is None:
            return
        inside = self.odom_from_hand.inverse().apply(self.can.position)
        between = bool((np.abs(inside) < (0.02, 0.02, 0.07)).all())
        self.object_width = 0.07 if between or self.hand_from_can is not None else None
        if self.hand_from_can is None and between and self.gripper_effort > 0.0:
            self.hand_from_can = self.odom_from_hand.inverse() @ self.can
        elif self.hand_from_can is not None and self.gripper_width > 0.072:
            self._drop()
        if self.hand_from_can is not None:
            lifted = self.odom_from_hand @ self.hand_from_can
            if self.slips and lifted.position[2] > self.table + 0.075:
                self._drop()
            else:
                self._follow_hand()

    def _follow_hand(self) -> None:
        assert self.hand_from_can is not None
        self.can = self.odom_from_hand @ self.hand_from_can

    def _drop(self) -> None:
        assert self.can is not None
        self.hand_from_can = self.object_width = None
        x, y, _ = self.can.position
        self.can = Transform((x, y, self.table + 0.065))

    def detected(self, stamp: float | None = None) -> DetectedObject:
        """The can as a detector would report it."""
        assert self.can is not None
        pose = Pose(self.can, "odom", self.time if stamp is None else stamp)
        return DetectedObject("can", pose, (0.07, 0.07, 0.13), "cylinder", 0.9, TABLE)

    def _picture(self) -> CameraImage:
        solids: list[Solid] = [Block((0.8, 1.4, self.table), (0.9, 0.0, self.table / 2))]
        if self.can is not None and not self.stays_hidden:
            x, y, z = self.can.position
            if self.topples and self.hand_from_can is None:
                solids.append(Block((0.13, 0.07, 0.07), (x, y, self.table + 0.035)))
            else:
                solids.append(Round((x, y, z - 0.065), 0.13, 0.035))
        return Painter([*solids, *self.others])(self)

    def _wrench(self) -> WrenchReading:
        force = np.zeros(3)
        if self.hand_from_can is not None and self.can is not None and not self.weightless:
            depth = self.table - (float(self.can.position[2]) - 0.065)
            carried = 3000.0 * max(0.0, depth) if self.surface_felt else 0.0
            force[2] = carried - 3.9
        frame = self.description.end_effector.frame
        turned = self.odom_from_hand.rotation.T @ force
        return WrenchReading(self.time, frame, frozen(turned), frozen(np.zeros(3)))


@pytest.fixture
def tabletop() -> type[Tabletop]:
    """`tabletop(can=…, pose=…)`: Fetch before a can on a table; see `Tabletop`."""
    return Tabletop


@pytest.fixture
def scene_of() -> Callable[[ScriptedRobot], PlanningSceneService]:
    """`scene_of(robot)`: a planning scene that has been started and updated once."""

    def build(robot: ScriptedRobot) -> PlanningSceneService:
        service = PlanningSceneService()
        frames = FrameBuffer(robot.description.kinematics())
        site, random = scripted_site(), np.random.default_rng(0)
        service.start(
            ServiceContext(site, robot.description, frames, robot, random, {}, lambda name: None)
        )
        service.update(robot, robot.time)
        return service

    return build


@pytest.fixture
def stretched_out() -> ScriptedRobot:
    """A robot whose arm is stretched out with the camera that it carries, and does not move."""
    description = eye_in_hand_robot()
    joints = zip(description.groups["arm"].joints, (0.0, 2.0, 3.14, 0.0, 0.0, 0.0), strict=True)
    robot = ScriptedRobot(description, joints=dict(joints), readings={"camera": Painter([])})
    robot.frozen.add("arm")
    return robot
