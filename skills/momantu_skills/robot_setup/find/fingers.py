"""Finding hands: links on which fingers sit that open and close against each other."""

from __future__ import annotations

import re
from dataclasses import dataclass

import numpy as np

from momantu_bt.geometry import Array
from momantu_skills.manipulation.model.hulls import placed
from momantu_skills.robot_setup.urdf.body import Body
from momantu_skills.robot_setup.urdf.skeleton import SetupJoint

FINGER_JOINTS = 5
"""Most moving joints of a finger."""
FINGER_REACH = 0.25
"""Largest distance from a finger's joint to its farthest point, m."""
NEAR = 0.03
"""Fingers that stay farther apart than this do not close, m."""
TRAVEL = 0.008
"""Least change of the gap between fingers that open, m."""
FREE = 6.2
"""Range of a hinge, rad, from which it counts as one without limits."""
SWING = 0.6
"""Assumed range of a finger's hinge without limits to each side of its place at rest, rad."""
JAW = re.compile(r"gripper|jaw|finger|claw|pinc|grasp", re.IGNORECASE)
"""Usual names of the joint of a single jaw; without them it looks like a last wrist joint."""
STEPS = 41
"""Openings that are sampled between open and closed."""
SHUT = 0.03
"""Fingers that touch within this share of the travel before its end count as closed at the end."""


@dataclass(frozen=True)
class Branch:
    """A finger. joint: its first joint. links: all of it. tip: its last rigid part."""

    joint: str
    links: tuple[str, ...]
    tip: tuple[str, ...]


@dataclass(frozen=True)
class Hand:
    """Fingers on a palm.

    palm: the link that carries them; body: everything fixed to it. leaders: (open, closed)
    position of each joint that closes the hand, and of those that follow them. widths: (k,)
    openings in m while they go from open to closed evenly. ahead, behind: the fingers that move
    along the closing direction, and those (or the palm) that they meet. closing: (3,) unit, in
    the palm's frame. single: one jaw against the palm.
    """

    palm: str
    body: tuple[str, ...]
    branches: tuple[Branch, ...]
    leaders: dict[str, tuple[float, float]]
    widths: Array
    ahead: tuple[str, ...]
    behind: tuple[str, ...]
    closing: Array
    single: bool

    def posture(self, share: float) -> dict[str, float]:
        """The hand's joints, `share` of the way from open (0) to closed (1)."""
        return {name: a + share * (b - a) for name, (a, b) in self.leaders.items()}

    @property
    def links(self) -> tuple[str, ...]:
        """Palm and fingers."""
        return (*self.body, *(link for branch in self.branches for link in branch.links))


def find_hands(body: Body) -> tuple[Hand, ...]:
    """Every hand below the base, in the order of the URDF."""
    skeleton = body.skeleton
    below = set(skeleton.subtree(body.base_frame))
    base = set(skeleton.rigid(body.base_frame))
    found: list[Hand] = []
    taken: set[str] = set()
    for link in skeleton.subtree(body.base_frame):
        if link in base or link in taken or link not in below or skeleton.rigid_root(link) != link:
            continue
        hand = _hand(body, link)
        if hand is not None:
            found.append(hand)
            taken |= set(skeleton.subtree(link))
    order = {name: i for i, name in enumerate(skeleton.links)}
    return tuple(sorted(found, key=lambda hand: order[hand.palm]))


def _hand(body: Body, link: str) -> Hand | None:
    joints = body.skeleton.branches(link)
    if not joints or not all(_is_finger(body, joint) for joint in joints):
        return None
    branches = tuple(_branch(body, joint) for joint in joints)
    branches = tuple(b for b in branches if any(link in body.hulls for link in b.tip))
    if len(branches) >= 2:
        return _gripper(body, link, branches)
    if len(branches) == 1 and JAW.search(branches[0].joint + branches[0].links[0]):
        return _jaw(body, link, branches[0])
    return None


def _is_finger(body: Body, joint: SetupJoint) -> bool:
    links = body.skeleton.subtree(joint.child)
    if 1 + len(body.skeleton.moving_below(joint.child)) > FINGER_JOINTS:
        return False
    origin = body.link_poses({})[joint.child][:3, 3]
    corners = body.corners(links, {})
    return len(corners) == 0 or float(np.linalg.norm(corners - origin, axis=1).max()) < FINGER_REACH


