"""Named poses by search: folded, ready, carrying, looking around; free of self-collision."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from copy import copy
from dataclasses import dataclass, field
from itertools import islice, product

import numpy as np
from scipy.spatial import ConvexHull

from momantu_bt.geometry import Array, Transform
from momantu_skills.robot_setup.find.arms import Limbs
from momantu_skills.robot_setup.find.base import Stand
from momantu_skills.robot_setup.find.fingers import Hand
from momantu_skills.robot_setup.find.matrix import ALWAYS
from momantu_skills.robot_setup.urdf.arm_ik import LimbSolver
from momantu_skills.robot_setup.urdf.body import Body, Contacts

SAMPLES = 1500
"""Random postures of the arm that are tried for folding it."""
BEST = 40
"""A quarter of the best of these, which are checked for collisions before the others."""
STARTS = 3
"""The first of these that are clear, which are improved."""
ROUNDS = 300
"""Small changes that improve the best one."""
MARGINS = (0.03, 0.015, 0.01, 0.005)
"""Clearances between links, m, tried in turn. Planners keep a margin of 8 mm, except from what is
nearer in a named pose; with the last one a path may graze the robot itself."""
CLOSE = (0.005, 0.002, 0.0)
"""Clearances of pairs that are always nearer than a margin, m: the largest that they can keep."""
OPENINGS = (1.0, 0.0, 0.5)
"""How far the hands are closed, as shares, where a posture must be clear."""
LOOKS = (-1.0, 0.0, 1.0)
"""How far a head turns to each side of where a pose points it, rad (a slide: m)."""
PARTING = 60
"""Postures for detecting a pair that is always nearer than a margin."""
AIMING = 6
"""Iterations over each joint of a head, with decreasing steps."""
LAZY = 1e-3
"""A head does not turn for a gain of less than this, rad per rad."""
OVER_FLOOR = 0.05
"""Clearance of the arm above the floor, m."""
TARGETS = 120
"""Poses of the hand or the camera that are tried with inverse kinematics."""
SEEDS = 6
"""Start postures for each."""
HELD = 0.06
"""Assumed radius of a held object around the grasp frame, m; it is twice as tall as wide."""
TABLE = 0.7
"""Height above the floor that `ready` looks at, m."""
FLOOR_AHEAD = 2.0
"""Distance before the base at which `home` looks at the floor, m."""
AROUND = 1.5
"""Distance before the base that `look_around` looks at, at the height of a table, m."""
VIEW = 1.05
"""Assumed horizontal field of view of a camera, rad, if unknown."""
LOW, HIGH = 0.05, 0.9
"""Shares of its range for a vertical slide: folded, and at work."""

Cost = Callable[[Mapping[str, float]], float]


@dataclass(frozen=True)
class Eye:
    """The camera. link_from_optical: z out of it. fov: width of its picture, rad."""

    link: str
    link_from_optical: Transform
    fov: float
    in_hand: bool


@dataclass(frozen=True)
class FoundPose:
    """joints: of arm, head and the rest. outside: m by which the arm leaves the footprint.

    covered: share of the arm's corners that the camera has in its picture. clear: m that links
    keep from each other, None where no posture without self-collision was found.
    """

    joints: dict[str, float]
    outside: float
    covered: float
    clear: float | None
    notes: tuple[str, ...] = ()


@dataclass
class _Best:
    cost: float = math.inf
    posture: dict[str, float] = field(default_factory=dict)


class PoseFinder:
    """Finds named poses of one robot; the same seed finds the same ones."""

    def __init__(
        self,
        body: Body,
        limbs: Limbs,
        stand: Stand,
        pairs: Iterable[tuple[str, str]],
        eye: Eye | None,
        seed: int = 0,
        still: Mapping[str, float] | None = None,
    ) -> None:
        """pairs: of links whose meeting is a collision. still: joints of other limbs."""
        assert limbs.arm is not None
        self.body, self.limbs, self.stand, self.eye = body, limbs, stand, eye
        self.arm = limbs.arm
        self.random = np.random.default_rng(seed)
        skeleton = body.skeleton
        first = skeleton.joints[self._turning()[0]].child
        self.links = tuple(link for link in skeleton.subtree(first) if link in body.hulls)
        hands = [limb.hand for limb in (limbs.arm, *limbs.others) if limb.hand is not None]
        own = [set(hand.links) for hand in hands]  # how near its parts are depends on no arm
        carried = set(skeleton.subtree(skeleton.joints[self.arm.joints[0]].child))
        moved = [pair for pair in pairs if set(pair) & carried]
        moved = [pair for pair in moved if not any(set(pair) <= links for links in own)]
        self._moved = moved
        self._contacts = self._judges(body.random_configurations(PARTING, seed=1))
        own_hand = set(self.arm.hand.links) if self.arm.hand is not None else set()
        self._solid = {
            link: ConvexHull(hull).equations
            for link, hull in body.hulls.items()
            if link not in own_hand
        }
        self._outline = _half_planes(stand.footprint)
        self._openings = [
            {name: q for hand in hands for name, q in hand.posture(share).items()}
            for share in OPENINGS
        ]
        at = {**body.rest(), **(still or {})}
        self.still = {name: at[name] for name in self._others()}

    def _judges(self, draws: Array) -> dict[float, Contacts]:
        """Contacts by margin. Pairs that are nearer in nearly all of draws (n, nq) may be so."""
        body, moved = self.body, self._moved
        return {m: Contacts(body, moved, m, _close(body, moved, m, draws)) for m in MARGINS}

    def allowing(self, postures: Sequence[Mapping[str, float]]) -> PoseFinder:
        """The same finder, for which links may be as near as nearly all of these postures need."""
        other = copy(self)
        draws = [self.body.configuration(posture) for posture in postures[:PARTING]]
        other._contacts = self._judges(np.array(draws))
        return other

    def _others(self) -> tuple[str, ...]:
        other = tuple(name for limb in self.limbs.others for name in limb.joints)
        return (*self.limbs.rest, *other)

    def _turning(self) -> tuple[str, ...]:
        """The arm's joints without the slides that only lift it."""
        names = tuple(n for n in self.arm.joints if n not in self._lifts())
        return names or self.arm.joints

    def _lifts(self) -> tuple[str, ...]:
        found = []
        poses = self.body.link_poses({})
        for name in self.arm.joints:
            joint = self.body.skeleton.joints[name]
            axis = poses[joint.child][:3, :3] @ np.array(joint.axis)
            if joint.kind != "prismatic" or abs(float(axis[2])) < 0.9:
                break
            found.append(name)
        return tuple(found)

    def lifted(self, share: float) -> dict[str, float]:
        """The vertical slides at a share of their range."""
        ranges = {name: self.body.skeleton.joints[name].range for name in self._lifts()}
        return {name: low + share * (high - low) for name, (low, high) in ranges.items()}

    # what a posture is worth

    def corners(self, posture: Mapping[str, float]) -> Array:
        """Corners (n, 3) of the arm's hulls."""
        return self.body.corners(self.links, posture)

    def outside(self, corners: Array, around: float = 0.0) -> float:
        """Distance in m by which the arm's corners, plus `around`, extend beyond the footprint."""
        return _outside(self._outline, corners, around)

    def covered(self, posture: Mapping[str, float], corners: Array) -> float:
        """Share of the arm's corners that lie in the camera's picture."""
        if self.eye is None or self.eye.in_hand:
            return 0.0
        return float(in_view(corners, self.optical(posture), self.eye.fov).mean())

    def crowded(self, posture: Mapping[str, float], base_from_grasp: Transform) -> float:
        """How far what is held upright reaches into links that are not the hand's, m."""
        upright = np.linspace(-HELD, HELD, 3)[:, None] * (0.0, 0.0, 1.0)
        held = base_from_grasp.position + upright
        poses = self.body.link_poses(posture, self._solid)
        nearest = HELD
        for link, planes in self._solid.items():
            local = (held - poses[link][:3, 3]) @ poses[link][:3, :3]
            away = (local @ planes[:, :3].T + planes[:, 3]).max(axis=1)
            nearest = min(nearest, float(away.min()))
        return HELD - nearest

    def optical(self, posture: Mapping[str, float]) -> Transform:
        """base_from_optical."""
        assert self.eye is not None
        link = Transform.from_matrix(self.body.link_poses(posture, [self.eye.link])[self.eye.link])
        return link @ self.eye.link_from_optical

    def aside(self, posture: Mapping[str, float], target: Array) -> float:
        """Angle between where the camera looks and a point, rad; 0 without a camera."""
        if self.eye is None:
            return 0.0
        optical = self.optical(posture)
        way = target - optical.position
        length = max(float(np.linalg.norm(way)), 1e-9)
        return math.acos(float(np.clip(way @ optical.rotation[:, 2] / length, -1.0, 1.0)))

    def clear(self, posture: Mapping[str, float], margin: float) -> bool:
        """Whether links keep a margin from each other, and the arm from the floor.

        They do with every opening of the hands: motions are planned with whatever it is then. The
        head may look around: nobody asks what is in its way.
        """
        openings = ({**posture, **fingers} for fingers in self._openings)
        looks = ({**posture, **look} for look in self._looks(posture))
        return all(self._clear_with(each, margin) for each in openings) and all(
            self._clear_with(each, MARGINS[-1]) for each in looks
        )

    def _looks(self, posture: Mapping[str, float]) -> Iterator[dict[str, float]]:
        """The head turned to all sides of where it is."""
        head = self.limbs.head.joints if self.limbs.head is not None else ()
        aims = []
        for name in head:
            low, high = self.body.skeleton.joints[name].range
            at = posture.get(name, self.body.rest()[name])
            aims.append([min(max(at + turn, low), high) for turn in LOOKS])
        if head:
            yield from (dict(zip(head, look, strict=True)) for look in product(*aims))

    def _clear_with(self, posture: Mapping[str, float], margin: float) -> bool:
        if self.corners(posture)[:, 2].min() < self.stand.floor + OVER_FLOOR:
            return False
        return self._contacts[margin].free(self.body.configuration(posture))

    # searching

    def aimed(self, posture: dict[str, float], target: Array) -> dict[str, float]:
        """The posture with the head turned so that the camera looks at a point."""
        head = self.limbs.head
        if head is None or self.eye is None:
            return posture
        ranges = {name: self.body.skeleton.joints[name].range for name in head.joints}
        aimed = {**posture, **{name: self.body.rest()[name] for name in head.joints}}
        for turn in range(AIMING):
            for name, (low, high) in ranges.items():
                reach = (high - low) * 0.3**turn
                near = np.linspace(aimed[name] - reach, aimed[name] + reach, 41)
                tried = [min(max(float(q), low), high) for q in (aimed[name], *near)]
                aimed[name] = min(tried, key=lambda q: self._off(aimed, name, q, target))
        return aimed

    def _off(self, posture: dict[str, float], name: str, position: float, target: Array) -> float:
        """How badly the camera looks at a point, and a little how far a joint is turned."""
        return self.aside({**posture, name: position}, target) + LAZY * abs(position)

    def folded(self, cost: Cost, fixed: dict[str, float]) -> tuple[dict[str, float], float | None]:
        """The cheapest posture of the arm that is clear, by sampling and then small changes.

        Returns the posture and the margin it keeps, None where nothing was clear.
        """
        names = [n for n in self._turning() if n not in fixed]
        ranges = np.array([self.body.skeleton.joints[n].range for n in names])
        draws = self.random.uniform(ranges[:, 0], ranges[:, 1], (SAMPLES, len(names)))
        rest = self.body.rest()
        for k, name in enumerate(names):
            if self.body.skeleton.joints[name].kind == "prismatic":
                draws[::2, k] = rest[name]
        tried = [{**fixed, **dict(zip(names, map(float, q), strict=True))} for q in draws]
        tried = sorted(tried, key=cost)
        for some in (tried[: 4 * BEST], tried[4 * BEST :]):
            for margin in MARGINS:
                clear = (posture for posture in some if self.clear(posture, margin))
                free = list(islice(clear, STARTS))
                if free:
                    return self._improved(free, cost, margin, names, ranges), margin
        return tried[0], None

    def _improved(
        self,
        starts: list[dict[str, float]],
        cost: Cost,
        margin: float,
        names: list[str],
        ranges: Array,
    ) -> dict[str, float]:
        best = _Best()
        for start in starts:
            posture, value = start, cost(start)
            for i in range(ROUNDS):
                step = 0.25 * 0.988**i * self.random.normal(size=len(names))
                some = self.random.random(len(names)) < 0.5
                moved = {
                    name: float(np.clip(posture[name] + d, low, high))
                    for name, d, (low, high), chosen in zip(names, step, ranges, some, strict=True)
                    if chosen
                }
                trial = {**posture, **moved}
                price = cost(trial)
                if price < value and self.clear(trial, margin):
                    posture, value = trial, price
            if value < best.cost:
                best = _Best(value, posture)
        return best.posture

    def solved(
        self, solver: LimbSolver, targets: Iterable[Transform], fixed: dict[str, float], cost: Cost
    ) -> tuple[dict[str, float], float | None] | None:
        """The cheapest clear posture among those that bring the frame to one of the targets."""
        return self.cheapest(self.reached(solver, targets, fixed), cost)

    def reached(
        self, solver: LimbSolver, targets: Iterable[Transform], fixed: dict[str, float]
    ) -> list[dict[str, float]]:
        """Postures that bring the frame to one of the targets."""
        return [{**fixed, **joints} for target in targets for joints in solver.solve(target, SEEDS)]

    def cheapest(
        self, postures: list[dict[str, float]], cost: Cost
    ) -> tuple[dict[str, float], float | None] | None:
        """The cheapest clear posture and the margin it keeps; None if none is clear."""
        some = sorted(postures, key=cost)[: 4 * BEST]
        for margin in MARGINS:
            for posture in some:
                if self.clear(posture, margin):
                    return posture, margin
        return None


