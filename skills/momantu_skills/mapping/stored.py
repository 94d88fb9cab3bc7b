"""What a map was made of, kept in one file beside it, so that mapping can go on later.

`survey.npz` is a zip of arrays in numpy's format; docs/mapping.md has them all. Submaps are not
kept: they are entered again from their scans.
"""

from __future__ import annotations

import io
import struct
import zipfile
import zlib
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from momantu_bt.errors import InputError
from momantu_bt.geometry import Array, Pose2D
from momantu_skills.mapping.logs.log import LoggedScan
from momantu_skills.mapping.loops import Loop
from momantu_skills.mapping.mapper import Graph
from momantu_skills.mapping.pose_graph import Match
from momantu_skills.mapping.survey import Known
from momantu_skills.navigation.map.sensing import Rays
from momantu_skills.navigation.matching.config import MatchingConfig
from momantu_skills.navigation.matching.scan import ScanPoints
from momantu_skills.navigation.matching.submap import Growing, Submap

VERSION = 1
_DAMAGED = (
    *(OSError, ValueError, KeyError, IndexError, TypeError, EOFError, OverflowError, MemoryError),
    *(zipfile.BadZipFile, zlib.error, struct.error, NotImplementedError),
)
"""What numpy and zipfile raise for an archive that is cut off or has other bytes in it."""
_NO_RAYS = Rays(np.zeros(2), np.zeros((0, 2)), np.zeros(0), np.zeros(0, dtype=bool))


def packed(known: Known) -> bytes:
    """The file's content; the same survey gives the same bytes."""
    graph, scans = known.graph, known.used
    numbers = {id(scan): number for number, scan in enumerate(known.read)}
    arrays: dict[str, Any] = {
        "version": np.array(VERSION),
        "stamps": np.array([scan.stamp for scan in known.read]),
        "odometry": _rows([scan.odom_from_base for scan in known.read]),
        "used": np.array([numbers[id(scan)] for scan in scans]),
        "sessions": np.flatnonzero([motion is None for motion in graph.motions]) + 1,
        "poses": _rows(graph.poses),
        "submaps": _rows(graph.origins),
        "ways": np.array(graph.ways),
        "finished": np.array(sorted(graph.finished), dtype=np.int64),
        "match_ends": np.array([(m.submap, m.scan, m.entered) for m in graph.matches]),
        "match_poses": _rows([match.pose for match in graph.matches]),
        "match_covariances": np.array([match.covariance for match in graph.matches]),
        "loop_ends": _pairs([(loop.older, loop.newer) for loop in graph.loops]),
        "loop_poses": _rows([loop.pose for loop in graph.loops]),
        "tried": _pairs(sorted(graph.tried)),
        **_beams([scan.rays for scan in scans]),
    }
    stream = io.BytesIO()
    np.savez_compressed(stream, **arrays)
    return stream.getvalue()


def read_stored(path: Path) -> Known:
    """Read a survey.

    Raises:
        InputError: it is no such file, or one of another version; the message says what to do.
    """
    try:
        with np.load(path, allow_pickle=False) as file:
            version = int(file["version"])
            if version != VERSION:
                raise InputError(
                    f"{path} is of version {version}, and this program reads version {VERSION}: "
                    "make the map anew"
                )
            arrays = {name: file[name] for name in file.files}
        return _known(arrays)
    except _DAMAGED as error:
        raise InputError(f"{path} is damaged, so the map cannot be extended: {error}") from None