def _branch(body: Body, joint: SetupJoint) -> Branch:
    skeleton = body.skeleton
    links = skeleton.subtree(joint.child)
    shaped = [link for link in links if link in body.hulls]
    depth = {link: sum(j.moving for j in skeleton.chain(link)) for link in shaped}
    last = max(shaped, key=lambda link: depth[link], default=joint.child)
    tip = tuple(name for name in skeleton.rigid(last) if name in links)
    return Branch(joint.name, links, tip)


def _joints_of(body: Body, link: str, branches: tuple[Branch, ...]) -> list[str]:
    """The free joints that move the fingers of a palm.

    A joint that moves every finger, itself or by those that mimic it, is the hand's motor. Beside
    one, other free joints of the fingers are springs, which stay where they are.
    """
    joints, below = body.skeleton.joints, set(body.skeleton.subtree(link))
    moved = dict[str, set[str]]()
    for branch in branches:
        for joint in joints.values():
            name = joint.name if joint.mimic is None else joint.mimic.leader
            if joint.child in branch.links and name in body.free_joints:
                moved.setdefault(name, set()).add(branch.joint)
    moved = {name: them for name, them in moved.items() if joints[name].child in below}
    motors = [name for name, them in moved.items() if len(them) == len(branches)]
    return [name for name in body.free_joints if name in (motors or moved)]


def _gripper(body: Body, link: str, branches: tuple[Branch, ...]) -> Hand | None:
    joints = _joints_of(body, link, branches)
    found = [_closing(body, link, branches, some) for some in _one_each(body, branches, joints)]
    hands = [hand for hand in found if hand is not None]
    if not hands:
        return _closing(body, link, branches, joints)
    return max(hands, key=lambda hand: (len(hand.ahead) + len(hand.behind), hand.widths[0]))


def _one_each(body: Body, branches: tuple[Branch, ...], joints: list[str]) -> list[list[str]]:
    """Ways to close a hand by one of the joints that follow on each other in each finger.

    The others stay at rest: the tip of a finger with a motor in its knuckle alone hangs on a
    spring, which keeps it straight in free space, and some fingers also spread. The first way has
    the last joint of each finger, the next those before them. No way for fingers of one joint.
    """
    depth = {n: len(body.skeleton.chain(body.skeleton.joints[n].child)) for n in joints}
    chains = [[n for n in joints if _moves(body, n, branch)] for branch in branches]
    chains = [sorted(chain, key=lambda n: -depth[n]) for chain in chains if chain]
    ways = max(map(len, chains), default=0)
    if ways < 2 or len({name for chain in chains for name in chain}) < sum(map(len, chains)):
        return []
    picked = [{chain[min(k, len(chain) - 1)] for chain in chains} for k in range(ways)]
    return [[name for name in joints if name in some] for some in picked]


def _leaders(
    body: Body, branches: tuple[Branch, ...], joints: list[str]
) -> dict[str, tuple[float, float]]:
    """(open, closed) of those of some joints that bring the fingers together."""
    ranges = {name: _span(body, name) for name in joints}
    middle = {name: (low + high) / 2 for name, (low, high) in ranges.items()}

    def spread(posture: dict[str, float]) -> float:
        tips = _tips(body, branches, posture)
        return float(np.linalg.norm(tips - tips.mean(axis=0), axis=1).sum())

    leaders: dict[str, tuple[float, float]] = {}
    for name, (low, high) in ranges.items():
        near, far = low + 0.4 * (high - low), low + 0.6 * (high - low)
        change = spread({**middle, name: far}) - spread({**middle, name: near})
        if abs(change) > 1e-4:
            leaders[name] = (high, low) if change > 0 else (low, high)
    return leaders


def _moves(body: Body, name: str, branch: Branch) -> bool:
    """Whether a free joint, or one that follows it, moves a finger."""
    joints = (body.skeleton.above(link) for link in branch.links)
    return any(
        joint is not None and name in (joint.name, joint.mimic and joint.mimic.leader)
        for joint in joints
    )


