"""Models: links, joints, frames, and the models within them."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from functools import partial
from typing import TypeVar

from momantu_worlds.sdf.read.document import Element
from momantu_worlds.sdf.read.lights import lights_of, read_light
from momantu_worlds.sdf.read.model import MOVING_JOINTS, Frame, Joint, Light, Link, Model
from momantu_worlds.sdf.read.reading import Reading
from momantu_worlds.sdf.read.shapes import shapes_of
from momantu_worlds.sdf.read.standard import standard_model
from momantu_worlds.sdf.read.unread import list_leftovers
from momantu_worlds.sdf.read.uris import MissingFile, model_file, version_of
from momantu_worlds.sdf.read.values import flag, name_of, number, pose_of

Named = TypeVar("Named", Link, Joint, Model)

MASS = 1.0
"""Default mass of a link in SDF, kg."""
MASSES = (1e-5, 1e5)
"""Range of possible masses, kg; others are mistakes."""
_OF_MODEL = ("pose", "static", "link", "joint", "frame", "model", "include")
_OF_LINK = ("pose", "inertial", "visual", "collision", "light", "gravity")
_OF_INCLUDE = ("uri", "name", "pose", "static", "placement_frame")


def read_model(element: Element, around: str, reading: Reading) -> Model:
    """A model and everything in it; around: the names of the models that it is in.

    Raises:
        SdfError: something in it is not possible.
    """
    with reading.within_model(element.place):
        return _model(element, around, reading)


def _model(element: Element, around: str, reading: Reading) -> Model:
    name = name_of(element)
    subject = f"{around}/{name}" if around else name
    list_leftovers(element, subject, _OF_MODEL, reading.deviations)
    static = flag(element, "static")
    each = partial(reading.each, around=subject)
    inner = each(element.all("model"), read=lambda e: read_model(e, subject, reading))
    for model, lights in each(
        element.all("include"), read=lambda e: read_include(e, subject, reading)
    ):
        inner += [] if model is None else [model]
        for light in lights:
            reading.deviations.dropped(light.place, subject, f"light {light.name!r}", "left out")
    links = each(element.all("link"), read=lambda e: _link(e, subject, static, reading))
    joints = each(element.all("joint"), read=lambda e: _joint(e, subject, reading))
    return Model(
        name=name,
        place=element.place,
        pose=pose_of(element),
        static=static,
        placement_frame=element.attributes.get("placement_frame", ""),
        links=_unique("link", links, subject, reading),
        joints=_unique("joint", joints, subject, reading),
        frames=tuple(each(element.all("frame"), read=read_frame)),
        models=_unique("model", inner, subject, reading),
        plugins=sum(1 for _ in element.all("plugin")),
    )


def read_include(
    element: Element, around: str, reading: Reading
) -> tuple[Model | None, tuple[Light, ...]]:
    """The model or the lights of an <include>; neither, and a deviation, when it is not there.

    Raises:
        SdfError: it has no URI, includes itself, or something in it is not possible.
    """
    uri = element.child("uri")
    if uri is None:
        raise element.error("<include> needs a <uri>, such as model://table")
    given = element.child("name")
    subject = "/".join(part for part in (around, given.text if given else uri.text) if part)
    list_leftovers(element, subject, _OF_INCLUDE, reading.deviations)
    try:
        file = reading.library.resolve(uri.text, uri.place)
        if file.is_dir():
            file = model_file(file, uri.place)
    except MissingFile as error:
        standard = standard_model(uri.text)
        if standard is not None:
            if standard.plain:
                instead = "it is drawn in plain, with the sizes that Gazebo's own model has"
                reading.deviations.changed(uri.place, subject, str(error), instead)
            return _included(standard.root, element, subject, around, reading)
        reading.deviations.lost(uri.place, subject, str(error))
        return None, ()
    with reading.including(file, uri.place) as root:
        version_of(root)
        return _included(root, element, subject, around, reading)


def _included(
    root: Element, include: Element, subject: str, around: str, reading: Reading
) -> tuple[Model | None, tuple[Light, ...]]:
    found = next(root.all("model", "light", "actor", "world"), None)
    if found is None or found.tag == "world":
        raise include.error(
            f"{root.place.file} holds no <model>; only models and lights can be included"
        )
    if found.tag == "light":
        light = read_light(found, around, reading)
        return None, () if light is None else (_moved(light, include),)
    if found.tag == "actor":
        reading.deviations.dropped(include.place, subject, "an actor", "left out")
        return None, ()
    return _overridden(read_model(found, around, reading), include), ()


def _moved(light: Light, include: Element) -> Light:
    return light if include.child("pose") is None else replace(light, pose=pose_of(include))


def _overridden(model: Model, include: Element) -> Model:
    """What an <include> says about a model instead of the model's own file."""
    given, frame = include.child("name"), include.child("placement_frame")
    if given is not None and given.text:
        model = replace(model, name=given.text)
    if include.child("pose") is not None:
        model = replace(model, pose=pose_of(include), placement_frame="")
    if frame is not None:
        model = replace(model, placement_frame=frame.text)
    if include.child("static") is not None:
        model = _with_static(model, flag(include, "static"))
    merged = include.attributes.get("merge", "false").lower() in ("true", "1")
    return replace(model, merged=merged)


