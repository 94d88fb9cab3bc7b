"""Where a hand grasps: the frame between its pads, their size, how wide and how strongly."""

from __future__ import annotations

import dataclasses
import math
from dataclasses import dataclass
from itertools import product

import numpy as np
from scipy.spatial import ConvexHull

from momantu_bt.geometry import Array, Transform
from momantu_skills.manipulation.model.hulls import placed
from momantu_skills.robot_setup.find.fingers import STEPS, Hand
from momantu_skills.robot_setup.urdf.body import Body
from momantu_skills.robot_setup.urdf.rays import opening_between

SNAP = 0.2
"""Directions within this angle to an axis of the palm's frame are set to that axis, rad."""
SAME_PLACE = 0.012
"""Distance from the centre between the pads within which an existing link is used as the grasp
frame, m."""
SAME_WAY = 0.06
"""Largest rotation of its axes, rad."""
FACE = 0.003
"""Distance from a finger's innermost corner within which corners belong to its pad, m."""
SHORT = 0.015
"""Least length of a pad, m; a shorter one is an edge."""
LEAST_PAD = 0.02
"""Least assumed length and height of a pad, m: rounded tips deform."""
STRONGEST = 60.0
"""Largest proposed closing force, N: it does not crush a can."""
APART = 2e-3
"""Least distance between closed fingers at which they do not touch, m."""
LINEAR = 1.2e-3
"""Largest deviation from a straight line, m, at which two rows describe an opening."""
ROWS = 6
"""Rows of an opening that is not linear."""


@dataclass(frozen=True)
class Grasp:
    """The grasp frame and what goes with it; lengths in m, see `EndEffector`.

    link: what the frame is fixed to. link_from_grasp: where, None where the link itself, moved by
    `offset` along its x, is the grasp frame. force_known: whether the URDF's efforts gave it.
    thinnest: opening of the hand when it is closed.
    """

    link: str
    link_from_grasp: Transform | None
    offset: float
    max_width: float
    max_force: float
    force_known: bool
    pad_length: float
    pad_height: float
    hand_clearance: float
    opening: dict[str, tuple[tuple[float, float], ...]]
    thinnest: float


def find_grasp(body: Body, hand: Hand) -> Grasp:
    """Measure a hand half open."""
    posture = hand.posture(_half_open(hand))
    base_from_palm = body.link_poses(posture)[hand.palm]
    y = _snapped(hand.closing)
    ahead, behind, palm = (
        _in_palm(body.points(links, posture), base_from_palm)
        for links in (hand.ahead, hand.behind, hand.body)
    )
    if hand.single:
        tip = ahead[int(np.argmax(np.linalg.norm(ahead, axis=1)))]
        behind = behind[np.linalg.norm(behind - tip, axis=1) < 2 * float(hand.widths[0])]
    poses = body.link_poses(posture, [branch.links[0] for branch in hand.branches])
    roots = _in_palm(np.array([pose[:3, 3] for pose in poses.values()]), base_from_palm)
    x = _outwards(palm, roots, np.vstack([ahead, behind]), y)
    axes = np.stack([x, np.cross(np.cross(x, y), x), np.cross(x, y)], axis=1)
    origin, length, height = _pads(ahead @ axes, behind @ axes)
    place = Transform.from_rotation(axes, axes @ origin)
    solids = [_in_palm(body.points([n], posture), base_from_palm) for n in hand.body]
    solids = [points @ axes for points in solids if len(points)]
    clearance = _clearance(solids, origin, float(hand.widths[0]), height)
    link, link_from_grasp, offset = _frame(body, hand, place, posture)
    hand = dataclasses.replace(hand, widths=_widths_at(body, hand, place, length, height))
    force, known = _force(body, hand)
    return Grasp(
        link,
        link_from_grasp,
        offset,
        round(float(hand.widths[0]), 4),
        force,
        known,
        length,
        height,
        clearance,
        _opening(hand),
        float(hand.widths[-1]),
    )


def _around(body: Body, hand: Hand, place: Transform, share: float) -> list[Array]:
    """Corners (n, 3) of each finger in the grasp frame, `share` of the way to closed."""
    poses = body.link_poses(hand.posture(share))
    grasp_from_base = (Transform.from_matrix(poses[hand.palm]) @ place).inverse()
    fingers = [n for n in (*hand.ahead, *hand.behind) if n in body.hulls]
    return [grasp_from_base.apply(placed(body.hulls[n], poses[n])) for n in fingers]


