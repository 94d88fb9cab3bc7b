"""Checks of the poses, footprint, height and joints of a robot."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from momantu_bt.findings import FindingAtKeys
from momantu_bt.formats.problems import Severity
from momantu_bt.formats.urdf import read_urdf
from momantu_bt.robot import REQUIRED_POSES, ActuatorKind, RobotDescription
from momantu_skills.manipulation.config import PlanningConfig
from momantu_skills.manipulation.model.arm_model import ArmModel
from momantu_skills.manipulation.model.collision import CollisionWorld, body_pairs
from momantu_skills.robot_setup.find.base import ABOVE, Stand
from momantu_skills.robot_setup.urdf.body import Body
from momantu_skills.robot_setup.urdf.cells import cuts_of, swallowed

AT_REST = "at rest"
"""Stands for the posture of a robot without named poses."""
OUTSIDE = 0.01
"""How far the base may extend beyond its footprint, m: errors of hulls and rounding."""
ROOMY = 0.06
"""How far the footprint may extend beyond the base, m: a bumper, or a safety margin."""
TALL = 0.02
"""How much taller than the description's height a posture may be, m."""
SLACK = 1e-3
"""How much a limit may exceed the URDF's, rad or m, and per second: rounding."""


def check_poses(description: RobotDescription, model: ArmModel) -> Iterator[FindingAtKeys]:
    """Named poses that collide, or leave joints of the arm open."""
    arm = description.groups["arm"].joints
    met: dict[tuple[str, str], list[str]] = {}
    for name, pose in description.named_poses.items():
        place = ("named_poses", name)
        required = name in REQUIRED_POSES
        missing = [joint for joint in arm if joint not in pose]
        if missing and required:
            yield FindingAtKeys(
                Severity.ERROR,
                "pose-incomplete",
                f"the pose {name} leaves {', '.join(missing)} open",
                "give every joint of the group `arm` a position",
                place,
            )
            continue
        for pair in _meeting(model, pose):
            met.setdefault(pair, []).append(name)
    effector = description.end_effector
    hand = set() if effector is None else set(effector.touch_links)
    for pair, poses in met.items():
        yield _closed_hand(pair) if set(pair) <= hand else _collision(pair, poses)


def _meeting(model: ArmModel, pose: Mapping[str, float]) -> Iterator[tuple[str, str]]:
    """Pairs of links for which no motion is planned to a pose, with the hand shut or open."""
    effector = model.description.end_effector
    widest = 0.0 if effector is None else effector.max_width
    q = np.array([pose.get(joint, 0.0) for joint in model.group.names])
    margin = min(PlanningConfig().margins)
    found: dict[tuple[str, str], None] = {}
    for width in dict.fromkeys((0.0, widest / 2, widest)):
        world = CollisionWorld(body_pairs(model), model.posture(pose, width), margin=margin)
        found |= dict.fromkeys(_links(a, b) for a, b in world.touching(q))
    yield from found


def _collision(pair: tuple[str, str], poses: list[str]) -> FindingAtKeys:
    required = any(name in REQUIRED_POSES for name in poses)
    return FindingAtKeys(
        Severity.ERROR if required else Severity.WARNING,
        "pose-collides",
        f"{pair[0]} meets {pair[1]} in {in_poses(poses)}",
        "move the arm away from there, or name the pair in `ignored_collisions` if only the hulls "
        "of the two overlap",
        ("named_poses", poses[0]),
    )


def _closed_hand(pair: tuple[str, str]) -> FindingAtKeys:
    return FindingAtKeys(
        Severity.WARNING,
        "closed-hand-collides",
        f"{pair[0]} meets {pair[1]} when the hand is closed: no motion is planned from there",
        f"write [{pair[0]}, {pair[1]}] under `ignored_collisions`",
        ("ignored_collisions",),
    )


def in_poses(names: list[str]) -> str:
    """`the pose home`, `the poses home and carry`."""
    if names == [AT_REST]:
        return "its posture at rest"
    if len(names) == 1:
        return f"the pose {names[0]}"
    return f"the poses {', '.join(names[:-1])} and {names[-1]}"


def _links(one: str, other: str) -> tuple[str, str]:
    """The links that shapes belong to; shapes of long links are numbered."""
    return one.split(":")[0], other.split(":")[0]


def check_footprint(
    description: RobotDescription, body: Body, stand: Stand
) -> Iterator[FindingAtKeys]:
    """A footprint that does not enclose the base, or is far too large; a wrong height."""
    if stand.footprint is not None:
        outline = np.array(description.footprint)
        planes = _half_planes(outline)
        beyond = (stand.low @ planes[:, :2].T - planes[:, 2]).max(axis=1)
        worst = int(np.argmax(beyond))
        if beyond[worst] > OUTSIDE:
            x, y = stand.low[worst]
            yield FindingAtKeys(
                Severity.ERROR,
                "footprint-too-small",
                f"the base reaches {beyond[worst]:.3f} m out of its footprint, at "
                f"({x:.3f}, {y:.3f})",
                f"enclose the base and what rolls up to {ABOVE:g} m above the floor",
                ("footprint",),
            )
        around = _half_planes(stand.footprint)
        room = (outline @ around[:, :2].T - around[:, 2]).max(axis=1).max()
        if room > ROOMY:
            yield FindingAtKeys(
                Severity.WARNING,
                "footprint-too-large",
                f"the footprint reaches {room:.3f} m beyond the base: doors get narrower by it",
                "draw it along the base",
                ("footprint",),
            )
    yield from _height(description, body)


