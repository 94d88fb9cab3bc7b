"""Planning how an arm moves so that its camera sees a point."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import product

import numpy as np
from numpy.typing import NDArray

from momantu_bt.failure import Failure
from momantu_bt.geometry import Array
from momantu_bt.messages import JointTrajectory
from momantu_bt.robot import CameraSensor, Robot
from momantu_bt.service import HeldObject
from momantu_bt.skill import Run, Skill, compute
from momantu_skills.gaze.line_of_sight import line_of_sight
from momantu_skills.manipulation.arm import LEAN_PENALTY, Arm
from momantu_skills.manipulation.config import GazeConfig
from momantu_skills.manipulation.model.arm_model import ArmModel
from momantu_skills.manipulation.model.collision import CollisionWorld, Obstacle
from momantu_skills.manipulation.scene.arm_scene import ArmScene

THINKING = 0.2
"""Time allowed for choosing a posture and planning the path, s: twice the median."""
CANDIDATES = 4000
"""Random postures that are turned towards the point; one in twenty gets a good view of it."""
NEARBY = 64
"""Postures that are tried around the current one."""
SPREAD = (0.15, 0.4)
"""Standard deviations of those postures, rad."""
ALMOST = 1.2
"""Largest angle to the point from which a posture is turned towards it, rad; larger angles need a
long motion."""
ON_IT = 0.01
"""Angle to the line of sight within which the point counts as on it, rad."""
TESTED = 400
"""Most postures that are checked for collisions."""
ENOUGH = 6
"""Postures to which a path is searched: the planner takes the first that it can reach."""
BESIDE = 0.3
"""Distance from the base's axis within which a point may be seen from any side, m."""
CLEAR = 0.03
"""Radius around the line of sight that must be free of known obstacles, m."""
LONGEST_ARM = 2.0
"""Distance from the camera within which the robot's own body may be in the view, m."""
ENDS = 0.12
"""Length at both ends of that line that is not checked, m: the hand, and the viewed object."""


@dataclass(frozen=True, eq=False)
class _Library:
    """Postures (m, n) of the joints that move the camera, and base_from_camera (m, 4, 4)."""

    postures: Array
    cameras: Array


@lru_cache(maxsize=4)
def _library(model: ArmModel) -> _Library:
    """Random postures of a robot, the same in every process; drawn once per process."""
    eye = model.eye
    lower = np.where(eye.endless, -np.pi, eye.lower)
    upper = np.where(eye.endless, np.pi, eye.upper)
    postures = np.random.default_rng(0).uniform(lower, upper, (CANDIDATES, len(eye.names)))
    return _Library(postures, eye.poses(postures))


def gaze(
    skill: Skill,
    robot: Robot,
    service: ArmScene,
    point_odom: Array,
    within: float,
    around: Sequence[Array] = (),
) -> Run:
    """Move the arm until its camera sees a point (3,) in odom; see `look_at.look_at`.

    Raises:
        Failure: OUT_OF_VIEW, with what stopped the arm as its cause.
    """
    arm = Arm(skill, robot, service)
    yield from arm.settle()
    arm.observe()
    base_from_odom = arm.state.odom_from_base.inverse()
    solids = tuple(
        Obstacle(f"solid {i}", base_from_odom.apply(corners)) for i, corners in enumerate(around)
    )
    try:
        way = yield from compute(lambda: plan_gaze(arm, point_odom, within, solids), THINKING)
        for trajectory in way:
            yield from arm.follow(trajectory, "look")
    except Failure as failure:
        if failure.code == "OUT_OF_VIEW":
            raise
        why = failure.value.message
        raise Failure(
            "OUT_OF_VIEW", f"the arm cannot bring its camera there: {why}", cause=failure.code
        ) from None


def plan_gaze(
    arm: Arm, point_odom: Array, within: float, around: tuple[Obstacle, ...] = ()
) -> list[JointTrajectory]:
    """Plan the path to the quickest good posture whose camera sees a point (3,) in odom.

    within: largest angle of the point to the optical axis, rad, if the held object hides the axis.
    around: solids to avoid, in addition to those of the scene.

    Raises:
        Failure: OUT_OF_VIEW if no posture sees it; NO_PLAN, START_IN_COLLISION.
    """
    state, held = arm.state, arm.service.held
    point = state.odom_from_base.inverse().apply(point_odom)
    ray = line_of_sight(arm.scene, state, held, within)
    postures = _ranked(arm, held, ray, point)
    for supposed, margin in product(arm.stages, arm.planning.margins):
        world = arm.scene.world(state, held, margin, extra=around, supposed=supposed)
        goals = free_postures(arm, world, postures[:TESTED], point)
        if goals:
            return arm.route(goals, held, extra=around)
    x, y, z = point
    raise Failure(
        "OUT_OF_VIEW",
        f"{len(postures)} postures of the arm point its camera at ({x:.2f}, {y:.2f}, {z:.2f}) m in "
        "the base frame, and all of them touch something or have something in between"
        if len(postures)
        else f"no posture of the arm points its camera at ({x:.2f}, {y:.2f}, {z:.2f}) m in the "
        "base frame; drive nearer, or turn the robot towards it",
        postures=len(postures),
    )


