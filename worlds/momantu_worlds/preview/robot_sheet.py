"""The pictures of `robots preview`: every named pose, its frames, and what its camera sees."""

from __future__ import annotations

import io
import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

from momantu_bt.geometry import Array, Transform
from momantu_bt.robot import CameraSensor, RobotDescription
from momantu_worlds.display.chase import looking
from momantu_worlds.preview.robot_scene import robot_episode
from momantu_worlds.sapien.sensors.camera import OPTICAL_FROM_SAPIEN
from momantu_worlds.sapien.sensors.camera_view import ViewCamera
from momantu_worlds.sapien.simulator import Simulator

WIDTH, HEIGHT = 720, 600
"""px of a pose's picture."""
SMOOTH = 2
"""Supersampling factor, for smooth edges."""
AT_REST = "at rest"
"""Title of the picture of a robot without named poses."""
FIELD = math.radians(32)
"""rad; width of a pose's picture: narrow, so that near arms do not look long."""
AROUND = math.radians(72)
"""rad; the side from which a robot is seen, from its x axis to the left: past the table."""
ABOVE = math.radians(20)
"""rad; how far from above."""
AIR = 1.25
"""Factor of the picture's extent over the robot's."""
AXIS = 0.14
"""m; length of a frame's axes."""
LINE = 30
"""px; height of a line of text."""
GAP = 10
"""px between pictures."""
COLORS = ((214, 39, 40), (44, 160, 44), (31, 119, 180))
"""RGB of the x, y and z axes."""
PAPER, INK, SKY = (255, 255, 255), (30, 30, 30), (238, 238, 236)


@dataclass(frozen=True)
class _View:
    """A picture's camera: base_from_view looks along x, z up. focal: px."""

    base_from_view: Transform
    focal: float

    def pixel(self, point: Array) -> tuple[float, float] | None:
        """Where a point (3,) of the base lies in the picture; None behind the camera."""
        x, y, z = self.base_from_view.inverse().apply(point)
        if x < 0.05:
            return None
        return WIDTH / 2 - self.focal * y / x, HEIGHT / 2 - self.focal * z / x


def robot_sheet(description: RobotDescription) -> bytes:
    """A PNG: for every named pose the robot with its frames, and its first camera's view.

    Raises:
        WorldError: the robot cannot be simulated, one of its meshes cannot be read, or nothing
            renders.
    """
    simulator = Simulator(description, robot_episode(description), seed=0)
    try:
        rows = [
            (_titled(name, _pose(simulator, description, pose)), eye)
            for name, pose in (description.named_poses or {AT_REST: {}}).items()
            for eye in [_camera(simulator, description, pose)]
        ]
    finally:
        simulator.close()
    sheet = _sheet(rows)
    out = io.BytesIO()
    sheet.save(out, "PNG", optimize=True)
    return out.getvalue()


def _opened(description: RobotDescription, pose: dict[str, float]) -> dict[str, float]:
    """The joints of a pose, with the fingers of any hand open."""
    effector = description.end_effector
    return pose if effector is None else {**effector.positions(effector.max_width), **pose}


def _put(simulator: Simulator, description: RobotDescription, pose: dict[str, float]) -> None:
    """Set the joints, the hand open."""
    model = simulator.model
    joints = _opened(description, pose)
    q = model.positions()
    for name, value in joints.items():
        if name in model.index:
            q[model.index[name]] = value
    model.articulation.set_qpos(q.astype(np.float32))


def _pose(
    simulator: Simulator, description: RobotDescription, pose: dict[str, float]
) -> Image.Image:
    _put(simulator, description, pose)
    view = _view(description)
    camera = ViewCamera(simulator.scene, SMOOTH * WIDTH, SMOOTH * HEIGHT, FIELD)
    picture = _taken(camera, view.base_from_view, WIDTH)
    draw = ImageDraw.Draw(picture)
    named: dict[tuple[int, ...], list[str]] = {}
    for name, place in _frames(description, pose):
        _draw_frame(draw, view, place)
        named.setdefault(tuple((place.position * 50).round().astype(int)), []).append(name)
    for name, place in _frames(description, pose):
        names = named[tuple((place.position * 50).round().astype(int))]
        if name == names[0]:
            _write(draw, view, place, ", ".join(names))
    return picture