def _with_static(model: Model, static: bool) -> Model:
    return replace(
        model, static=static, models=tuple(_with_static(m, static) for m in model.models)
    )


def read_frame(element: Element) -> Frame:
    """A named frame of a model or of the world."""
    return Frame(name_of(element), element.attributes.get("attached_to", ""), pose_of(element))


def _link(element: Element, around: str, static: bool, reading: Reading) -> Link:
    subject = f"{around}/{name_of(element)}"
    list_leftovers(element, subject, _OF_LINK, reading.deviations)
    mass = number(element, "inertial/mass", MASS)
    inertia = element.find("inertial/inertia")
    if inertia is not None and not static:
        instead = "inertia follows from the mass and the shape"
        reading.deviations.changed(inertia.place, subject, "<inertia>", instead)
    if not MASSES[0] <= mass <= MASSES[1] and not static:
        where = element.find("inertial/mass") or element
        reading.deviations.changed(where.place, subject, f"a mass of {mass:g} kg", f"{MASS:g} kg")
        mass = MASS
    visuals, unseen = shapes_of(element, "visual", subject, reading)
    collisions, untouched = shapes_of(element, "collision", subject, reading)
    return Link(
        name=name_of(element),
        place=element.place,
        pose=pose_of(element),
        mass=mass,
        visuals=visuals,
        collisions=collisions,
        lights=tuple(lights_of(element, subject, reading)),
        sensors=sum(1 for _ in element.all("sensor")),
        unseen=unseen,
        untouched=untouched,
        weightless=not flag(element, "gravity", True),
    )


def _joint(element: Element, around: str, reading: Reading) -> Joint:
    name, kind = name_of(element), element.attributes.get("type", "")
    if kind not in (*MOVING_JOINTS, "fixed"):
        known = ", ".join(("fixed", *MOVING_JOINTS))
        raise element.error(f"<joint> of type {kind!r}; expected: {known}")
    ends = []
    for tag in ("parent", "child"):
        end = element.child(tag)
        text = "" if end is None else end.text or getattr(end.child("link"), "text", "")
        if not text:
            raise element.error(f"<joint> needs a <{tag}>")
        ends.append(text)
    sensors = sum(1 for _ in element.all("sensor"))
    if sensors:
        reading.deviations.dropped(element.place, f"{around}/{name}", "<sensor>", "left out")
    if _is_locked(element):
        kind = "fixed"
    return Joint(name, kind, ends[0], ends[1], pose_of(element), element.place)


def _is_locked(element: Element) -> bool:
    """Whether limits leave a joint no range: an old way to write a fixed one."""
    axis = element.child("axis")
    if axis is None or axis.find("limit/lower") is None or axis.find("limit/upper") is None:
        return False
    return number(axis, "limit/lower", 0.0) >= number(axis, "limit/upper", 0.0)


def _unique(what: str, things: Iterable[Named], around: str, reading: Reading) -> tuple[Named, ...]:
    """The things in their order; a second one of a name is listed and left out."""
    found: dict[str, Named] = {}
    for thing in things:
        first = found.setdefault(thing.name, thing)
        if first is not thing:
            why = f"there are two {what}s {thing.name!r}; the first is at {first.place}"
            reading.deviations.dropped(
                thing.place, f"{around}/{thing.name}", why, f"this {what} is left out"
            )
    return tuple(found.values())
