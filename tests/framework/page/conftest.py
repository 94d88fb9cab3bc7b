"""Runs that were never run: a record is built by hand, so that every part of it is known."""

import base64
import io
import json
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

from momantu_bt.failure import FailureValue
from momantu_bt.geometry import Pose2D
from momantu_bt.messages import plain
from momantu_bt.record.codec import to_json
from momantu_bt.record.recording import ChangeRecord, NodeInfo, Recording, TickRecord
from momantu_bt.world import Site, Surface

TREE = """\
momantu_bt: 1
trees:
  Bring:
    - GoTo: {surface: table_a}
    - recover:
        attempts: 2
        try: {pick: {object: $found}}
        catch: {GRASP_MISSED: {reset_pose: ready}}
"""


NODES = (
    ("Bring", "Bring", 0, None, "Bring", 4),
    ("GoTo", "GoTo", 1, 0, "GoTo surface table_a", 4),
    ("navigate", "navigate", 2, 1, "navigate in_front_of table_a", 4),
    ("recover", "Recover", 1, 0, "recover with 2 tries", 5),
    ("pick", "pick", 2, 3, "pick object $found", 7),
    ("reset_pose", "reset_pose", 2, 3, "reset_pose ready", 8),
)
MISSED = FailureValue(
    "GRASP_MISSED", "the fingers closed on nothing", {"width": 0.0}, "pick", "bring.yaml:7"
)
RECOVERED = FailureValue(
    "GRASP_MISSED",
    "the fingers closed on nothing",
    node="recover",
    place="bring.yaml:5",
    cause=MISSED,
    tries=2,
    most_tries=2,
)
TOP = FailureValue(
    "GRASP_MISSED",
    "the fingers closed on nothing",
    node="Bring",
    place="bring.yaml:4",
    cause=RECOVERED,
)
STORY: Mapping[int, Sequence[tuple[int, str, str, FailureValue | None]]] = {
    0: [(2, "RUNNING", "plan", None), (1, "RUNNING", "", None), (0, "RUNNING", "", None)],
    4: [(2, "RUNNING", "follow", None)],
    40: [
        (2, "SUCCESS", "", None),
        (1, "SUCCESS", "", None),
        (4, "RUNNING", "reach", None),
        (3, "RUNNING", "1 of 2 tries", None),
    ],
    60: [(4, "FAILURE", "", MISSED), (3, "RUNNING", "GRASP_MISSED", None)],
    61: [(5, "RUNNING", "", None)],
    80: [(5, "SUCCESS", "", None)],
    81: [(4, "RUNNING", "reach", None), (3, "RUNNING", "2 of 2 tries", None)],
    99: [(4, "FAILURE", "", MISSED), (3, "FAILURE", "", RECOVERED), (0, "FAILURE", "", TOP)],
}
"""By tick: node, status, note, failure. Six nodes drive, grasp twice in vain, and give up."""


def jpeg(shade: int) -> str:
    out = io.BytesIO()
    Image.new("RGB", (32, 24), (shade, 90, 160)).save(out, "JPEG")
    return base64.b64encode(out.getvalue()).decode("ascii")


