"""A robot file from a proposal, with comments that say what to trust."""

from __future__ import annotations

import math
import os
from collections.abc import Iterable, Iterator
from pathlib import Path

import numpy as np

from momantu_bt.geometry import Transform
from momantu_skills.robot_setup.grasp import APART, STRONGEST, Grasp
from momantu_skills.robot_setup.matrix import Why
from momantu_skills.robot_setup.proposal import Proposal
from momantu_skills.robot_setup.reach import HEIGHTS
from momantu_skills.robot_setup.sensor_writer import sensor_frames, sensor_lines

ON_FLOOR = 0.01
"""m; a base frame this near to the floor lies on it."""
PUSH = 3.0
"""m/s2; rubber wheels on a floor push with a third of the weight, not more."""
MOST_UP = 2
"""Folders that a relative path goes up at most."""
FLOOR_LINK = "base_footprint"
"""The frame that is put on the floor where the URDF has none there."""
POSES = {
    "home": "Folded for driving: within the footprint as far as it goes, the camera ahead.",
    "ready": "Before work at a table: the camera looks at it.",
    "carry": "The hand level, what it holds upright if it was gripped from the side.",
    "look_around": "The camera looks far, the arm out of its picture.",
}
"""What the poses are for."""


def robot_file(proposal: Proposal, folder: Path) -> str:
    """The text of `folder/robot.yaml`."""
    blocks = (
        _head(proposal),
        _parts(proposal, folder),
        _frames(proposal),
        _footprint(proposal),
        _working(proposal),
        _base(proposal),
        _actuators(proposal),
        _joint_limits(proposal),
        sensor_lines(proposal),
        _groups(proposal),
        _end_effector(proposal),
        _named_poses(proposal),
        _ignored(proposal),
        _simulation(proposal),
    )
    return "\n\n".join("\n".join(block) for block in map(list, blocks) if block) + "\n"


def missing(proposal: Proposal) -> tuple[str, ...]:
    """What the person has to fill in before the file can be read."""
    found = []
    if proposal.stand.footprint is None:
        found.append("`footprint`: the base has no collision shape to take it from")
    if proposal.limbs.arm is None:
        found.append("`groups.arm` and its `actuators`: no arm was found")
        found.append("`named_poses`: they need the arm")
    if proposal.grasp is None:
        found.append(
            "`end_effector` and `actuators.gripper`: no two links were found that open and close "
            "against each other"
        )
    return tuple(found)


def base_frame(proposal: Proposal) -> str:
    """The frame on the floor: the URDF's own, or one that is put below it."""
    return FLOOR_LINK if _put_on_floor(proposal) else proposal.base.frame


def _put_on_floor(proposal: Proposal) -> bool:
    """Whether the robot gets a base frame of its own.

    It does where the URDF's is not on the floor, or hangs below another link.
    """
    skeleton = proposal.prepared.skeleton
    unfit = abs(proposal.stand.floor) > ON_FLOOR or proposal.base.frame != skeleton.root
    return unfit and not proposal.base.virtual and FLOOR_LINK not in skeleton.links


def _head(proposal: Proposal) -> Iterator[str]:
    yield f"# {proposal.name}, proposed by `momantu-bt robots setup` from"
    yield f"# {proposal.prepared.source.name}. Lengths in m, angles in rad."
    yield "#"
    yield "# Measured: found in the URDF's geometry. From the URDF: copied. Guessed: look at it."
    yield "# FILL IN: could not be found; the file cannot be read before it is there."
    for note in proposal.notes:
        yield from _wrapped(f"Note: {note}.")
    yield "momantu_robot: 1"
    yield f"name: {proposal.name}"


def _parts(proposal: Proposal, folder: Path) -> Iterator[str]:
    path = _path(proposal.prepared.source.resolve(), folder.resolve())
    yield "parts:"
    yield f"  {proposal.name}: {{{proposal.prepared.kind}: {_text(path)}}}"
    if _put_on_floor(proposal):
        height, base = number(-proposal.stand.floor), proposal.base.frame
        link = "" if base == proposal.prepared.skeleton.root else f", link: {base}"
        yield f"# Measured: {base} lies {height} m above the robot's lowest point; a base frame is"
        yield "# put on the floor below it."
        yield "mounts:"
        yield f"  {proposal.name}: {{on: {FLOOR_LINK}, xyz: [0, 0, {height}]{link}}}"
    elif abs(proposal.stand.floor) > ON_FLOOR:
        yield from _wrapped(
            f"Look at it: the robot's lowest point lies {number(proposal.stand.floor)} m from the "
            "base frame, which must lie on the floor."
        )
    yield f"base_frame: {base_frame(proposal)}"


