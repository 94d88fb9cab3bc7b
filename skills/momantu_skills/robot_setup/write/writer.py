"""Writing a robot file from a proposal, with comments that say how reliable each value is."""

from __future__ import annotations

import math
import os
from collections.abc import Iterable, Iterator
from pathlib import Path

import numpy as np

from momantu_bt.geometry import Transform
from momantu_skills.robot_setup.find.matrix import Why
from momantu_skills.robot_setup.find.named import TIPS
from momantu_skills.robot_setup.find.proposal import Proposal
from momantu_skills.robot_setup.find.reach import HEIGHTS, LADDER, Reach
from momantu_skills.robot_setup.write.arm_writer import (
    actuator_lines,
    end_effector_lines,
    group_lines,
    limit_lines,
    pose_lines,
)
from momantu_skills.robot_setup.write.file_text import comment, listed, number, quoted, scalar
from momantu_skills.robot_setup.write.sensor_writer import sensor_frames, sensor_lines

ON_FLOOR = 0.01
"""Largest height of a base frame that counts as on the floor, m."""
PUSH = 3.0
"""Push force of the base per mass, m/s2: rubber wheels push with at most a third of the weight."""
MOST_UP = 2
"""Most folders that a relative path goes up."""
FLOOR_LINKS = ("base_footprint", "base_on_floor", "robot_on_floor")
"""Names of the frame that is added on the floor: the first that no link of the URDF has."""


def robot_file(proposal: Proposal, folder: Path) -> str:
    """The text of `folder/robot.yaml`."""
    blocks = (
        _head(proposal),
        _parts(proposal, folder),
        _frames(proposal),
        _footprint(proposal),
        _working(proposal),
        _base(proposal),
        actuator_lines(proposal),
        limit_lines(proposal),
        sensor_lines(proposal),
        group_lines(proposal),
        end_effector_lines(proposal),
        pose_lines(proposal),
        _ignored(proposal),
        _simulation(proposal),
    )
    return "\n\n".join("\n".join(block) for block in map(list, blocks) if block) + "\n"


def missing(proposal: Proposal) -> tuple[str, ...]:
    """The values that must be filled in before the file can be read."""
    found = []
    if proposal.stand.footprint is None:
        found.append("`footprint`: the base has no collision shape to take it from")
    return tuple(found)


def without(proposal: Proposal) -> tuple[str, ...]:
    """What the robot is described without, and what it cannot do for that."""
    found = []
    if proposal.limbs.arm is None:
        found.append("no arm: it drives and looks, and trees that need an arm are refused")
    elif proposal.grasp is None:
        found.append(
            "no hand: no two links were found that open and close against each other. It moves "
            "its arm, and trees that pick or place are refused"
        )
    if proposal.grasp is not None:
        found += _reach_lacks(proposal.reach)
    found += _weak_holds(proposal)
    kinds = {sensor.kind for sensor in proposal.sensors}
    if "camera" not in kinds:
        found.append("no camera: trees that look for anything are refused")
    if not kinds & {"laser", "lidar"}:
        found.append("no laser: trees that drive are refused, as it cannot localize itself")
    return tuple(found)


def _weak_holds(proposal: Proposal) -> Iterator[str]:
    """Why the hand may lose what it holds."""
    grasp, carry = proposal.grasp, proposal.poses.get("carry")
    if grasp is not None and carry is not None and TIPS in carry.notes:
        yield f"no level `carry`: {TIPS}, and trees that carry may fail"


def _reach_lacks(reach: Reach) -> Iterator[str]:
    """Which tables the hand does not reach, why, and what to do."""
    if reach.measured and reach.tables == HEIGHTS:
        return
    near = reach.reach[0]
    usual, tried = (f"{h[0]:g} to {h[-1]:g} m high" for h in (HEIGHTS, LADDER))
    if reach.measured:
        low, high = reach.tables[0], reach.tables[-1]
        where = "higher" if low + high < HEIGHTS[0] + HEIGHTS[-1] else "lower"
        yield (
            f"no reach to usual tables, {usual}: it grasps on tables {low:g} to {high:g} m high, "
            "and `working.reach` holds for those. Trees that pick or place need surfaces of such "
            f"heights, or an arm that is mounted {where}"
        )
        return
    why = ""
    if reach.freedoms < 6:
        why = (
            f": it moves the hand in {reach.freedoms} of the six directions and turns that a grasp "
            "has, and where the base stands chooses no more than one of them"
        )
    yield (
        f"no reach: the arm brings the hand to no grasp on a table {tried}, on no side, {near:g} m "
        f"or more from the base, as the nearest things stand there{why}. Trees that pick or place "
        "fail; `momantu-bt robots reach` draws where the hand gets"
    )


def base_frame(proposal: Proposal) -> str:
    """The frame on the floor: the URDF's own, or one that is put below it."""
    return _floor_link(proposal) if _put_on_floor(proposal) else proposal.base.frame


def _floor_link(proposal: Proposal) -> str:
    links = proposal.prepared.skeleton.links
    return next((name for name in FLOOR_LINKS if name not in links), "")


