"""The plan of an episode: all that stands in it from above, with names."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from types import MappingProxyType

import cv2
import numpy as np
import shapely
from PIL import Image

from momantu_bt.geometry import Array, Pose2D, Transform
from momantu_bt.zone import Zone, ZoneKind
from momantu_worlds.checking.ground import Ground
from momantu_worlds.checking.scenario import WALL, Scenario
from momantu_worlds.preview.canvas import Canvas, Rgb, rgb
from momantu_worlds.scenes.geometry.bodies import Body, Mesh, Part, Picture
from momantu_worlds.scenes.geometry.solids import outline

PAPER: Rgb = (226, 224, 219)
WAY: Rgb = (251, 250, 246)
DARK: Rgb = (72, 74, 80)
ABOVE: Rgb = (196, 194, 188)
"""Lintels, lamps and roofs: parts above the robot."""
INK: Rgb = (40, 42, 48)
FAINT: Rgb = (122, 120, 114)
RED: Rgb = (190, 32, 24)
BLUE: Rgb = (24, 92, 176)
GREEN: Rgb = (20, 120, 80)
PURPLE: Rgb = (130, 50, 150)
ZONES: Mapping[ZoneKind, Rgb] = MappingProxyType(
    {"keep_out": (200, 40, 32), "slow": (206, 140, 20), "preferred": (40, 140, 70)}
)
"""Colours of zones."""
HATCH = 0.25
"""m between the lines that fill a zone to keep out of."""
MARGIN = 0.4
"""Margin of floor that is drawn around everything, m."""
BIG = 0.18
"""Least extent of a loose body for which its name is drawn, m."""
BENEATH = 12
"""px; of a surface's name beneath its edge."""
ARROW = 0.28
"""m; length of the mark that tells which way a place looks."""
CUT = 1.8
"""m; what begins above this is left out of meshes, so that a ceiling hides no room."""
FLOOR, WIDE = 0.03, 3.0
"""m; what ends below the first and is wider than the second either way is a floor."""
MOST_TRIANGLES = 60_000
"""A mesh of more triangles is drawn as its convex outline."""


def draw_plan(scenario: Scenario, width: int) -> Image.Image:
    """Draw the plan, its longer side upright. width: px."""
    low, high = extent(scenario)
    canvas = Canvas(low, high, width, PAPER)
    _ways(canvas, scenario, scenario.ground)
    _scale(canvas, low)
    _bodies(canvas, scenario)
    _zones(canvas, scenario)
    _surfaces(canvas, scenario)
    _start(canvas, scenario)
    _doors(canvas, scenario)
    _places(canvas, scenario)
    _actors(canvas, scenario)
    _zone_names(canvas, scenario)
    _names(canvas, scenario)
    return canvas.picture()


def extent(scenario: Scenario) -> tuple[Array, Array]:
    """Corners of what is drawn: everything but the floor that is empty around it."""
    points = [scenario.robot.outline(scenario.episode.start)]
    points += [part_points(b, part)[:, :2] for b in scenario.bodies for part in b.parts]
    points += [np.array([(p.x, p.y)]) for p in scenario.episode.site.places.values()]
    points += [np.array(zone.corners) for zone in scenario.episode.site.zones.values()]
    everything = np.concatenate(points)
    return everything.min(axis=0) - MARGIN, everything.max(axis=0) + MARGIN


def _ways(canvas: Canvas, scenario: Scenario, ground: Ground) -> None:
    """The floor that the robot's base can cover, lighter than the rest."""
    radius = math.ceil(scenario.robot.half_width / ground.cell)
    disc = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (2 * radius + 1, 2 * radius + 1))
    covered = cv2.dilate(scenario.reached.astype(np.uint8) * 255, disc)
    rows, columns = covered.shape
    extent = (columns * ground.cell, rows * ground.cell)
    canvas.mask(Image.fromarray(covered), WAY, ground.low, extent)


def _bodies(canvas: Canvas, scenario: Scenario) -> None:
    """Every part of every body, the highest last; parts above the robot as outlines only."""
    parts = [
        (body, part, part_points(body, part))
        for body in scenario.bodies
        for part in body.parts
        if part.visual
    ]
    for body, part, points in sorted(parts, key=lambda entry: float(entry[2][:, 2].max())):
        if _is_floor(points):
            continue
        shape = _outline(points)
        if isinstance(part.geometry, Mesh) and len(part.geometry.triangles) <= MOST_TRIANGLES:
            _mesh(canvas, part, points)
        elif isinstance(part.geometry, Picture):
            canvas.polygon(shape, (20, 20, 20), (255, 255, 255))
        elif float(points[:, 2].min()) >= scenario.robot.height:
            canvas.polygon(shape, None, ABOVE)
        elif body.category == WALL:
            canvas.polygon(shape, DARK, DARK)
        else:
            canvas.polygon(shape, rgb(part.color), rgb(part.color, 0.55))


