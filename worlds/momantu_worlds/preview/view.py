"""A view of an episode from above a corner of its rooms."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from momantu_bt.geometry import Array, Transform
from momantu_bt.robot import RobotDescription
from momantu_worlds.checking.scenario import WALL
from momantu_worlds.display.chase import looking
from momantu_worlds.preview.plan import part_points
from momantu_worlds.sapien.sensors.camera_view import ViewCamera
from momantu_worlds.sapien.simulator import Simulator
from momantu_worlds.scenes.geometry.bodies import Body, Box, Episode, Part, SunLight

FIELD = math.radians(35)
"""rad; horizontal field of view: narrow, so that far rooms are not tiny."""
ELEVATION = math.radians(56)
"""rad above the horizon from which it looks: steep enough to see over the near walls."""
AZIMUTH = math.radians(-76)
"""rad; the side from which it looks, from the x axis: nearly from the map's south."""
SMOOTH = 2
"""Supersampling factor, for smooth edges."""
AIR = 1.03
"""Factor of the picture's extent over the rooms'."""
CUT = 1.3
"""m; walls are cut at this height, so that they hide little of the rooms behind them."""
ROOF, WIDE = 1.9, 1.0
"""m; what begins so high and is so wide either way is a roof: it is left out."""
AMBIENT = 0.7
"""Ambient light; an episode's own light is for the robot's camera, not for previews."""
SUN = SunLight((0.35, 0.55, -1.0), (0.75, 0.75, 0.72))
"""One sun from behind the eye gives every face its own shade."""
HALVINGS = 50
"""Steps of the bisection for the camera's height: far below a millimetre."""
MOST_HEIGHT = 1800
"""px; a deep house makes a narrower picture."""
UPRIGHT = 0.999
"""Cosine of the tilt up to which a box of a wall counts as upright."""
PAPER = (238, 238, 236)
"""RGB of the background."""


def draw_view(
    episode: Episode, description: RobotDescription, low: Array, high: Array, width: int
) -> Image.Image:
    """The view. low, high: corners (3,) of what must be in it, map, m. width: px, at most.

    Raises:
        WorldError: the robot cannot be simulated, or nothing renders.
    """
    corners = np.array(np.meshgrid(*zip(low, high, strict=True))).reshape(3, -1).T
    turn = looking(towards(), np.zeros(3)).rotation
    eye, aspect = eye_over(corners, turn)
    width = min(width, round(MOST_HEIGHT / aspect))
    height = round(width * aspect)
    simulator = Simulator(description, as_model(episode), episode.seed)
    try:
        camera = ViewCamera(
            simulator.scene, SMOOTH * width, SMOOTH * height, FIELD, far=_far(corners, eye)
        )
        picture: NDArray[np.uint8] = camera.take(Transform.from_rotation(turn, eye)).copy()
        picture[~camera.met()] = PAPER
    finally:
        simulator.close()
    return Image.fromarray(picture).resize((width, height), Image.Resampling.LANCZOS)


def as_model(episode: Episode) -> Episode:
    """The episode as a model of it would be built: with low walls and no roof, in even light."""
    bodies = tuple(
        _cut(body) if body.category == WALL else _roofless(body) for body in episode.bodies
    )
    ambient = (AMBIENT, AMBIENT, AMBIENT)
    return replace(episode, bodies=bodies, ambient=ambient, suns=(SUN,), lamps=())


def _roofless(body: Body) -> Body:
    """A body without those of its parts that would hide a room from above."""
    if not body.static:
        return body
    return replace(body, parts=tuple(part for part in body.parts if not _is_roof(body, part)))


def _is_roof(body: Body, part: Part) -> bool:
    points = part_points(body, part)
    extent = points.max(axis=0) - points.min(axis=0)
    return bool(points[:, 2].min() >= ROOF and extent[:2].min() >= WIDE)


def _cut(wall: Body) -> Body:
    """A wall no higher than `CUT`; what is not an upright box stays as it is."""
    parts = (_cut_part(wall, part) for part in wall.parts)
    return replace(wall, parts=tuple(part for part in parts if part is not None))


def _cut_part(wall: Body, part: Part) -> Part | None:
    """What is left of a part; None of a lintel, which is above the cut."""
    at = wall.map_from_body @ part.body_from_part
    box = part.geometry
    if not isinstance(box, Box) or at.rotation[2, 2] < UPRIGHT:
        return part
    bottom = float(at.position[2]) - box.size[2] / 2
    over = bottom + box.size[2] - CUT
    if bottom >= CUT or over <= 0:
        return None if bottom >= CUT else part
    shape = Box((box.size[0], box.size[1], box.size[2] - over))
    return replace(
        part, geometry=shape, body_from_part=part.body_from_part @ Transform((0, 0, -over / 2))
    )


def towards() -> Array:
    """Unit vector (3,) from what is looked at to the eye."""
    flat = math.cos(ELEVATION)
    return np.array([flat * math.cos(AZIMUTH), flat * math.sin(AZIMUTH), math.sin(ELEVATION)])


def eye_over(corners: Array, turn: Array) -> tuple[Array, float]:
    """Where the camera must be so that all corners (n, 3) just fit, and height by width.

    In the camera's frame x is ahead, y to the left, z up. A corner is between the picture's sides
    when it is on the inner side of both planes through the eye; each plane touches a corner. Above
    and below are then made equal.
    """
    slope = math.tan(FIELD / 2) / AIR
    own = corners @ turn
    left = float((own[:, 1] - slope * own[:, 0]).max())
    right = float((-own[:, 1] - slope * own[:, 0]).max())
    ahead, across = -(left + right) / (2 * slope), (left - right) / 2
    depth = own[:, 0] - ahead
    low, high = float(own[:, 2].min()) - 1.0, float(own[:, 2].max()) + 1.0
    for _ in range(HALVINGS):
        middle = (low + high) / 2
        up = (own[:, 2] - middle) / depth
        low, high = (middle, high) if up.max() + up.min() > 0 else (low, middle)
    up = np.abs((own[:, 2] - low) / depth).max()
    return turn @ np.array([ahead, across, low]), float(up) / math.tan(FIELD / 2) * AIR


def _far(corners: Array, eye: Array) -> float:
    return 1.2 * float(np.linalg.norm(corners - eye, axis=1).max())