def _put_on_floor(proposal: Proposal) -> bool:
    """Whether a base frame is added for the robot.

    This is so if the URDF's is not on the floor, or is below another link.
    """
    skeleton = proposal.prepared.skeleton
    unfit = abs(proposal.stand.floor) > ON_FLOOR or proposal.base.frame != skeleton.root
    return unfit and not proposal.base.virtual and _floor_link(proposal) != ""


def _head(proposal: Proposal) -> Iterator[str]:
    yield f"# {proposal.name}, proposed by `momantu-bt robots setup` from"
    yield f"# {proposal.prepared.source.name}. Lengths in m, angles in rad."
    yield "#"
    yield "# Measured: found in the URDF's geometry. From the URDF: copied. Guessed: look at it."
    yield "# FILL IN: could not be found; the file cannot be read before it is there."
    for note in proposal.notes:
        yield from comment(f"Note: {note}.")
    for lack in without(proposal):
        yield from comment(f"Described without: {lack}.")
    yield "momantu_robot: 1"
    yield f"name: {proposal.name}"


def _parts(proposal: Proposal, folder: Path) -> Iterator[str]:
    path = _path(proposal.prepared.source.resolve(), folder.resolve())
    given = proposal.prepared.given
    yield "parts:"
    if given.args or given.inertials:
        yield f"  {proposal.name}:"
        yield f"    {proposal.prepared.kind}: {scalar(path)}"
    else:
        yield f"  {proposal.name}: {{{proposal.prepared.kind}: {scalar(path)}}}"
    if given.args:
        args = ", ".join(f"{scalar(name)}: {quoted(value)}" for name, value in given.args.items())
        yield f"    args: {{{args}}}"
    if given.inertials:
        yield "    # Guessed: the URDF's masses and inertias of these are impossible; boxes around"
        yield "    # their shapes. Weigh the real ones."
        yield "    inertials:"
        for name, solid in given.inertials.items():
            box, middle = (", ".join(number(v) for v in each) for each in (solid.box, solid.xyz))
            body = f"mass: {number(solid.mass)}, box: [{box}], xyz: [{middle}]"
            yield f"      {scalar(name)}: {{{body}}}"
    if given.package_path:
        folders = [_path(each.resolve(), folder.resolve()) for each in given.package_path]
        yield f"packages: {listed(folders)}"
    if _put_on_floor(proposal):
        height, base = number(-proposal.stand.floor), proposal.base.frame
        link = "" if base == proposal.prepared.skeleton.root else f", link: {scalar(base)}"
        yield f"# Measured: {base} lies {height} m above the robot's lowest point; a base frame is"
        yield "# put on the floor below it."
        yield "mounts:"
        yield f"  {proposal.name}: {{on: {_floor_link(proposal)}, xyz: [0, 0, {height}]{link}}}"
    elif abs(proposal.stand.floor) > ON_FLOOR:
        yield from comment(
            f"Look at it: the robot's lowest point lies {number(proposal.stand.floor)} m from the "
            "base frame, which must lie on the floor."
        )
    yield f"base_frame: {scalar(base_frame(proposal))}"


def _path(source: Path, folder: Path) -> str:
    """A path relative to the folder if both are close, so that they can be moved together."""
    relative = os.path.relpath(source, folder)
    return relative if relative.count("..") <= MOST_UP else str(source)


def _frames(proposal: Proposal) -> Iterator[str]:
    frames = dict(sensor_frames(proposal))
    for limb, grasp in proposal.grasps.items():
        if grasp.link_from_grasp is not None:
            name = "grasp" if limb == "arm" else f"{limb}_grasp"
            frames[name] = (grasp.link, grasp.link_from_grasp)
    if not frames:
        return
    yield "# Measured: between the pads, x out along the fingers, y the closing direction. Optical"
    yield "# frames are guessed to look along x of the link that they sit on."
    yield "frames:"
    for name, (link, place) in frames.items():
        turns = ", ".join(number(v) for v in _rpy(place))
        shift = ", ".join(number(v) for v in place.position)
        yield f"  {name}: {{on: {scalar(link)}, xyz: [{shift}], rpy: [{turns}]}}"


def _rpy(place: Transform) -> tuple[float, float, float]:
    r = place.rotation
    level = math.hypot(r[0, 0], r[1, 0])
    pitch = math.atan2(-r[2, 0], level)
    if level < 1e-9:
        return 0.0, pitch, math.atan2(-r[0, 1], r[1, 1])
    return math.atan2(r[2, 1], r[2, 2]), pitch, math.atan2(r[1, 0], r[0, 0])


def _footprint(proposal: Proposal) -> Iterator[str]:
    outline = proposal.stand.footprint
    if outline is None:
        yield "# FILL IN: the base has no collision shape. Corners counter-clockwise, for example"
        yield "# footprint: [[0.25, 0.2], [-0.25, 0.2], [-0.25, -0.2], [0.25, -0.2]]"
    else:
        yield "# Measured: outline of the base and what rolls, up to 25 cm above the floor."
        yield "footprint:"
        yield from (f"  - [{number(x)}, {number(y)}]" for x, y in outline)
    yield "# Measured: the tallest of the named poses."
    yield f"height: {number(proposal.height)}"