def _closing(body: Body, link: str, branches: tuple[Branch, ...], joints: list[str]) -> Hand | None:
    """The hand, if these joints close it while the others stay at rest."""
    leaders = _leaders(body, branches, joints)
    if not leaders:
        return None
    # of a linkage, the pieces that hang on most joints hold; the others only guide them
    depth = {b: sum(j.moving for j in body.skeleton.chain(b.tip[0])) for b in branches}
    for some in (tuple(b for b in branches if depth[b] == max(depth.values())), branches):
        closing, ahead, behind = _sides(body, link, some, leaders)
        if ahead and behind:
            return _measured(body, link, branches, leaders, closing, ahead, behind)
    return None


def _span(body: Body, name: str) -> tuple[float, float]:
    """The range of a finger's joint, rad or m; of a hinge without limits a guess."""
    low, high = body.skeleton.joints[name].range
    unknown = body.skeleton.joints[name].kind != "prismatic" and high - low > FREE
    return (-SWING, SWING) if unknown else (low, high)


def _tips(body: Body, branches: tuple[Branch, ...], posture: dict[str, float]) -> Array:
    return np.array([body.corners(branch.tip, posture).mean(axis=0) for branch in branches])


def _sides(
    body: Body, link: str, branches: tuple[Branch, ...], leaders: dict[str, tuple[float, float]]
) -> tuple[Array, tuple[str, ...], tuple[str, ...]]:
    """Closing direction in the palm's frame, and the tips that move along it and against it."""
    at = [{n: a + s * (b - a) for n, (a, b) in leaders.items()} for s in (0.4, 0.6)]
    moves = _tips(body, branches, at[1]) - _tips(body, branches, at[0])
    lengths = np.linalg.norm(moves, axis=1)
    moves = moves / np.maximum(lengths, 1e-9)[:, None]
    agree = np.abs(moves @ moves.T).sum(axis=1) * (lengths > 1e-5)
    signs = np.sign(moves @ moves[int(np.argmax(agree))])
    axis = (moves * (signs * (lengths > 1e-5))[:, None]).sum(axis=0)
    axis /= max(float(np.linalg.norm(axis)), 1e-9)
    ahead = tuple(n for b, m in zip(branches, moves, strict=True) if m @ axis > 0.1 for n in b.tip)
    behind = tuple(
        n for b, m in zip(branches, moves, strict=True) if m @ axis < -0.1 for n in b.tip
    )
    if not behind:  # the others do not move: they are what is closed against
        still = [b for b, length in zip(branches, lengths, strict=True) if length <= 1e-5]
        behind = tuple(n for b in still for n in b.tip)
    base_from_palm = body.link_poses({})[link]
    closing = base_from_palm[:3, :3].T @ axis
    return closing / max(float(np.linalg.norm(closing)), 1e-9), ahead, behind


def _measured(
    body: Body,
    link: str,
    branches: tuple[Branch, ...],
    leaders: dict[str, tuple[float, float]],
    closing: Array,
    ahead: tuple[str, ...],
    behind: tuple[str, ...],
) -> Hand | None:
    gap = _Gap(body, link, leaders, closing, ahead, behind)
    shares = np.linspace(0.0, 1.0, STEPS)
    gaps = np.array([gap(s) for s in shares])
    shut = float(shares[np.argmax(gaps <= 0)]) if (gaps <= 0).any() else 1.0
    if gaps[0] - gaps.min() < TRAVEL or max(gap(shut), 0.0) > NEAR or shut == 0.0:
        return None
    if shut < 1.0 - SHUT:
        shut = _touch(gap, shut - 1 / (STEPS - 1), shut)
        leaders = {n: (a, a + shut * (b - a)) for n, (a, b) in leaders.items()}
    else:
        shut = 1.0
    widths = np.array([max(gap(s * shut), 0.0) for s in shares])
    return Hand(
        link,
        body.skeleton.rigid(link),
        branches,
        _with_followers(body, leaders),
        np.minimum.accumulate(widths),
        ahead,
        behind,
        closing,
        single=False,
    )


