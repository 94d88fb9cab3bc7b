"""Cameras, lasers and lidars: from `<sensor>` elements, or from the names of links."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass

from lxml import etree

from momantu_skills.robot_setup.urdf.skeleton import Skeleton

KINDS = {
    "camera": "camera",
    "depth": "camera",
    "depth_camera": "camera",
    "rgbd_camera": "camera",
    "rgbd": "camera",
    "wideanglecamera": "camera",
    "ray": "laser",
    "gpu_ray": "laser",
    "lidar": "laser",
    "gpu_lidar": "laser",
    "force_torque": "wrench",
}
"""Gazebo's types of sensors, mapped to this project's. A ray sensor of several rings is a lidar."""
OPTICAL = re.compile(r"optical", re.IGNORECASE)
NAMES = (
    ("camera", re.compile(r"(rgb|color|head|wrist|hand|^|_)_?(camera|cam|realsense|kinect)", re.I)),
    ("lidar", re.compile(r"velodyne|vlp|ouster|livox|lidar_?3d|3d_?lidar", re.I)),
    ("laser", re.compile(r"laser|hokuyo|sick|rplidar|lidar|base_scan", re.I)),
    ("wrench", re.compile(r"(force_?torque|wrench|_ft_?(sensor|tool|link)|ftsensor)", re.I)),
)
"""Usual names of links with a sensor, the more reliable ones first."""
NO_FRAME = re.compile(
    r"sonar|ultraso|infrared|cliff|screw|mount|bracket|cable|laser_?pointer|projector|button|imu",
    re.I,
)
"""Names of links that contain a sensor's name but are not sensors."""
RANGER = re.compile(
    r"sonar|ultraso|infrared|cliff|(^|_)(ir|us)_|range_?finder|bumper", re.IGNORECASE
)
"""Names of sensors that measure one distance ahead, which URDFs write as a ray sensor."""
NARROW = 1.0
"""Swept angle, rad, below which a ray sensor measures one distance ahead and scans nothing."""
PREFERRED = re.compile(r"rgb|color", re.IGNORECASE)
"""The preferred one of a camera's optical frames: that of a registered picture."""

DEPTH_KINDS = ("depth", "depth_camera", "rgbd_camera", "rgbd")
"""Gazebo's types of cameras that measure depth."""

PICTURE = (0.01, 3.09)
"""Range of horizontal fields of view of a flat picture, rad."""
PIXELS = (1, 100_000)
BEAMS = (2, 100_000)
RINGS = (1, 4096)
TURN = (-2 * math.pi, 2 * math.pi)
"""Range of directions of the first and the last beam, rad."""
STEEP = (-math.pi / 2, math.pi / 2)
"""Range of elevations of rings, rad."""
NEAR, FAR = (0.0, 5.0), (0.6, 10_000.0)
"""Ranges of the least and the largest measured distance of a laser, m."""
SECTOR = 0.01
"""Least swept angle of a laser, rad."""


@dataclass(frozen=True)
class FoundSensor:
    """A sensor. link: it sits there. optical: whether the link's axes are an optical frame's.

    written: whether a `<sensor>` element says so; otherwise the link's name does.
    The numbers are None where nothing says them: fov rad, width and height px, near and far m,
    angles rad, beams counts, rings rad. depth: whether it is written as a camera with depth.
    """

    kind: str
    link: str
    written: bool
    optical: bool = False
    fov: float | None = None
    size: tuple[int, int] | None = None
    near: float | None = None
    far: float | None = None
    angles: tuple[float, float] | None = None
    beams: int | None = None
    rings: tuple[float, ...] | None = None
    depth: bool = False


def find_sensors(
    document: etree._Element, skeleton: Skeleton, below: set[str]
) -> list[FoundSensor]:
    """Sensors on links of `below`, those that are written first; one per place and kind."""
    found = [s for s in _written(document, skeleton) if s.link in below]
    for kind, pattern in NAMES:
        if any(sensor.kind == kind for sensor in found):
            continue
        if kind == "laser" and any(sensor.kind == "lidar" for sensor in found):
            pattern = re.compile(r"laser|hokuyo|sick|base_scan", re.IGNORECASE)
        names = [n for n in skeleton.links if n in below and pattern.search(n)]
        names = [n for n in names if not NO_FRAME.search(n) and not RANGER.search(n)]
        if names:
            found += _by_name(kind, names, skeleton)
    return found


