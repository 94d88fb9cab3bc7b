"""Write into a URDF the joint limits that it leaves out and the robot file gives."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from lxml import etree

from momantu_bt.robot_parts import JointLimit

LIMITED = ("revolute", "prismatic")
"""Types of joints that have a range."""


def complete_limits(joints: Iterable[etree._Element], limits: Mapping[str, JointLimit]) -> bool:
    """Write missing limits into joints; return whether any was missing.

    limits: the robot file's, by joint. An empty range in a URDF counts as missing: programs write
    0 to 0 for a hinge if nobody gave its ends. If the robot file gives no
    ends either, the hinge turns for ever. A joint that is not in the robot file does not move. An
    effort of 0 counts as missing.
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