class _Gap:
    """Distance between two sides of a hand along the closing direction, at their outer halves."""

    def __init__(
        self,
        body: Body,
        link: str,
        leaders: dict[str, tuple[float, float]],
        closing: Array,
        ahead: tuple[str, ...],
        behind: tuple[str, ...],
    ) -> None:
        self._body, self._leaders = body, leaders
        base_from_palm = body.link_poses({}, [link])[link]
        self._axis = base_from_palm[:3, :3] @ closing
        middle = self._posture(0.5)
        shaped = [name for name in body.skeleton.rigid(link) if name in body.hulls]
        palm = body.points(shaped, middle)
        root = palm.mean(axis=0) if len(palm) else base_from_palm[:3, 3]
        tips = body.points((*ahead, *behind), middle)
        out = tips.mean(axis=0) - root
        self._out = out - (out @ self._axis) * self._axis
        self._sides = [self._outer(side, middle) for side in (ahead, behind)]

    def _posture(self, share: float) -> dict[str, float]:
        return {name: a + share * (b - a) for name, (a, b) in self._leaders.items()}

    def _outer(self, side: tuple[str, ...], posture: dict[str, float]) -> dict[str, Array]:
        """The corners of each tip, in its own frame, that lie in the outer half of all of them."""
        shaped = [name for name in side if name in self._body.hulls]
        poses = self._body.link_poses(posture, shaped)
        local = {name: self._body.link_points(name) for name in shaped}
        along = {name: placed(local[name], poses[name]) @ self._out for name in shaped}
        every = np.concatenate(list(along.values()))
        half = (every.min() + every.max()) / 2
        return {n: local[n][along[n] >= half] for n in shaped if (along[n] >= half).any()}

    def __call__(self, share: float) -> float:
        posture = self._posture(share)
        ends = []
        for side, extreme in zip(self._sides, (np.max, np.min), strict=True):
            poses = self._body.link_poses(posture, side)
            ends.append(extreme(np.vstack([placed(side[n], poses[n]) for n in side]) @ self._axis))
        return float(ends[1] - ends[0])


def _touch(gap: _Gap, apart: float, together: float) -> float:
    """The share at which the gap closes, between one where it is open and one where it is not."""
    for _ in range(20):
        middle = (apart + together) / 2
        apart, together = (middle, together) if gap(middle) > 0 else (apart, middle)
    return together


def _with_followers(
    body: Body, leaders: dict[str, tuple[float, float]]
) -> dict[str, tuple[float, float]]:
    """The joints that lead and those that follow them, in the order of the URDF."""
    every = dict(leaders)
    for name, joint in body.skeleton.joints.items():
        if joint.mimic is not None and joint.mimic.leader in leaders and name in body.index:
            a, b = leaders[joint.mimic.leader]
            ratio, offset = joint.mimic.multiplier, joint.mimic.offset
            every[name] = (ratio * a + offset, ratio * b + offset)
    return every


def _jaw(body: Body, link: str, branch: Branch) -> Hand | None:
    """One jaw against the palm, judged by the jaw's tip and the point of the palm it meets."""
    name = branch.joint
    low, high = body.skeleton.joints[name].range
    palm = tuple(n for n in body.skeleton.rigid(link) if n in body.hulls)
    if not palm or high <= low:
        return None
    hinge = body.link_poses({})[branch.links[0]][:3, 3]
    own = body.points(branch.tip, {name: low})
    farthest = int(np.argmax(np.linalg.norm(own - hinge, axis=1)))
    reach = float(np.linalg.norm(own[farthest] - hinge))
    path = [
        body.points(branch.tip, {name: float(q)})[farthest] for q in np.linspace(low, high, STEPS)
    ]
    fixed = body.points(palm, {})
    fixed = fixed[np.linalg.norm(fixed - hinge, axis=1) > 0.5 * reach]
    if not len(fixed):
        return None
    between = np.linalg.norm(np.array(path)[:, None] - fixed[None], axis=2)
    shut, meets = np.unravel_index(int(np.argmin(between)), between.shape)
    opened = 0 if shut > STEPS / 2 else STEPS - 1
    step = (high - low) / (STEPS - 1)
    leaders = {name: (low + opened * step, low + float(shut) * step)}
    track = np.array(path)[np.linspace(opened, shut, STEPS).round().astype(int)]
    widths = np.linalg.norm(track - track[-1], axis=1)
    if widths[0] < TRAVEL or between.min() > NEAR:
        return None
    move = fixed[meets] - track[STEPS // 2]
    closing = body.link_poses({})[link][:3, :3].T @ move
    return Hand(
        link,
        body.skeleton.rigid(link),
        (branch,),
        _with_followers(body, leaders),
        np.minimum.accumulate(widths),
        branch.tip,
        palm,
        closing / np.linalg.norm(closing),
        single=True,
    )
