"""The proposal: everything found in a robot's URDF, in the order it needs."""

from __future__ import annotations

import math
import re
import tempfile
from dataclasses import dataclass
from pathlib import Path

from momantu_bt.frames import KinematicTree
from momantu_bt.geometry import Transform
from momantu_skills.robot_setup.find.arms import Limbs, find_limbs, own_chain
from momantu_skills.robot_setup.find.base import (
    ABOVE,
    BaseFrame,
    Stand,
    find_base,
    find_stand,
    planar,
)
from momantu_skills.robot_setup.find.cameras import OPTICAL_FROM_LINK, best_first
from momantu_skills.robot_setup.find.fingers import find_hands
from momantu_skills.robot_setup.find.grasp import Grasp, find_grasp
from momantu_skills.robot_setup.find.limits import FoundLimit, find_limits, plain_limits
from momantu_skills.robot_setup.find.matrix import SAMPLES, CollisionMatrix, Why, sample_matrix
from momantu_skills.robot_setup.find.named import find_poses, fold_others
from momantu_skills.robot_setup.find.poses import OPENINGS, VIEW, Eye, FoundPose, PoseFinder
from momantu_skills.robot_setup.find.reach import Reach, find_reach
from momantu_skills.robot_setup.find.sensors import FoundSensor, find_sensors
from momantu_skills.robot_setup.find.wheels import Driving, find_driving
from momantu_skills.robot_setup.urdf.arm_ik import LimbSolver
from momantu_skills.robot_setup.urdf.body import Body
from momantu_skills.robot_setup.urdf.cells import cuts_of, swallowed
from momantu_skills.robot_setup.urdf.prepare import Given, Placed, Prepared, prepare
from momantu_skills.robot_setup.urdf.simulated import hollow, pressing

TALLEST = 0.05
"""m to which the robot's height is rounded up."""


@dataclass(frozen=True)
class Proposal:
    """What a robot file is written from. grasp: of the arm's hand. poses: empty without an arm.

    grasps: of further arms' hands. cells: cuts of meshes. pressing: pairs that only a simulator
    ignores. notes: what was left out of the URDF or decided, and why.
    """

    name: str
    prepared: Prepared
    base: BaseFrame
    virtual: tuple[str, str, str] | None
    stand: Stand
    driving: Driving
    limbs: Limbs
    grasp: Grasp | None
    grasps: dict[str, Grasp]
    sensors: tuple[FoundSensor, ...]
    carriers: dict[str, str]
    limits: dict[str, FoundLimit]
    matrix: CollisionMatrix
    poses: dict[str, FoundPose]
    reach: Reach
    height: float
    cells: dict[str, dict[str, tuple[float, ...]]]
    pressing: tuple[tuple[str, str], ...]
    notes: tuple[str, ...]


def propose(
    source: Path, *, samples: int = SAMPLES, seed: int = 0, given: Given | None = None
) -> Proposal:
    """Find out all there is about a URDF or xacro file.

    given: arguments of a xacro file, and where packages are.

    Raises:
        SetupError: it is not a URDF of one robot, or no mechanism.
    """
    with tempfile.TemporaryDirectory() as folder:
        prepared = prepare(source, Path(folder), given)
        return _propose(prepared, samples, seed)


def _propose(prepared: Prepared, samples: int, seed: int) -> Proposal:
    skeleton = prepared.skeleton
    base = find_base(skeleton)
    body = Body(skeleton, Placed(prepared.urdf, base.frame))
    stand = find_stand(body)
    hands = find_hands(body)
    sensors = best_first(
        body, find_sensors(prepared.document, skeleton, set(skeleton.subtree(base.frame))), hands
    )
    camera = next((sensor for sensor in sensors if sensor.kind == "camera"), None)
    eye = None if camera is None else camera.link
    limbs = find_limbs(body, hands, eye, stand.wheels)
    grasps = {
        limb.name: find_grasp(body, limb.hand)
        for limb in (limbs.arm, *limbs.others)
        if limb is not None and limb.hand is not None
    }
    limits = find_limits(body, _actuated(limbs), _light(limbs))
    closed = [{n: rows[0][1] for n, rows in g.opening.items()} for g in grasps.values()]
    used = [limb.hand for limb in (limbs.arm, *limbs.others) if limb and limb.hand]
    matrix = sample_matrix(body, samples, seed, closed, used)
    solver = _hand_solver(prepared, base, limbs, grasps.get("arm"), limits, seed)
    poses = _poses(prepared, base, body, stand, limbs, camera, limits, matrix, solver, seed)
    virtual = planar(skeleton, base.virtual)
    cells = _cells(body, poses, matrix)
    return Proposal(
        robot_name(prepared),
        prepared,
        base,
        virtual,
        stand,
        find_driving(body, prepared.document, stand.wheels, virtual is not None),
        limbs,
        grasps.get("arm"),
        grasps,
        tuple(sensors),
        {sensor.link: carrier_of(body, limbs, sensor) for sensor in sensors},
        limits,
        matrix,
        poses,
        find_reach(solver, stand),
        _height(body, stand, poses),
        cells,
        _pressing(body, limbs, poses, matrix, cells),
        (*prepared.notes, *limbs.notes),
    )


