"""From the lines of a file of views to a robot's corrections, checked on views held back."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from momantu_bt.formats import urdf
from momantu_bt.formats.names import valid_names
from momantu_bt.geometry import Array
from momantu_bt.robot import ARM, CameraSensor, RobotDescription
from momantu_bt.wheels import between_wheels
from momantu_skills.calibration.errors import CalibrationError
from momantu_skills.calibration.robot.model import Model
from momantu_skills.calibration.robot.parameters import Parameters
from momantu_skills.calibration.robot.rows import Row
from momantu_skills.calibration.robot.solve import Solution, solve
from momantu_skills.calibration.robot.start import start
from momantu_skills.calibration.robot.telling import untold
from momantu_skills.calibration.robot.views import Views, gather
from momantu_skills.manipulation.model.batched import BatchedChain

_HELD_BACK = 5
"""Every fifth view is held back."""
_LOST, _WORST = 0.5, 8.0
"""With more outliers than this share, or corners off by more pixels, the views do not fit."""


@dataclass(frozen=True, slots=True, eq=False)
class Settings:
    """What a person may say. camera: a sensor's name; None: the first one.

    held: tags that move with the hand; None: finds out. track: m between the wheels; None: from
    the URDF. keep: names of parameters that do not change.
    """

    camera: str | None = None
    held: tuple[int, ...] | None = None
    track: float | None = None
    keep: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True, eq=False)
class HeldBack:
    """Tags of views held back: how far from where they were seen, before and after.

    before, after: (n,) m, across the line of sight. hand: whether only tags on the hand count.
    """

    before: Array
    after: Array
    hand: bool


@dataclass(frozen=True, slots=True, eq=False)
class Calibrated:
    """A robot's corrections. free: (P,), which parameters the views are about."""

    robot: RobotDescription
    camera: str
    frame: str
    views: Views
    parameters: Parameters
    in_hand: NDArray[np.bool_]
    free: NDArray[np.bool_]
    solution: Solution
    untold: list[tuple[str, ...]]
    held_back: HeldBack


def calibrate(rows: Sequence[Row], robot: RobotDescription, settings: Settings) -> Calibrated:
    """Estimate zeros, mounting, lens and wheels from views.

    Raises:
        CalibrationError: the views do not allow it.
    """
    name, frame = _camera(robot, settings.camera)
    camera = BatchedChain(robot, frame)
    tip = _tip(robot)
    hand = None if tip is None else BatchedChain(robot, tip)
    chains = [camera] if hand is None else [camera, hand]
    views = gather(rows, robot, chains, name)
    parameters = Parameters(views.joints, _slides(robot), settings.track or between_wheels(robot))
    unknown = [tag for tag in settings.held or () if tag not in views.tag_ids]
    if unknown:
        seen = ", ".join(map(str, views.tag_ids))
        raise CalibrationError(f"no two views show the tag {unknown[0]}; they show: {seen}")
    model = Model(views, parameters, camera, hand, np.zeros(len(views.tag_ids), dtype=bool))
    state, in_hand = start(model, np.zeros(parameters.count), settings.held)
    model = Model(views, parameters, camera, hand, in_hand)
    free = _free(model, settings.keep)
    solution = solve(model, state, free)
    if solution.used.mean() < 1.0 - _LOST or solution.pixel > _WORST:
        raise CalibrationError(
            f"no calibration of {robot.name} explains the views: {(~solution.used).sum()} of "
            f"{len(views)} sightings fit not at all, the others to {solution.pixel:.0f} px. Is it "
            "this robot, are joints in rad and m, and did no tag move on the hand or on its place?"
        )
    told = untold(
        solution.information[np.ix_(free, free)],
        parameters.usual[free],
        [n for n, f in zip(parameters.names, free, strict=True) if f],
    )
    held_back = _held_back(model, solution, free)
    return Calibrated(
        robot, name, frame, views, parameters, in_hand, free, solution, told, held_back
    )


def _held_back(model: Model, solution: Solution, free: NDArray[np.bool_]) -> HeldBack:
    """Estimate with and without corrections from four fifths of the views; compare on the rest."""
    lines = np.unique(model.views.lines)
    out = np.isin(model.views.lines, lines[_HELD_BACK // 2 :: _HELD_BACK])
    hand = bool((model.in_hand[model.views.tags] & out & solution.used).any())
    judged = out & solution.used & (model.in_hand[model.views.tags] | (not hand))
    errors = []
    for allowed in (np.zeros_like(free), free):
        trained = model.of(~out)
        state, _ = start(trained, np.zeros(len(free)), held=_ids(model))
        found = solve(trained, state, allowed).state
        rest = model.of(judged)
        off = rest.pixels(found).mean(1)
        scale = rest.views.intrinsics[:, :2] / rest.depths(found)[:, None]
        errors.append(np.linalg.norm(off / scale, axis=1))
    return HeldBack(errors[0], errors[1], hand)


def _ids(model: Model) -> list[int]:
    return [i for i, held in zip(model.views.tag_ids, model.in_hand, strict=True) if held]


def _free(model: Model, keep: Sequence[str]) -> NDArray[np.bool_]:
    """What the views can be about: chains that are seen, wheels that were driven."""
    parameters = model.parameters
    unknown = [name for name in keep if name not in parameters.names]
    if unknown:
        raise CalibrationError(
            f"there is no parameter {unknown[0]!r} to keep; "
            f"{valid_names(unknown[0], parameters.names, 'parameters')}"
        )
    moving = set(model.camera.names)
    if model.hand is not None and model.in_hand.any():
        moving |= set(model.hand.names)
    free = np.array([name not in keep for name in parameters.names])
    free[: len(parameters.joints)] &= [joint in moving for joint in parameters.joints]
    free[parameters.wheels] &= bool(model.views.drives)
    return free


def _camera(robot: RobotDescription, name: str | None) -> tuple[str, str]:
    if not any(isinstance(sensor, CameraSensor) for sensor in robot.sensors.values()):
        raise CalibrationError(f"the robot {robot.name} has no camera")
    try:
        found, sensor = robot.camera(name)
    except KeyError as error:
        raise CalibrationError(str(error.args[0])) from None
    return found, sensor.frame


def _tip(robot: RobotDescription) -> str | None:
    if robot.end_effector is not None:
        return robot.end_effector.frame
    return robot.groups[ARM].tip if ARM in robot.groups else None


def _slides(robot: RobotDescription) -> frozenset[str]:
    joints = urdf.read_urdf(robot.urdf).joints
    return frozenset(joint.name for joint in joints if joint.kind == "prismatic")
