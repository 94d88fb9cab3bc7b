"""Models of Gazebo that worlds include by name without bringing them along."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from momantu_worlds.sdf.read.document import Element, parse_document

_SUN = """<light name='sun' type='directional'>
  <diffuse>0.8 0.8 0.8 1</diffuse><direction>-0.4 0.2 -0.9</direction></light>"""
_GROUND = """<model name='ground_plane'><static>true</static><link name='link'>
  <collision name='collision'>
    <geometry><plane><normal>0 0 1</normal><size>100 100</size></plane></geometry>
  </collision></link></model>"""
_WOOD = "<material><diffuse>0.6 0.43 0.27 1</diffuse></material>"


@dataclass(frozen=True, slots=True)
class StandardModel:
    """root: of its SDF file. plain: it is simpler than Gazebo's own."""

    root: Element
    plain: bool


def _boxes(name: str, boxes: Iterable[tuple[str, str]]) -> str:
    """A static model of upright boxes, each of a size, with its middle at a point, m."""
    shapes = "".join(
        f"<{tag} name='{tag}_{n}'><pose>{at} 0 0 0</pose>"
        f"<geometry><box><size>{size}</size></box></geometry>{paint}</{tag}>"
        for n, (size, at) in enumerate(boxes)
        for tag, paint in (("collision", ""), ("visual", _WOOD))
    )
    return f"<model name='{name}'><static>1</static><link name='link'>{shapes}</link></model>"


_CAFE_TABLE = _boxes(
    "cafe_table",
    (
        ("0.913 0.913 0.04", "0 0 0.755"),
        ("0.042 0.042 0.735", "0 0 0.3675"),
        ("0.56 0.56 0.04", "0 0 0.02"),
    ),
)
_TABLE = _boxes(
    "table",
    (
        ("1.5 0.8 0.03", "0 0 1"),
        *(("0.04 0.04 0.985", f"{x} {y} 0.4925") for x in (-0.68, 0.68) for y in (-0.38, 0.38)),
    ),
)
_TEXTS = {
    "sun": (_SUN, False),
    "ground_plane": (_GROUND, False),
    "cafe_table": (_CAFE_TABLE, True),
    "table": (_TABLE, True),
}


def standard_model(uri: str) -> StandardModel | None:
    """A model that is known by its name, whatever server it is named on; or None."""
    words = uri.lower().replace("%20", "_").replace(" ", "_").split("/")
    name = next((word for word in words if word in _TEXTS), None)
    if name is None:
        return None
    text, plain = _TEXTS[name]
    root = parse_document(f"<sdf version='1.6'>{text}</sdf>".encode(), Path(f"<{name}>"))
    return StandardModel(root, plain)
