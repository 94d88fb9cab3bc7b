"""Reads lidar and IMU as a run goes on, and maps the turns in three dimensions."""

from __future__ import annotations

from typing import ClassVar

from momantu_bt.errors import InputError
from momantu_bt.failure import SENSOR_DEAD, Failure
from momantu_bt.lazy import lazily
from momantu_bt.robot import (
    ImuSensor,
    LidarSensor,
    Robot,
    RobotDescription,
    laser_band,
    read_imu,
    read_lidar,
)
from momantu_bt.service import Service, ServiceContext

with lazily():
    from momantu_skills.mapping.three_d import raster, registration, surveying

BAND = 0.3
"""Least width of the band of heights that the floor plan has, m: rings lie so far apart at 9 m."""
RINGS = 4
"""Fewest rings of a lidar for a map in three dimensions: fewer show no surfaces."""


def lidar_of(description: RobotDescription) -> str:
    """The name of the lidar that maps in three dimensions.

    Raises:
        InputError: the robot has no lidar of several rings, or no IMU; the message says what to do.
    """
    sensors = description.sensors
    lidars = {name: s for name, s in sensors.items() if isinstance(s, LidarSensor)}
    lidar = next((name for name, s in lidars.items() if len(s.elevations) >= RINGS), None)
    missing = [] if lidar is not None else [f"a lidar with {RINGS} rings or more (kind: lidar)"]
    if not any(isinstance(sensor, ImuSensor) for sensor in sensors.values()):
        missing.append("an IMU (kind: imu)")
    if missing or lidar is None:
        having = ", ".join(f"{name} ({s.kind})" for name, s in sensors.items()) or "none"
        raise InputError(
            f"the robot {description.name} cannot map in three dimensions: it lacks "
            f"{' and '.join(missing)}. Its sensors: {having}. Name another one with --robot, add "
            "them to its robot file, or leave out --dimensions 3"
        )
    return lidar


def check(description: RobotDescription) -> None:
    """Check that a robot can map in three dimensions here.

    Raises:
        InputError: it lacks a sensor.
        RegistrationMissingError: small_gicp is not installed.
    """
    lidar_of(description)
    registration.check_installed()


class CloudService(Service):
    """Maps in three dimensions, beside the service `mapping`, which the robot drives by.

    A turn whose sensors do not answer is left out; wheels and IMU bridge it.
    """

    rate: ClassVar[float] = 20.0

    def start(self, context: ServiceContext) -> None:
        """Begin a map at the site's start pose; see `check`."""
        description = context.description
        self.lidar = lidar_of(description)
        self.band, self.height = plan_band(description), description.height
        self._turn = _turn_of(description, self.lidar)
        self._frames, self._base = context.frames, description.base_frame
        self._start = context.site.start.transform()
        self._imu = description.imu()[1].frame
        self._due = 0.0
        self.survey: surveying.CloudSurvey | None = None

    def update(self, robot: Robot, now: float) -> None:
        """Follow the base, and map the lidar's turn when it has ended."""
        survey = self.survey
        if survey is None:
            mount = self._frames.lookup(self._base, self._imu, now)
            survey = self.survey = surveying.CloudSurvey(mount, self._start)
            self._due = now + self._turn
            read_lidar(robot, self.lidar)
        state = robot.state()
        try:
            survey.move(state.stamp, state.odom_from_base, read_imu(robot))
            if now >= self._due - 1e-6:
                self._due = now + self._turn
                cloud = read_lidar(robot, self.lidar)
                survey.add(cloud, self._frames.lookup(self._base, cloud.frame, cloud.stamp))
        except Failure as failure:
            if failure.code != SENSOR_DEAD:
                raise


def plan_band(description: RobotDescription) -> tuple[float, float]:
    """Lowest and highest point of what the floor plan has: the laser's band, but BAND wide, m."""
    low, high = laser_band(description)
    wider = max(0.0, BAND - (high - low)) / 2.0
    return max(raster.LOWEST, low - wider), high + wider


def _turn_of(description: RobotDescription, lidar: str) -> float:
    """Time between two turns that are mapped, s."""
    return description.lidar(lidar)[1].turn or 0.1
