"""The main job: a can goes from table A to table B, and the referee agrees."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import av
import pytest

SEED = 7
LISTED = {
    "tree", "world", "robot", "seed", "status", "success", "failure", "sim_time_s", "wall_time_s",
    "real_time_factor", "ticks", "blackboard", "nodes", "fingerprint", "versions",
}  # fmt: skip


@pytest.fixture
def done(run: Callable[..., Any], tmp_path: Path) -> Any:
    return run("bring_object", "--seed", str(SEED), "--video", tmp_path / "run.mp4")


def test_the_can_is_brought(done: Any, tmp_path: Path) -> None:
    assert done.code == 0, done.said
    report = done.report
    assert set(report) >= LISTED
    assert report["status"] == "SUCCESS"
    assert report["success"] is True
    assert report["failure"] is None
    assert report["ticks"] == pytest.approx(report["sim_time_s"] / 0.05, abs=1)
    ran = {node["type"]: node for node in report["nodes"] if node["runs"]}
    assert {"navigate", "detect_object", "pick", "find_apriltag", "detect_plane", "place"} <= set(
        ran
    )
    with av.open(str(tmp_path / "run.mp4")) as film:
        stream = film.streams.video[0]
        seconds = float(stream.duration * stream.time_base)
        assert seconds == pytest.approx(report["sim_time_s"], rel=0.2)
        assert stream.width * 9 == stream.height * 16
