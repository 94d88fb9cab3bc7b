"""Planning groups: arms that end in a hand, heads that carry a camera, the rest."""

from __future__ import annotations

from dataclasses import dataclass, field

from momantu_skills.robot_setup.find.fingers import JAW, Hand
from momantu_skills.robot_setup.urdf.body import Body

LEAST_JOINTS = 4
"""Fewest joints of an arm: with fewer it cannot choose the direction of approach."""


@dataclass(frozen=True)
class Limb:
    """A chain of joints. name: of its actuator. tip: its last link. hand: at its end."""

    name: str
    joints: tuple[str, ...]
    tip: str
    hand: Hand | None = None


@dataclass(frozen=True)
class Limbs:
    """arm: the one for planning. others: further arms. head: carries the camera.

    rest: all other joints, which are held still. notes: decisions and their reasons.
    """

    arm: Limb | None
    others: tuple[Limb, ...] = ()
    head: Limb | None = None
    rest: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()


@dataclass
class _Draft:
    notes: list[str] = field(default_factory=list)


def find_limbs(
    body: Body, hands: tuple[Hand, ...], camera: str | None, wheels: tuple[str, ...]
) -> Limbs:
    """Assign the joints to limbs. camera: the link with the camera. wheels: links that roll."""
    draft = _Draft()
    arms = _arms(body, hands, draft)
    if not arms:
        arms = _bare_arm(body, wheels, draft)
    taken = {name for arm in arms for name in arm.joints}
    fingers = {name for hand in hands for name in _inside(body, hand)}
    head = _head(body, camera, taken | fingers)
    taken |= set(head.joints) if head else set()
    taken |= {name for hand in hands for name in hand.leaders}
    rolling = {name for name in body.index if body.skeleton.joints[name].child in wheels}
    rest = tuple(name for name in body.free_joints if name not in taken | rolling)
    if rest:
        draft.notes.append(
            f"{len(rest)} joints belong to no arm, hand or head; they are held where the named "
            f"poses put them: {', '.join(rest[:6])}{', …' if len(rest) > 6 else ''}"
        )
    return Limbs(arms[0] if arms else None, tuple(arms[1:]), head, rest, tuple(draft.notes))


def own_chain(body: Body, link: str) -> tuple[str, ...]:
    """Actively moved joints between the base and a link, from the base outwards."""
    return tuple(
        joint.name for joint in body.skeleton.chain(link) if joint.name in body.free_joints
    )


def _inside(body: Body, hand: Hand) -> list[str]:
    return [name for name in body.index if body.skeleton.joints[name].child in hand.links]


def _arms(body: Body, hands: tuple[Hand, ...], draft: _Draft) -> list[Limb]:
    chains = [(hand, own_chain(body, hand.palm)) for hand in hands]
    long = [(hand, chain) for hand, chain in chains if len(chain) >= LEAST_JOINTS]
    for hand, chain in chains:
        if len(chain) < LEAST_JOINTS:
            draft.notes.append(
                f"the hand on {hand.palm} hangs on {len(chain)} joints only: no arm of "
                f"{LEAST_JOINTS} or more"
            )
    if len(long) > 1:
        names = ", ".join(hand.palm for hand, _ in long)
        draft.notes.append(
            f"there are {len(long)} arms (hands on {names}); the first is `arm`, which skills "
            "use, and joints that several share belong to it"
        )
    arms: list[Limb] = []
    taken: set[str] = set()
    for number, (hand, chain) in enumerate(long):
        own = tuple(name for name in chain if name not in taken)
        arms.append(Limb("arm" if number == 0 else f"arm_{number + 1}", own, hand.palm, hand))
        taken |= set(own)
    return arms


def _bare_arm(body: Body, wheels: tuple[str, ...], draft: _Draft) -> list[Limb]:
    """The longest chain without a hand, if no chain ends in a hand."""
    ends = [name for name in body.hulls if name not in wheels]
    chains = {end: _without_fingers(body, own_chain(body, end)) for end in ends}
    tip = max(ends, key=lambda end: len(chains[end]), default=None)
    if tip is None or len(chains[tip]) < LEAST_JOINTS:
        draft.notes.append(f"no chain of {LEAST_JOINTS} or more joints was found: no arm")
        return []
    joint = body.skeleton.joints[chains[tip][-1]]
    draft.notes.append(
        f"no hand that opens and closes was found; the longest chain, {len(chains[tip])} joints "
        f"to {joint.child}, is taken for the arm"
    )
    return [Limb("arm", chains[tip], joint.child)]


def _without_fingers(body: Body, chain: tuple[str, ...]) -> tuple[str, ...]:
    """The joints of a chain without those at its end that are called like a finger's."""
    while chain and JAW.search(chain[-1] + body.skeleton.joints[chain[-1]].child):
        chain = chain[:-1]
    return chain


def _head(body: Body, camera: str | None, taken: set[str]) -> Limb | None:
    if camera is None:
        return None
    joints = tuple(name for name in own_chain(body, camera) if name not in taken)
    return Limb("head", joints, camera) if joints else None
