"""Write into a URDF the joint limits that it leaves out and the robot file gives."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from lxml import etree

from momantu_bt.robot_parts import JointLimit

LIMITED = ("revolute", "prismatic")
"""Types of joints that have a range."""


def complete_limits(joints: Iterable[etree._Element], limits: Mapping[str, JointLimit]) -> bool:
    """Write into joints what their limits lack; whether anything was lacking.

    limits: of the robot file, by joint. A URDF whose range is empty has none: programs write a
    hinge from 0 to 0 where nobody gave its ends. A hinge that has no ends in the robot file
    either turns for ever; a joint that the robot file does not know stays where it is. An effort
    of 0 is one that nobody gave.
    """
    lacking = [_complete(joint, limits.get(str(joint.get("name")))) for joint in joints]
    return any(lacking)


def _complete(joint: etree._Element, given: JointLimit | None) -> bool:
    if joint.get("type") not in LIMITED:
        return False
    limit = joint.find("limit")
    if limit is None:
        limit = etree.SubElement(joint, "limit")
    more = {"effort": "0", "velocity": "0" if given is None else repr(given.velocity)}
    more = {name: value for name, value in more.items() if limit.get(name) is None}
    endless = False
    if given is not None and not has_range(limit):
        if given.lower is not None and given.upper is not None:
            more |= {"lower": repr(given.lower), "upper": repr(given.upper)}
        elif joint.get("type") == "revolute":
            endless = True
            joint.set("type", "continuous")
    for name, value in more.items():
        limit.set(name, value)
    return bool(more) or endless


def has_range(limit: etree._Element) -> bool:
    """Whether a `limit` of a hinge or slide leaves it room; its ends are numbers, or not given."""
    return float(limit.get("lower", "0")) < float(limit.get("upper", "0"))