def robot_name(prepared: Prepared) -> str:
    """The URDF's name in the letters that a robot file takes."""
    given = prepared.document.get("name") or prepared.source.name.split(".")[0]
    name = re.sub(r"[^a-z0-9]+", "_", given.lower()).strip("_")
    return name if name and name[0].isalpha() else f"robot_{name}".rstrip("_")


def carrier_of(body: Body, limbs: Limbs, sensor: FoundSensor) -> str:
    """The actuator that moves a sensor; empty where none does.

    An arm does only if most of its joints do: a torso that lifts arm and head carries both.
    """
    chain = set(own_chain(body, sensor.link))
    if limbs.head is not None and chain & set(limbs.head.joints):
        return limbs.head.name
    for limb in (limbs.arm, *limbs.others):
        if limb is not None and 2 * len(chain & set(limb.joints)) >= len(limb.joints):
            return limb.name
    return ""


def _actuated(limbs: Limbs) -> tuple[str, ...]:
    every = [limb for limb in (limbs.arm, *limbs.others, limbs.head) if limb is not None]
    joints = [name for limb in every for name in limb.joints]
    fingers = [n for limb in every if limb.hand is not None for n in limb.hand.leaders]
    return (*joints, *limbs.rest, *fingers)


def _light(limbs: Limbs) -> tuple[str, ...]:
    fingers = [limb.hand.leaders for limb in (limbs.arm, *limbs.others) if limb and limb.hand]
    head = limbs.head.joints if limbs.head else ()
    return (*head, *(name for some in fingers for name in some))


def _hand_solver(
    prepared: Prepared,
    base: BaseFrame,
    limbs: Limbs,
    grasp: Grasp | None,
    limits: dict[str, FoundLimit],
    seed: int,
) -> LimbSolver | None:
    if limbs.arm is None or grasp is None:
        return None
    place = grasp.link_from_grasp or Transform((grasp.offset, 0.0, 0.0))
    tree = KinematicTree.from_urdf(prepared.urdf, base.frame)
    return LimbSolver(tree, limbs.arm.joints, plain_limits(limits), grasp.link, place, seed)


def _poses(
    prepared: Prepared,
    base: BaseFrame,
    body: Body,
    stand: Stand,
    limbs: Limbs,
    camera: FoundSensor | None,
    limits: dict[str, FoundLimit],
    matrix: CollisionMatrix,
    hand: LimbSolver | None,
    seed: int,
) -> dict[str, FoundPose]:
    if limbs.arm is None:
        return {}
    eye, view = None, None
    if camera is not None:
        place = Transform() if camera.optical else OPTICAL_FROM_LINK
        in_hand = carrier_of(body, limbs, camera) == limbs.arm.name
        eye = Eye(camera.link, place, camera.fov or VIEW, in_hand)
        if in_hand:
            tree = KinematicTree.from_urdf(prepared.urdf, base.frame)
            joints, known = limbs.arm.joints, plain_limits(limits)
            view = LimbSolver(tree, joints, known, camera.link, place, seed, upright=False)
    pairs = matrix.pairs(Why.SOMETIMES, Why.NEVER)
    folded = fold_others(body, limbs, stand, pairs, seed)
    finder = PoseFinder(body, limbs, stand, pairs, eye, seed, folded)
    return find_poses(finder, hand, view)


def _cells(
    body: Body, poses: dict[str, FoundPose], matrix: CollisionMatrix
) -> dict[str, dict[str, tuple[float, ...]]]:
    """Cuts of long links whose hull other links lie in, or whose hull fills hollows of theirs."""
    postures = {name: pose.joints for name, pose in poses.items()}
    found = [long for _, _, long in swallowed(body, postures, matrix.ignored)]
    return {link: cuts_of(body, link) for link in dict.fromkeys((*found, *hollow(body, ABOVE)))}


def _pressing(
    body: Body,
    limbs: Limbs,
    poses: dict[str, FoundPose],
    matrix: CollisionMatrix,
    cells: dict[str, dict[str, tuple[float, ...]]],
) -> tuple[tuple[str, str], ...]:
    """Pairs that only a simulator is to ignore: their hulls meet where the links do not."""
    hands = [limb.hand for limb in (limbs.arm, *limbs.others) if limb is not None and limb.hand]
    postures = [
        {**pose.joints, **{name: q for hand in hands for name, q in hand.posture(share).items()}}
        for pose in poses.values()
        for share in OPENINGS
    ]
    return pressing(body, matrix.pairs(Why.SOMETIMES, Why.NEVER), cells, postures)


def _height(body: Body, stand: Stand, poses: dict[str, FoundPose]) -> float:
    tops = [
        float(body.corners(body.hulls, posture)[:, 2].max()) - stand.floor
        for posture in [pose.joints for pose in poses.values()] or [{}]
        if body.hulls
    ]
    return round(math.ceil(max(tops, default=0.0) / TALLEST) * TALLEST, 3) or TALLEST