def _is_floor(points: Array) -> bool:
    """Whether a part is a floor, which would hide where the robot gets."""
    flat = float(points[:, 2].max()) <= FLOOR
    return flat and bool((np.ptp(points[:, :2], axis=0) > WIDE).all())


def _mesh(canvas: Canvas, part: Part, points: Array) -> None:
    """The triangles of a mesh below the cut, the highest last; points: its vertices in the map."""
    assert isinstance(part.geometry, Mesh)
    corners = points[part.geometry.triangles]
    shown = corners[corners[:, :, 2].min(axis=1) < CUT]
    face, edge = rgb(part.color), rgb(part.color, 0.8)
    for triangle in shown[np.argsort(shown[:, :, 2].max(axis=1), kind="stable")]:
        canvas.polygon(triangle[:, :2], face, edge)


def part_points(body: Body, part: Part) -> Array:
    """Points (n, 3) around a part in the map."""
    geometry = part.geometry
    if isinstance(geometry, Picture):
        corners = np.array([(1, 1, 0), (-1, 1, 0), (-1, -1, 0), (1, -1, 0)]) / 2
        own = corners * (*geometry.size, 0.0)
    elif isinstance(geometry, Mesh):
        own = geometry.vertices
    else:
        own = outline(part)
    return (body.map_from_body @ part.body_from_part).apply(own)


def _outline(points: Array) -> Array:
    """The outline (n, 2) of points (m, 3) as they are seen from above."""
    return np.asarray(cv2.convexHull(points[:, :2].astype(np.float32))[:, 0], dtype=np.float64)


def _surfaces(canvas: Canvas, scenario: Scenario) -> None:
    """Tops that have a name, and ticks at the sides to stand at; the preferred one is longer."""
    for name, (map_from_top, size) in scenario.surfaces.items():
        half, surface = np.array(size) / 2, scenario.episode.site.surfaces[name]
        own = np.array([(1, 1), (-1, 1), (-1, -1), (1, -1)]) * half
        if surface.round:
            turns = np.linspace(0.0, 2 * np.pi, 48, endpoint=False)
            own = half * np.stack([np.cos(turns), np.sin(turns)], axis=1)
        canvas.polygon(_flat(map_from_top, own), None, GREEN, 2.5)
        for rank, side in enumerate(surface.sides):
            cos, sin = math.cos(side), math.sin(side)
            edge = half[0] if abs(cos) > abs(sin) or surface.round else half[1]
            ends = np.array([(edge, 0.0), (edge + (0.3 if rank == 0 else 0.15), 0.0)])
            turned = ends @ np.array([(cos, sin), (-sin, cos)])
            canvas.line(_flat(map_from_top, turned), GREEN, 2.5)


def _flat(map_from_own: Transform, points: Array) -> Array:
    """Points (n, 2) of a level frame in the map."""
    return map_from_own.apply(np.column_stack([points, np.zeros(len(points))]))[:, :2]


def _zones(canvas: Canvas, scenario: Scenario) -> None:
    """The outlines of zones, translucent; those to keep out of are hatched."""
    for zone in scenario.episode.site.zones.values():
        corners, color = np.array(zone.corners), ZONES[zone.kind]
        canvas.polygon(corners, (*color, 48), color, 2)
        if zone.kind == "keep_out":
            for line in _hatching(zone):
                canvas.line(line, color, 1)


def _hatching(zone: Zone) -> Iterator[Array]:
    """Slanting lines (2, 2) over a zone, cut at its border."""
    area = shapely.Polygon(zone.corners)
    left, low, right, high = area.bounds
    high_enough = high - low
    for x in np.arange(left - high_enough, right, HATCH):
        line = shapely.LineString([(x, low), (x + high_enough, high)])
        for piece in shapely.get_parts(shapely.intersection(line, area)):
            if piece.geom_type == "LineString":
                yield shapely.get_coordinates(piece)


