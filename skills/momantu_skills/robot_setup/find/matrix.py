"""Which pairs of links are worth a collision check: the self-collision matrix, by sampling.

As MoveIt's Setup Assistant does it: pairs that share a joint, that meet in the default posture,
that meet in nearly every posture, and that meet in none of many random ones.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from enum import StrEnum
from itertools import combinations

import numpy as np

from momantu_bt.geometry import Array
from momantu_skills.manipulation.model.hulls import placed
from momantu_skills.robot_setup.find.fingers import Hand
from momantu_skills.robot_setup.urdf.body import Body, Contacts, hulls_meet

SAMPLES = 10_000
"""Random postures: a pair that collides in one of a thousand is missed in one of 20,000 set-ups."""
FEW = 20
"""Postures for detecting neighbours that overlap."""
ALWAYS = 0.95
"""Share of the postures in which a pair must collide to count as always overlapping."""


class Why(StrEnum):
    """The class of a pair of links in the self-collision matrix."""

    ADJACENT = "adjacent"
    DEFAULT = "default"
    ALWAYS = "always"
    NEVER = "never"
    SOMETIMES = "sometimes"


@dataclass(frozen=True)
class CollisionMatrix:
    """Every pair of links that have shapes, in the order of the URDF.

    why: of each pair. share: of the random postures in which it met, 0 for adjacent pairs.
    samples: how many postures were tried. overlapping: adjacent pairs that are not parent and child
    and whose hulls meet; planning never checks them, and a simulator would push them apart.
    """

    why: Mapping[tuple[str, str], Why]
    share: Mapping[tuple[str, str], float]
    samples: int
    overlapping: tuple[tuple[str, str], ...] = ()

    def pairs(self, *reasons: Why) -> tuple[tuple[str, str], ...]:
        """The pairs of which one of the reasons holds."""
        return tuple(pair for pair, why in self.why.items() if why in reasons)

    @property
    def ignored(self) -> tuple[tuple[str, str], ...]:
        """Pairs whose contact is ignored, in addition to parents and their children."""
        return (*self.overlapping, *self.pairs(Why.DEFAULT, Why.ALWAYS))

    @property
    def checked(self) -> tuple[tuple[str, str], ...]:
        """Pairs that need a check."""
        return self.pairs(Why.SOMETIMES)


def sample_matrix(
    body: Body,
    samples: int = SAMPLES,
    seed: int = 0,
    usual: Iterable[Mapping[str, float]] = (),
    hands: Iterable[Hand] = (),
) -> CollisionMatrix:
    """The matrix from `samples` postures of a seed.

    usual: postures that count as the one at rest does, such as a closed hand's. hands: their own
    links may meet each other at any opening.
    """
    every = tuple(combinations(body.hulls, 2))
    apart = tuple(pair for pair in every if not body.shapes.adjacent(*pair))
    contacts = Contacts(body, apart)
    at_rest = contacts.meeting(body.configuration({}))
    for posture in usual:
        at_rest |= contacts.meeting(body.configuration(posture))
    for hand in hands:
        own = np.array([set(pair) <= set(hand.links) for pair in apart], dtype=bool)
        for closed in (0.0, 0.5, 1.0):
            at_rest |= own & contacts.meeting(body.configuration(hand.posture(closed)))
    met = _count(contacts, body.random_configurations(samples, seed))
    why = dict.fromkeys(every, Why.ADJACENT)
    share = dict.fromkeys(every, 0.0)
    for pair, default, count in zip(apart, at_rest, met, strict=True):
        share[pair] = float(count) / samples
        why[pair] = _why(bool(default), share[pair])
    near = [pair for pair in every if why[pair] is Why.ADJACENT and not _related(body, pair)]
    draws = [body.configuration({}), *body.random_configurations(FEW, seed)]
    return CollisionMatrix(why, share, samples, tuple(p for p in near if _overlap(body, p, draws)))


def _related(body: Body, pair: tuple[str, str]) -> bool:
    """Whether one link carries the other."""
    above = [body.skeleton.above(link) for link in pair]
    return any(j is not None and j.parent in pair for j in above)


def _overlap(body: Body, pair: tuple[str, str], draws: Iterable[Array]) -> bool:
    """Whether the hulls of two links meet in one of some postures (nq,)."""
    one, other = pair
    for q in draws:
        poses = body.link_poses(body.named(q), pair)
        if hulls_meet(placed(body.hulls[one], poses[one]), placed(body.hulls[other], poses[other])):
            return True
    return False


def _count(contacts: Contacts, postures: Array) -> Array:
    met = np.zeros(len(contacts.pairs))
    for q in postures:
        met += contacts.meeting(q)
    return met


def _why(default: bool, share: float) -> Why:
    if share >= ALWAYS:
        return Why.ALWAYS
    if default:
        return Why.DEFAULT
    return Why.SOMETIMES if share > 0.0 else Why.NEVER
