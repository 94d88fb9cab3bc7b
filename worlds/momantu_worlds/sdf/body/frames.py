"""Resolving the frames of models and worlds.

Each model is a scope with the frame `__model__`; the world is one with the frame `world`. In a
scope links, joints, frames and models are frames too, and `model::link` names a frame of a model.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field, replace

from momantu_bt.formats.places import Place
from momantu_bt.geometry import Transform
from momantu_worlds.sdf.deviations import Deviations
from momantu_worlds.sdf.errors import SdfError
from momantu_worlds.sdf.read.model import Frame, Joint, Link, Model, SdfWorld
from momantu_worlds.sdf.read.values import Pose

WORLD = "world"
MODEL = "__model__"
_INNER = "::"
MOST_NAMED = 8
"""Most frames that a message lists."""


@dataclass(frozen=True, slots=True)
class _Edge:
    """A frame's pose in another frame of its scope, or in the usual one if that may be missing."""

    parent: str
    pose: Transform
    place: Place
    usual: str = ""


@dataclass(slots=True)
class Scope:
    """The frames of one model, or of the world. root: the name of its own frame."""

    root: str
    inner: dict[str, Scope] = field(default_factory=dict)
    merged: list[str] = field(default_factory=list)
    _edges: dict[str, _Edge] = field(default_factory=dict)
    _known: dict[str, Transform] = field(default_factory=dict)

    def pose(self, name: str, place: Place) -> Transform:
        """Pose of a frame in the scope's own frame; place: the reference, for messages.

        Raises:
            SdfError: there is no such frame, or frames refer to each other in a circle.
        """
        chain: list[tuple[str, Transform]] = []
        seen: set[str] = set()
        here = name
        while here != self.root and here not in self._known:
            if here in seen:
                raise SdfError(place, f"the frames {_circle(chain, here)} hang on each other")
            seen.add(here)
            edge = self._edge(here, place)
            chain.append((here, edge.pose))
            here, place = edge.parent, edge.place
            if edge.usual and not self._has(here):
                here = edge.usual
        pose = Transform() if here == self.root else self._known[here]
        for frame, step in reversed(chain):
            pose = pose @ step
            self._known[frame] = pose
        return pose

    def placed(self, pose: Pose, usual: str) -> Transform:
        """A pose as written, in the scope's own frame; usual: the default reference frame."""
        here = pose.relative_to or usual
        if pose.old and not self._has(here):
            here = usual
        return self.pose(here, pose.place) @ pose.transform

    def add(self, name: str, pose: Pose, usual: str) -> None:
        """Add a frame to the scope; if two have the same name, the first is used."""
        edge = _Edge(
            pose.relative_to or usual, pose.transform, pose.place, usual if pose.old else ""
        )
        self._edges.setdefault(name, edge)

    def _edge(self, name: str, place: Place) -> _Edge:
        if name in self._edges:
            return self._edges[name]
        outer, inner, rest = name.partition(_INNER)
        if inner and outer in self.inner:
            return _Edge(outer, self.inner[outer].pose(rest, place), place)
        for model in self.merged:
            if name in self.inner[model]._edges:
                return _Edge(model, self.inner[model].pose(name, place), place)
        names = ", ".join([*self._edges][:MOST_NAMED])
        raise SdfError(place, f"there is no frame {name!r}; frames here: {self.root}, {names}")

    def _has(self, name: str) -> bool:
        outer, inner, rest = name.partition(_INNER)
        if name == self.root or name in self._edges:
            return True
        if inner and outer in self.inner:
            return self.inner[outer]._has(rest)
        return any(name in self.inner[model]._edges for model in self.merged)


def _circle(chain: list[tuple[str, Transform]], again: str) -> str:
    names = [name for name, _ in chain]
    return " -> ".join([*names[names.index(again) :], again][:MOST_NAMED])


def scope_of_world(world: SdfWorld, deviations: Deviations) -> Scope:
    """All frames of a world; a model of which the frames fit nowhere is listed and left out."""
    scope = Scope(WORLD)
    _fill(scope, (), world.frames)
    for model in world.models:
        try:
            _fill(scope, (model,), ())
        except SdfError as error:
            deviations.lost(error.place, model.name, error.reason)
    return scope


def scope_of_model(model: Model) -> Scope:
    """All frames of a model."""
    scope = Scope(MODEL)
    for link in model.links:
        scope.add(link.name, link.pose, MODEL)
    for joint in model.joints:
        # a joint to the world has nothing of its model to hang on
        scope.add(joint.name, joint.pose, MODEL if joint.child == WORLD else joint.child)
    _fill(scope, model.models, model.frames)
    return scope


def _fill(scope: Scope, models: Iterable[Model], frames: Iterable[Frame]) -> None:
    for frame in frames:
        scope.add(frame.name, frame.pose, frame.attached_to or scope.root)
    for model in models:
        inner, pose = scope_of_model(model), model.pose
        if model.placement_frame:
            back = inner.pose(model.placement_frame, model.place).inverse()
            pose = replace(pose, transform=pose.transform @ back)
        scope.inner[model.name] = inner
        if model.merged:
            scope.merged.append(model.name)
        scope.add(model.name, pose, scope.root)


@dataclass(frozen=True, slots=True)
class PlacedLink:
    """A link in the world. path: names of the models that contain it, from the outermost."""

    path: tuple[str, ...]
    link: Link
    world_from_link: Transform
    scale: tuple[float, float, float] = (1.0, 1.0, 1.0)

    @property
    def subject(self) -> str:
        """Its name in messages."""
        return "/".join((*self.path, self.link.name))


@dataclass(frozen=True, slots=True)
class PlacedModel:
    """A model in the world with its direct contents, and its scope for its own frames."""

    path: tuple[str, ...]
    model: Model
    scope: Scope
    world_from_model: Transform
    links: tuple[PlacedLink, ...]
    models: tuple[PlacedModel, ...]

    def everything(self) -> Iterator[PlacedModel]:
        """The model and all models in it."""
        yield self
        for inner in self.models:
            yield from inner.everything()

    @property
    def joints(self) -> tuple[Joint, ...]:
        """Its own joints."""
        return self.model.joints