def _widths_at(body: Body, hand: Hand, place: Transform, length: float, height: float) -> Array:
    """Openings (STEPS,) at the pads' middle, where fingers that turn may differ from their tips."""
    if hand.single:
        return hand.widths
    widths = []
    for share in np.linspace(0.0, 1.0, STEPS):
        gap = opening_between(_around(body, hand, place, share), length, height)
        if gap is None:
            return hand.widths
        widths.append(gap)
    return np.minimum.accumulate(widths)


def _half_open(hand: Hand) -> float:
    return int(np.argmin(np.abs(hand.widths - hand.widths[0] / 2))) / (STEPS - 1)


def _in_palm(points: Array, base_from_palm: Array) -> Array:
    return np.asarray((points - base_from_palm[:3, 3]) @ base_from_palm[:3, :3])


def _snapped(direction: Array) -> Array:
    best = int(np.argmax(np.abs(direction)))
    axis = np.zeros(3)
    axis[best] = np.sign(direction[best])
    return axis if float(direction @ axis) > np.cos(SNAP) else direction


def _outwards(palm: Array, roots: Array, fingers: Array, y: Array) -> Array:
    """From the palm to the fingers, square to the closing direction.

    A camera on a palm moves its middle aside, and so do hinges beside it the middle of the fingers'
    roots: of both, that counts whose direction is nearer to an axis of the palm's frame.
    """
    tips = _middle(fingers)
    starts = [_middle(points) for points in (palm, roots) if len(points)]
    ways = [_square(tips - start, y) for start in starts]
    lengths = [float(np.linalg.norm(way)) for way in ways]
    found = [way / length for way, length in zip(ways, lengths, strict=True) if length > SHORT]
    if found:
        out = max(found, key=lambda way: round(float(np.abs(way).max()), 6))
    else:  # the fingers sit around the palm's middle: out is any way square to y
        out = np.cross(y, np.eye(3)[int(np.argmin(np.abs(y)))])
    snapped = _square(_snapped(out / np.linalg.norm(out)), y)
    return np.asarray(snapped / np.linalg.norm(snapped))


def _square(way: Array, y: Array) -> Array:
    return np.asarray(way - (way @ y) * y)


def _middle(points: Array) -> Array:
    return np.asarray((points.min(axis=0) + points.max(axis=0)) / 2)


def _pads(ahead: Array, behind: Array) -> tuple[Array, float, float]:
    """Origin (3,) between two pads, given in grasp axes, and the pads' length and height.

    Pads are where the fingers are innermost. Fingers that turn are so at their roots, or only at
    an edge: of those the outer halves are the pads.
    """
    both = np.vstack([ahead, behind])
    half = float(both[:, 0].min() + both[:, 0].max()) / 2
    inner, outer = float(ahead[:, 1].max()), float(behind[:, 1].min())
    one, other = ahead[ahead[:, 1] > inner - FACE], behind[behind[:, 1] < outer + FACE]
    low, high = _overlap(one, other)
    if high[0] - low[0] < SHORT or (low[0] + high[0]) / 2 < half - SHORT:
        one, other = ahead[ahead[:, 0] >= half], behind[behind[:, 0] >= half]
        one, other = (side if len(side) else both for side in (one, other))
        inner, outer = float(one[:, 1].max()), float(other[:, 1].min())
        low, high = _overlap(one, other)
        low[0] = half
    middle = (low + high) / 2
    size = np.maximum(high - low, LEAST_PAD)
    origin = np.array([middle[0], (inner + outer) / 2, middle[2]])
    return origin, round(float(size[0]), 3), round(float(size[2]), 3)


def _overlap(one: Array, other: Array) -> tuple[Array, Array]:
    """Lower and upper corner of what two boxes share; where they share nothing, the middle."""
    low = np.maximum(one.min(axis=0), other.min(axis=0))
    high = np.minimum(one.max(axis=0), other.max(axis=0))
    middle = (low + high) / 2
    return np.minimum(low, middle), np.maximum(high, middle)


