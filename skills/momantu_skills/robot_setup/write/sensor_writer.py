"""Writing the sensors of a robot file."""

from __future__ import annotations

import math
from collections.abc import Iterator

from momantu_bt.geometry import Transform
from momantu_skills.robot_setup.find.cameras import OPTICAL_FROM_LINK
from momantu_skills.robot_setup.find.proposal import Proposal
from momantu_skills.robot_setup.find.sensors import FoundSensor
from momantu_skills.robot_setup.write.file_text import scalar

USUAL_FOV = 1.05
"""Default field of view, rad: 60 degrees."""
USUAL_SIZE = (640, 480)
USUAL_DEPTH = (0.3, 4.5)
"""Default depth range, m: what structured light measures indoors."""
USUAL_ANGLES = (-1.92, 1.92)
"""Default angles of a laser, rad: 110 degrees to each side."""
USUAL_BEAMS = 662
USUAL_RANGE = (0.05, 25.0)
"""Default range of a laser, m."""
USUAL_RINGS = tuple(round(math.radians(-15 + 2 * i), 4) for i in range(16))
"""Default elevations of a lidar's rings, rad; sixteen rings, two degrees apart."""
USUAL_COLUMNS = 900
MOST_RINGS, MOST_COLUMNS = 256, 100_000
BAND = (0.08, 0.5)
"""Heights above the floor of obstacles in a scan made from a lidar, m."""
LIDAR_SCAN = "scan_frame"
"""The level frame of a scan that is made from a lidar."""


def sensor_names(proposal: Proposal) -> dict[str, FoundSensor]:
    """Names of the sensors: the part that carries a camera, or the sensor's kind, with a number."""
    named: dict[str, FoundSensor] = {}
    for sensor in proposal.sensors:
        carrier = proposal.carriers.get(sensor.link, "")
        stem = sensor.kind
        if sensor.kind == "camera" and carrier:
            stem = f"{'hand' if carrier.startswith('arm') else carrier}_camera"
        name, count = stem, 1
        while name in named:
            count += 1
            name = f"{stem}_{count}"
        named[name] = sensor
    return named


def sensor_frames(proposal: Proposal) -> Iterator[tuple[str, tuple[str, Transform]]]:
    """Frames that sensors need and the URDF does not have: (name, (link, place on it))."""
    names = sensor_names(proposal)
    for name, sensor in names.items():
        if sensor.kind == "camera" and not sensor.optical:
            yield f"{name}_optical_frame", (sensor.link, OPTICAL_FROM_LINK)
    if _scan_source(names) is not None:
        yield LIDAR_SCAN, (proposal.base.frame, Transform())


def sensor_lines(proposal: Proposal) -> Iterator[str]:
    """The section `sensors`."""
    names = sensor_names(proposal)
    if not names:
        yield "# Look at it: no camera, laser or lidar was found in the URDF. Skills look with a"
        yield "# camera and drive with a laser; put their frames under `frames`."
        yield "sensors: {}"
        return
    yield "sensors:"
    for name, sensor in names.items():
        yield "  # From the URDF." if sensor.written else "  # Guessed from the link's name."
        yield f"  {name}:"
        lines = {"camera": _camera, "laser": _laser, "lidar": _lidar, "wrench": _wrench}
        yield from (f"    {line}" for line in lines[sensor.kind](name, sensor, proposal))
    if proposal.grasp is not None and not any(s.kind == "wrench" for s in names.values()):
        yield "  # Look at it: no force sensor was found. Where joint efforts tell the hand's load,"
        yield "  # add `wrench: {kind: wrench, frame: LINK}`: with it, things are set down softly."
    source = _scan_source(names)
    if source is not None:
        yield "  # Guessed: made from the lidar. Look at it: the robot must stay out of the band."
        yield "  laser:"
        yield f"    kind: laser\n    frame: {LIDAR_SCAN}\n    source: {source}"
        yield f"    band: [{BAND[0]:g}, {BAND[1]:g}]"
        yield "    angle_min: -3.1416\n    angle_max: 3.1416\n    beams: 720"
        yield f"    range_min: {USUAL_RANGE[0]:g}\n    range_max: {USUAL_RANGE[1]:g}"


def _scan_source(names: dict[str, FoundSensor]) -> str | None:
    if any(sensor.kind == "laser" for sensor in names.values()):
        return None
    return next((name for name, sensor in names.items() if sensor.kind == "lidar"), None)


def _camera(name: str, sensor: FoundSensor, proposal: Proposal) -> Iterator[str]:
    carrier = proposal.carriers.get(sensor.link, "")
    width, height = sensor.size or USUAL_SIZE
    yield "kind: camera"
    yield f"frame: {scalar(sensor.link) if sensor.optical else f'{name}_optical_frame'}"
    if carrier:
        yield f"carrier: {carrier}"
    yield f"width: {width}"
    yield f"height: {height}"
    yield _or_guess("horizontal_fov", sensor.fov, USUAL_FOV)
    yield f"min_depth: {USUAL_DEPTH[0]:g}    # guessed"
    yield f"max_depth: {USUAL_DEPTH[1]:g}    # guessed"


def _laser(name: str, sensor: FoundSensor, proposal: Proposal) -> Iterator[str]:
    low, high = sensor.angles or (None, None)
    yield "kind: laser"
    yield f"frame: {scalar(sensor.link)}"
    yield _or_guess("angle_min", low, USUAL_ANGLES[0])
    yield _or_guess("angle_max", high, USUAL_ANGLES[1])
    yield _or_guess("beams", sensor.beams, USUAL_BEAMS)
    yield _or_guess("range_min", sensor.near, USUAL_RANGE[0])
    yield _or_guess("range_max", sensor.far, USUAL_RANGE[1])


def _lidar(name: str, sensor: FoundSensor, proposal: Proposal) -> Iterator[str]:
    rings = sensor.rings or USUAL_RINGS
    rings = rings[:: math.ceil(len(rings) / MOST_RINGS)]
    guess = "" if sensor.rings else "    # guessed"
    beams = min(sensor.beams, MOST_COLUMNS) if sensor.beams else None
    yield "kind: lidar"
    yield f"frame: {scalar(sensor.link)}"
    yield f"elevations: [{', '.join(f'{ring:g}' for ring in rings)}]{guess}"
    yield _or_guess("columns", beams, USUAL_COLUMNS)
    yield _or_guess("range_min", sensor.near, 0.5)
    yield _or_guess("range_max", sensor.far, 100.0)


def _wrench(name: str, sensor: FoundSensor, proposal: Proposal) -> Iterator[str]:
    yield "kind: wrench"
    yield f"frame: {scalar(sensor.link)}"


def _or_guess(key: str, found: float | None, usual: float) -> str:
    return f"{key}: {usual:g}    # guessed" if found is None else f"{key}: {found:.6g}"
