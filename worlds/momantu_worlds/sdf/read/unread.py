"""Elements and attributes that no reader uses: each is listed as a deviation."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator, Mapping

from momantu_worlds.sdf.deviations import Deviations
from momantu_worlds.sdf.read.document import Element

_OFF = ("0", "false")
_ON = ("1", "true")

NEUTRAL: Mapping[str, tuple[str, ...] | None] = {
    "allow_auto_disable": None,
    "canonical_link": None,
    "cast_shadows": None,
    "enable_wind": _OFF,
    "gravity": _ON,
    "kinematic": _OFF,
    "laser_retro": ("0", "0.0"),
    "lighting": None,
    "max_contacts": None,
    "meta": None,
    "must_be_base_link": None,
    "receive_shadows": None,
    "self_collide": _OFF,
    "shadows": None,
    "sim_time": None,
    "real_time": None,
    "wall_time": None,
    "iterations": None,
    "transparency": ("0", "0.0"),
    "xyz_offset": None,
}
"""Elements that have no effect here, with the values for which that is true; None: all values.
There are no shadows and no wind, solver settings belong to Gazebo, and bodies do not collide with
themselves."""

NOTHING_AT_ZERO = ("emissive", "specular", "velocity_decay", "wind")
"""Elements that have no effect if all their numbers are zero."""
COLORS = 3
"""Numbers of a colour that count; the fourth is alpha."""

INSTEAD: Mapping[str, str] = {
    "actor": "left out; write people into the world file as `actors`, with their stops",
    "attenuation": "a lamp's light falls with the square of the distance",
    "atmosphere": "left out; no sensor of ours feels the air",
    "audio": "left out",
    "audio_sink": "left out",
    "audio_source": "left out",
    "background": "left out; the background is plain",
    "battery": "left out",
    "bounce": "nothing bounces here",
    "bullet": "left out; friction is read from <ode>",
    "collision_detection": "left out",
    "contact": "left out; contacts are the simulator's own",
    "emissive": "it reflects light but gives none",
    "enable_wind": "there is no wind",
    "fog": "left out; the air is clear",
    "friction1": "left out",
    "gravity": "gravity is 9.81 m/s2 downwards, for everything",
    "grid": "left out; it is Gazebo's window's",
    "gui": "left out; it is Gazebo's window's",
    "inertia": "inertia follows from the mass and the shape",
    "kinematic": "left out; what is not static moves by physics",
    "laser_retro": "the laser measures no intensity",
    "magnetic_field": "left out; no sensor of ours feels it",
    "normal_map": "surfaces are smooth",
    "origin_visual": "left out; it is Gazebo's window's",
    "particle_emitter": "left out",
    "physics": "left out; the simulator's own settings hold",
    "plugin": "left out; no code is run",
    "population": "left out; none of its models is there",
    "projector": "left out",
    "pbr": "only the colour and the colour's picture are kept",
    "road": "left out",
    "scene": "left out",
    "self_collide": "bodies of one model do touch each other here, links of one body do not",
    "sensor": "left out; sensors belong to the robot's description",
    "shader": "left out",
    "sky": "left out; the background is plain",
    "soft_contact": "nothing is soft here",
    "specular": "surfaces are matt",
    "spot": "it shines to all sides",
    "spherical_coordinates": "left out; nothing here needs a place on Earth",
    "surface": "left out",
    "torsional": "left out; friction is the same for sliding and turning",
    "transparency": "it is drawn as if it were not transparent",
    "velocity_decay": "left out",
    "visibility_flags": "every camera sees it",
    "wind": "there is no wind",
}
"""What replaces an element that is not imported."""


def list_leftovers(
    element: Element, subject: str, read: Collection[str], deviations: Deviations
) -> None:
    """List the children of an element that no reader uses and that have an effect."""
    for child in element.children:
        if child.tag not in read and not _says_nothing(child):
            instead = INSTEAD.get(child.tag, "not known here; left out")
            deviations.dropped(child.place, subject, described(child), instead)


def described(element: Element) -> str:
    """An element in a few words: its tag, its name and its type."""
    named = [f"{k}='{element.attributes[k]}'" for k in ("name", "type") if k in element.attributes]
    return f"<{' '.join((element.tag, *named))}>"


def _says_nothing(element: Element) -> bool:
    if element.tag in NEUTRAL:
        values = NEUTRAL[element.tag]
        return values is None or element.text.lower() in values or not any(_texts(element))
    if element.tag in NOTHING_AT_ZERO:
        numbers = [word for text in _texts(element) for word in text.split()[:COLORS]]
        return all(re.fullmatch(r"[-+]?0*\.?0*(e[-+]?\d+)?", word) for word in numbers)
    return not element.attributes and not any(_texts(element))


def _texts(element: Element) -> Iterator[str]:
    """All texts and attributes within an element."""
    waiting = list(element.children)
    yield element.text
    while waiting:
        here = waiting.pop()
        yield from (here.text, *here.attributes.values())
        waiting += here.children
