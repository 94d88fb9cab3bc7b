"""How an object rests on a level surface: upright, on its head, or on its side."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from momantu_bt.geometry import Array, Pose, Transform, rotation_between
from momantu_bt.messages import DetectedObject

LYING = math.sin(math.radians(45.0))
"""Share of an axis that is along the vertical below which a round object lies."""
UPRIGHT = 0.999
"""The same above which an axis is upright."""


def lies(thing: DetectedObject) -> bool:
    """Whether a round object lies on its side."""
    upward = float(thing.pose.transform.rotation[2, 2])
    return thing.shape == "cylinder" and abs(upward) < LYING


def rise(thing: DetectedObject, frame_from_object: Transform) -> float:
    """Half of the height of an object that rests as in a level frame, m."""
    half = np.array(thing.size) / 2
    up = frame_from_object.rotation[2]
    if thing.shape == "cylinder":
        return float(max(half[:2]) * math.hypot(up[0], up[1]) + half[2] * abs(up[2]))
    return float(np.abs(up) @ half)


def levelled(rotation: Array) -> Array:
    """The rotation (3, 3), in a level frame, with the most upright axis made upright.

    Of an object that lies its own axis is made level.
    """
    index = int(np.argmax(np.abs(rotation[2])))
    if index == 2:
        goal = np.array([0.0, 0.0, math.copysign(1.0, rotation[2, 2])])
        return rotation_between(rotation[:, 2], goal) @ rotation
    axis = rotation[:, 2]
    flat = np.array([axis[0], axis[1], 0.0])
    return rotation_between(axis, flat / np.linalg.norm(flat)) @ rotation


def put_right(thing: DetectedObject) -> DetectedObject:
    """The object with a pose in which something can rest on the surface below it.

    A round object that lies gets a level axis, at the height of its radius. A box whose z axis is
    not the upright one gets other names for its axes.
    """
    pose = thing.pose.transform
    if lies(thing):
        x, y, _ = pose.position
        middle = (x, y, thing.support_height + max(thing.size[:2]) / 2)
        level = Transform.from_rotation(levelled(pose.rotation), middle)
        return replace(thing, pose=Pose(level, thing.pose.frame, thing.pose.stamp))
    if thing.shape != "box" or abs(float(pose.rotation[2, 2])) >= LYING:
        return thing
    return _renamed(thing, pose)


def held_level(grasp_from_object: Transform) -> Transform:
    """The pose in the hand of a round object between two pads, which turn its axis along them.

    The pads are across y of the grasp frame.
    """
    axis = grasp_from_object.rotation[:, 2]
    along = np.array([axis[0], 0.0, axis[2]])
    rotation = rotation_between(axis, along / np.linalg.norm(along)) @ grasp_from_object.rotation
    return Transform.from_rotation(rotation, grasp_from_object.position)


def _renamed(thing: DetectedObject, pose: Transform) -> DetectedObject:
    """A box with the axis that is most upright as its z axis, upwards."""
    up = int(np.argmax(np.abs(pose.rotation[2])))
    order = [(up + 1) % 3, (up + 2) % 3, up]
    axes = pose.rotation[:, order]
    if axes[2, 2] < 0.0:
        axes, order = -axes[:, [1, 0, 2]], [order[1], order[0], order[2]]
    x, y, z = (thing.size[i] for i in order)
    turned = Pose(Transform.from_rotation(axes, pose.position), thing.pose.frame, thing.pose.stamp)
    return replace(thing, pose=turned, size=(x, y, z))
