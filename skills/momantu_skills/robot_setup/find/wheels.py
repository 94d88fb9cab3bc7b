"""How a base drives: from its wheels' axes, and from what a simulator's plug-in is called."""

from __future__ import annotations

import re
from dataclasses import dataclass

import numpy as np
from lxml import etree

from momantu_bt.geometry import Array
from momantu_bt.robot import BaseKind
from momantu_skills.robot_setup.urdf.body import Body
from momantu_skills.robot_setup.urdf.skeleton import TURNING, SetupJoint

SIDEWAYS = re.compile(r"mecanum|omni|holonom|swerve|planar_?move|force_?based_?move", re.IGNORECASE)
"""Words for bases that drive sideways, in names of plug-ins, links, joints and meshes."""
UPRIGHT = 0.9
"""Least vertical component of the axis of a joint that steers a wheel (unit vector)."""
PARALLEL = 0.95
"""Least cosine of the angle between axes that count as parallel."""
FEWEST = 3
"""Fewest wheels of a base whose wheels' axes say that it drives sideways."""


@dataclass(frozen=True)
class Driving:
    """The kind of a base, why, and whether its wheels' axes prove it."""

    kind: BaseKind
    why: str
    measured: bool


def find_driving(
    body: Body, document: etree._Element, wheels: tuple[str, ...], virtual: bool
) -> Driving:
    """How the base drives. wheels: links that roll. virtual: joints x, y and yaw carry it."""
    axles = [joint for joint in map(body.skeleton.above, wheels) if joint and joint.endless]
    axles = [joint for joint in axles if not _upright(body, joint)]
    if len(axles) >= FEWEST and _askew(body, axles):
        why = "its wheels have axes in several directions"
        return Driving(BaseKind.OMNIDIRECTIONAL, why, True)
    steering = {_steering(body, joint) for joint in axles}
    if axles and None not in steering and (len(axles) >= FEWEST or len(steering) < len(axles)):
        one = len(axles) < FEWEST
        why = "its wheels sit on a turntable" if one else "every wheel is steered"
        return Driving(BaseKind.OMNIDIRECTIONAL, why, True)
    word = _word(document, {name for wheel in wheels for name in (wheel, *_joint(body, wheel))})
    if word is not None:
        return Driving(BaseKind.OMNIDIRECTIONAL, f"the URDF has `{word}`", False)
    if virtual and not axles:
        why = "it has joints along x and y, and no wheels"
        return Driving(BaseKind.OMNIDIRECTIONAL, why, False)
    return Driving(BaseKind.DIFFERENTIAL, "nothing says that it drives sideways", False)


def _joint(body: Body, link: str) -> tuple[str, ...]:
    above = body.skeleton.above(link)
    return () if above is None else (above.name,)


def _axis(body: Body, joint: SetupJoint) -> Array:
    """Unit vector along a joint's axis, in the base frame, while every joint is at rest."""
    turned = body.link_poses({})[joint.child][:3, :3] @ np.array(joint.axis)
    return np.asarray(turned / max(float(np.linalg.norm(turned)), 1e-9))


def _upright(body: Body, joint: SetupJoint) -> bool:
    return bool(abs(_axis(body, joint)[2]) > UPRIGHT)


def _askew(body: Body, axles: list[SetupJoint]) -> bool:
    """Whether axles that are fixed to the base are not parallel."""
    fixed = [_axis(body, joint) for joint in axles if _steering(body, joint) is None]
    return len(fixed) >= FEWEST and any(abs(fixed[0] @ axis) < PARALLEL for axis in fixed)


def _steering(body: Body, axle: SetupJoint) -> str | None:
    """The upright joint between the base and a wheel that turns the wheel's axis."""
    above = body.skeleton.above(axle.parent)
    while above is not None and axle.parent != body.base_frame:
        if above.kind in TURNING and _upright(body, above):
            return above.name
        above = body.skeleton.above(above.parent)
    return None


def _word(document: etree._Element, names: set[str]) -> str | None:
    """A name in a URDF that says that its base drives sideways."""
    for plugin in document.iter("plugin"):
        for said in (plugin.get("name", ""), plugin.get("filename", "")):
            if SIDEWAYS.search(said):
                return said
    return next((name for name in sorted(names) if SIDEWAYS.search(name)), None) or _mesh(
        document, names
    )


def _mesh(document: etree._Element, names: set[str]) -> str | None:
    """A mesh of a wheel whose name says so."""
    for link in document.iter("link"):
        if link.get("name") in names:
            for mesh in link.iter("mesh"):
                said = mesh.get("filename", "").rsplit("/", 1)[-1]
                if SIDEWAYS.search(said):
                    return said
    return None
