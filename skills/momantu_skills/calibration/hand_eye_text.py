"""A hand-eye calibration as lines for a person and as plain data for JSON."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from momantu_bt.geometry import Transform
from momantu_skills.calibration.hand_eye.estimate import JOINT, Method
from momantu_skills.calibration.recorded import Calibration

_MOST_OUTLIERS = 12


def lines(found: Calibration) -> list[str]:
    """The result for a terminal, without notes."""
    return [*_data(found), "", *_table(found), "", *_mounting(found), "", *_outliers(found)]


def _data(found: Calibration) -> list[str]:
    where = "eye on base" if found.settings.on_base else "eye in hand"
    said = [
        f"{where}: {len(found.views)} different views, of {found.matched} poses of the target with "
        f"the hand's pose, of {found.samples} in {found.target.name}"
    ]
    if found.settings.align:
        said.append(
            f"time offset: {found.offset:.4f} s, to add to the stamps of {found.target.name}"
        )
    return said


def _table(found: Calibration) -> list[str]:
    joint = found.estimate.refined.mounting.eye
    rows = ["method       residual, held back     away from the result"]
    for method in found.estimate.methods:
        if method.eye is None:
            rows.append(f"{method.name:<10}  gives no result")
            continue
        row = f"{method.name:<10}  {_both(method.rotation, method.position)}"
        if method.name == JOINT:
            rows.append(f"{row}   the result")
            continue
        apart = float(np.linalg.norm(method.eye.position - joint.position))
        rows.append(f"{row}   {_both(method.eye.angle_to(joint), apart)}")
    rows.append("Residuals: median over all views, each held back in one of five rounds.")
    return rows


def _both(angle: float, distance: float) -> str:
    if math.isnan(angle):
        return f"{'none':>21}"
    return f"{math.degrees(angle):8.3f} deg {1e3 * distance:8.2f} mm"


def _mounting(found: Calibration) -> list[str]:
    refined = found.estimate.refined
    mounting, settings = refined.mounting, found.settings
    rotation, position = refined.rotation_deviations, refined.position_deviations
    turned = _numbers(np.degrees(rotation), 3)
    rpy = Rotation.from_matrix(mounting.eye.rotation).as_euler("xyz")
    return [
        f"{settings.carrier}_from_camera",
        f"  position         {_numbers(mounting.eye.position, 5)} m",
        f"  quaternion_wxyz  {_numbers(mounting.eye.quaternion, 6)}",
        f"  in a URDF        xyz={_quoted(mounting.eye.position)} rpy={_quoted(rpy)}",
        f"  standard deviations: {_numbers(1e3 * position, 2)} mm along x y z of the "
        f"{settings.carrier}, {turned} deg about x y z of the camera",
        f"{settings.holder}_from_target",
        f"  position         {_numbers(mounting.target.position, 5)} m",
        f"  quaternion_wxyz  {_numbers(mounting.target.quaternion, 6)}",
        _noise(found),
    ]


def _noise(found: Calibration) -> str:
    noise, settings = found.estimate.refined.noise, found.settings
    frames = ("target", "camera", settings.carrier, settings.holder)
    parts = sorted(zip(noise.shares, frames, strict=True), reverse=True)
    where = ", ".join(
        f"{100 * share:.0f} % at the {frame}" for share, frame in parts if share > 0.1
    )
    return (
        f"noise per axis: {math.degrees(noise.rotation):.3f} deg, {1e3 * noise.position:.2f} mm at "
        f"the target; turns act {where}"
    )


def _outliers(found: Calibration) -> list[str]:
    wrong = np.flatnonzero(found.estimate.refined.outliers)
    if not len(wrong):
        return ["outliers: none"]
    said = [
        f"outliers, without influence: {len(wrong)} of {len(found.views)} views, in "
        f"{found.target.name}"
    ]
    for index in wrong[:_MOST_OUTLIERS]:
        residual = _both(found.estimate.rotations[index], found.estimate.positions[index])
        said.append(f"  line {found.lines[index]:<6}{residual}")
    if len(wrong) > _MOST_OUTLIERS:
        said.append(f"  and {len(wrong) - _MOST_OUTLIERS} more; --json names all")
    return said


def plain(found: Calibration, notes: list[str]) -> dict[str, Any]:
    """The result as plain data, in SI."""
    refined, settings = found.estimate.refined, found.settings
    frames = ("target", "camera", settings.carrier, settings.holder)
    return {
        f"{settings.carrier}_from_camera": {
            **_plain(refined.mounting.eye),
            "position_deviations": _list(refined.position_deviations),
            "rotation_deviations": _list(refined.rotation_deviations),
        },
        f"{settings.holder}_from_target": _plain(refined.mounting.target),
        "views": len(found.views),
        "time_offset": found.offset,
        "noise": {
            "rotation": refined.noise.rotation,
            "position": refined.noise.position,
            "acts_at": dict(zip(frames, _list(refined.noise.shares), strict=True)),
        },
        "methods": [_plain_method(each) for each in found.estimate.methods],
        "residuals": [
            {
                "line": int(line),
                "rotation": float(turned),
                "position": float(away),
                "outlier": bool(wrong),
            }
            for line, turned, away, wrong in zip(
                found.lines,
                found.estimate.rotations,
                found.estimate.positions,
                refined.outliers,
                strict=True,
            )
        ],
        "outliers": [int(line) for line in found.lines[refined.outliers]],
        "notes": notes,
    }


def _plain(transform: Transform) -> dict[str, Any]:
    return {
        "position": _list(transform.position),
        "quaternion_wxyz": _list(transform.quaternion),
    }


def _plain_method(method: Method) -> dict[str, Any]:
    failed = method.eye is None or math.isnan(method.rotation)
    return {
        "name": method.name,
        "rotation_residual": None if failed else method.rotation,
        "position_residual": None if failed else method.position,
        **({} if method.eye is None else _plain(method.eye)),
    }


def _list(values: Any) -> list[float]:
    return [float(value) for value in values]


def _numbers(values: Any, digits: int) -> str:
    return " ".join(f"{value + 0.0:.{digits}f}" for value in values)


def _quoted(values: Any) -> str:
    return f'"{_numbers(values, 6)}"'
