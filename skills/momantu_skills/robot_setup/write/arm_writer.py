"""Writing the arms, hands and poses of a robot file."""

from __future__ import annotations

from collections.abc import Iterator

from momantu_skills.robot_setup.find.grasp import APART, STRONGEST, Grasp
from momantu_skills.robot_setup.find.proposal import Proposal
from momantu_skills.robot_setup.write.file_text import comment, listed, number, scalar

POSES = {
    "home": "Folded for driving: within the footprint as far as it goes, the camera ahead.",
    "ready": "Before work at a table: the camera looks at it.",
    "carry": "The hand level, what it holds upright if it was gripped from the side.",
    "look_around": "The camera looks far, the arm out of its picture.",
}
"""What the poses are for."""


def actuator_lines(proposal: Proposal) -> Iterator[str]:
    """The actuators: base, limbs, grippers, and remaining joints."""
    limbs = proposal.limbs
    yield "actuators:"
    yield "  base: {kind: base}"
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


def gripper_name(limb: str) -> str:
    """The actuator of the hand at a limb's end."""
    return limb.replace("arm", "gripper", 1)


def _joints(name: str, kind: str, joints: tuple[str, ...]) -> Iterator[str]:
    if sum(map(len, joints)) < 50:
        yield f"  {name}: {{kind: {kind}, joints: {listed(joints)}}}"
        return
    yield f"  {name}:"
    yield f"    kind: {kind}"
    yield "    joints:"
    yield from (f"      - {scalar(joint)}" for joint in joints)


def limit_lines(proposal: Proposal) -> Iterator[str]:
    """Positions, speeds and accelerations of the joints."""
    if not proposal.limits:
        return
    yield "# Positions and speeds from the URDF. Accelerations measured: half of the effort by the"
    yield "# greatest inertia, and not more than an arm does gently."
    yield "joint_limits:"
    for name, found in proposal.limits.items():
        limit = found.limit
        values = limit.model_dump(exclude_none=True)
        inside = ", ".join(f"{key}: {number(value, 9)}" for key, value in values.items())
        guessed = f"    # guessed: {'; '.join(found.guessed)}" if found.guessed else ""
        yield f"  {scalar(name)}: {{{inside}}}{guessed}"


def group_lines(proposal: Proposal) -> Iterator[str]:
    """The planning groups: the arms."""
    limbs = [limb for limb in (proposal.limbs.arm, *proposal.limbs.others) if limb is not None]
    if not limbs:
        yield "# If the robot has an arm: groups: {arm: {joints: [shoulder_joint, …], tip: hand}},"
        yield "# with `actuators: {arm: {kind: joints, joints: […]}}`, their `joint_limits`,"
        yield "# `working: {reach: […]}` and the poses home, ready, carry and look_around."
        return
    yield "groups:"
    for limb in limbs:
        grasp = proposal.grasps.get(limb.name)
        tip = limb.tip if grasp is None else _grasp_frame(proposal, limb.name, grasp)
        yield f"  {limb.name}:"
        yield "    joints:"
        yield from (f"      - {scalar(joint)}" for joint in limb.joints)
        yield f"    tip: {scalar(tip)}"


def _grasp_frame(proposal: Proposal, limb: str, grasp: Grasp) -> str:
    if grasp.link_from_grasp is None:
        return grasp.link
    return "grasp" if limb == "arm" else f"{limb}_grasp"


def end_effector_lines(proposal: Proposal) -> Iterator[str]:
    """The hand of the first arm."""
    grasp, arm = proposal.grasp, proposal.limbs.arm
    if grasp is None or arm is None or arm.hand is None:
        yield "# If the robot has a hand: a frame whose x points out along the fingers, y closing"
        yield "# direction, and `actuators: {gripper: {kind: gripper, joints: […]}}`."
        yield "# end_effector: {actuator: gripper, frame: hand, max_width: 0.1, max_force: 20,"
        yield "#   pad_length: 0.03, pad_height: 0.02, hand_clearance: 0.03, touch_links: [hand]}"
        return
    hand = arm.hand
    touch = [link for link in hand.links if proposal.prepared.skeleton.links[link].collisions]
    yield "# Measured: opening and pads by the distance of the fingers' hulls."
    if hand.single:
        yield "# Look at it: one jaw closes against the palm; its widths are those of its tip."
    if grasp.thinnest > APART:
        yield f"# Look at it: closed, the fingers are {number(grasp.thinnest, 3)} m apart; the row"
        yield "# for width 0 lies beyond the joint's limit."
    yield "end_effector:"
    yield f"  actuator: {gripper_name(arm.name)}"
    yield f"  frame: {scalar(_grasp_frame(proposal, arm.name, grasp))}"
    yield f"  grasp_offset: {number(grasp.offset)}"
    yield f"  max_width: {number(grasp.max_width)}"
    force = "by the URDF's efforts" if grasp.force_known else "guessed: the URDF has no effort"
    yield f"  max_force: {number(grasp.max_force)}    # {force}, at most {STRONGEST:g} N"
    yield f"  pad_length: {number(grasp.pad_length)}"
    yield f"  pad_height: {number(grasp.pad_height)}"
    yield f"  hand_clearance: {number(grasp.hand_clearance)}"
    yield f"  touch_links: {listed(touch)}"
    yield "  opening:    # rows [width, joint position]"
    for joint, rows in grasp.opening.items():
        pairs = ", ".join(f"[{number(w, 5)}, {number(q, 5)}]" for w, q in rows)
        yield f"    {scalar(joint)}: [{pairs}]"


def pose_lines(proposal: Proposal) -> Iterator[str]:
    """The poses that were found, with what is to be known of each."""
    if not proposal.poses:
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
        yield from comment(f"{'; '.join((*said, *pose.notes))}.", "  ")
        yield f"  {name}:"
        yield from (
            f"    {scalar(joint)}: {number(value, 5)}" for joint, value in pose.joints.items()
        )