def in_view(points: Array, base_from_optical: Transform, fov: float) -> Array:
    """(n,) which points (n, 3) lie in a picture of that width and three quarters of its height."""
    local = base_from_optical.inverse().apply(points)
    depth = np.maximum(local[:, 2], 1e-6)
    half = math.tan(fov / 2)
    inside = (np.abs(local[:, 0]) < half * depth) & (np.abs(local[:, 1]) < 0.75 * half * depth)
    return np.asarray(inside & (local[:, 2] > 0))


def looking(eye: Array, target: Array) -> Transform:
    """base_from_optical of a camera at `eye` that looks at a point, its picture upright."""
    z = (target - eye) / np.linalg.norm(target - eye)
    x = np.cross(z, (0.0, 0.0, 1.0))
    x /= max(float(np.linalg.norm(x)), 1e-9)
    return Transform.from_rotation(np.stack([x, np.cross(z, x), z], axis=1), eye)


def _half_planes(footprint: Array | None) -> Array:
    """(k, 3): outward normals and offsets of a counter-clockwise outline."""
    corners = np.zeros((3, 2)) if footprint is None else footprint
    edges = np.roll(corners, -1, axis=0) - corners
    normals = np.stack([edges[:, 1], -edges[:, 0]], axis=1)
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-9)
    return np.column_stack([normals, (normals * corners).sum(axis=1)])


def _outside(outline: Array, corners: Array, around: float) -> float:
    if not len(corners):
        return 0.0
    beyond = (corners[:, :2] @ outline[:, :2].T - outline[:, 2]).max(axis=1)
    return max(0.0, float(beyond.max()) + around)


def _close(
    body: Body, pairs: list[tuple[str, str]], margin: float, draws: Array
) -> dict[tuple[str, str], float]:
    """The pairs that cannot keep a margin, in nearly all of draws (n, nq), and what they can, m."""
    close: dict[tuple[str, str], float] = {}
    tried = (margin, *(m for m in CLOSE if m < margin))
    for clearance, less in zip(tried, (*tried[1:], 0.0), strict=True):
        contacts = Contacts(body, pairs, clearance)
        near = np.mean([contacts.meeting(q) for q in draws], axis=0) if pairs else np.zeros(0)
        pairs = [pair for pair, share in zip(pairs, near, strict=True) if share >= ALWAYS]
        close |= dict.fromkeys(pairs, less)
    return close


def posed(hand: Hand | None, share: float) -> dict[str, float]:
    """The fingers, `share` of the way from open to closed."""
    return {} if hand is None else hand.posture(share)
