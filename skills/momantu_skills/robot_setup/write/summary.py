"""The summary of what `setup` found, for a terminal and for programs."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

from momantu_skills.robot_setup.find.matrix import Why
from momantu_skills.robot_setup.find.proposal import Proposal
from momantu_skills.robot_setup.find.reach import HEIGHTS
from momantu_skills.robot_setup.write.sensor_writer import sensor_names
from momantu_skills.robot_setup.write.writer import base_frame


def lines(proposal: Proposal) -> Iterator[str]:
    """A line for each property: its name, what was found, how reliable it is."""
    skeleton, stand = proposal.prepared.skeleton, proposal.stand
    moving = sum(joint.moving for joint in skeleton.joints.values())
    yield f"{proposal.name}: {len(skeleton.links)} links, {moving} moving joints"
    yield f"base         {base_frame(proposal)}, {stand.mass:.1f} kg, {_wheels(proposal)}"
    yield f"drive        {proposal.driving.kind}: {proposal.driving.why}"
    if stand.footprint is not None:
        corners = stand.footprint
        size = corners.max(axis=0) - corners.min(axis=0)
        yield f"footprint    {size[0]:.2f} x {size[1]:.2f} m, {len(corners)} corners"
    arm, head = proposal.limbs.arm, proposal.limbs.head
    if arm is not None:
        yield f"arm          {len(arm.joints)} joints to {arm.tip}: {', '.join(arm.joints)}"
    if head is not None:
        yield f"head         {', '.join(head.joints)}"
    grasp = proposal.grasp
    if grasp is not None:
        yield (
            f"hand         opens to {1000 * grasp.max_width:.0f} mm, grasps at {grasp.link}"
            f"{'' if grasp.link_from_grasp is None else ' (a frame was added)'}, closes with "
            f"{grasp.max_force:g} N{'' if grasp.force_known else ' (guessed)'}"
        )
    named = sensor_names(proposal)
    for name, sensor in named.items():
        sure = "" if sensor.written else " (by its name: look at it)"
        yield f"sensor       {name}: {sensor.kind} on {sensor.link}{sure}"
    if not named:
        yield "sensor       none was found: look at it"
    if proposal.limbs.arm is not None:
        yield from _reach(proposal)
    for name, pose in proposal.poses.items():
        clear = "IN COLLISION" if pose.clear is None else f"clear by {1000 * pose.clear:.0f} mm"
        yield f"pose         {name}: {clear}, {pose.outside:.2f} m out of the footprint"
    counts = ", ".join(f"{len(proposal.matrix.pairs(why))} {why.value}" for why in Why)
    yield f"collisions   {proposal.matrix.samples} postures; pairs: {counts}"


def _wheels(proposal: Proposal) -> str:
    if proposal.virtual is not None:
        return f"on the virtual joints {', '.join(proposal.virtual)}"
    if proposal.stand.wheels:
        return f"rolls on {', '.join(proposal.stand.wheels[:4])}"
    return "nothing that rolls was found"


def _reach(proposal: Proposal) -> Iterator[str]:
    reach = proposal.reach
    near, best, far = reach.reach
    sure = "" if reach.measured else " (guessed: nothing was reached)"
    off = f"stands {reach.stand_off:g} m off"
    turned = f", {math.degrees(reach.heading):.0f} deg from ahead" if reach.heading else ""
    beside = f", {reach.lateral:g} m to the left" if reach.lateral else ""
    low, high = reach.tables[0], reach.tables[-1]
    on = "" if reach.tables == HEIGHTS else f", on tables {low:g} to {high:g} m high"
    yield f"reach        {near:g} to {far:g} m{turned}{beside}, best {best:g}{on}; {off}{sure}"
    if reach.measured and reach.freedoms < 6:
        yield (
            f"             the arm moves the hand in {reach.freedoms} of six directions and turns: "
            "the base brings things onto its line of reach"
        )


def plain(proposal: Proposal) -> dict[str, Any]:
    """The same as plain data, with the whole self-collision matrix."""
    arm, head, grasp = proposal.limbs.arm, proposal.limbs.head, proposal.grasp
    outline = proposal.stand.footprint
    return {
        "name": proposal.name,
        "base_frame": base_frame(proposal),
        "mass": proposal.stand.mass,
        "wheels": list(proposal.stand.wheels),
        "drive": str(proposal.driving.kind),
        "footprint": None if outline is None else outline.tolist(),
        "arm": None if arm is None else list(arm.joints),
        "head": None if head is None else list(head.joints),
        "hand": None if grasp is None else {"link": grasp.link, "max_width": grasp.max_width},
        "sensors": {n: {"kind": s.kind, "link": s.link} for n, s in sensor_names(proposal).items()},
        "reach": {"distances": list(proposal.reach.reach), "measured": proposal.reach.measured},
        "poses": {
            name: {"joints": pose.joints, "clear": pose.clear, "outside": pose.outside}
            for name, pose in proposal.poses.items()
        },
        "collisions": {
            "samples": proposal.matrix.samples,
            "pairs": [
                {"links": list(pair), "why": why.value, "share": proposal.matrix.share[pair]}
                for pair, why in proposal.matrix.why.items()
            ],
        },
        "notes": list(proposal.notes),
    }
