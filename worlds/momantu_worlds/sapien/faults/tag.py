"""tag.covered and tag.wrong_id: a book or another tag lies where the marker was seen."""

from __future__ import annotations

from collections.abc import Callable

from momantu_bt.fault import Fault, FaultError
from momantu_bt.geometry import Transform
from momantu_bt.tags import USUAL_FAMILY
from momantu_worlds.sapien.faults.parameters import only, whole
from momantu_worlds.sapien.faults.stage import Stage
from momantu_worlds.sapien.faults.tops import obstacles, table_top
from momantu_worlds.scenes.catalogue.tags import known_ids, shown_by, tag_picture
from momantu_worlds.scenes.geometry.bodies import Body, Part, Picture
from momantu_worlds.scenes.geometry.parts import block
from momantu_worlds.scenes.geometry.prisms import body_prism

PAPER = 0.0005
"""Thickness of the sheet with another tag, m."""
BOOK, BOOK_MASS = 0.02, 0.4
"""Thickness and mass of a book as large as the marker's picture, m and kg."""
BOOK_COLOR = (0.28, 0.18, 0.16)


class Overlaid:
    """A flat body on the marker, removed at the end."""

    def __init__(self, stage: Stage, fault: Fault, cover: Callable[[Transform], Body]) -> None:
        """cover: the body that lies on the marker, from `map_from_marker`."""
        self._stage, self._fault, self._cover = stage, fault, cover
        self._added: str | None = None

    def begin(self) -> None:
        """Add the body; FaultError while something is in the way."""
        stage = self._stage
        body = self._cover(stage.simulator.truth.pose(stage.marker.name))
        prism, top = body_prism(body, body.map_from_body), table_top(stage, stage.goal.support)
        if prism is not None and not prism.clear_of(obstacles(stage, top), 0.0):
            raise FaultError(f"{self._fault.name}: something stands on {stage.marker.name} now")
        self._added = stage.add(body)

    def end(self) -> None:
        """Remove the body."""
        if self._added is not None:
            self._stage.remove(self._added)
            self._added = None


def covered(stage: Stage, fault: Fault) -> Overlaid:
    """A closed book, which can be pushed. No parameters."""
    only(fault)
    x, y = marker_picture(stage).size
    part = block((x, y, BOOK), (0.0, 0.0, BOOK / 2), BOOK_COLOR)
    return Overlaid(
        stage, fault, lambda at: Body("book", "book", at, (part,), static=False, mass=BOOK_MASS)
    )


def wrong_id(stage: Stage, fault: Fault) -> Overlaid:
    """Another tag of the family, of the same size, on thin paper. Parameters: id, its number."""
    only(fault, "id")
    own = marker_picture(stage)
    family, own_id = shown_by(own.pixels) or (USUAL_FAMILY, None)
    number = whole(fault, "id", 0, known_ids(family) - 1)
    pixels = tag_picture(number, family)
    if number == own_id:
        raise FaultError(f"{fault.name}: {number} is the id that the tag has; name another one")
    part = Part(Picture(own.size, pixels), Transform((0.0, 0.0, PAPER)), collision=False)
    return Overlaid(stage, fault, lambda at: Body("other_tag", "tag", at, (part,)))


def marker_picture(stage: Stage) -> Picture:
    """The picture of the goal's marker; FaultError if it has none."""
    return next(p.geometry for p in stage.marker.parts if isinstance(p.geometry, Picture))
