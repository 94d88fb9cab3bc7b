"""Groups of links that move as one: fixed joints merged, robots distinguished from furniture."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

from momantu_worlds.sdf.body.frames import WORLD, PlacedLink, PlacedModel
from momantu_worlds.sdf.deviations import Deviations
from momantu_worlds.sdf.read.model import Joint

_INNER = "::"
JOINTS_OF_A_ROBOT = 2
"""A model with at least this many moving joints, and with sensors or plugins, is a robot, unless it
is fixed to the world. A door is not."""


@dataclass(slots=True)
class Group:
    """Links that form one body. still: it does not move."""

    links: list[PlacedLink] = field(default_factory=list)
    still: bool = False


def is_robot(model: PlacedModel) -> bool:
    """Whether a model looks like a robot, not like furniture."""
    if model.model.static:
        return False
    inner = list(model.everything())
    if any(WORLD in (joint.parent, joint.child) for one in inner for joint in one.joints):
        return False
    moving = sum(joint.moves for one in inner for joint in one.joints)
    driven = any(one.model.plugins for one in inner)
    senses = any(placed.link.sensors for one in inner for placed in one.links)
    return moving >= JOINTS_OF_A_ROBOT and (driven or senses)


def rigid_groups(model: PlacedModel, deviations: Deviations) -> list[Group]:
    """The bodies of an outermost model, in the order of their first links.

    Links that a joint would move stay at their poses: they become one static body.
    """
    groups: dict[tuple[str, ...], Group] = {}
    for one, static in _with_static(model, static=False):
        for placed in one.links:
            groups[(*placed.path, placed.link.name)] = Group([placed], static)
        if static and one.links:
            _join_all(groups, [(*p.path, p.link.name) for p in one.links])
    for one in model.everything():
        for joint in one.joints:
            _apply(groups, one, joint, deviations)
    found = list({id(group): group for group in groups.values()}.values())
    for group in found:
        _hold(group, deviations)
    return found


def _hold(group: Group, deviations: Deviations) -> None:
    """Keep what gravity does not pull, such as a picture on a wall, where it is."""
    first = group.links[0]
    if not group.still and all(placed.link.weightless for placed in group.links):
        group.still = True
        deviations.changed(
            first.link.place, first.subject, "no gravity pulls it", "it stays where it is"
        )


def _with_static(model: PlacedModel, *, static: bool) -> Iterator[tuple[PlacedModel, bool]]:
    static = static or model.model.static
    yield model, static
    for inner in model.models:
        yield from _with_static(inner, static=static)


def _apply(
    groups: dict[tuple[str, ...], Group], model: PlacedModel, joint: Joint, deviations: Deviations
) -> None:
    subject = "/".join((*model.path, joint.name))
    ends = [_end(model, end) for end in (joint.parent, joint.child)]
    if None in ends:
        what = f"a joint from {joint.parent!r} to {joint.child!r}, which are not both there"
        deviations.dropped(joint.place, subject, what, "left out")
        return
    keys = [end for end in ends if end]
    if keys:
        _join_all(groups, keys)
        joined = groups[keys[0]]
        if joint.moves and not joined.still:
            deviations.changed(
                joint.place, subject, f"a {joint.kind} joint", "what it moves stays where it is"
            )
        joined.still = joined.still or joint.moves or len(keys) < len(ends)


def _join_all(groups: dict[tuple[str, ...], Group], keys: list[tuple[str, ...]]) -> None:
    first = groups[keys[0]]
    for key in keys[1:]:
        other = groups[key]
        if other is not first:
            first.links += other.links
            first.still = first.still or other.still
            for placed in other.links:
                groups[(*placed.path, placed.link.name)] = first


def _end(model: PlacedModel, name: str) -> tuple[str, ...] | None:
    """The link at a joint's end: empty for the world, None if there is none."""
    if name == WORLD:
        return ()
    for _ in range(len(model.model.frames) + 1):
        frame = next((f for f in model.model.frames if f.name == name), None)
        if frame is None:
            break
        name = frame.attached_to
    return _link_of(model, name)


def _link_of(model: PlacedModel, name: str) -> tuple[str, ...] | None:
    outer, inner, rest = name.partition(_INNER)
    for one in model.models:
        if one.model.name == outer:
            return _link_of(one, rest) if inner else _first_link(one)
    for placed in model.links:
        if name in ("", placed.link.name):
            return (*placed.path, placed.link.name)
    merged = (_link_of(one, name) for one in model.models if one.model.merged)
    return next((found for found in merged if found is not None), None)


def _first_link(model: PlacedModel) -> tuple[str, ...] | None:
    """A model's canonical link if none is named: its first."""
    found = (placed for one in model.everything() for placed in one.links)
    return next(((*placed.path, placed.link.name) for placed in found), None)
