"""A room to test skills in: two tables, a can, four walls, and its map.

The camera and the laser see the objects in the room; the site describes the same objects.
"""

from __future__ import annotations

import math
import tempfile
from functools import partial
from pathlib import Path

import numpy as np

from momantu_bt.formats.maps import MapPicture, write_map
from momantu_bt.geometry import Array, Pose2D
from momantu_bt.messages import LaserScan, WrenchReading, frozen
from momantu_bt.robot import CameraSensor, LaserSensor, RobotDescription, SensorReading
from momantu_bt.testing.description import small_robot
from momantu_bt.testing.painting import Block, Painter, Round
from momantu_bt.testing.robot import Scripted, ScriptedRobot
from momantu_bt.testing.world import ScriptedWorld, scripted_site
from momantu_bt.world import seeded

HALF = (3.5, 2.5)
"""m; half the room's length and width."""
RESOLUTION = 0.05
"""m per pixel of the map."""
NOISE = 0.01
"""m; sigma of a beam of the laser."""
_FREE, _OCCUPIED = 254, 0
_WALLS = (
    Block((2 * HALF[0], 0.1, 2.0), (0.0, HALF[1], 1.0)),
    Block((2 * HALF[0], 0.1, 2.0), (0.0, -HALF[1], 1.0)),
    Block((0.1, 2 * HALF[1], 2.0), (HALF[0], 0.0, 1.0)),
    Block((0.1, 2 * HALF[1], 2.0), (-HALF[0], 0.0, 1.0)),
    # Without it, both ends of the room look the same.
    Block((0.6, 0.4, 2.0), (-HALF[0] + 0.3, HALF[1] - 0.2, 1.0)),
)


class ExampleWorld(ScriptedWorld):
    """A scripted world with the tables of `scripted_site`, a can on table A, walls, and a map.

    robot: by default the small robot. Sensors without a scripted reading see the room. Tables are
    solid down to the floor. The map is in a temporary folder, which is removed with the world.
    """

    def __init__(self, seed: int = 0, robot: ScriptedRobot | None = None) -> None:
        self._folder = tempfile.TemporaryDirectory(prefix="momantu_bt_map_")
        site = scripted_site(map_file=_write_map(Path(self._folder.name)))
        robot = robot or ScriptedRobot(_seeing(small_robot()))
        robot.readings = _readings(robot.description, seed) | robot.readings
        super().__init__(robot, site)

    def close(self) -> None:
        """Remove the map."""
        super().close()
        self._folder.cleanup()


def _seeing(description: RobotDescription) -> RobotDescription:
    """The small robot with pictures large enough to measure in."""
    camera = description.sensors["camera"].model_copy(update={"width": 160, "height": 120})
    sensors = {**description.sensors, "camera": camera}
    return description.model_copy(update={"sensors": sensors})


def _tables() -> tuple[Block, ...]:
    surfaces = scripted_site().surfaces.values()
    return tuple(
        Block(
            (*surface.size, surface.height),
            (surface.map_from_surface.x, surface.map_from_surface.y, surface.height / 2),
            surface.map_from_surface.yaw,
        )
        for surface in surfaces
    )


def _readings(description: RobotDescription, seed: int) -> dict[str, Scripted]:
    tables = _tables()
    top = tables[0].size[2]
    can = Round((tables[0].centre[0] - 0.2, 0.1, top), 0.13, 0.035)
    painter = Painter((*_WALLS, *tables, can), seed=seed)
    found: dict[str, Scripted] = {}
    for name, sensor in description.sensors.items():
        if isinstance(sensor, CameraSensor):
            found[name] = painter
        elif isinstance(sensor, LaserSensor):
            found[name] = _Laser(sensor, (*_WALLS, *tables), seed)
        else:
            found[name] = partial(_no_force, sensor.frame)
    return found


def _no_force(frame: str, robot: ScriptedRobot) -> WrenchReading:
    return WrenchReading(robot.time, frame, frozen(np.zeros(3)), frozen(np.zeros(3)))


class _Laser:
    """Rays against the solids, in the laser's own plane."""

    def __init__(self, sensor: LaserSensor, solids: tuple[Block, ...], seed: int) -> None:
        self._sensor, self._solids, self._seed = sensor, solids, seed

    def __call__(self, robot: ScriptedRobot) -> SensorReading:
        """The current scan."""
        sensor = self._sensor
        mount = robot.description.kinematics().base_from_frame(sensor.frame, robot.joints)
        odom_from_laser = robot.base.transform() @ mount
        angles = np.linspace(sensor.angle_min, sensor.angle_max, sensor.beams)
        flat = np.stack([np.cos(angles), np.sin(angles), np.zeros_like(angles)], axis=1)
        ways: Array = flat @ odom_from_laser.rotation.T
        lengths = [solid.hit(odom_from_laser.position, ways) for solid in self._solids]
        ranges = np.min(lengths, axis=0)
        ranges += seeded(self._seed, "laser", robot.time).normal(0.0, NOISE, len(ranges))
        step = (sensor.angle_max - sensor.angle_min) / (sensor.beams - 1)
        bounded = np.clip(ranges, sensor.range_min, sensor.range_max)
        return LaserScan(
            robot.time,
            sensor.frame,
            sensor.angle_min,
            step,
            sensor.range_min,
            sensor.range_max,
            frozen(bounded),
        )


def _write_map(folder: Path) -> Path:
    """The room as a map_server map, a pixel per 5 cm; returns its YAML file."""
    margin = 0.5
    columns, rows = (math.ceil(2 * (half + margin) / RESOLUTION) for half in HALF)
    left, bottom = -columns * RESOLUTION / 2, -rows * RESOLUTION / 2
    y, x = np.mgrid[0:rows, 0:columns]
    points = np.stack([left + (x + 0.5) * RESOLUTION, bottom + (y + 0.5) * RESOLUTION], axis=-1)
    cells = np.full((rows, columns), _FREE, np.uint8)
    for block in (*_WALLS, *_tables()):
        cells[_covered(block, points)] = _OCCUPIED
    file = folder / "map.yaml"
    write_map(file, MapPicture(cells[::-1], RESOLUTION, (left, bottom)))
    return file


def _covered(block: Block, points: Array) -> Array:
    """Which points (rows, columns, 2) of the floor are under a block."""
    turned = Pose2D(block.centre[0], block.centre[1], block.yaw)
    c, s = math.cos(turned.yaw), math.sin(turned.yaw)
    away = points - np.array([turned.x, turned.y])
    along = away @ np.array([[c, -s], [s, c]])
    covered: Array = (np.abs(along) <= np.array(block.size[:2]) / 2).all(axis=-1)
    return covered
