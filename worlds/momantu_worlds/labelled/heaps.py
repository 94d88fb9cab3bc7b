"""Things on a surface: apart, touching, lying, in a tray, on top of each other, behind an arm."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from shapely.affinity import translate
from shapely.geometry import MultiPoint, Polygon
from shapely.prepared import prep

from momantu_bt.geometry import Array, Transform, quaternion_from_axis_angle
from momantu_worlds.labelled.shape import Draw, Shape, draw_color
from momantu_worlds.labelled.stock import Stock
from momantu_worlds.scenes.geometry.bodies import Box, Cylinder, Part, Sphere
from momantu_worlds.scenes.geometry.parts import block

UPRIGHT, UPSIDE_DOWN = 0.6, 0.08
"""Shares of the things that stand, and that stand on their head; the others lie."""
TOUCHING = 0.45
"""Share of the things that are put against another one."""
ON_TOP = 0.06
"""Share of the things that are put on a box."""
TRAY, ARM, CLUTTER = 0.15, 0.25, 0.45
"""Shares of the pictures with a tray, with an arm, and with clutter of no category."""
TRIES = 12
"""Places tried for a thing before it is left out."""
NEAR = 0.28
"""Half the edge of the square in which things are put, m."""
CLOSE = 1e-4
"""Gap between things that touch, m."""


@dataclass(frozen=True, slots=True)
class Manner:
    """How a heap is made. upright, touching, tray, clutter, arm: shares, as the constants above.

    things: the fewest, and one more than the most.
    """

    upright: float = UPRIGHT
    touching: float = TOUCHING
    tray: float = TRAY
    clutter: float = CLUTTER
    arm: float = ARM
    things: tuple[int, int] = (3, 10)


USUAL = Manner()
"""Heaps of pictures to train and to test with."""


@dataclass(frozen=True, slots=True)
class Laid:
    """A thing at its place. shape: None: it is of no category.

    top_from_thing: its pose on the surface, z up.
    """

    name: str
    shape: Shape | None
    parts: tuple[Part, ...]
    top_from_thing: Transform


@dataclass(slots=True)
class _Heap:
    """What lies so far; ground: its outlines on the surface."""

    half: tuple[float, float]
    manner: Manner
    laid: list[Laid]
    ground: list[Polygon]


def heap(draw: Draw, half: tuple[float, float], stock: Stock, manner: Manner = USUAL) -> list[Laid]:
    """Things around the origin of a surface.

    half: half the extent (2,) of the free room around the origin, m. stock: where things are from.
    """
    made = _Heap((min(NEAR, half[0]), min(NEAR, half[1])), manner, [], [])
    inside = 0
    if draw.random() < manner.tray:
        inside = _tray(draw, made, stock)
    if draw.random() < manner.clutter:
        for _ in range(int(draw.integers(1, 3))):
            _put(draw, made, f"clutter_{len(made.laid)}", None, _clutter(draw))
    for _ in range(max(1, int(draw.integers(*manner.things)) - inside)):
        shape = stock.shape(draw)
        if draw.random() < ON_TOP and _on_box(draw, made, shape):
            continue
        _put(draw, made, f"{shape.category}_{len(made.laid)}", shape, shape.parts)
    return made.laid


def _put(draw: Draw, made: _Heap, name: str, shape: Shape | None, parts: tuple[Part, ...]) -> None:
    """Put a thing at a free place, if one is found."""
    if shape is None:
        pose, points = Transform(), _corners(parts)
        flat = MultiPoint(points[:, :2]).convex_hull
    else:
        pose = resting(draw, shape, made.manner.upright)
        flat = MultiPoint(pose.apply(shape.outline)[:, :2]).convex_hull
    at = _place(draw, made, flat)
    if at is None:
        return
    made.ground.append(translate(flat, *at))
    made.laid.append(Laid(name, shape, parts, Transform((*at, 0.0)) @ pose))


def _place(draw: Draw, made: _Heap, flat: Polygon) -> tuple[float, float] | None:
    """Where an outline (around the origin) finds room; None if it finds none."""
    for _ in range(TRIES):
        x, y = draw.uniform(-1.0, 1.0, 2) * made.half
        if made.ground and draw.random() < made.manner.touching:
            beside = made.ground[int(draw.integers(len(made.ground)))]
            x, y = _against(draw, beside, flat)
        low_x, low_y, high_x, high_y = flat.bounds
        if max(x + high_x, -x - low_x) > made.half[0] + 0.05:
            continue
        if max(y + high_y, -y - low_y) > made.half[1] + 0.05:
            continue
        there = prep(translate(flat, x, y))
        if not any(there.intersects(other) for other in made.ground):
            return float(x), float(y)
    return None


def _against(draw: Draw, other: Polygon, flat: Polygon) -> tuple[float, float]:
    """Where an outline just touches another one, in a random direction."""
    turn = draw.uniform(-math.pi, math.pi)
    way = np.array([math.cos(turn), math.sin(turn)])
    middle = np.array([other.centroid.x, other.centroid.y])
    near, far = 0.0, 0.6
    for _ in range(12):
        step = (near + far) / 2
        if translate(flat, *(middle + step * way)).intersects(other):
            near = step
        else:
            far = step
    x, y = (middle + (far + CLOSE) * way).tolist()
    return x, y


def resting(draw: Draw, shape: Shape, upright: float = UPRIGHT) -> Transform:
    """A pose in which a thing rests on z = 0 above the origin. upright: share that stands."""
    turn = Transform(quaternion=quaternion_from_axis_angle((0, 0, 1), draw.uniform(0, 2 * math.pi)))
    kind = draw.random()
    if shape.lying:
        lie = _mesh_lies(draw, shape.lying, stands=kind < upright)
    elif shape.profile is None:
        lie = _box_lies(draw, kind)
    elif kind < upright:
        lie = Transform()
    elif kind < upright + UPSIDE_DOWN and shape.category != "bottle":
        lie = Transform(quaternion=(0.0, 1.0, 0.0, 0.0))
    else:
        lie = _on_side(draw, shape)
    pose = turn @ lie
    low = float(pose.apply(shape.outline)[:, 2].min())
    return Transform((0.0, 0.0, -low)) @ pose


def _box_lies(draw: Draw, kind: float) -> Transform:
    """A box with its longest edge up, or its shortest, or its middle one."""
    if kind < 0.4:
        return Transform()
    axis = (0.0, 1.0, 0.0) if kind < 0.75 else (1.0, 0.0, 0.0)
    return Transform(quaternion=quaternion_from_axis_angle(axis, math.pi / 2))


def _mesh_lies(draw: Draw, lying: Sequence[Array], *, stands: bool) -> Transform:
    """A mesh as it stands in its file, or on one of its sides."""
    if stands:
        return Transform()
    return Transform.from_rotation(lying[int(draw.integers(len(lying)))])


def _on_side(draw: Draw, shape: Shape) -> Transform:
    """A round thing on a line of its side on which it is stable; a handle points upwards."""
    assert shape.profile is not None
    edges = _stable_edges(shape.profile)
    if not edges:
        return Transform()
    slope = edges[int(draw.integers(len(edges)))]
    roll = draw.uniform(-math.pi, math.pi)
    if shape.category == "mug":
        roll = math.pi + draw.uniform(-1.3, 1.3)
    about = Transform(quaternion=quaternion_from_axis_angle((0, 0, 1), roll))
    down = Transform(quaternion=quaternion_from_axis_angle((0, 1, 0), math.pi / 2 + slope))
    return down @ about


def _stable_edges(profile: Array) -> list[float]:
    """Angles of the outline's sides to the axis, rad, on which the middle of the box rests."""
    hull = MultiPoint(np.concatenate([profile, profile * (-1.0, 1.0)])).convex_hull
    points = np.array(hull.exterior.coords)
    found = []
    for a, b in pairwise(points):
        way = b - a
        long = float(np.hypot(*way))
        if min(a[0], b[0]) < 0.2 * profile[:, 0].max() or abs(way[1]) < 0.25 * long or long < 0.02:
            continue
        share = float(-a @ way) / long**2
        if 0.05 < share < 0.95:
            up = way if way[1] > 0 else -way
            found.append(math.atan2(up[0], up[1]))
    return found