def _path(source: Path, folder: Path) -> str:
    """As seen from the folder where both lie near each other, so that they can be moved as one."""
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
        yield f"  {name}: {{on: {link}, xyz: [{shift}], rpy: [{turns}]}}"


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
    tables = f"{HEIGHTS[0]:g}-{HEIGHTS[-1]:g} m"
    if reach.measured:
        text = f"Measured: inverse kinematics of level and pitched grasps on tables {tables} high."
    else:
        text = f"Guessed: no grasp on tables {tables} high was reached beyond the footprint."
    yield from _wrapped(text)
    yield "working:"
    yield f"  stand_off: {number(reach.stand_off)}    # the footprint's front and 13 cm"
    yield f"  look_off: {number(reach.look_off)}"
    yield f"  reach: [{', '.join(number(v) for v in reach.reach)}]"


def _base(proposal: Proposal) -> Iterator[str]:
    stand = proposal.stand
    force = float(np.clip(stand.mass * PUSH, 50.0, 1000.0))
    torque = force * max(stand.width, 0.2) / 2
    yield "# Guessed: a brisk walk. Its makers' data sheet knows better."
    if not stand.wheels and proposal.virtual is None:
        yield "# Look at it: nothing that rolls was found. Without `drive` it is not simulated."
    yield "base:"
    yield "  linear: 0.8"
    yield "  angular: 1.5"
    yield "  linear_acceleration: 0.8"
    yield "  angular_acceleration: 2.0"
    yield f"  # Guessed: the wheels push with a third of the weight of {number(stand.mass, 1)} kg."
    yield "  drive:"
    if proposal.virtual is not None:
        x, y, yaw = proposal.virtual
        yield f"    joints: {{x: {x}, y: {y}, yaw: {yaw}}}"
    yield f"    force: {number(round(force))}"
    yield f"    torque: {number(round(torque, 1))}"


def _actuators(proposal: Proposal) -> Iterator[str]:
    limbs = proposal.limbs
    yield "actuators:"
    yield "  base: {kind: base}"
    if limbs.arm is None:
        yield "  # FILL IN: arm: {kind: joints, joints: [shoulder_joint, elbow_joint, …]}"
    for limb in (limbs.arm, *limbs.others, limbs.head):
        if limb is not None and limb.joints:
            yield from _joints(limb.name, "joints", limb.joints)
    if limbs.rest:
        yield "  # Joints that belong to nothing above: held still, so that they do not dangle."
        yield from _joints("rest", "joints", limbs.rest)
    for limb in (limbs.arm, *limbs.others):
        if limb is not None and limb.name in proposal.grasps:
            yield from _joints(
                gripper_name(limb.name), "gripper", tuple(proposal.grasps[limb.name].opening)
            )
    if proposal.grasp is None:
        yield "  # FILL IN: gripper: {kind: gripper, joints: [left_finger_joint, …]}"


def gripper_name(limb: str) -> str:
    """The actuator of the hand at a limb's end."""
    return limb.replace("arm", "gripper", 1)


def _joints(name: str, kind: str, joints: tuple[str, ...]) -> Iterator[str]:
    if sum(map(len, joints)) < 50:
        yield f"  {name}: {{kind: {kind}, joints: [{', '.join(joints)}]}}"
        return
    yield f"  {name}:"
    yield f"    kind: {kind}"
    yield "    joints:"
    yield from (f"      - {joint}" for joint in joints)


def _joint_limits(proposal: Proposal) -> Iterator[str]:
    if not proposal.limits:
        yield "# FILL IN: joint_limits: {shoulder_joint: {velocity: 1.0, acceleration: 1.5}}"
        yield "joint_limits: {}"
        return
    yield "# Positions and speeds from the URDF. Accelerations measured: half of the effort by the"
    yield "# greatest inertia, and not more than an arm does gently."
    yield "joint_limits:"
    for name, found in proposal.limits.items():
        limit = found.limit
        values = limit.model_dump(exclude_none=True)
        inside = ", ".join(f"{key}: {number(value, 5)}" for key, value in values.items())
        guessed = f"    # guessed: {'; '.join(found.guessed)}" if found.guessed else ""
        yield f"  {name}: {{{inside}}}{guessed}"


def _groups(proposal: Proposal) -> Iterator[str]:
    limbs = [limb for limb in (proposal.limbs.arm, *proposal.limbs.others) if limb is not None]
    if not limbs:
        yield "# FILL IN: groups: {arm: {joints: [shoulder_joint, …], tip: hand_link}}"
        yield "groups: {}"
        return
    yield "groups:"
    for limb in limbs:
        grasp = proposal.grasps.get(limb.name)
        tip = limb.tip if grasp is None else _grasp_frame(proposal, limb.name, grasp)
        yield f"  {limb.name}:"
        yield "    joints:"
        yield from (f"      - {joint}" for joint in limb.joints)
        yield f"    tip: {tip}"


def _grasp_frame(proposal: Proposal, limb: str, grasp: Grasp) -> str:
    if grasp.link_from_grasp is None:
        return grasp.link
    return "grasp" if limb == "arm" else f"{limb}_grasp"