def _working(proposal: Proposal) -> Iterator[str]:
    reach = proposal.reach
    if proposal.limbs.arm is None:
        yield "# Guessed: how far from a table's edge the robot stands."
        yield "working:"
        yield f"  stand_off: {number(reach.stand_off)}    # the footprint's front and 13 cm"
        yield f"  look_off: {number(reach.look_off)}"
        return
    tables = f"{reach.tables[0]:g}-{reach.tables[-1]:g} m"
    if reach.measured:
        text = f"Measured: inverse kinematics of level and pitched grasps on tables {tables} high."
    else:
        tables = f"{LADDER[0]:g}-{LADDER[-1]:g} m"
        text = f"Guessed: no grasp on tables {tables} high was reached beyond the footprint."
    yield from comment(text)
    yield "working:"
    yield f"  stand_off: {number(reach.stand_off)}    # the footprint's front and 13 cm"
    yield f"  look_off: {number(reach.look_off)}"
    yield f"  reach: [{', '.join(number(v) for v in reach.reach)}]"
    if reach.heading or reach.lateral:
        yield "  # The line along which the arm reaches: its direction, and how far left it lies."
        yield f"  heading: {number(reach.heading)}"
        yield f"  lateral: {number(reach.lateral)}"
    if reach.breadth is not None:
        yield "  # The arm has few joints: the base brings what is grasped onto that line."
        yield f"  breadth: {number(reach.breadth)}"


def _base(proposal: Proposal) -> Iterator[str]:
    stand = proposal.stand
    force = float(np.clip(stand.mass * PUSH, 50.0, 1000.0))
    torque = force * max(stand.width, 0.2) / 2
    driving = proposal.driving
    yield f"# {'Measured' if driving.measured else 'Guessed'}: {driving.why}."
    yield "# Guessed: a brisk walk. Its makers' data sheet knows better."
    if not stand.wheels and proposal.virtual is None:
        yield "# Look at it: nothing that rolls was found. Without `drive` it is not simulated."
    yield "base:"
    yield f"  kind: {driving.kind}"
    yield "  linear: 0.8"
    yield "  angular: 1.5"
    yield "  linear_acceleration: 0.8"
    yield "  angular_acceleration: 2.0"
    yield f"  # Guessed: the wheels push with a third of the weight of {number(stand.mass, 1)} kg."
    yield "  drive:"
    if proposal.virtual is not None:
        x, y, yaw = map(scalar, proposal.virtual)
        yield f"    joints: {{x: {x}, y: {y}, yaw: {yaw}}}"
    yield f"    force: {number(round(force))}"
    yield f"    torque: {number(round(torque, 1))}"


def _ignored(proposal: Proposal) -> Iterator[str]:
    matrix = proposal.matrix
    counts = {why: len(matrix.pairs(why)) for why in dict.fromkeys(matrix.why.values())}
    told = ", ".join(f"{count} {why.value}" for why, count in counts.items())
    yield from comment(
        f"Measured in {matrix.samples} random postures: {told or 'no pairs'}. Pairs that share a "
        "joint are never checked. Pairs that never met are: a check costs little, and random "
        "postures prove nothing. These overlap for good, where every joint stands at rest, or "
        "where the hand is closed; neighbours would be pushed apart by a simulator:"
    )
    if not matrix.ignored:
        yield "ignored_collisions: []"
        return
    yield "ignored_collisions:"
    for one, other in matrix.ignored:
        why, share = matrix.why[one, other], matrix.share[one, other]
        said = f"{why.value}, met in {share:.0%}" if why is not Why.ADJACENT else "neighbours"
        yield f"  - {listed((one, other))}    # {said}"


def _simulation(proposal: Proposal) -> Iterator[str]:
    arm, skeleton = proposal.limbs.arm, proposal.prepared.skeleton
    hand = arm.hand if arm is not None else None
    fingers: Iterable[str] = ()
    if hand is not None:
        moving = {link for branch in hand.branches for link in branch.links}
        fingers = [n for n in (*hand.ahead, *hand.behind) if n in moving]
        fingers = [n for n in fingers if skeleton.links[n].collisions]
    yield "# What a simulator must know beside all this. Friction is guessed: rubber pads."
    yield "simulation:"
    yield f"  floor_links: {listed(proposal.stand.grounded)}"
    yield f"  finger_links: {listed(fingers)}"
    yield "  finger_friction: 1.0"
    if proposal.cells:
        yield "  # Measured: the hulls around these meshes swallow other links, or are much"
        yield "  # fuller than the meshes. Guessed: even cuts."
        yield "  convex_cells:"
        for link, cuts in proposal.cells.items():
            inside = ", ".join(f"{n}: [{', '.join(map(number, at))}]" for n, at in cuts.items())
            yield f"    {scalar(link)}: {{{inside}}}"
    if proposal.pressing:
        yield "  # Measured: the hulls that a simulator takes for links meet, the links do not."
        yield "  ignored_collisions:"
        yield from (f"    - {listed(pair)}" for pair in proposal.pressing)
