"""Lights of a world or of a link."""

from __future__ import annotations

import math

from momantu_worlds.sdf.errors import SdfError
from momantu_worlds.sdf.read.document import Element
from momantu_worlds.sdf.read.model import Light, LightKind
from momantu_worlds.sdf.read.reading import Reading
from momantu_worlds.sdf.read.unread import list_leftovers
from momantu_worlds.sdf.read.values import color_of, flag, name_of, number, pose_of, vector

STRONGEST = 100.0
"""Largest intensity of a light; more makes everything white."""
WHITE = (1.0, 1.0, 1.0, 1.0)
_READ = ("pose", "diffuse", "direction", "intensity", "light_on", "visualize")


def lights_of(parent: Element, around: str, reading: Reading) -> list[Light]:
    """The lights directly in an element."""
    found = reading.each(
        parent.all("light"), around, lambda element: read_light(element, around, reading)
    )
    return [light for light in found if light is not None]


def read_light(element: Element, around: str, reading: Reading) -> Light | None:
    """One light; None when it is off.

    Raises:
        SdfError: its kind or its direction is not possible.
    """
    name = name_of(element)
    subject = f"{around}/{name}" if around else name
    if not flag(element, "light_on", default=True):
        reading.deviations.dropped(element.place, subject, "a light that is off", "left out")
        return None
    kind = _kind(element)
    list_leftovers(element, subject, _READ, reading.deviations)
    x, y, z = vector(element, "direction", (0.0, 0.0, -1.0))
    if kind is LightKind.SUN and math.hypot(x, y, z) < 1e-9:
        raise element.error("<light> has a direction without length")
    if kind is LightKind.SPOT:
        reading.deviations.changed(element.place, subject, "a spot light", "it shines to all sides")
    strength = min(max(number(element, "intensity", 1.0), 0.0), STRONGEST)
    red, green, blue, alpha = color_of(element, "diffuse") or WHITE
    diffuse = (red * strength, green * strength, blue * strength, alpha)
    return Light(name, kind, element.place, pose_of(element), diffuse, (x, y, z))


def _kind(element: Element) -> LightKind:
    kind = element.attributes.get("type", "")
    try:
        return LightKind(kind)
    except ValueError:
        known = ", ".join(LightKind)
        raise SdfError(element.place, f"<light> of type {kind!r}; expected: {known}") from None
