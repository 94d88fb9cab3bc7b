"""An import as the text of a world file, with comments for its next editor."""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field

from momantu_bt.geometry import Pose2D, Transform
from momantu_worlds.sdf.body.bodies import ImportedBody
from momantu_worlds.sdf.body.ground import Ground
from momantu_worlds.sdf.body.lighting import Lighting
from momantu_worlds.sdf.body.parts import MeshPart, Part
from momantu_worlds.sdf.deviations import Deviation
from momantu_worlds.sdf.read.model import Box, Cylinder, Sphere
from momantu_worlds.sdf.write.proposal import Proposal, Surface
from momantu_worlds.sdf.write.task import TAG, Task

BARE = 20.0
"""Edge of a floor without any bodies, m."""
DECIMALS = 6
"""Decimals of metres and radians: a micrometre."""


@dataclass(frozen=True, slots=True)
class Imported:
    """The input of the writer of a world file.

    light: None for daylight. map: the robot's floor plan, relative to the world file; None: it is
    drawn from the bodies.
    """

    name: str
    source: str
    robot: str | None
    bodies: Sequence[ImportedBody]
    ground: Ground
    light: Lighting | None
    site: Proposal
    map: str | None = None
    task: Task = field(default_factory=Task)


def world_text(imported: Imported, deviations: Iterable[Deviation]) -> str:
    """The world file."""
    lines = [
        f"# The world {imported.name}, imported from {imported.source}.",
        "# Lengths in m, angles in rad; bodies stand on the floor, which is z = 0.",
    ]
    listed = len(list(deviations))
    if listed:
        lines.append(f"# {listed} things did not come over as they were; the import listed them.")
    lines += ["momantu_world: 1", f"name: {imported.name}", ""]
    lines += [
        *_floor(imported.ground, bare=not imported.bodies),
        *_start(imported),
        *(() if imported.light is None else _light(imported.light)),
    ]
    if imported.bodies:
        lines.append(
            "# What stands there. What is not static can be pushed, and carried where a hand fits."
        )
        lines.append("bodies:")
    for body in imported.bodies:
        lines += _body(body, imported.site.surfaces.get(body.name))
    lines += ["", *_task(imported.task), *_site(imported)]
    return "\n".join(lines) + "\n"


def _floor(ground: Ground, *, bare: bool) -> list[str]:
    """bare: nothing stands on it, so that its size must be written."""
    lines = [f"  center: {_row((0.0, 0.0))}", f"  size: {_row((BARE, BARE))}"] if bare else []
    if ground.color is not None:
        lines.append(f"  color: {_row(ground.color)}")
    if ground.friction is not None:
        lines.append(f"  friction: {_number(min(max(ground.friction, 0.01), 1.0))}")
    return ["floor:", *lines, ""] if lines else []


def _start(imported: Imported) -> list[str]:
    why = f"where {imported.robot} stood" if imported.robot else "a free place, by guess"
    return [
        f"# Where the robot stands at first: {why}.",
        "start:",
        f"  at: {_planar(imported.site.start)}",
        "  turn: 0",
        f"  clear: {_number(imported.site.clear)}",
        "",
    ]


def _light(light: Lighting) -> list[str]:
    lines = ["light:", f"  ambient: {_row(light.ambient)}"]
    if light.suns:
        lines.append("  suns:")
        lines += [f"    - {{direction: {_row(d)}, color: {_row(c)}}}" for d, c in light.suns]
    if light.bulbs:
        lines.append("  bulbs:")
        lines += [f"    - {{at: {_row(at)}, color: {_row(c)}}}" for at, c in light.bulbs]
    return [*lines, ""]


def _body(body: ImportedBody, surface: Surface | None) -> Iterator[str]:
    yield f"  {body.name}:  # {_comment(body.title)}"
    if body.category:
        yield f"    category: {body.category}"
    if not body.still:
        yield "    static: false"
        yield f"    mass: {_number(body.mass or 0.0)}"
    if body.friction is not None:
        yield f"    friction: {_number(body.friction)}"
    yield f"    at: {_pose(body.at)}"
    yield "    parts:"
    for part in body.parts:
        yield f"      - {{{', '.join(_part(part))}}}"
    if surface is not None:
        top = surface.top
        yield "    surface:  # a top to pick from and place on; `sides`: where to stand, best first"
        yield f"      at: {_planar(top.pose)}"
        yield f"      size: {_row(top.size)}"
        yield f"      height: {_number(top.height)}"
        yield f"      sides: {_row(surface.sides)}"


