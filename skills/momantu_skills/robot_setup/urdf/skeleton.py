"""A URDF as a tree of links and joints."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, replace

from momantu_bt.errors import MomantuError
from momantu_bt.formats.urdf import Joint, Link, Mimic, Urdf, UrdfError
from momantu_bt.geometry import Transform

TURNING = ("revolute", "continuous")
MOVING = (*TURNING, "prismatic")
"""Types of joints with one degree of freedom."""


class SetupError(MomantuError):
    """A URDF that cannot be analysed; the message says why and what to do."""


@dataclass(frozen=True)
class SetupJoint:
    """A joint of a URDF, with its limits as they are written: None where they are missing.

    lower, upper: rad or m. velocity: per second. effort: Nm or N. axis: (3,) in its own frame.
    """

    name: str
    kind: str
    parent: str
    child: str
    parent_from_joint: Transform
    axis: tuple[float, float, float]
    lower: float | None = None
    upper: float | None = None
    velocity: float | None = None
    effort: float | None = None
    mimic: Mimic | None = None

    @property
    def moving(self) -> bool:
        """Whether it has a degree of freedom, its own or one that follows another joint."""
        return self.kind in MOVING

    @property
    def endless(self) -> bool:
        """Whether it turns without limit."""
        return self.kind == "continuous"

    @property
    def range(self) -> tuple[float, float]:
        """Its range, rad or m; half a turn each way if it turns without limit."""
        if self.endless or self.lower is None or self.upper is None or self.lower >= self.upper:
            return (-math.pi, math.pi) if self.kind in TURNING else (0.0, 0.0)
        return self.lower, self.upper


class Skeleton:
    """Links and joints of a URDF, from its root outwards."""

    def __init__(self, links: Iterable[Link], joints: Iterable[SetupJoint]) -> None:
        """Raises SetupError: two joints of one name, or no tree with one root."""
        self.links = {link.name: link for link in links}
        self.joints = _followed(_by_name(joints))
        self._above = {joint.child: joint for joint in self.joints.values()}
        self._below: dict[str, list[SetupJoint]] = {name: [] for name in self.links}
        for joint in self.joints.values():
            for end in (joint.parent, joint.child):
                if end not in self.links:
                    raise SetupError(f"the joint {joint.name!r} names the missing link {end!r}")
            self._below[joint.parent].append(joint)
        self.root = self._only_root()

    def _only_root(self) -> str:
        roots = [name for name in self.links if name not in self._above]
        if len(roots) != 1 or len(self._above) != len(self.joints):
            twice = [j.child for j in self.joints.values() if self._above[j.child] is not j]
            what = f"links with two parents: {', '.join(twice)}" if twice else ""
            what = what or f"links without a parent: {', '.join(roots) or 'none'}"
            raise SetupError(
                f"the links do not hang together as a tree with one root ({what}); "
                "a robot in several files is described by `parts` and `mounts` in a robot.yaml"
            )
        reached = set(self.subtree(roots[0]))
        lost = [name for name in self.links if name not in reached]
        if lost:
            raise SetupError(f"these links hang in a circle of joints: {', '.join(lost)}")
        return roots[0]

    def above(self, link: str) -> SetupJoint | None:
        """The joint that carries a link; None for the root."""
        return self._above.get(link)

    def below(self, link: str) -> tuple[SetupJoint, ...]:
        """The joints that a link carries."""
        return tuple(self._below[link])

    def subtree(self, link: str) -> tuple[str, ...]:
        """A link and everything that it carries."""
        found, waiting, seen = [], [link], {link}
        while waiting:
            found.append(waiting.pop())
            for joint in self._below[found[-1]]:
                if joint.child not in seen:
                    seen.add(joint.child)
                    waiting.append(joint.child)
        return tuple(found)

    def chain(self, link: str) -> tuple[SetupJoint, ...]:
        """The joints from the root to a link, fixed ones included."""
        chain: list[SetupJoint] = []
        joint = self.above(link)
        while joint is not None:
            chain.append(joint)
            joint = self.above(joint.parent)
        return tuple(reversed(chain))

    def rigid_root(self, link: str) -> str:
        """The link nearest to the root that a link is fixed to."""
        joint = self.above(link)
        while joint is not None and not joint.moving:
            link = joint.parent
            joint = self.above(link)
        return link

    def rigid(self, link: str) -> tuple[str, ...]:
        """All links that are fixed to a link, itself included, from the root outwards."""
        found, waiting = [], [self.rigid_root(link)]
        while waiting:
            found.append(waiting.pop(0))
            waiting += [j.child for j in self._below[found[-1]] if not j.moving]
        return tuple(found)

    def branches(self, link: str) -> tuple[SetupJoint, ...]:
        """The moving joints that sit on a link or on what is fixed to it."""
        return tuple(j for name in self.rigid(link) for j in self._below[name] if j.moving)

    def moving_below(self, link: str) -> tuple[SetupJoint, ...]:
        """Every moving joint in what a link carries, in the order of the file."""
        inside = set(self.subtree(link))
        return tuple(j for j in self.joints.values() if j.moving and j.parent in inside)


def _by_name(joints: Iterable[SetupJoint]) -> dict[str, SetupJoint]:
    found: dict[str, SetupJoint] = {}
    for joint in joints:
        if joint.name in found:
            raise SetupError(
                f"two joints are called {joint.name!r}, one to {found[joint.name].child!r} and one "
                f"to {joint.child!r}; give one of them another name"
            )
        found[joint.name] = joint
    return found


def _followed(joints: dict[str, SetupJoint]) -> dict[str, SetupJoint]:
    """The same, but a joint that follows another one has room for all that this one asks of it.

    Its own range may be written for the other way round.
    """
    return {name: _with_room(joint, joints) for name, joint in joints.items()}


def _with_room(joint: SetupJoint, joints: dict[str, SetupJoint]) -> SetupJoint:
    leader = None if joint.mimic is None else joints.get(joint.mimic.leader)
    if leader is None or leader.endless or joint.lower is None or joint.upper is None:
        return joint
    assert joint.mimic is not None
    asked = [joint.mimic.multiplier * end + joint.mimic.offset for end in leader.range]
    return replace(joint, lower=min(joint.lower, *asked), upper=max(joint.upper, *asked))


def read_skeleton(urdf: Urdf) -> Skeleton:
    """The links and joints of a URDF.

    Raises:
        SetupError: an invalid number, or not a tree.
    """
    try:
        return Skeleton(urdf.links, [_joint(joint) for joint in urdf.joints])
    except UrdfError as error:
        raise SetupError(f"the URDF has a value that cannot be read: {error}") from None


def _joint(joint: Joint) -> SetupJoint:
    return SetupJoint(
        name=joint.name,
        kind=joint.kind,
        parent=joint.parent,
        child=joint.child,
        parent_from_joint=Transform.from_rpy(joint.xyz, joint.rpy),
        axis=joint.axis,
        lower=joint.lower,
        upper=joint.upper,
        velocity=joint.velocity,
        effort=joint.effort,
        mimic=joint.mimic,
    )
