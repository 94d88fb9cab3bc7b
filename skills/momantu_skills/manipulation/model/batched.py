"""Kinematics of one chain for many postures at once, differentiable in the joints' positions."""

from __future__ import annotations

import contextlib
import io
from typing import TYPE_CHECKING

import numpy as np
from lxml import etree

from momantu_bt.formats import urdf
from momantu_bt.frames import KinematicTree
from momantu_bt.geometry import Array
from momantu_bt.lazy import lazily
from momantu_bt.robot import RobotDescription

with lazily():
    import pytorch_kinematics
    import torch

if TYPE_CHECKING:
    from torch import Tensor

MOVING = ("revolute", "continuous", "prismatic")
"""Kinds of joints with one position."""


class BatchedChain:
    """The pose of a link in the base's frame, from the positions of the joints on the way to it.

    names: the joints that move, from the base outwards.
    """

    def __init__(self, description: RobotDescription, frame: str) -> None:
        """Read the chain from the robot's URDF.

        Raises:
            Failure: FRAME_UNKNOWN, the robot has no such frame.
        """
        robot = urdf.read_urdf(description.urdf)
        tree = KinematicTree.of_urdf(robot, description.base_frame)
        chain = [joint.name for joint in tree.chain(frame)]
        by_name = {joint.name: joint for joint in robot.joints}
        joints = [by_name[name] for name in chain]
        self.names = tuple(joint.name for joint in joints if joint.kind in MOVING)
        torch.set_num_threads(1)
        self._chain = _serial(joints, frame) if self.names else None
        self._fixed = torch.as_tensor(tree.base_from_frame(frame, {}).matrix)

    def base_from_frame(self, positions: Tensor) -> Tensor:
        """Poses (n, 4, 4) at positions (n, joints) in rad or m, float64."""
        if self._chain is None:
            return self._fixed.expand(len(positions), 4, 4)
        poses: Tensor = self._chain.forward_kinematics(positions).get_matrix()
        return poses

    def matrices(self, positions: Array) -> Array:
        """As `base_from_frame`, with arrays."""
        with torch.no_grad():
            return np.asarray(self.base_from_frame(torch.as_tensor(positions)).numpy())


def _serial(joints: list[urdf.Joint], frame: str) -> pytorch_kinematics.SerialChain:
    """The joints alone as a chain: without meshes, and without limits, which are not its work."""
    root = etree.Element("robot", name="chain")
    for name in (joints[0].parent, *(joint.child for joint in joints)):
        etree.SubElement(root, "link", name=name)
    for joint in joints:
        kind = "revolute" if joint.kind == "continuous" else joint.kind
        moving = kind in MOVING
        element = etree.SubElement(root, "joint", name=joint.name, type=kind if moving else "fixed")
        etree.SubElement(element, "origin", xyz=_numbers(joint.xyz), rpy=_numbers(joint.rpy))
        etree.SubElement(element, "parent", link=joint.parent)
        etree.SubElement(element, "child", link=joint.child)
        if moving:
            unit = np.asarray(joint.axis) / np.linalg.norm(joint.axis)
            etree.SubElement(element, "axis", xyz=_numbers(unit))
            etree.SubElement(element, "limit", lower="-4", upper="4", effort="1", velocity="1")
    text = etree.tostring(root)
    with contextlib.redirect_stdout(io.StringIO()):  # the library prints what it builds
        chain = pytorch_kinematics.build_serial_chain_from_urdf(text, frame)
    return chain.to(dtype=torch.float64)


def _numbers(values: object) -> str:
    return " ".join(repr(float(value)) for value in np.asarray(values))
