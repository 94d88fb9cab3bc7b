"""A whole SDF world: models, lights, frames, and the states that Gazebo saved."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace
from functools import partial
from pathlib import Path

from momantu_bt.formats.places import Place
from momantu_bt.geometry import Transform
from momantu_worlds.sdf.deviations import Deviations
from momantu_worlds.sdf.read.document import Element
from momantu_worlds.sdf.read.lights import lights_of
from momantu_worlds.sdf.read.model import Model, ModelState, Rgba, SdfWorld
from momantu_worlds.sdf.read.models import read_frame, read_include, read_model
from momantu_worlds.sdf.read.reading import Reading
from momantu_worlds.sdf.read.unread import INSTEAD, list_leftovers
from momantu_worlds.sdf.read.uris import Library, version_of
from momantu_worlds.sdf.read.values import color_of, name_of, numbers, pose_of, vector

DOWN = 9.8
"""Gravity within 0.1 of this counts as the Earth's, m/s2."""
_OF_WORLD = ("model", "include", "light", "frame", "state", "scene", "gravity", "physics")
_GRAVITY_NEAR = 0.1
SCALES = (0.001, 1000)
"""Range of factors by which a state may scale a model."""


def read_world(file: Path, folders: Iterable[Path], deviations: Deviations) -> SdfWorld:
    """The world of an SDF file. A file with models alone is a world of them.

    Raises:
        SdfError: the file, or one that it includes, is broken; the message says where.
    """
    reading = Reading(Library(tuple(folders)), deviations)
    with reading.including(file, Place(str(file))) as root:
        version = version_of(root)
        worlds = list(root.all("world"))
        for other in worlds[1:]:
            deviations.dropped(other.place, other.attributes.get("name", ""), "<world>", "left out")
        return _world(worlds[0] if worlds else root, file, version, reading)


def _world(element: Element, file: Path, version: tuple[int, int], reading: Reading) -> SdfWorld:
    each = partial(reading.each, around="")
    each([element], read=lambda e: _list_settings(e, reading.deviations), what="setting")
    models = each(element.all("model"), read=lambda e: read_model(e, "", reading))
    lights = lights_of(element, "", reading)
    for model, more in each(element.all("include"), read=lambda e: read_include(e, "", reading)):
        models += [] if model is None else [model]
        lights += more
    state = element.child("state")
    if state is not None:
        models += each(_inserted(state), read=lambda e: read_model(e, "", reading))
        gone = _deleted(state)
        models = [model for model in models if model.name not in gone]
        lights = [light for light in lights if light.name not in gone]
        list_leftovers(state, "state", _OF_STATE, reading.deviations)
    if not models and next(element.all("model", "include"), None) is None:
        raise element.error(f"there is no <model> in {file}; nothing could be imported")
    return SdfWorld(
        name=element.attributes.get("name", "") or file.stem,
        file=file,
        version=version,
        models=_apart(models, reading.deviations),
        lights=tuple(lights),
        frames=tuple(each(element.all("frame"), read=read_frame)),
        states={} if state is None else _states(state, "state", reading),
        light_states={} if state is None else _poses(state, "light", "state", reading),
        ambient=_ambient(element, reading),
    )


def _ambient(element: Element, reading: Reading) -> Rgba | None:
    """The colour of light from everywhere; None when there is none."""
    found = reading.each(
        element.all("scene"), "world", lambda scene: color_of(scene, "ambient"), what="setting"
    )
    return found[0] if found else None


def _list_settings(element: Element, deviations: Deviations) -> None:
    list_leftovers(element, "world", _OF_WORLD, deviations)
    for child in element.all("physics"):
        deviations.dropped(child.place, "world", "<physics>", INSTEAD["physics"])
    for child in element.all("scene"):
        list_leftovers(child, "world/scene", ("ambient",), deviations)
    gravity = vector(element, "gravity", (0.0, 0.0, -DOWN))
    if max(abs(gravity[0]), abs(gravity[1]), abs(gravity[2] + DOWN)) > _GRAVITY_NEAR:
        where = element.child("gravity") or element
        deviations.changed(where.place, "world", "<gravity>", INSTEAD["gravity"])


def _apart(models: Iterable[Model], deviations: Deviations) -> tuple[Model, ...]:
    """Rename models with the same name as Gazebo does: `can`, `can_0`, `can_1`."""
    names: dict[str, Model] = {}
    for model in models:
        name, count = model.name, 0
        while name in names:
            name, count = f"{model.name}_{count}", count + 1
        if name != model.name:
            deviations.changed(
                model.place, model.name, "a name that is here twice", f"it is {name}"
            )
        names[name] = replace(model, name=name)
    return tuple(names.values())


_OF_STATE = ("model", "light", "insertions", "deletions")


def _inserted(state: Element) -> Iterator[Element]:
    for insertions in state.all("insertions"):
        yield from insertions.all("model")


def _deleted(state: Element) -> set[str]:
    return {name.text for gone in state.all("deletions") for name in gone.all("name")}


def _states(around: Element, subject: str, reading: Reading) -> dict[str, ModelState]:
    """What a state says about the models in it, by their names; broken entries are left out."""

    def read(child: Element) -> tuple[str, ModelState]:
        name = name_of(child)
        pose = None if child.child("pose") is None else pose_of(child).transform
        links = _poses(child, "link", f"{subject}/{name}", reading)
        inner = _states(child, f"{subject}/{name}", reading)
        return name, ModelState(child.place, pose, _scale(child), links, inner)

    # a broken state loses no model: the model stays where it says itself
    return dict(reading.each(around.all("model"), subject, read, what="state"))


def _scale(element: Element) -> tuple[float, float, float]:
    scale = element.child("scale")
    x, y, z = (1.0, 1.0, 1.0) if scale is None else numbers(scale, 3)
    if not SCALES[0] <= min(x, y, z) <= max(x, y, z) <= SCALES[1]:
        few, many = SCALES
        raise element.error(f"<scale> is {x:g} {y:g} {z:g}; expected factors of {few} to {many}")
    return x, y, z


def _poses(around: Element, tag: str, subject: str, reading: Reading) -> dict[str, Transform]:
    """Poses of the links or the lights of a state, by name."""
    posed = (child for child in around.all(tag) if child.child("pose") is not None)
    return dict(
        reading.each(
            posed,
            subject,
            lambda child: (name_of(child), pose_of(child).transform),
            what="state",
        )
    )