def _end_effector(proposal: Proposal) -> Iterator[str]:
    grasp, arm = proposal.grasp, proposal.limbs.arm
    if grasp is None or arm is None or arm.hand is None:
        yield "# FILL IN: a frame whose x points out along the fingers, y the closing direction"
        yield "# end_effector: {actuator: gripper, frame: hand, max_width: 0.1, max_force: 20,"
        yield "#   pad_length: 0.03, pad_height: 0.02, hand_clearance: 0.03, touch_links: [hand]}"
        return
    hand = arm.hand
    touch = [link for link in hand.links if proposal.prepared.skeleton.links[link].shapes]
    yield "# Measured: opening and pads by the distance of the fingers' hulls."
    if hand.single:
        yield "# Look at it: one jaw closes against the palm; its widths are those of its tip."
    if grasp.thinnest > APART:
        yield f"# Look at it: closed, the fingers are {number(grasp.thinnest, 3)} m apart; the row"
        yield "# for width 0 lies beyond the joint's limit."
    yield "end_effector:"
    yield f"  actuator: {gripper_name(arm.name)}"
    yield f"  frame: {_grasp_frame(proposal, arm.name, grasp)}"
    yield f"  grasp_offset: {number(grasp.offset)}"
    yield f"  max_width: {number(grasp.max_width)}"
    force = "by the URDF's efforts" if grasp.force_known else "guessed: the URDF has no effort"
    yield f"  max_force: {number(grasp.max_force)}    # {force}, at most {STRONGEST:g} N"
    yield f"  pad_length: {number(grasp.pad_length)}"
    yield f"  pad_height: {number(grasp.pad_height)}"
    yield f"  hand_clearance: {number(grasp.hand_clearance)}"
    yield f"  touch_links: [{', '.join(touch)}]"
    yield "  opening:    # rows [width, joint position]"
    for joint, rows in grasp.opening.items():
        pairs = ", ".join(f"[{number(w, 5)}, {number(q, 5)}]" for w, q in rows)
        yield f"    {joint}: [{pairs}]"


def _named_poses(proposal: Proposal) -> Iterator[str]:
    if not proposal.poses:
        yield "# FILL IN: named_poses: home, ready, carry and look_around, joint by joint"
        yield "named_poses: {}"
        return
    yield "# Found by search, free of self-collision where nothing else is said."
    yield "named_poses:"
    for name, pose in proposal.poses.items():
        yield f"  # {POSES[name]}"
        said = [f"the arm reaches {number(pose.outside, 2)} m out of the footprint"]
        if pose.clear is not None:
            said.append(f"links keep {number(pose.clear)} m")
        if pose.covered > 0:
            said.append(f"{pose.covered:.0%} of the arm is in the camera's picture")
        yield from _wrapped(f"{'; '.join((*said, *pose.notes))}.", "  ")
        yield f"  {name}:"
        yield from (f"    {joint}: {number(value, 5)}" for joint, value in pose.joints.items())


def _ignored(proposal: Proposal) -> Iterator[str]:
    matrix = proposal.matrix
    counts = {why: len(matrix.pairs(why)) for why in dict.fromkeys(matrix.why.values())}
    told = ", ".join(f"{count} {why.value}" for why, count in counts.items())
    yield from _wrapped(
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
        yield f"  - [{one}, {other}]    # {said}"


def _simulation(proposal: Proposal) -> Iterator[str]:
    arm, skeleton = proposal.limbs.arm, proposal.prepared.skeleton
    hand = arm.hand if arm is not None else None
    fingers: Iterable[str] = ()
    if hand is not None:
        moving = {link for branch in hand.branches for link in branch.links}
        fingers = [n for n in (*hand.ahead, *hand.behind) if n in moving]
        fingers = [n for n in fingers if skeleton.links[n].shapes]
    yield "# What a simulator must know beside all this. Friction is guessed: rubber pads."
    yield "simulation:"
    yield f"  floor_links: [{', '.join(proposal.stand.grounded)}]"
    yield f"  finger_links: [{', '.join(fingers)}]"
    yield "  finger_friction: 1.0"
    if proposal.cells:
        yield "  # Measured: other links lie in the hulls around these meshes. Guessed: even cuts."
        yield "  convex_cells:"
        for link, cuts in proposal.cells.items():
            inside = ", ".join(f"{n}: [{', '.join(map(number, at))}]" for n, at in cuts.items())
            yield f"    {link}: {{{inside}}}"


def number(value: float, digits: int = 4) -> str:
    """A number as a person writes it."""
    text = f"{value:.{digits}f}".rstrip("0").rstrip(".")
    return "0" if text in ("-0", "") else text


def _text(value: str) -> str:
    """A path as YAML takes it."""
    plain = all(letter.isalnum() or letter in "/._-" for letter in value)
    return value if plain else '"' + value.replace("\\", "\\\\").replace('"', '\\"') + '"'


def _wrapped(text: str, indent: str = "", width: int = 98) -> Iterator[str]:
    line = f"{indent}#"
    for word in text.split():
        if len(line) + 1 + len(word) > width and line != f"{indent}#":
            yield line
            line = f"{indent}#"
        line += f" {word}"
    yield line
