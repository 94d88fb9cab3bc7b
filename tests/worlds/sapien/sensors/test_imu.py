"""The IMU tells turning and specific force, with the noise and bias that it is said to have."""

from __future__ import annotations

import math

import numpy as np
import pytest
from momantu_worlds.robots import kinova_jackal
from momantu_worlds.sapien.config import ImuErrors
from momantu_worlds.sapien.sensors.imu import AT_REST, Imu, Moving
from momantu_worlds.sapien.simulator import Simulator
from momantu_worlds.testing import plain_episode

from momantu_bt.geometry import matrix_from_quaternion, quaternion_from_rpy
from momantu_bt.messages import BaseVelocity, ImuReading
from momantu_bt.robot import ImuSensor, read_imu

ROBOT = kinova_jackal()
NAME, SENSOR = ROBOT.imu()
STEP = 1 / 240


def at_rest(tilt: float = 0.0) -> Moving:
    turned = matrix_from_quaternion(quaternion_from_rpy(0.0, tilt, 0.0))
    return Moving(turned, np.zeros(3), np.zeros(3))


def sampled(moving: Moving, errors: ImuErrors, seconds: float, seed: int = 1) -> ImuReading:
    """All samples of so many seconds, as one reading."""
    sensor = ImuSensor(frame="base_link", rate=120)
    imu = Imu(lambda: moving, "imu", sensor, seed, errors)
    found: dict[float, tuple[np.ndarray, np.ndarray]] = {}
    imu.read(0.0)
    for step in range(1, round(seconds / STEP) + 1):
        imu.collect(step * STEP)
        if step % 12 == 0:
            reading = imu.read(step * STEP)
            values = zip(reading.times, reading.rates, reading.forces, strict=True)
            found.update({float(t): (rate, force) for t, rate, force in values})
    rates, forces = (np.array(each) for each in zip(*found.values(), strict=True))
    return ImuReading(max(found), "base_link", np.array(list(found)), rates, forces)


def test_noise_has_the_density_that_is_said() -> None:
    errors = ImuErrors(rate_bias=0.0, force_bias=0.0)
    told = sampled(at_rest(), errors, 20.0)
    assert len(told.times) == 20 * 120 + 1
    assert told.rates.std() == pytest.approx(errors.rate_noise * math.sqrt(120), rel=0.05)
    spread = (told.forces - AT_REST).std()
    assert spread == pytest.approx(errors.force_noise * math.sqrt(120), rel=0.05)
    assert np.abs(told.rates.mean(axis=0)).max() < 4 * errors.rate_noise / math.sqrt(20.0)


def test_biases_are_constant_in_an_episode_and_differ_between_seeds() -> None:
    errors = ImuErrors(rate_noise=0.0, force_noise=0.0)
    all_rates, all_forces = [], []
    for seed in range(200):
        told = sampled(at_rest(), errors, 0.1, seed)
        assert np.ptp(told.rates, axis=0) == pytest.approx(0.0)
        all_rates.append(told.rates[0])
        all_forces.append(told.forces[0] - AT_REST)
    assert np.std(all_rates) == pytest.approx(errors.rate_bias, rel=0.1)
    assert np.std(all_forces) == pytest.approx(errors.force_bias, rel=0.1)


def test_gravity_is_felt_along_the_axes_of_a_tilted_frame() -> None:
    none = ImuErrors(0.0, 0.0, 0.0, 0.0)
    force = sampled(at_rest(0.2), none, 0.1).forces[-1]
    assert force == pytest.approx([-9.81 * math.sin(0.2), 0.0, 9.81 * math.cos(0.2)])


def test_a_robot_that_drives_a_curve_is_pushed_inwards() -> None:
    simulator = Simulator(ROBOT, plain_episode(table=False), 3, render=False)
    read_imu(simulator.robot)
    for _ in range(60):
        simulator.robot.command("base", BaseVelocity(0.5, 0.8))
        simulator.step()
    told = read_imu(simulator.robot)
    errors = simulator.config.imu
    assert told.rates[:, 2].mean() == pytest.approx(0.8, abs=4 * errors.rate_bias)
    assert told.forces[:, 1].mean() == pytest.approx(0.4, abs=4 * errors.force_bias)
    assert np.diff(told.times) == pytest.approx(1 / SENSOR.rate)
    assert told.times[-1] == told.stamp == pytest.approx(simulator.now())


def test_braking_is_felt_backwards() -> None:
    simulator = Simulator(ROBOT, plain_episode(table=False), 3, render=False)
    for _ in range(30):
        simulator.robot.command("base", BaseVelocity(0.5, 0.0))
        simulator.step()
    read_imu(simulator.robot)
    simulator.robot.stop("base")
    for _ in range(4):
        simulator.step()
    assert read_imu(simulator.robot).forces[1:, 0].mean() < -0.5


def test_nothing_is_computed_until_it_is_asked() -> None:
    simulator = Simulator(ROBOT, plain_episode(table=False), 3, render=False)
    simulator.step()
    imu = simulator.robot.sensors[NAME]
    assert isinstance(imu, Imu)
    assert not imu.asked
    assert len(read_imu(simulator.robot).times) == 1