def _clearance(palms: list[Array], origin: Array, width: float, height: float) -> float:
    """From the grasp frame's origin back to the palm, m; hulls (n, 3) are given in grasp axes."""
    nearest = math.inf
    for corners in palms:
        planes = ConvexHull(corners).equations
        for y, z in product((-0.4, 0.0, 0.4), repeat=2):
            beside = np.array([0.0, y * width, z * max(height, LEAST_PAD)])
            nearest = min(nearest, _behind(planes, origin + beside))
    return round(nearest, 3) if math.isfinite(nearest) else 0.0


def _behind(planes: Array, start: Array) -> float:
    """How far behind a point, against x, a convex solid begins; infinite where it does not."""
    along, inside = planes[:, 0], planes[:, :3] @ start + planes[:, 3]
    level = np.abs(along) < 1e-9
    if (inside[level] > 0).any():
        return math.inf
    crossings = inside[~level] / along[~level]
    first = max(crossings[along[~level] > 0], default=-math.inf)
    last = min(crossings[along[~level] < 0], default=math.inf)
    return math.inf if first > last or last < 0 else max(float(first), 0.0)


def _frame(
    body: Body, hand: Hand, place: Transform, posture: dict[str, float]
) -> tuple[str, Transform | None, float]:
    """A link that is the grasp frame already, or the palm and the frame's place on it."""
    poses = body.link_poses(posture)
    palm_from_base = Transform.from_matrix(poses[hand.palm]).inverse()
    flipped = place @ Transform.from_rpy((0, 0, 0), (np.pi, 0, 0))
    for link in reversed(hand.body):
        palm_from_link = palm_from_base @ Transform.from_matrix(poses[link])
        between = palm_from_link.inverse() @ place
        turned = min(palm_from_link.angle_to(place), palm_from_link.angle_to(flipped))
        aside = float(np.linalg.norm(between.position[1:]))
        if turned < SAME_WAY and aside < SAME_PLACE:
            along = float(between.position[0])
            return link, None, 0.0 if abs(along) < SAME_PLACE else round(along, 3)
    return hand.palm, place, 0.0


def _force(body: Body, hand: Hand) -> tuple[float, bool]:
    """Closing force by the URDF's efforts, N, and whether there are any."""
    forces = []
    for name in hand.leaders:
        joint = body.skeleton.joints[name]
        if joint.mimic is not None or not joint.effort:
            continue
        opened, closed = hand.leaders[name]
        lever = float(hand.widths[0] - hand.widths[-1]) / max(abs(closed - opened), 1e-9)
        forces.append(joint.effort if joint.kind == "prismatic" else joint.effort / lever)
    if not forces:
        return STRONGEST / 3, False
    return round(min(STRONGEST, sum(forces)), 1), True


def _opening(hand: Hand) -> dict[str, tuple[tuple[float, float], ...]]:
    """Rows (width, position) of each joint, from width 0 to the widest opening.

    Fingers that stay apart when they are closed go on straight to width 0.
    """
    widths, shares = hand.widths[::-1], np.linspace(1.0, 0.0, STEPS)
    rising = np.concatenate([[True], np.diff(np.maximum.accumulate(widths)) > 1e-6])
    widths, shares = widths[rising].copy(), shares[rising]
    widths[-1] = round(float(hand.widths[0]), 4)
    straight = np.interp(shares, shares[[-1, 0]], widths[[-1, 0]])
    bends = float(np.abs(widths - straight).max()) > LINEAR
    picked = np.linspace(0, len(widths) - 1, ROWS if bends else 2).round().astype(int)
    widths, shares = widths[picked], shares[picked]
    if widths[0] > APART:
        slope = (shares[1] - shares[0]) / (widths[1] - widths[0])
        shares = np.concatenate([[shares[0] - slope * widths[0]], shares])
        widths = np.concatenate([[0.0], widths])
    widths[0] = 0.0
    return {
        name: tuple(
            (round(float(w), 5), round(opened + float(s) * (closed - opened), 5) + 0.0)
            for w, s in zip(widths, shares, strict=True)
        )
        for name, (opened, closed) in hand.leaders.items()
        if abs(closed - opened) > 1e-9
    }