def _by_name(kind: str, names: list[str], skeleton: Skeleton) -> list[FoundSensor]:
    """One sensor per rigid piece whose links are called so."""
    places: dict[str, list[str]] = {}
    for name in names:
        places.setdefault(skeleton.rigid_root(name), []).append(name)
    return [
        FoundSensor(kind, link, written=False, optical=bool(OPTICAL.search(link)))
        for some in places.values()
        for link in [_best_frame(kind, some)]
    ]


def _best_frame(kind: str, names: list[str]) -> str:
    optical = [name for name in names if OPTICAL.search(name)]
    if kind == "camera" and optical:
        return next((name for name in optical if PREFERRED.search(name)), optical[0])
    return next((name for name in names if name.endswith(("frame", "link"))), names[0])


def _written(document: etree._Element, skeleton: Skeleton) -> list[FoundSensor]:
    found: dict[tuple[str, str], FoundSensor] = {}
    holders = [(g.get("reference"), g) for g in document.findall("gazebo")]
    holders += [(link.get("name"), link) for link in document.findall("link")]
    for link, holder in holders:
        for element in holder.findall("sensor"):
            sensor = _sensor(element, link or "", skeleton)
            if sensor is not None:
                found.setdefault((sensor.kind, sensor.link), sensor)
    for element in document.findall("sensor"):
        parent = element.find("parent")
        sensor = _sensor(element, "" if parent is None else parent.get("link", ""), skeleton)
        if sensor is not None:
            found.setdefault((sensor.kind, sensor.link), sensor)
    return list(found.values())


def _sensor(element: etree._Element, link: str, skeleton: Skeleton) -> FoundSensor | None:
    kind = KINDS.get(element.get("type", "").lower())
    for tag in ("camera", "ray", "lidar"):  # urdfdom names the kind by the element inside
        if kind is None and element.find(tag) is not None:
            kind = "camera" if tag == "camera" else "laser"
    if kind is None or link not in skeleton.links:
        return None
    if kind == "camera":
        return _camera(element, link, skeleton)
    if kind == "wrench":
        return FoundSensor(kind, link, written=True)
    laser = _laser(element, link)
    narrow = laser.angles is not None and laser.angles[1] - laser.angles[0] < NARROW
    if narrow or RANGER.search(element.get("name", "")) or RANGER.search(link):
        return None
    return laser


def _camera(element: etree._Element, link: str, skeleton: Skeleton) -> FoundSensor:
    width, height = (_number(element, f".//{side}", *PIXELS) for side in ("width", "height"))
    optical = [n for n in skeleton.rigid(link) if OPTICAL.search(n) and n in _near(skeleton, link)]
    frame = _best_frame("camera", optical) if optical else link
    return FoundSensor(
        "camera",
        frame,
        written=True,
        optical=bool(OPTICAL.search(frame)),
        fov=_number(element, ".//horizontal_fov", *PICTURE),
        size=(int(width), int(height)) if width and height else None,
        depth=element.get("type", "").lower() in DEPTH_KINDS,
    )


def _near(skeleton: Skeleton, link: str) -> set[str]:
    """The link, what it carries, and its siblings: one camera's frames."""
    above = skeleton.above(link)
    return set(skeleton.subtree(link if above is None or above.moving else above.parent))


def _laser(element: etree._Element, link: str) -> FoundSensor:
    low, high = (_number(element, f".//horizontal/{end}_angle", *TURN) for end in ("min", "max"))
    rings = int(_number(element, ".//vertical/samples", *RINGS) or 1)
    down, up = (
        _number(element, f".//vertical/{side}_angle", *STEEP) or 0.0 for side in ("min", "max")
    )
    beams = _number(element, ".//horizontal/samples", *BEAMS)
    near, far = _number(element, ".//range/min", *NEAR), _number(element, ".//range/max", *FAR)
    if near is not None and far is not None and near >= far:
        near, far = None, None
    swept = low is not None and high is not None and high - low > SECTOR
    step = (up - down) / max(rings - 1, 1)
    return FoundSensor(
        "lidar" if rings > 1 else "laser",
        link,
        written=True,
        near=near,
        far=far,
        angles=(low, high) if low is not None and high is not None and swept else None,
        beams=int(beams) if beams else None,
        rings=tuple(round(down + i * step, 6) for i in range(rings)) if rings > 1 else None,
    )


def _number(
    element: etree._Element, path: str, least: float = -math.inf, most: float = math.inf
) -> float | None:
    """A number at a path; None where there is none, or not a value that such a sensor can have."""
    found = element.find(path)
    try:
        value = float(found.text or "") if found is not None else math.nan
    except ValueError:
        return None
    return value if math.isfinite(value) and least <= value <= most else None