def _ranked(arm: Arm, held: HeldObject | None, ray: Array, point: Array) -> Array:
    """Postures (k, n) of the arm with the point on the ray, cheapest first."""
    model, start = arm.scene.model, arm.joints
    eye, config = model.eye, GazeConfig()
    sensor = model.description.camera()[1]
    index = [model.group.names.index(name) for name in eye.names]
    found, off = eye.point(start_postures(arm, start[index], ray, point), ray, point)
    found = eye.nearest_turn(found, start[index])
    cameras = eye.poses(found)
    cost = np.max(np.abs(found - start[index]) / eye.velocity, axis=1)
    cost += _penalty(cameras, ray, point, config)
    usable = (off < ON_IT) & _well_placed(cameras, point, sensor)
    postures = np.repeat(start[None], len(found), axis=0)
    postures[:, index] = found
    if held is not None:
        leans = np.array([arm.lean(held, q) for q in postures])
        usable &= leans <= max(arm.planning.tilt, arm.lean(held, start) + config.tilt_slack)
        cost += LEAN_PENALTY * leans
    order = np.argsort(cost, kind="stable")
    return np.asarray(postures[order[usable[order]]])


def start_postures(arm: Arm, start: Array, ray: Array, point: Array) -> Array:
    """Start postures (m, n): around the current one, and library ones that almost see it."""
    eye, library = arm.scene.model.eye, _library(arm.scene.model)
    spread = np.repeat(SPREAD, NEARBY // len(SPREAD))[:, None]
    near = start + spread * arm.skill.random.normal(size=(len(spread), len(start)))
    near = np.clip(near, eye.lower, eye.upper)
    way = point - library.cameras[:, :3, 3]
    way /= np.linalg.norm(way, axis=1, keepdims=True)
    almost = np.einsum("mi,mi->m", library.cameras[:, :3, :3] @ ray, way) > math.cos(ALMOST)
    return np.vstack([start, near, library.postures[almost]])


def _well_placed(cameras: Array, point: Array, sensor: CameraSensor) -> NDArray[np.bool_]:
    """Whether the point is at a measurable depth, and seen from the robot's side of it: (m,)."""
    way = point - cameras[:, :3, 3]
    depth = np.einsum("mi,mi->m", cameras[:, :3, 2], way)
    fits = (depth > sensor.min_depth) & (depth < sensor.max_depth)
    out = float(np.hypot(point[0], point[1]))
    if out > BESIDE:
        fits &= way[:, :2] @ (point[:2] / out) > 0.0
    return np.asarray(fits)


def _penalty(cameras: Array, ray: Array, point: Array, config: GazeConfig) -> Array:
    """Extra cost (m,) of a view, s: how much longer than a perfect one it may take to reach."""
    way = point - cameras[:, :3, 3]
    length = np.linalg.norm(way, axis=1)
    near, far = config.distances
    cost = config.distance_penalty * np.abs(length - np.clip(length, near, far))
    down = np.arcsin(np.clip(-way[:, 2] / length, -1.0, 1.0))
    flat, steep = config.elevations
    cost += config.elevation_penalty * np.abs(down - np.clip(down, flat, steep))
    return np.asarray(cost + config.roll_penalty * np.abs(cameras[:, 2, 0]))


def free_postures(arm: Arm, world: CollisionWorld, postures: Array, point: Array) -> list[Array]:
    """The first postures without collision and with a free line from camera to point."""
    eye = arm.scene.model.eye
    index = [arm.group.names.index(name) for name in eye.names]
    base_from_odom = arm.state.odom_from_base.inverse()
    cells = base_from_odom.apply(arm.scene.surroundings.cells)
    found: list[Array] = []
    for q in postures:
        camera = eye.tip_matrix(q[index])[:3, 3]
        if _hidden(camera, point, cells) or not world.free(q):
            continue
        ends = arm.state.odom_from_base.apply(np.vstack([camera, point]))
        if any(solid.between(*ends) for solid in arm.scene.overhead):
            continue
        if not arm.scene.own.hides(_between(camera, point), q):
            found.append(q)
            if len(found) == ENOUGH:
                break
    return found


def _between(camera: Array, point: Array) -> Array:
    """Points (n, 3) on the line from the camera to a point, without both ends."""
    length = float(np.linalg.norm(point - camera))
    along = np.arange(ENDS, max(ENDS, min(length, LONGEST_ARM)), CLEAR)
    return np.asarray(camera + along[:, None] * ((point - camera) / length))


def _hidden(camera: Array, point: Array, cells: Array) -> bool:
    """Whether one of cells (n, 3) is on the line from the camera to the point."""
    way = point - camera
    length = float(np.linalg.norm(way))
    offsets = cells - camera
    along = offsets @ (way / length)
    between = offsets[(along > ENDS) & (along < length - ENDS)]
    along = along[(along > ENDS) & (along < length - ENDS)]
    aside = np.linalg.norm(between - along[:, None] * (way / length), axis=1)
    return bool((aside < CLEAR).any())
