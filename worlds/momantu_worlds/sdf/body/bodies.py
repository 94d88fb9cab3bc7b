"""Rigid groups of links as bodies of a world file."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import partial
from typing import TypeAlias

import numpy as np

from momantu_bt.formats.places import Place
from momantu_bt.geometry import Array, Transform
from momantu_worlds.scenes.geometry.bodies import GREY
from momantu_worlds.sdf.body.frames import PlacedLink, PlacedModel
from momantu_worlds.sdf.body.ground import Ground
from momantu_worlds.sdf.body.parts import Part, joined
from momantu_worlds.sdf.body.placing import placed_in_link
from momantu_worlds.sdf.body.rigid_groups import Group
from momantu_worlds.sdf.body.shaping import Shaping
from momantu_worlds.sdf.deviations import Deviations
from momantu_worlds.sdf.read.model import Shape, Vector

Make: TypeAlias = Callable[[Shape, Transform, Vector, str], Iterator[Part]]
"""Makes the parts of a shape at a pose in the body, at a scale, with a name for messages."""

MOST_PARTS = 500
"""Limit of parts of one body, as in world files."""
FRICTION = (0.01, 1.0)
"""Range of friction that a world file accepts."""
_LONGEST = 50


@dataclass(frozen=True, slots=True)
class ImportedBody:
    """One body. title: the models and links that it was made of. mass: kg, None if it is static.

    friction: None if the SDF world gives none. category: empty if it is none of the known ones.
    """

    name: str
    title: str
    place: Place
    at: Transform
    parts: tuple[Part, ...]
    still: bool
    mass: float | None = None
    friction: float | None = None
    category: str = ""

    def hulls(self) -> Iterator[Array]:
        """Points (n, 3) of all collision shapes, piece by piece, in the map."""
        for part in self.parts:
            for hull in part.hulls:
                yield self.at.apply(part.body_from_part.apply(hull))

    def lifted(self, height: float) -> ImportedBody:
        """The same body, moved up."""
        return replace(self, at=Transform((0.0, 0.0, height)) @ self.at)


class BodyMaker:
    """Makes the bodies of one import, each with a unique name."""

    def __init__(self, shaping: Shaping, ground: Ground, deviations: Deviations) -> None:
        self._shaping, self._ground, self._deviations = shaping, ground, deviations
        self._names: set[str] = set()

    def body(self, model: PlacedModel, group: Group) -> Iterator[ImportedBody]:
        """The body of a group; several if it has too many parts; none if no part is left."""
        first = group.links[0]
        at = _frame_of(model, group) if group.still else first.world_from_link
        parts = list(joined(self._parts(model, group, at)))
        if not parts:
            if any(self._had_shapes(placed) for placed in group.links):
                self._deviations.dropped(
                    first.link.place, first.subject, "a body of which no shape is left", "left out"
                )
            return
        still = group.still or not any(part.collision for part in parts)
        if still and not group.still:
            self._deviations.changed(
                first.link.place, first.subject, "it can move but not be touched", "it stays there"
            )
        mass = None if still else sum(placed.link.mass for placed in group.links)
        title = first.subject if len(group.links) == 1 else "/".join(first.path)
        if not still and len(parts) > MOST_PARTS:
            what = f"{len(parts)} parts of one loose body"
            self._deviations.dropped(
                first.link.place, first.subject, what, f"the first {MOST_PARTS} are kept"
            )
            parts = parts[:MOST_PARTS]
        for count in range(0, len(parts), MOST_PARTS):
            yield ImportedBody(
                self._name(model, group),
                title,
                first.link.place,
                at,
                tuple(parts[count : count + MOST_PARTS]),
                still,
                mass,
                self._friction(group),
            )

    def _parts(self, model: PlacedModel, group: Group, at: Transform) -> Iterator[Part]:
        owners = {one.path: one for one in model.everything()}
        for placed in group.links:
            yield from self._of_link(owners[placed.path], placed, at.inverse(), still=group.still)

    def _of_link(
        self, owner: PlacedModel, placed: PlacedLink, body_from_world: Transform, *, still: bool
    ) -> Iterator[Part]:
        """The parts of a link. What is only seen or only touched, as a file is missing, is both."""

        def parts(shapes: tuple[Shape, ...], lost: int, make: Make) -> tuple[list[Part], int]:
            found: list[Part] = []
            for shape in shapes:
                if self._ground.is_floor(placed, shape):
                    continue
                pose = body_from_world @ placed_in_link(owner, placed, shape.pose)
                own = list(make(shape, pose, placed.scale, f"{placed.subject}/{shape.name}"))
                lost += not own
                found += own
            return found, lost

        link, touched_by = placed.link, partial(self._shaping.touched, still=still)
        seen, unseen = parts(link.visuals, link.unseen, self._shaping.seen)
        touched, untouched = parts(link.collisions, link.untouched, touched_by)
        if unseen and not seen and touched:
            touched = [replace(part, visual=True, color=GREY) for part in touched]
            self._stands_in(placed, "what is seen of it is lost", "its collision shape is drawn")
        elif untouched and not touched and seen:
            touched, _ = parts(link.visuals, 0, touched_by)
            self._stands_in(placed, "its collision shape is lost", "what is seen of it is touched")
        yield from (*seen, *touched)

    def _stands_in(self, placed: PlacedLink, what: str, instead: str) -> None:
        self._deviations.changed(placed.link.place, placed.subject, what, instead)

    def _had_shapes(self, placed: PlacedLink) -> bool:
        """Whether a link has any shape besides the floor."""
        shapes = (*placed.link.visuals, *placed.link.collisions)
        return any(not self._ground.is_floor(placed, shape) for shape in shapes)

    def _friction(self, group: Group) -> float | None:
        """A body has one friction for all its shapes: the smallest of theirs."""
        given = [
            s.friction for p in group.links for s in p.link.collisions if s.friction is not None
        ]
        if not given:
            return None
        friction = min(given)
        used = float(np.clip(friction, *FRICTION))
        first = group.links[0]
        if used != friction or max(given) != friction:
            given_text = f"friction {max(given):g}" + (
                f" to {friction:g}" if max(given) > friction else ""
            )
            self._deviations.changed(
                first.link.place, first.subject, given_text, f"{used:g} for all of it"
            )
        return used

    def _name(self, model: PlacedModel, group: Group) -> str:
        """The outermost model's name if it is one body, else the innermost's and the link's."""
        first = group.links[0]
        if len(group.links) == sum(len(one.links) for one in model.everything()):
            return self.unique(model.model.name)
        inner = next(one for one in model.everything() if one.path == first.path)
        own = [placed for placed in group.links if placed.path == first.path]
        link = [] if len(own) == len(inner.links) else [first.link.name]
        return self.unique("_".join([first.path[-1], *link]))

    def unique(self, title: str) -> str:
        """A unique name that is valid in world files."""
        stem = plain_name(title)
        name, count = stem, 2
        while name in self._names:
            name, count = f"{stem}_{count}", count + 1
        self._names.add(name)
        return name


def _frame_of(model: PlacedModel, group: Group) -> Transform:
    """The frame of the innermost model that has all links of a group, in the world's."""
    first = group.links[0]
    if any(placed.path != first.path for placed in group.links):
        return model.world_from_model
    return next(one for one in model.everything() if one.path == first.path).world_from_model


def plain_name(title: str) -> str:
    """Small letters, digits and underscores, beginning with a letter."""
    name = re.sub(r"[^a-z0-9]+", "_", title.lower()).strip("_")[:_LONGEST].rstrip("_")
    if not name:
        return "body"
    return name if name[0].isalpha() else f"body_{name}"