def _channels(ticks: int) -> dict[str, Any]:
    cells = np.full((60, 80), 255, dtype=np.uint8)
    cells[10:50, 10:70] = 0
    cells[10, 10:70] = cells[49, 10:70] = cells[10:50, 10] = cells[10:50, 69] = 100
    upright = {"x": 0.0, "y": 0.0, "z": 0.0, "w": 1.0}

    def pose(x: float, y: float) -> dict[str, Any]:
        return {"position": {"x": x, "y": y, "z": 0.0}, "orientation": upright}

    grid = {
        "frame_id": "map",
        "pose": pose(-4.0, -3.0),
        "column_count": 80,
        "row_stride": 80,
        "cell_size": {"x": 0.1, "y": 0.1},
        "data": base64.b64encode(cells.tobytes()).decode("ascii"),
    }
    transform = {
        "parent_frame_id": "map",
        "child_frame_id": "odom",
        "rotation": upright,
        "translation": {"x": 1.0, "y": 0.0, "z": 0.0},
    }
    can = {
        "frame_id": "odom",
        "id": "found",
        "texts": [{"text": "can"}],
        "cubes": [],
        "cylinders": [{"pose": pose(0.5, 1.0), "size": {"x": 0.07, "y": 0.07, "z": 0.13}}],
    }
    held = {**can, "frame_id": "gripper_link", "id": "held"}
    path = [
        (0.05 * i, {"frame_id": "map", "pose": pose(-2.0 + 0.04 * i, 0.01 * i)})
        for i in range(0, ticks, 4)
    ]
    return {
        "/map": [(0.0, grid)],
        "/pose": [(0.0, {"frame_id": "odom", "pose": pose(9.0, 9.0)}), *path],
        "/tf": [(0.0, {"transforms": [transform]})],
        "/objects": [
            (1.0, {"deletions": [], "entities": [can]}),
            (4.0, {"deletions": [{"id": "found"}], "entities": [held]}),
        ],
        "/camera/head": [
            (t, {"format": "jpeg", "data": jpeg(40 * i)}) for i, t in enumerate((0.0, 1.0, 3.0))
        ],
        "/service/localization": [
            (0.0, {"quality": 0.9}),
            (0.2, {"quality": 0.9}),
            (0.4, {"quality": 0.5}),
        ],
    }


def build(
    *, nodes: Sequence[Any] = NODES, story: Any = STORY, ticks: int = 100, **changed: Any
) -> Recording:
    """The run that STORY tells, 100 ticks of 0.05 s; `changed`: fields that are otherwise."""
    site = Site(
        "room",
        places={"dock": Pose2D(-3.0, -1.0, 0.0)},
        surfaces={"table_a": Surface(Pose2D(1.5, 1.0, 0.3), (0.8, 1.5), 0.7, (0.0,))},
    )
    writes = {1: (("found", "a can"),), 30: (("n", 1), ("found", Pose2D(1.23456, 0.5, 0.0)))}
    report = {
        "tree": "trees/bring.yaml",
        "world": "four_rooms",
        "robot": "fetch",
        "seed": 3,
        "ticks": ticks,
        "sim_time_s": 4.95,
        "start_time_s": 0.5,
        "status": "FAILURE",
        "success": False,
        "unmet": ["the can is elsewhere"],
        "error": None,
        "failure": plain(TOP.as_dict()),
        "wall_time_s": 1.5,
        "fingerprint": "ab" * 32,
        "nodes": [{"runs": i + 1, "failures": i} for i in range(len(nodes))],
    }
    fields: dict[str, Any] = {
        "folder": Path("run1"),
        "about": {
            "tree": "trees/bring.yaml",
            "seed": 3,
            "world": "four_rooms",
            "robot": "fetch",
            "versions": {"momantu-bt": "1.0"},
            "options": {"max_time": 600.0},
            "values": {},
        },
        "files": {"bring.yaml": TREE, "site.json": json.dumps(to_json(site))},
        "nodes": tuple(
            NodeInfo(i, name, kind, f"bring.yaml:{line}", depth, parent, label)
            for i, (name, kind, depth, parent, label, line) in enumerate(nodes)
        ),
        "ticks": tuple(
            TickRecord(
                i + 1,
                0.05 * i,
                tuple(ChangeRecord(*c) for c in story.get(i, ())),
                writes.get(i, ()),
            )
            for i in range(ticks)
        ),
        "report": report,
        "complete": True,
        "raw": raw(_channels(ticks)),
    }
    return Recording(**{**fields, **changed})


def raw(channels: Mapping[str, Sequence[tuple[float, Any]]]) -> dict[str, Any]:
    """Messages as a record keeps them."""
    return {
        topic: tuple((time, json.dumps(message).encode()) for time, message in messages)
        for topic, messages in channels.items()
    }


@pytest.fixture(scope="session")
def recording() -> Callable[..., Recording]:
    """A function that builds a record: see `build`."""
    return build
