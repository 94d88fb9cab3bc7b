"""A robot's body for planning: links, hulls, chains of joints. All poses are in the base frame."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cached_property, lru_cache

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray
from scipy.spatial import ConvexHull

from momantu_bt.formats.urdf import read_urdf
from momantu_bt.geometry import Array, Transform
from momantu_bt.messages import RobotState
from momantu_bt.robot import ARM, RobotDescription
from momantu_skills.manipulation.model.group import Group, chain_group
from momantu_skills.manipulation.model.hulls import link_hulls
from momantu_skills.manipulation.model.urdf import base_urdf


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

    @cached_property
    def efforts(self) -> Array:
        """The URDF's largest effort of each joint of the group (n,), Nm or N; 0: not given."""
        places = [self.pin.joints[self.pin.getJointId(name)].idx_v for name in self.group.names]
        return np.asarray(self.pin.effortLimit[places])

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
        """Planes (k, 4) around each link of the fully opened fingers; see `fingers_at`."""
        return self.fingers_at(self.description.hand.max_width)

    def fingers_at(self, width: float) -> tuple[Array, ...]:
        """Planes (k, 4) around each link of the fingers at an opening of `width` m, grasp frame.

        Outward normal and offset in m: a point is inside if all values are negative.
        """
        effector = self.description.hand
        joint = self.pin.frames[self.frame_ids[effector.frame]].parentJoint
        poses = self.link_poses(self.posture({}, width))
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
