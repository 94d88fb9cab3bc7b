"""Placing every link in the world's frame, with the poses of a saved state."""

from __future__ import annotations

from collections.abc import Iterator

from momantu_bt.geometry import Transform
from momantu_worlds.sdf.body.frames import (
    MODEL,
    WORLD,
    PlacedLink,
    PlacedModel,
    Scope,
    scope_of_world,
)
from momantu_worlds.sdf.deviations import Deviations
from momantu_worlds.sdf.read.model import Light, Model, ModelState, SdfWorld
from momantu_worlds.sdf.read.values import Pose


def placed_models(world: SdfWorld, deviations: Deviations) -> list[PlacedModel]:
    """The world's models with the poses of all links; raises SdfError for frames that do not exist.

    A state is as Gazebo saves it: poses of models and links in the world's frame.
    """
    scope = scope_of_world(world)
    placed = []
    for model in world.models:
        state = world.states.get(model.name)
        pose = scope.pose(model.name, model.place)
        placed.append(_place(model, (), pose, scope.inner[model.name], state, deviations))
    known = {model.name for model in world.models}
    for name, state in world.states.items():
        if name not in known:
            deviations.dropped(
                state.place, name, "a state of a model that is not there", "left out"
            )
    return placed


def _place(
    model: Model,
    around: tuple[str, ...],
    world_from_model: Transform,
    scope: Scope,
    state: ModelState | None,
    deviations: Deviations,
) -> PlacedModel:
    path = (*around, model.name)
    scale = (1.0, 1.0, 1.0)
    if state is not None:
        world_from_model = state.pose or world_from_model
        scale = state.scale
        if scale != (1.0, 1.0, 1.0):
            what = "a state with scale {:g} {:g} {:g}".format(*scale)
            deviations.changed(state.place, "/".join(path), what, "its shapes are scaled")
    saved = {} if state is None else state.links
    links = tuple(
        PlacedLink(
            path,
            link,
            saved.get(link.name) or world_from_model @ scope.pose(link.name, link.place),
            scale,
        )
        for link in model.links
    )
    models = tuple(
        _place(
            inner,
            path,
            world_from_model @ scope.pose(inner.name, inner.place),
            scope.inner[inner.name],
            None if state is None else state.models.get(inner.name),
            deviations,
        )
        for inner in model.models
    )
    return PlacedModel(path, model, scope, world_from_model, links, models)


def placed_lights(
    world: SdfWorld, models: list[PlacedModel]
) -> Iterator[tuple[Light, str, Transform]]:
    """Every light with its name in messages and its pose in the world's frame."""
    scope = scope_of_world(world)
    for light in world.lights:
        pose = world.light_states.get(light.name) or scope.placed(light.pose, WORLD)
        yield light, light.name, pose
    for model in (inner for outer in models for inner in outer.everything()):
        for placed in model.links:
            for light in placed.link.lights:
                pose = placed_in_link(model, placed, light.pose)
                yield light, f"{placed.subject}/{light.name}", pose


def placed_in_link(model: PlacedModel, placed: PlacedLink, pose: Pose) -> Transform:
    """A pose written in a link, converted to the world's frame; the default reference is the link.

    A frame is looked up in the model, and moves with the link if a state moves the link.
    """
    if not pose.relative_to:
        return placed.world_from_link @ pose.transform
    model_from_link = model.scope.pose(placed.link.name, placed.link.place)
    link_from_model = model_from_link.inverse()
    return placed.world_from_link @ link_from_model @ model.scope.placed(pose, MODEL)