def _zone_names(canvas: Canvas, scenario: Scenario) -> None:
    """The name of each zone, and what it is for, at a point inside."""
    for name, zone in scenario.episode.site.zones.items():
        limit = "" if zone.speed is None else f" {zone.speed:g} m/s"
        inside = shapely.get_coordinates(shapely.point_on_surface(shapely.Polygon(zone.corners)))[0]
        canvas.text(f"{name}: {zone.kind.replace('_', ' ')}{limit}", inside, ZONES[zone.kind], 13)


def _doors(canvas: Canvas, scenario: Scenario) -> None:
    for name, gap in scenario.episode.doorways.items():
        canvas.dot(gap.at, 3, FAINT)
        canvas.text(name, gap.at, FAINT, 11, above=10, always=False)


def _places(canvas: Canvas, scenario: Scenario) -> None:
    for name, pose in scenario.episode.site.places.items():
        tip = pose @ Pose2D(ARROW, 0.0, 0.0)
        canvas.line(np.array([(pose.x, pose.y), (tip.x, tip.y)]), BLUE, 2)
        canvas.dot((pose.x, pose.y), 4, BLUE)
        canvas.text(name, (pose.x, pose.y), BLUE, 13, above=-14)


def _actors(canvas: Canvas, scenario: Scenario) -> None:
    """Where people stop, by their names."""
    for actor in scenario.episode.actors:
        for number, stop in enumerate(actor.stops, 1):
            canvas.dot(stop, 5, PURPLE)
            canvas.text(f"{actor.name} {number}", stop, PURPLE, 12, above=-13, always=False)


def _start(canvas: Canvas, scenario: Scenario) -> None:
    """The base as it stands at first, and where it believes to stand."""
    robot, true, told = scenario.robot, scenario.episode.start, scenario.episode.site.start
    canvas.polygon(robot.outline(told), None, (150, 180, 220), 1.5)
    canvas.polygon(robot.outline(true), (120, 170, 235), BLUE, 2)
    front = true @ Pose2D(float(robot.footprint[:, 0].max()), 0.0, 0.0)
    canvas.line(np.array([(true.x, true.y), (front.x, front.y)]), BLUE, 3)
    canvas.text(f"{robot.name} starts here", (true.x, true.y), BLUE, 13, above=26)


def _names(canvas: Canvas, scenario: Scenario) -> None:
    """Names of surfaces and of what the goal is about first, then of all that there is room for."""
    goals = scenario.episode.goals
    wanted = {body.name for body in scenario.bodies if body.category == "tag"}
    wanted |= {name for goal in goals for name in (goal.item, goal.marker) if name is not None}
    items = {goal.item for goal in goals}
    for body in scenario.bodies:
        if body.name in wanted:
            color = RED if body.name in items else INK
            canvas.dot(body.map_from_body.position, 4, color)
            canvas.text(body.name, body.map_from_body.position, color, 15, above=14)
    for name, (map_from_top, size) in scenario.surfaces.items():
        height = float(map_from_top.position[2])
        x, y, _ = map_from_top.position
        corners = _flat(map_from_top, np.array([(1, 1), (-1, 1), (-1, -1), (1, -1)]) * size / 2)
        below = canvas.scale * float(y - corners[:, 1].min()) + BENEATH
        canvas.text(name, (x, y), GREEN, 15, above=-below)
        canvas.text(f"{height:.2f} m high", (x, y), GREEN, 12, above=-below - 15)
    for body in scenario.bodies:
        named = body.name in wanted or body.name in scenario.surfaces
        if named or body.category == WALL or not body.parts:
            continue
        points = np.concatenate([part_points(body, part)[:, :2] for part in body.parts])
        low, high = points.min(axis=0), points.max(axis=0)
        if body.static or (high - low).max() >= BIG:
            canvas.text(body.name, (low + high) / 2, INK, 11, always=False)


def _scale(canvas: Canvas, low: Array) -> None:
    """A bar of a metre in the lower left corner, and the map's axes."""
    x, y = float(low[0]) + 0.15, float(low[1]) + 0.15
    canvas.line(np.array([(x, y), (x + 1.0, y)]), INK, 3)
    canvas.text("1 m", (x + 0.5, y), INK, 12, above=10)
    canvas.line(np.array([(0.0, 0.0), (0.5, 0.0)]), RED, 2)
    canvas.line(np.array([(0.0, 0.0), (0.0, 0.5)]), GREEN, 2)
    canvas.text("x", (0.58, 0.0), RED, 12)
    canvas.text("y", (0.0, 0.6), GREEN, 12)