def _on_box(draw: Draw, made: _Heap, shape: Shape) -> bool:
    """Put a thing upright on a box that carries nothing yet; False if there is none."""
    if shape.category == "bottle":
        return False
    for number, below in enumerate(made.laid):
        if below.shape is None or below.shape.category != "box" or below.name.endswith("_loaded"):
            continue
        points = below.top_from_thing.apply(below.shape.outline)
        top, ground = float(points[:, 2].max()), MultiPoint(points[:, :2]).convex_hull
        wide = math.hypot(*shape.size[:2]) / 2 if shape.category == "box" else shape.size[0] / 2
        x, y = ground.centroid.x, ground.centroid.y
        if ground.area < math.pi * (0.8 * wide) ** 2 or top > 0.15:
            continue
        turn = quaternion_from_axis_angle((0, 0, 1), draw.uniform(0, 2 * math.pi))
        pose = Transform((x, y, top + shape.size[2] / 2), turn)
        made.laid[number] = Laid(
            f"{below.name}_loaded", below.shape, below.parts, below.top_from_thing
        )
        made.laid.append(Laid(f"{shape.category}_{len(made.laid)}", shape, shape.parts, pose))
        return True
    return False


def _tray(draw: Draw, made: _Heap, stock: Stock) -> int:
    """An open box with things in it; how many."""
    x, y = draw.uniform(0.12, 0.19), draw.uniform(0.14, 0.24)
    high, wall = draw.uniform(0.03, 0.10), draw.uniform(0.003, 0.01)
    color = draw_color(draw)
    parts = (
        block((2 * x, 2 * y, 0.004), (0, 0, 0.002), color),
        *(
            block((wall, 2 * y, high), (side * (x - wall / 2), 0, high / 2), color)
            for side in (-1, 1)
        ),
        *(
            block((2 * x, wall, high), (0, side * (y - wall / 2), high / 2), color)
            for side in (-1, 1)
        ),
    )
    turn = draw.uniform(-math.pi, math.pi)
    pose = Transform(quaternion=quaternion_from_axis_angle((0, 0, 1), turn))
    inner = _Heap((x - wall - 0.05, y - wall - 0.05), made.manner, [], [])
    if min(inner.half) < 0.02:
        return 0
    for _ in range(int(draw.integers(1, 5))):
        shape = stock.shape(draw)
        _put(draw, inner, f"{shape.category}_in_{len(inner.laid)}", shape, shape.parts)
    room = MultiPoint(pose.apply(_corners(parts))[:, :2]).convex_hull
    made.ground.append(room)
    made.laid.append(Laid("tray", None, parts, pose))
    for thing in inner.laid:
        lifted = pose @ Transform((0, 0, 0.004)) @ thing.top_from_thing
        made.laid.append(Laid(thing.name, thing.shape, thing.parts, lifted))
    return len(inner.laid)


