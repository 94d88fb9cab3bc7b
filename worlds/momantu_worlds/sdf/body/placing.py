"""Placing every link in the world's frame, with the poses of a saved state."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace
from typing import TypeVar

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
from momantu_worlds.sdf.errors import SdfError
from momantu_worlds.sdf.read.model import Light, Model, ModelState, SdfWorld, Shape
from momantu_worlds.sdf.read.values import Pose

Posed = TypeVar("Posed", Shape, Light)


def placed_models(world: SdfWorld, deviations: Deviations) -> list[PlacedModel]:
    """The world's models with the poses of all links; what has no pose is listed and left out.

    A state is as Gazebo saves it: poses of models and links in the world's frame.
    """
    scope, placed = scope_of_world(world, deviations), []
    for model in world.models:
        if model.name not in scope.inner:
            continue
        state = world.states.get(model.name)
        try:
            pose = scope.pose(model.name, model.place)
            placed.append(_place(model, (), pose, scope.inner[model.name], state, deviations))
        except SdfError as error:
            deviations.lost(error.place, model.name, error.reason)
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
    placed = PlacedModel(path, model, scope, world_from_model, links, models)
    return replace(placed, links=tuple(_sound(placed, link, deviations) for link in links))


def _sound(model: PlacedModel, placed: PlacedLink, deviations: Deviations) -> PlacedLink:
    """A link without what has no pose in it."""

    def posed(things: Iterable[Posed], what: str) -> tuple[Posed, ...]:
        found = []
        for thing in things:
            try:
                placed_in_link(model, placed, thing.pose)
            except SdfError as error:
                subject = f"{placed.subject}/{thing.name}"
                deviations.dropped(error.place, subject, error.reason, f"this {what} is left out")
            else:
                found.append(thing)
        return tuple(found)

    link = placed.link
    return replace(
        placed,
        link=replace(
            link,
            visuals=posed(link.visuals, "visual"),
            collisions=posed(link.collisions, "collision"),
            lights=posed(link.lights, "light"),
        ),
    )


def placed_lights(
    world: SdfWorld, models: list[PlacedModel], deviations: Deviations
) -> Iterator[tuple[Light, str, Transform]]:
    """Every light with its name in messages and its pose in the world's frame.

    One that has no pose is listed and left out.
    """
    scope = scope_of_world(world, Deviations())  # what is wrong with it is listed already
    for light in world.lights:
        try:
            pose = world.light_states.get(light.name) or scope.placed(light.pose, WORLD)
        except SdfError as error:
            deviations.dropped(error.place, light.name, error.reason, "this light is left out")
        else:
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