def _height(description: RobotDescription, body: Body) -> Iterator[FindingAtKeys]:
    tops = {
        name: float(body.corners(body.hulls, pose)[:, 2].max())
        for name, pose in (description.named_poses or {AT_REST: {}}).items()
        if body.hulls
    }
    tallest = max(tops, key=lambda name: tops[name], default=None)
    if tallest is not None and tops[tallest] > description.height + TALL:
        yield FindingAtKeys(
            Severity.ERROR,
            "taller-than-height",
            f"in {in_poses([tallest])} the robot is {tops[tallest]:.2f} m tall, and its height is "
            f"{description.height:g} m",
            f"write `height: {tops[tallest] + 0.005:.2f}`, or lower the pose",
            ("height",),
        )


def _half_planes(corners: np.ndarray) -> np.ndarray:
    """(k, 3): outward normals and offsets of a counter-clockwise outline."""
    edges = np.roll(corners, -1, axis=0) - corners
    normals = np.stack([edges[:, 1], -edges[:, 0]], axis=1)
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-9)
    return np.column_stack([normals, (normals * corners).sum(axis=1)])


def check_limits(description: RobotDescription, body: Body) -> Iterator[FindingAtKeys]:
    """Limits beyond the URDF's, and joints whose drive has no force."""
    for name, limit in description.joint_limits.items():
        joint = body.skeleton.joints[name]
        place = ("joint_limits", name)
        given = {"lower": limit.lower, "upper": limit.upper}
        for key, value in given.items():
            bound = getattr(joint, key)
            sign = -1.0 if key == "lower" else 1.0
            wide = value is not None and bound is not None and not joint.endless
            if wide and sign * (value - bound) > SLACK:
                yield FindingAtKeys(
                    Severity.ERROR,
                    "limit-beyond-urdf",
                    f"{key} of {name} is {value:g}, and the URDF's is {bound:g}",
                    "take the URDF's, or mend the URDF",
                    (*place, key),
                )
        if joint.velocity and limit.velocity > joint.velocity + SLACK:
            yield FindingAtKeys(
                Severity.WARNING,
                "faster-than-urdf",
                f"{name} may go {limit.velocity:g} per second, by the URDF {joint.velocity:g}",
                "take the URDF's speed, unless you know better",
                (*place, "velocity"),
            )
    yield from _forces(description, body)


def _forces(description: RobotDescription, body: Body) -> Iterator[FindingAtKeys]:
    if description.simulation is None:
        return
    drives = description.simulation.drives
    for name, actuator in description.actuators.items():
        if actuator.kind is not ActuatorKind.JOINTS:
            continue
        strong = {joint for joint, gains in drives.items() if gains.force is not None}
        strong |= {joint for joint in actuator.joints if body.skeleton.joints[joint].effort}
        weak = [joint for joint in actuator.joints if joint not in strong]
        if weak:
            yield FindingAtKeys(
                Severity.WARNING,
                "no-force",
                f"neither the URDF nor `drives` says how strong these are, and nothing limits "
                f"them: {', '.join(weak)}",
                f"write `drives: {{{weak[0]}: {{force: …}}}}`, Nm or N",
                ("actuators", name),
            )


def check_hulls(description: RobotDescription, body: Body) -> Iterator[FindingAtKeys]:
    """Links inside the hull of a long mesh: a simulator pushes them out."""
    if description.simulation is None:
        return
    cut = description.simulation.convex_cells
    met: dict[tuple[str, str], list[str]] = {}
    for pose, link, long in swallowed(
        body, description.named_poses, description.ignored_collisions
    ):
        if long not in cut and pose not in met.setdefault((link, long), []):
            met[link, long].append(pose)
    for (link, long), poses in met.items():
        cuts = ", ".join(f"{name}: {list(at)}" for name, at in cuts_of(body, long).items())
        yield FindingAtKeys(
            Severity.ERROR,
            "hull-swallows",
            f"{link} lies in the convex hull of {long}, for which a simulator takes it, in "
            f"{in_poses(poses)}",
            f"cut the mesh: write `{long}: {{{cuts}}}` under `convex_cells`, or ignore the pair",
            ("simulation",),
        )


def check_looks(description: RobotDescription) -> Iterator[FindingAtKeys]:
    """Links with a collision shape but no visual shape."""
    links = read_urdf(description.urdf).links
    bare = [link.name for link in links if link.collisions and not link.visuals]
    if bare:
        yield FindingAtKeys(
            Severity.WARNING,
            "invisible",
            f"{len(bare)} links have a collision shape and nothing to look at: simulated cameras "
            f"and pictures do not show {', '.join(bare[:4])}{', …' if len(bare) > 4 else ''}",
            "give them a <visual>, the same shape at least",
            ("parts",),
        )
