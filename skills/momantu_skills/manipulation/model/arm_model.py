"""A robot's body for planning: links, hulls, chains of joints. All poses are in the base frame."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray
from scipy.spatial import ConvexHull

from momantu_bt.formats.urdf import read_urdf
from momantu_bt.frames import Joint, KinematicTree
from momantu_bt.geometry import Array, Transform
from momantu_bt.messages import RobotState
from momantu_bt.robot import ARM, JointLimit, RobotDescription
from momantu_skills.manipulation.model import kinematics as kin
from momantu_skills.manipulation.model.hulls import link_hulls
from momantu_skills.manipulation.model.urdf import base_urdf

PACE = 1.5
"""Speed of a usual arm's joints, rad/s; the joints of a group are scaled relative to it."""
JUMP = 0.25
"""Largest joint motion between two solutions 1 cm apart on a straight line, rad; more means another
arm configuration."""
RANKED = 8
"""Random postures in which the freedoms of a chain are counted."""
SINGULAR = 1e-3
"""Least singular value of a Jacobian, m or rad per rad or m, that counts as a freedom."""
NEAR, TURN = 5e-4, 3e-3
"""Tolerances of inverse kinematics, m and rad: well below calibration errors."""


@dataclass(frozen=True)
class Group:
    """A chain of n joints from the base to a tip, with limits (endless joints: infinite).

    scale (n,): converts joint angles to equal times. For the other fields see `kinematics`.
    """

    names: tuple[str, ...]
    lower: Array
    upper: Array
    velocity: Array
    acceleration: Array
    origins: Array
    axes: Array
    slides: NDArray[np.bool_]
    tip: Array

    @property
    def pace(self) -> float:
        """Speed in rad/s: a scaled radian takes 1 / pace s on each joint. Less on a slow arm."""
        return min(PACE, float(np.median(self.velocity)))

    @property
    def scale(self) -> Array:
        """Scaled radians per radian or metre, (n,)."""
        return self.pace / self.velocity

    @property
    def endless(self) -> NDArray[np.bool_]:
        """Which joints (n,) can turn without limit."""
        return np.asarray(~np.isfinite(self.lower))

    @cached_property
    def chain(self) -> kin.Chain:
        """The joints in the form that the compiled kinematics take."""
        weights = (self.velocity / self.pace) ** 2
        limits = (self.lower, self.upper)
        return kin.Chain(self.origins, self.axes, self.slides, self.tip, *limits, weights)

    def tip_pose(self, q: Array) -> Transform:
        """base_from_tip at joints (n,)."""
        r, p, _ = kin.forward(self.chain, q)
        return Transform.from_rotation(r, p)

    def tip_matrix(self, q: Array) -> Array:
        """base_from_tip (4, 4) at joints (n,)."""
        m = np.eye(4)
        m[:3, :3], m[:3, 3], _ = kin.forward(self.chain, q)
        return m

    def jacobian(self, q: Array) -> Array:
        """(6, n): velocity of the tip, then angular velocity, in base, per joint."""
        return np.asarray(kin.forward(self.chain, q)[2])

    def solve(self, targets: Array, seeds: Array, rounds: int = 40) -> tuple[Array, Array]:
        """Inverse kinematics of poses (m, 4, 4) from seeds (s, n).

        Returns joints (m, s, n) within the limits, and success (m, s).
        """
        found, good = kin.solve(
            self.chain, np.ascontiguousarray(targets), seeds, rounds, NEAR, TURN
        )
        return found, good

    def trace(self, targets: Array, start: Array) -> tuple[Array, int]:
        """Joints along poses (k, 4, 4) a centimetre apart: (reached, n), and their number."""
        path, reached = kin.trace(
            self.chain, np.ascontiguousarray(targets), np.array(start), NEAR, TURN, JUMP
        )
        return path[:reached], int(reached)

    @cached_property
    def freedoms(self) -> int:
        """In how many of its six directions and turns the chain moves its tip."""
        lower = np.where(self.endless, -np.pi, self.lower)
        upper = np.where(self.endless, np.pi, self.upper)
        draws = np.random.default_rng(0).uniform(lower, upper, (RANKED, len(lower)))
        return max(int(np.linalg.matrix_rank(self.jacobian(q), tol=SINGULAR)) for q in draws)

    @property
    def few(self) -> bool:
        """Whether it has too few joints to choose the turn of the hand about the vertical."""
        return self.freedoms < 6

    def turning(self, tip_from_axis: Array, limit: float) -> Group:
        """Return the chain with one more joint, a turn of the tip about z of a frame on it.

        A pose that this chain reaches is one of this group's but for such a turn. tip_from_axis:
        (4, 4). limit: rad, infinite for a free turn.
        """
        return replace(
            self,
            names=(*self.names, "turn"),
            lower=np.append(self.lower, -limit),
            upper=np.append(self.upper, limit),
            velocity=np.append(self.velocity, self.velocity.max()),
            acceleration=np.append(self.acceleration, 1.0),
            origins=np.concatenate([self.origins, (self.tip @ tip_from_axis)[None]]),
            axes=np.vstack([self.axes, (0.0, 0.0, 1.0)]),
            slides=np.append(self.slides, False),
            tip=np.asarray(np.linalg.inv(tip_from_axis), dtype=np.float64),
        )

    def solve_upright(
        self, targets: Array, centres: Array, seeds: Array, limit: float, rounds: int = 60
    ) -> tuple[Array, Array]:
        """Inverse kinematics of poses (m, 4, 4) but for a turn about the vertical.

        centres: (m, 3) points in base, or (3,), through which the axes of the turns go. limit: of
        the turns, rad. Returns joints (m, s, n) and success (m, s), as `solve` does.
        """
        found = np.zeros((len(targets), *seeds.shape))
        good = np.zeros(found.shape[:2], dtype=np.bool_)
        starts = np.column_stack([seeds, np.zeros(len(seeds))])
        for i, (target, centre) in enumerate(
            zip(targets, np.broadcast_to(centres, (len(targets), 3)), strict=True)
        ):
            base_from_axis = np.eye(4)
            base_from_axis[:3, 3] = centre
            group = self.turning(np.linalg.inv(target) @ base_from_axis, limit)
            joints, good[i : i + 1] = group.solve(target[None], starts, rounds)
            found[i] = joints[0, :, :-1]
        return found, good

    def trace_upright(
        self, targets: Array, start: Array, tip_from_axis: Array, limit: float
    ) -> tuple[Array, int]:
        """As `trace`, but each pose may be turned by up to `limit` rad about an axis of the tip."""
        group = self.turning(tip_from_axis, limit)
        path, reached = group.trace(targets, np.append(start, 0.0))
        return path[:, :-1], reached

    def poses(self, postures: Array) -> Array:
        """base_from_tip (m, 4, 4) at each of joints (m, n)."""
        return np.asarray(kin.poses(self.chain, postures))

    def point(
        self, starts: Array, ray: Array, target: Array, rounds: int = 12
    ) -> tuple[Array, Array]:
        """Rotate a ray (3,) of the tip towards a point (3,) in base, from joints (m, n).

        Returns joints (m, n) within the limits, with little motion, and the remaining angles (m,),
        rad.
        """
        found, left = kin.point(self.chain, starts, ray, target, rounds, TURN)
        return found, left

    def nearest_turn(self, q: Array, reference: Array) -> Array:
        """The same posture, with endless joints (.., n) within half a turn of `reference` (n,)."""
        turns = np.round((q - reference) / (2 * np.pi)) * (2 * np.pi)
        return np.where(self.endless, q - turns, q)