def _view(description: RobotDescription) -> _View:
    """From before and to the left, so far off that the robot and the table's edge fit."""
    tall = max(description.height, 0.6)
    target = np.array([0.25 * description.working.look_off, 0.0, 0.48 * tall])
    away = AIR * max(tall, 1.6 * description.working.look_off) / (2 * math.tan(FIELD / 2))
    flat = math.cos(ABOVE)
    toward = (flat * math.cos(AROUND), flat * math.sin(AROUND), math.sin(ABOVE))
    eye = target + away * WIDTH / HEIGHT * np.array(toward)
    return _View(looking(eye, target), WIDTH / 2 / math.tan(FIELD / 2))


def _frames(
    description: RobotDescription, pose: dict[str, float]
) -> Iterator[tuple[str, Transform]]:
    """base_from_frame of the grasp frame and of every sensor."""
    tree, effector = description.kinematics(), description.end_effector
    joints = _opened(description, pose)
    if effector is not None:
        hand = tree.base_from_frame(effector.frame, joints)
        yield "hand", hand @ Transform((effector.grasp_offset, 0.0, 0.0))
    for name, sensor in description.sensors.items():
        if sensor.kind not in ("imu", "wrench"):
            yield name, tree.base_from_frame(sensor.frame, joints)


def _draw_frame(draw: ImageDraw.ImageDraw, view: _View, place: Transform) -> None:
    start = view.pixel(place.position)
    if start is None:
        return
    for axis, color in zip(place.rotation.T, COLORS, strict=True):
        end = view.pixel(place.position + AXIS * axis)
        if end is not None:
            draw.line([start, end], fill=color, width=3)


def _write(draw: ImageDraw.ImageDraw, view: _View, place: Transform, text: str) -> None:
    at = view.pixel(place.position)
    if at is not None:
        font = ImageFont.load_default(15)
        draw.text((at[0] + 6, at[1] + 4), text, INK, font, stroke_width=3, stroke_fill=PAPER)


def _camera(
    simulator: Simulator, description: RobotDescription, pose: dict[str, float]
) -> Image.Image | None:
    """What the first camera sees, as high as a pose's picture; None without a camera."""
    cameras = [(n, s) for n, s in description.sensors.items() if isinstance(s, CameraSensor)]
    if not cameras:
        return None
    name, sensor = cameras[0]
    _put(simulator, description, pose)
    joints = _opened(description, pose)
    optical = description.kinematics().base_from_frame(sensor.frame, joints)
    width = round(HEIGHT * sensor.width / sensor.height)
    camera = ViewCamera(simulator.scene, SMOOTH * width, SMOOTH * HEIGHT, sensor.horizontal_fov)
    picture = _taken(camera, optical @ OPTICAL_FROM_SAPIEN, width)
    return _titled(f"what {name} sees", picture)


def _taken(camera: ViewCamera, base_from_view: Transform, width: int) -> Image.Image:
    pixels: NDArray[np.uint8] = camera.take(base_from_view).copy()
    pixels[~camera.met()] = SKY
    return Image.fromarray(pixels).resize((width, HEIGHT), Image.Resampling.LANCZOS)


def _titled(text: str, picture: Image.Image) -> Image.Image:
    titled = Image.new("RGB", (picture.width, picture.height + LINE), PAPER)
    titled.paste(picture, (0, LINE))
    ImageDraw.Draw(titled).text((4, 4), text, INK, ImageFont.load_default(20))
    return titled


def _sheet(rows: list[tuple[Image.Image, Image.Image | None]]) -> Image.Image:
    """Pictures of a pose side by side, poses one beneath the other."""
    wide = max(pose.width + (eye.width + GAP if eye else 0) for pose, eye in rows) + 2 * GAP
    tall = sum(pose.height + GAP for pose, _ in rows) + GAP
    sheet = Image.new("RGB", (wide, tall), PAPER)
    top = GAP
    for pose, eye in rows:
        sheet.paste(pose, (GAP, top))
        if eye is not None:
            sheet.paste(eye, (2 * GAP + pose.width, top))
        top += pose.height + GAP
    return sheet
