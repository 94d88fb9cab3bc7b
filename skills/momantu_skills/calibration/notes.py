"""What is worth a doubt in a calibration that succeeded."""

from __future__ import annotations

import math

import numpy as np

from momantu_skills.calibration.errors import CalibrationError
from momantu_skills.calibration.hand_eye.refine import scale_of_target
from momantu_skills.calibration.hand_eye.spread import GOOD
from momantu_skills.calibration.recorded import Calibration
from momantu_skills.calibration.trajectory.time_offset import time_offset

_FEW = 12
_FAR = 0.4
"""m; a camera is rarely mounted farther from the hand."""
_FAR_WAY = 5.0
"""m between the ends of the hand's ways."""
_BADLY_KNOWN = math.radians(0.5), 0.005
_SCALE = 0.02
_MANY_WRONG = 0.3
_SAMPLES_FOR_OFFSET = 100
_SLOWEST_FOR_OFFSET = 0.2


def notes(found: Calibration) -> list[str]:
    """Sentences for a person, each with what to do."""
    each = [
        _few(found),
        _hardly_turned(found),
        _badly_known(found),
        _many_wrong(found),
        _scaled(found),
        _far_ways(found),
        _swapped(found),
        _behind(found),
        _late(found),
    ]
    return [note for note in each if note]


def _few(found: Calibration) -> str:
    count = len(found.views)
    return f"{count} views are few; 15 or more are good" if count < _FEW else ""


def _hardly_turned(found: Calibration) -> str:
    if found.turned[1] >= GOOD:
        return ""
    degrees = ", ".join(f"{math.degrees(angle):.1f}" for angle in found.turned)
    return f"the hand turns little, by {degrees} deg about three axes; turn it more about two"


def _badly_known(found: Calibration) -> str:
    refined = found.estimate.refined
    turned = float(np.linalg.norm(refined.rotation_deviations))
    moved = float(np.linalg.norm(refined.position_deviations))
    if turned < _BADLY_KNOWN[0] and moved < _BADLY_KNOWN[1]:
        return ""
    return (
        f"the result is uncertain by {math.degrees(turned):.2f} deg and {1e3 * moved:.1f} mm; "
        f"add views, and turn the hand more between them"
    )


def _many_wrong(found: Calibration) -> str:
    wrong = found.estimate.refined.outliers
    if wrong.mean() < _MANY_WRONG:
        return ""
    return (
        f"{wrong.sum()} of {len(wrong)} views disagree with the rest; find out why before you "
        f"trust the result"
    )


def _scaled(found: Calibration) -> str:
    scale, deviation = scale_of_target(found.views, found.estimate.refined)
    if abs(scale - 1.0) < max(_SCALE, 4.0 * deviation):
        return ""
    return (
        f"positions of the target fit better times {scale:.3f} (± {deviation:.3f}): is the size of "
        f"its squares or tags right, and the camera's focal length?"
    )


def _far_ways(found: Calibration) -> str:
    moves = float(np.linalg.norm(np.ptp(found.hand.positions, axis=0)))
    if moves < _FAR_WAY:
        return ""
    return f"the hand moves by {moves:.1f} m: are positions in metres?"


def _swapped(found: Calibration) -> str:
    mounting, settings = found.estimate.refined.mounting, found.settings
    eye = float(np.linalg.norm(mounting.eye.position))
    target = float(np.linalg.norm(mounting.target.position))
    far, near = (target, eye) if settings.on_base else (eye, target)
    if far < _FAR or near > far / 2:
        return ""
    return (
        f"the camera would be {eye:.2f} m from the {settings.carrier}, and the target "
        f"{target:.2f} m from the {settings.holder}. If it is the other way round, the two files "
        f"are swapped, or both are inverted; residuals do not show that"
    )


def _behind(found: Calibration) -> str:
    behind = found.views.camera_from_target.positions[:, 2] <= 0.0
    if behind.mean() < 0.5:
        return ""
    return (
        f"in {behind.sum()} of {len(behind)} views the target is behind the camera (z of "
        f"camera_from_target is not positive), unless its frame is no optical frame"
    )


def _late(found: Calibration) -> str:
    if found.settings.align:
        return ""
    for each in (found.hand, found.target):
        if len(each) < _SAMPLES_FOR_OFFSET or each.step > _SLOWEST_FOR_OFFSET:
            return ""
    try:
        offset = time_offset(found.hand, found.target)
    except CalibrationError:
        return ""
    if abs(offset) < 1.5 * max(found.hand.step, found.target.step):
        return ""
    return f"the motions fit best with clocks {offset:.3f} s apart: use --align-time"
