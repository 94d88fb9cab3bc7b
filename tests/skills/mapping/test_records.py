"""Records in MCAP with JSON for viewers, as runs write them."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from mcap.writer import Writer
from momantu_skills.mapping.logs.log import LogError, LoggedScan
from momantu_skills.mapping.logs.reading import read_log

from momantu_bt.geometry import Pose2D
from tests.skills.mapping.walls import ANGLES, REACH, ROUND, driven, logged

WAY = logged(driven(ROUND[:2], 0.5), 3)
SCAN, TF = "foxglove.LaserScan", "foxglove.FrameTransforms"


def _stamp(seconds: float) -> dict[str, int]:
    return {"sec": int(seconds), "nsec": round(seconds % 1.0 * 1e9)}


def _frame(parent: str, child: str, stamp: float, pose: Pose2D) -> dict[str, Any]:
    half = pose.yaw / 2
    return {
        "timestamp": _stamp(stamp),
        "parent_frame_id": parent,
        "child_frame_id": child,
        "translation": {"x": pose.x, "y": pose.y, "z": 0.0},
        "rotation": {"x": 0.0, "y": 0.0, "z": math.sin(half), "w": math.cos(half)},
    }


def _scan(each: LoggedScan) -> dict[str, Any]:
    return {
        "timestamp": _stamp(each.stamp),
        "frame_id": "laser",
        "start_angle": float(ANGLES[0]),
        "end_angle": float(ANGLES[-1]),
        "ranges": np.where(each.rays.hit, each.rays.ranges, 2.5 * REACH).tolist(),
    }


def written(path: Path, *, scans: bool = True, frames: bool = True, topic: str = "/scan/a") -> Path:
    """A record of the way."""
    with path.open("wb") as file:
        writer = Writer(file, chunk_size=5000)
        writer.start()
        channels = {}
        for kind, name in ((SCAN, topic), (TF, "/tf")):
            schema = writer.register_schema(kind, "jsonschema", b"{}")
            channels[kind] = writer.register_channel(name, "json", schema)

        def add(kind: str, stamp: float, content: Any) -> None:
            at = round(stamp * 1e9)
            writer.add_message(channels[kind], at, json.dumps(content).encode(), at)

        mount = _frame("base_link", "laser", 0.0, Pose2D(0.2, 0.0))
        for n, each in enumerate(WAY):
            moved = _frame("odom", "base_link", each.stamp, each.odom_from_base)
            if frames:
                add(TF, each.stamp, {"transforms": [moved] if n else [mount, moved]})
            if scans:
                add(SCAN, each.stamp, _scan(each))
        writer.finish()
    return path


@pytest.mark.parametrize("folder", [True, False])
def test_a_record_gives_back_what_was_recorded(folder: bool, tmp_path: Path) -> None:
    path = written(tmp_path / "run.mcap")
    found = read_log(tmp_path if folder else path)
    assert len(found.scans) == len(WAY)
    assert found.notes == ()
    for read, true in zip(found.scans, WAY, strict=True):
        assert read.odom_from_base.distance_to(true.odom_from_base) < 1e-9
        assert np.array_equal(read.rays.hit, true.rays.hit)
        assert np.abs(read.rays.points() - true.rays.points()).max() < 1e-9


def test_a_record_that_was_cut_off_is_read_as_far_as_it_goes(tmp_path: Path) -> None:
    path = written(tmp_path / "run.mcap")
    whole = path.read_bytes()
    path.write_bytes(whole[: len(whole) // 2])
    found = read_log(path)
    assert 0 < len(found.scans) < len(WAY)
    assert "cut off" in found.notes[0]


def test_what_a_record_lacks_is_told(tmp_path: Path) -> None:
    with pytest.raises(LogError, match="holds no scans; expected messages foxglove.LaserScan"):
        read_log(written(tmp_path / "a.mcap", scans=False))
    found = read_log(written(tmp_path / "b.mcap", frames=False))
    assert "nothing tells how the base moved, so the scans do" in found.notes[0]
    with pytest.raises(LogError, match="has no scans on 'front'; it has /scan/a"):
        read_log(written(tmp_path / "c.mcap"), "front")
    (tmp_path / "d.mcap").write_bytes(b"\x89MCAP0\r\nnothing more")
    with pytest.raises(LogError, match="cannot be read"):
        read_log(tmp_path / "d.mcap")