def _known(arrays: Mapping[str, Any]) -> Known:
    rays = _rays(arrays)
    all_rays = dict(zip(arrays["used"].tolist(), rays, strict=True))
    odometry = _poses(arrays["odometry"])
    read = tuple(
        LoggedScan(float(stamp), pose, all_rays.get(number, _NO_RAYS))
        for number, (stamp, pose) in enumerate(zip(arrays["stamps"], odometry, strict=True))
    )
    used = tuple(read[number] for number in arrays["used"])
    matches = [
        Match(int(submap), int(scan), pose, covariance, bool(entered))
        for (submap, scan, entered), pose, covariance in zip(
            arrays["match_ends"],
            _poses(arrays["match_poses"]),
            arrays["match_covariances"],
            strict=True,
        )
    ]
    loops = [
        Loop(int(older), int(newer), pose)
        for (older, newer), pose in zip(
            arrays["loop_ends"], _poses(arrays["loop_poses"]), strict=True
        )
    ]
    graph = Graph(
        _poses(arrays["poses"]),
        _motions(used, set(arrays["sessions"].tolist())),
        matches,
        _poses(arrays["submaps"]),
        [float(way) for way in arrays["ways"]],
        loops,
        {(int(older), int(newer)) for older, newer in arrays["tried"]},
        _submaps(arrays["finished"].tolist(), matches, rays),
    )
    return Known(graph, read, used)


def _motions(used: Sequence[LoggedScan], sessions: set[int]) -> list[Pose2D | None]:
    """Odometry between the scans in use; None before the first scan of a further session."""
    return [
        None
        if number in sessions
        else used[number - 1].odom_from_base.inverse() @ used[number].odom_from_base
        for number in range(1, len(used))
    ]


def _submaps(
    finished: Sequence[int], matches: Sequence[Match], rays: Sequence[Rays]
) -> dict[int, Submap]:
    """Enter the scans of each finished submap again."""
    config, found = MatchingConfig(), {}
    scans = [ScanPoints.from_rays(each, config.longest) for each in rays]
    of: dict[int, list[Match]] = {number: [] for number in finished}
    for match in matches:
        if match.entered and match.submap in of:
            of[match.submap].append(match)
    for number, entered in of.items():
        growing = Growing(config)
        for match in entered:
            growing.add(match.pose, scans[match.scan])
        submap = growing.finished()
        if submap is not None:
            found[number] = submap
    return found


def _beams(rays: Sequence[Rays]) -> dict[str, Any]:
    """The beams of scans: ranges, NaN where nothing was hit, and the fans that scans share."""
    fans: dict[bytes, int] = {}
    fan_of, kept = [], []
    for each in rays:
        key = each.origin.tobytes() + each.directions.tobytes()
        if key not in fans:
            fans[key] = len(fans)
            kept.append(each)
        fan_of.append(fans[key])
    ranges = [np.where(each.hit, each.ranges, np.nan) for each in rays]
    return {
        "fan": np.array(fan_of, dtype=np.int32),
        "fan_sizes": np.array([len(each.directions) for each in kept]),
        "fan_origins": np.array([each.origin for each in kept]).reshape(-1, 2),
        "fan_directions": np.vstack([np.zeros((0, 2)), *(each.directions for each in kept)]),
        "ranges": np.concatenate([np.zeros(0), *ranges]).astype(np.float32),
    }


def _rays(arrays: Mapping[str, Any]) -> list[Rays]:
    sizes = arrays["fan_sizes"]
    directions = np.split(arrays["fan_directions"], np.cumsum(sizes)[:-1])
    fan = arrays["fan"]
    ranges = np.split(arrays["ranges"].astype(np.float64), np.cumsum(sizes[fan])[:-1])
    found = []
    for number, measured in zip(fan, ranges, strict=True):
        hit = np.isfinite(measured)
        if len(measured) != len(directions[number]):
            raise ValueError("a scan has another number of beams than its fan")
        origin = arrays["fan_origins"][number]
        found.append(Rays(origin, directions[number], np.where(hit, measured, 0.0), hit))
    return found


def _rows(poses: Sequence[Pose2D]) -> Array:
    """(n, 3) of x, y, yaw."""
    return np.array([(pose.x, pose.y, pose.yaw) for pose in poses]).reshape(-1, 3)


def _pairs(pairs: Sequence[tuple[int, int]]) -> Any:
    return np.array(pairs, dtype=np.int64).reshape(-1, 2)


def _poses(rows: Array) -> list[Pose2D]:
    return [Pose2D(float(x), float(y), float(yaw)) for x, y, yaw in rows]