class ArmModel:
    """Kinematics and hulls of the whole robot; one planning group moves.

    A robot without an arm has a model too: its hulls tell what belongs to it in pictures.
    """

    def __init__(self, description: RobotDescription, group: str = ARM) -> None:
        self.description = description
        self.urdf = base_urdf(description)
        self.pin: pin.Model = pin.buildModelFromXML(self.urdf.text)
        self.hulls = link_hulls(self.urdf.parts)
        self._name = group
        effector = description.end_effector
        tip = () if effector is None else (effector.frame,)
        self._index = {
            name: int(self.pin.joints[self.pin.getJointId(name)].idx_q)
            for name in list(self.pin.names)[1:]
        }
        self._followers = [
            (self._index[joint.name], self._index[joint.mimic.leader], joint.mimic)
            for joint in read_urdf(description.urdf).joints
            if joint.mimic and joint.name in self._index and joint.mimic.leader in self._index
            if effector is None or joint.name not in effector.opening
        ]
        self.frame_ids = {
            link: int(self.pin.getFrameId(link, pin.FrameType.BODY)) for link in (*self.hulls, *tip)
        }

    @cached_property
    def group(self) -> Group:
        """The planning group, to the hand's frame, or to its own tip on an arm without a hand.

        Raises:
            LookupError: the robot has no such group.
        """
        description = self.description
        if self._name not in description.groups:
            raise LookupError(f"the robot {description.name} has no group {self._name!r}")
        own = description.groups[self._name]
        tip = own.tip if description.end_effector is None else description.end_effector.frame
        return _chain_of(description, own.joints, tip)

    @cached_property
    def group_index(self) -> NDArray[np.int64]:
        """Where the group's joints (n,) stand among all joints."""
        return np.array([self._index[name] for name in self.group.names])

    def joints(self, state: RobotState) -> Array:
        """Measured joints of the planning group (n,), clipped to their limits."""
        q = np.array([state.position(name) for name in self.group.names])
        return np.asarray(np.clip(q, self.group.lower, self.group.upper))

    def configuration(self, state: RobotState, width: float | None = None) -> Array:
        """All joints (nq,) in pinocchio's order; fingers from a width, or as measured if None."""
        return self.posture(state.joints(), state.gripper_width if width is None else width)

    def posture(self, joints: Mapping[str, float], width: float) -> Array:
        """All joints (nq,) from the given ones and the gripper's opening in m; the others are 0."""
        q = np.zeros(self.pin.nq)
        for name, value in joints.items():
            if name in self._index:
                q[self._index[name]] = value
        if self.description.end_effector is not None:
            for finger, value in self.description.hand.positions(max(0.0, width)).items():
                q[self._index[finger]] = value
        return self.follow(q)

    def follow(self, q: Array) -> Array:
        """All joints (nq,) with those that follow others where they follow; changed in place."""
        for own, leader, mimic in self._followers:
            q[own] = mimic.multiplier * q[leader] + mimic.offset
        return q

    def link_poses(self, q: Array) -> dict[str, Array]:
        """base_from_link (4, 4) of the tip and of every link with a hull, at all joints (nq,)."""
        data = self._data
        pin.framesForwardKinematics(self.pin, data, q)
        return {link: np.array(data.oMf[i].homogeneous) for link, i in self.frame_ids.items()}

    @property
    def _data(self) -> pin.Data:
        data = self.__dict__.get("_cached_data")
        if data is None:
            data = self.__dict__["_cached_data"] = self.pin.createData()
        return data

    @property
    def tip_from_grasp(self) -> Transform:
        """The grasp frame relative to the tip, the link that is the end effector's frame."""
        effector = self.description.end_effector
        return Transform((0.0 if effector is None else effector.grasp_offset, 0.0, 0.0))

    @cached_property
    def palm(self) -> Array:
        """Corners (n, 3) of the hand without its fingers, in the grasp frame, m.

        They come from the links that may touch the grasped object and are fixed to the tip.
        """
        effector = self.description.hand
        tip = self.pin.frames[self.frame_ids[effector.frame]]
        corners = []
        for link in effector.touch_links:
            frame = self.pin.frames[self.frame_ids[link]] if link in self.hulls else None
            if frame is None or frame.parentJoint != tip.parentJoint:
                continue
            place = tip.placement.actInv(frame.placement).homogeneous
            own = self.hulls[link]
            corners.append(own if link == effector.frame else own @ place[:3, :3].T + place[:3, 3])
        found = np.vstack(corners) if corners else np.zeros((1, 3))
        return np.asarray(found - (effector.grasp_offset, 0.0, 0.0))

    @cached_property
    def open_fingers(self) -> tuple[Array, ...]:
        """Planes (k, 4) around each link of the fully opened fingers, in the grasp frame, m.

        Outward normal and offset: a point is inside if all values are negative.
        """
        effector = self.description.hand
        joint = self.pin.frames[self.frame_ids[effector.frame]].parentJoint
        poses = self.link_poses(self.posture({}, effector.max_width))
        grasp = Transform.from_matrix(poses[effector.frame]) @ self.tip_from_grasp
        found = []
        for link in effector.touch_links:
            moves = self.pin.frames[self.pin.getFrameId(link)].parentJoint != joint
            if moves and link in self.hulls:
                pose = grasp.inverse() @ Transform.from_matrix(poses[link])
                found.append(ConvexHull(pose.apply(self.hulls[link])).equations)
        return tuple(found)

    @cached_property
    def grasp_from_camera(self) -> Transform | None:
        """The first camera's pose in the grasp frame if it is fixed to the hand, else None."""
        if not self.description.eye_in_hand or self.eye.names != self.group.names:
            return None
        joints = np.zeros(len(self.group.names))
        tip, camera = self.group.tip_pose(joints), self.eye.tip_pose(joints)
        return (tip @ self.tip_from_grasp).inverse() @ camera

    @cached_property
    def beyond_eye(self) -> frozenset[str]:
        """Links with hulls that move with the first camera, or that move relative to it alone."""
        frame = self.pin.frames[self.pin.getFrameId(self.description.camera()[1].frame)]
        below = set(self.pin.subtrees[int(frame.parentJoint)])
        return frozenset(
            link
            for link in self.hulls
            if int(self.pin.frames[self.frame_ids[link]].parentJoint) in below
        )

    @cached_property
    def eye(self) -> Group:
        """The group's joints that move the first camera, with the camera's frame as the tip.

        Raises ValueError if the arm does not carry it.
        """
        description = self.description
        if not description.eye_in_hand:
            raise ValueError(f"the arm of {description.name} carries no camera")
        return _chain_of(description, self.group.names, description.camera()[1].frame)