def _part(part: Part) -> Iterator[str]:
    solid = part.solid
    if isinstance(solid, Box):
        yield f"box: {_row(solid.size)}"
    elif isinstance(solid, Cylinder):
        size = f"radius: {_number(solid.radius)}, height: {_number(solid.length)}"
        yield f"cylinder: {{{size}}}"
    elif isinstance(solid, Sphere):
        yield f"sphere: {_number(solid.radius)}"
    else:
        how = "parts" if part.collision else "none"
        yield f"mesh: {{file: {solid.path}, collision: {how}}}"
    if (at := _pose(part.body_from_part)) != _pose(Transform()):
        yield f"at: {at}"
    if part.color is not None and part.visual:
        yield f"color: {_row(part.color)}"
    if not part.visual:
        yield "visual: false"
    if not part.collision and not isinstance(solid, MeshPart):
        yield "collision: false"


def _task(task: Task) -> Iterator[str]:
    if task.tag is not None:
        tag, at = task.tag, _row((task.tag.at.x, task.tag.at.y))
        yield "# An AprilTag of the family 36h11; edge: of its black square."
        yield "tag:"
        yield f"  {{name: {TAG}, id: {tag.id}, edge: {_number(tag.edge)}, on: {tag.on}, at: {at},"
        yield f"   yaw: {_number(tag.at.yaw)}, turn: 0}}"
        yield ""
    if task.item:
        yield f"goal: {task.item} on {task.on} beside {TAG}"
        yield ""


def _site(imported: Imported) -> Iterator[str]:
    site = imported.site
    yield "# What the robot is told. All of it was guessed from shapes: correct it."
    yield "site:"
    if imported.map is not None:
        yield f"  map: {_text(imported.map)}"
    yield "  places:"
    for name, pose in site.places.items():
        yield f"    {name}: {_planar(pose)}"
    if site.objects:
        yield "  objects:"
        for name, sizes in site.objects.items():
            entries = (
                f"{key}: {value if isinstance(value, str) else _number(value)}"
                for key, value in sizes.items()
            )
            yield f"    {name}: {{{', '.join(entries)}}}"


def _planar(pose: Pose2D) -> str:
    return _row((pose.x, pose.y, pose.yaw))


def _pose(pose: Transform) -> str:
    roll, pitch, yaw = rpy(pose)
    x, y, z = (float(v) for v in pose.position)
    if round(roll, DECIMALS) or round(pitch, DECIMALS):
        return _row((x, y, z, roll, pitch, yaw))
    return _row((x, y, z, yaw) if round(yaw, DECIMALS) else (x, y, z))


def rpy(pose: Transform) -> tuple[float, float, float]:
    """Turns about fixed axes x, y, z in this order, rad, that make a pose's rotation."""
    r = pose.rotation
    pitch = math.atan2(-float(r[2, 0]), math.hypot(float(r[0, 0]), float(r[1, 0])))
    if math.cos(pitch) < 1e-6:  # x points up or down: yaw and roll turn about one axis
        return math.atan2(-float(r[1, 2]), float(r[1, 1])), pitch, 0.0
    return (
        math.atan2(float(r[2, 1]), float(r[2, 2])),
        pitch,
        math.atan2(float(r[1, 0]), float(r[0, 0])),
    )


def _row(values: Iterable[float]) -> str:
    return f"[{', '.join(_number(value) for value in values)}]"


def _number(value: float) -> str:
    """Decimals without an exponent and without zeros at the end."""
    text = f"{value:.{DECIMALS}f}".rstrip("0").rstrip(".")
    return "0" if text in ("", "-0") else text


def _text(value: str) -> str:
    """A text as YAML reads it back, whatever stands in it."""
    return json.dumps(value, ensure_ascii=False)


def _comment(text: str) -> str:
    """A text that stays within its line of a comment."""
    return "".join(c if c.isprintable() else " " for c in text)[:120]