def _clutter(draw: Draw) -> tuple[Part, ...]:
    """A ball, a plate, a slab or a leaning stick: of no category."""
    color, kind = draw_color(draw), int(draw.integers(4))
    if kind == 0:
        r = draw.uniform(0.02, 0.05)
        return (Part(Sphere(r), Transform((0, 0, r)), color),)
    if kind == 1:
        r, h = draw.uniform(0.06, 0.12), draw.uniform(0.008, 0.02)
        return (Part(Cylinder(r, h), Transform((0, 0, h / 2)), color),)
    if kind == 2:
        x, y = draw.uniform(0.02, 0.1), draw.uniform(0.08, 0.2)
        h = draw.uniform(0.006, 0.018)
        return (block((x, y, h), (0, 0, h / 2), color),)
    r, h = draw.uniform(0.004, 0.01), draw.uniform(0.1, 0.2)
    lean = Transform.from_rpy((0, 0, 0.45 * h), (draw.uniform(0.2, 1.3), 0, draw.uniform(0, 6)))
    return (Part(Cylinder(r, h), lean, color),)


def _corners(parts: tuple[Part, ...]) -> Array:
    """Corners (n, 3) of boxes around all parts."""
    unit = np.array(np.meshgrid(*[(-0.5, 0.5)] * 3)).reshape(3, -1).T
    found = []
    for part in parts:
        shape = part.geometry
        if isinstance(shape, Box):
            size = shape.size
        elif isinstance(shape, Sphere):
            size = (2 * shape.radius,) * 3
        else:
            assert isinstance(shape, Cylinder)
            size = (2 * shape.radius, 2 * shape.radius, shape.height)
        found.append(part.body_from_part.apply(unit * np.array(size)))
    return np.concatenate(found)


def arm(draw: Draw, eye: Array) -> Laid:
    """An arm with a hand that reaches from beside the camera into the heap.

    eye: (3,) the camera's place on the surface, m.
    """
    tip = np.array([*draw.uniform(-0.2, 0.2, 2), draw.uniform(0.05, 0.3)])
    flat = np.array([eye[0], eye[1], 0.0])
    aside = np.cross((0, 0, 1), flat / np.linalg.norm(flat)) * draw.choice([-1, 1])
    start = 0.6 * flat + draw.uniform(0.1, 0.5) * aside + np.array([0, 0, draw.uniform(0.1, 0.5)])
    elbow = (tip + start) / 2 + np.array([0, 0, draw.uniform(0.0, 0.25)])
    color, dark = draw_color(draw), draw_color(draw)
    wrist = tip + 0.25 * (elbow - tip)
    radius = draw.uniform(0.03, 0.06)
    parts = [_limb(start, elbow, radius, color), _limb(elbow, wrist, 0.9 * radius, dark)]
    parts += [Part(Sphere(radius), Transform(elbow), color)]
    ahead = (tip - wrist) / np.linalg.norm(tip - wrist)
    across = np.cross(ahead, draw.standard_normal(3))
    across /= np.linalg.norm(across)
    gap = draw.uniform(0.01, 0.05)
    parts.append(_limb(wrist - gap * across, wrist + gap * across, 0.02, dark))
    parts += [
        _limb(wrist + s * gap * across, wrist + s * gap * across + 0.07 * ahead, 0.009, color)
        for s in (-1.0, 1.0)
    ]
    return Laid("arm", None, tuple(parts), Transform())


def _limb(start: Array, end: Array, radius: float, color: tuple[float, float, float]) -> Part:
    """A cylinder from start to end."""
    way = end - start
    long = float(np.linalg.norm(way))
    axis = np.cross((0.0, 0.0, 1.0), way)
    sine = float(np.linalg.norm(axis)) / long
    turn = (1.0, 0.0, 0.0, 0.0)
    if sine > 1e-6:
        angle = math.atan2(sine, float(way[2]) / long)
        turn = tuple(quaternion_from_axis_angle(axis, angle).tolist())
    return Part(Cylinder(radius, long), Transform((start + end) / 2, turn), color)