def arm_model(description: RobotDescription) -> ArmModel:
    """Return the model of a description; built once per process."""
    return _cached(_Key(description))


class _Key:
    def __init__(self, description: RobotDescription) -> None:
        self.description = description
        self.text = description.model_dump_json()

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _Key) and other.text == self.text

    def __hash__(self) -> int:
        return hash(self.text)


@lru_cache(maxsize=4)
def _cached(key: _Key) -> ArmModel:
    return ArmModel(key.description)


def _chain_of(description: RobotDescription, names: Sequence[str], tip: str) -> Group:
    return chain_group(description.kinematics(), names, tip, description.joint_limits)


def chain_group(
    kinematics: KinematicTree,
    names: Sequence[str],
    tip: str,
    joint_limits: Mapping[str, JointLimit],
) -> Group:
    """The chain of those joints in `names` that lead to a link; others on the way stay at 0."""
    joints: list[Joint] = []
    origins: list[Array] = []
    after = np.eye(4)
    for joint in kinematics.chain(tip):
        after = after @ joint.parent_from_joint.matrix
        if joint.name in names:
            joints.append(joint)
            origins.append(after)
            after = np.eye(4)
    limits = [joint_limits[joint.name] for joint in joints]
    axes = np.array([joint.axis for joint in joints])
    return Group(
        names=tuple(joint.name for joint in joints),
        lower=np.array([-np.inf if m.lower is None else m.lower for m in limits]),
        upper=np.array([np.inf if m.upper is None else m.upper for m in limits]),
        velocity=np.array([m.velocity for m in limits]),
        acceleration=np.array([m.acceleration for m in limits]),
        origins=np.ascontiguousarray(origins),
        axes=axes / np.linalg.norm(axes, axis=1, keepdims=True),
        slides=np.array([joint.kind == "prismatic" for joint in joints]),
        tip=after,
    )


def compile_kernels() -> None:
    """Compile `kinematics` into numba's cache: some 10 s once, instead of during a run."""
    eye = np.eye(4)
    group = Group(
        names=("slide", "turn"),
        lower=np.array([0.0, -np.inf]),
        upper=np.array([1.0, np.inf]),
        velocity=np.ones(2),
        acceleration=np.ones(2),
        origins=np.stack([eye, eye]),
        axes=np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0]]),
        slides=np.array([True, False]),
        tip=eye,
    )
    here = np.array([0.5, 0.0])
    target = group.tip_matrix(here)[None]
    group.solve(target, here[None])
    group.trace(target, here)
