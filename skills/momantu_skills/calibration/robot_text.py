"""A robot's calibration as lines for a person and as plain data, and what is worth a doubt."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from momantu_bt.geometry import Array
from momantu_skills.calibration.robot.estimate import Calibrated
from momantu_skills.calibration.robot.parameters import mounted

_FEW = 20
_BAD_PIXEL = 1.0
_SHOWN = {"rad": (180.0 / np.pi, "deg"), "m": (1000.0, "mm"), "": (100.0, "%")}


def lines(found: Calibrated) -> Iterator[str]:
    """The result for a terminal."""
    views, solution = found.views, found.solution
    pictures = len(np.unique(views.lines))
    yield f"{found.robot.name}: {pictures} views of {found.camera} show {len(views.tag_ids)} tags"
    on_hand = [str(i) for i, held in zip(views.tag_ids, found.in_hand, strict=True) if held]
    still = [str(i) for i, held in zip(views.tag_ids, found.in_hand, strict=True) if not held]
    yield f"on the hand: tag {', '.join(on_hand) or 'none'}; standing: {', '.join(still) or 'none'}"
    yield f"corners fit to {solution.pixel:.2f} px"
    yield from _outliers(found)
    yield ""
    parameters, deviations = found.parameters, np.sqrt(np.diag(solution.covariance))
    width = max(map(len, parameters.names))
    for i, (name, unit) in enumerate(zip(parameters.names, parameters.units, strict=True)):
        factor, shown = _SHOWN[unit]
        if not found.free[i]:
            continue
        value, deviation = factor * solution.state.told[i], factor * deviations[i]
        alone = "  the views do not tell" if (name,) in found.untold else ""
        yield f"  {name:<{width}}  {value:+9.3f} ± {deviation:.3f} {shown}{alone}"
    yield ""
    yield _held_back(found)


def _outliers(found: Calibrated) -> Iterator[str]:
    out = np.flatnonzero(~found.solution.used)
    if len(out):
        views = found.views
        named = [f"line {views.lines[i]} (tag {views.tag_ids[views.tags[i]]})" for i in out]
        yield f"sightings that do not fit and do not count: {', '.join(named)}"


def _held_back(found: Calibrated) -> str:
    held = found.held_back
    if not len(held.before):
        return "no view could be held back to check the result"
    which = "the tags on the hand" if held.hand else "the tags"
    return (
        f"{len(held.before)} sightings held back: {which} are off by "
        f"{1000 * np.median(held.before):.1f} mm before and {1000 * np.median(held.after):.1f} mm "
        f"after (median; at most {1000 * held.before.max():.1f} and {1000 * held.after.max():.1f})"
    )


def notes(found: Calibrated) -> Iterator[str]:
    """Sentences for a person, each with what to do."""
    solution, held = found.solution, found.held_back
    for group in found.untold:
        if len(group) > 1:
            yield (
                f"the views cannot tell apart: {', '.join(group)}; the correction is shared out "
                "among them, which is right for postures like those of the views"
            )
    alone = [group[0] for group in found.untold if len(group) == 1]
    if alone:
        yield (
            f"the views do not tell: {', '.join(alone)}; they stay nearly as described. Views with "
            "other postures of head and arm, other stands of the base and more tags tell more"
        )
    if not found.in_hand.any():
        yield "no tag moves with the hand: joints that do not move the camera were not calibrated"
    if not found.views.drives:
        yield "the base did not drive between the views: nothing is said about its wheels"
    pictures = len(np.unique(found.views.lines))
    if pictures < _FEW:
        yield f"{pictures} views are few; 30 or more are good"
    if solution.pixel > _BAD_PIXEL:
        yield (
            f"corners fit to {solution.pixel:.1f} px only: calibrate the lens first, stand still "
            "for each view, and fix the tags well"
        )
    if len(held.before) and np.median(held.after) > np.median(held.before):
        yield "the views held back fit no better after: the robot may need no correction"


def plain(found: Calibrated, doubts: list[str]) -> dict[str, Any]:
    """The result for a program: SI units."""
    solution, parameters = found.solution, found.parameters
    deviations = np.sqrt(np.diag(solution.covariance))
    return {
        "robot": found.robot.name,
        "camera": found.camera,
        "views": len(np.unique(found.views.lines)),
        "pixel": solution.pixel,
        "parameters": {
            name: {
                "unit": unit or "factor minus 1",
                "correction": float(solution.state.told[i]),
                "deviation": float(deviations[i]),
                "estimated": bool(found.free[i]),
            }
            for i, (name, unit) in enumerate(zip(parameters.names, parameters.units, strict=True))
        },
        "joint_zeros": zeros(found),
        "camera_from_corrected_camera": {
            key: [float(v) for v in value]
            for key, value in zip(("xyz", "rotation_vector"), mounting(found), strict=True)
        },
        "not_told_apart": [list(group) for group in found.untold],
        "tags_on_hand": [
            i for i, held in zip(found.views.tag_ids, found.in_hand, strict=True) if held
        ],
        "outliers": [int(line) for line in found.views.lines[~solution.used]],
        "held_back": {
            "before": found.held_back.before.tolist(),
            "after": found.held_back.after.tolist(),
        },
        "notes": doubts,
    }


def zeros(found: Calibrated) -> dict[str, float]:
    """What is added to each joint's reported position, rad or m."""
    told = found.solution.state.told
    names = found.parameters.joints
    return {name: float(told[i]) for i, name in enumerate(names) if found.free[i]}


def mounting(found: Calibrated) -> tuple[Array, Array]:
    """Position (3,), m, and rotation vector (3,), rad, of the true camera in the described one."""
    mount = found.solution.state.told[found.parameters.mount]
    return mounted(mount).position, np.asarray(mount[:3])
