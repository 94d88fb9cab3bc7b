"""The site's floor plan, as map_server means it, in the record."""

import base64

import numpy as np
import pytest

from momantu_bt.testing import ScriptedWorld, scripted_site

YAML = """
image: map.pgm
resolution: 0.1
origin: [-1.0, 2.0, 0.0]
negate: 0
occupied_thresh: 0.65
free_thresh: 0.25
"""
PIXELS = np.array([[0, 254, 150], [254, 254, 0]], dtype=np.uint8)
"""Top row first: occupied, free, unknown; free, free, occupied."""

ALIKE = [
    b"P5\n# by hand\n3 2\n255\n" + PIXELS.tobytes(),
    b"P5 3 2 255 " + PIXELS.tobytes(),
    b"P2\n# plain\n3 2 # wide\n255\n0 254 150\n254 254 0\n",
    b"P2 3 2 100 0 100 60 100 100 0",
    b"P5 3 2 65535\n" + (PIXELS.astype(np.uint16) * 256).astype(">u2").tobytes(),
]
"""One floor plan, as different programs write it."""


def write(folder, picture=None):
    (folder / "map.pgm").write_bytes(ALIKE[0] if picture is None else picture)
    (folder / "map.yaml").write_text(YAML)
    return folder / "map.yaml"


@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("map.pgm", b"P2 3 2 255 0 0 0 0 0"),
        ("map.pgm", b"P5 30 20 255 xx"),
        ("map.pgm", None),
        ("map.yaml", b"image: map.pgm"),
        ("map.yaml", b"[1, 2]"),
        ("map.yaml", b"\xff"),
        ("map.yaml", b"{"),
        ("map.yaml", None),
    ],
)
def test_what_is_no_floor_plan_is_told_and_the_run_goes_on(record_run, tmp_path, name, content):
    file = write(tmp_path)
    (tmp_path / name).unlink()
    if content is not None:
        (tmp_path / name).write_bytes(content)
    world = ScriptedWorld(site=scripted_site(map_file=file))
    report, recording = record_run("trees: {Main: [{wait: 0.1 s}]}", world=world)
    assert report.status == "SUCCESS"
    assert recording.complete
    assert "/map" not in recording.topics()


@pytest.mark.parametrize("picture", ALIKE)
def test_every_map_that_a_robot_can_drive_on_is_in_the_record(record_run, tmp_path, picture):
    world = ScriptedWorld(site=scripted_site(map_file=write(tmp_path, picture)))
    _, recording = record_run("trees: {Main: [{wait: 0.1 s}]}", world=world)
    ((time, grid),) = recording.messages("/map")
    assert time == 0.0
    assert base64.b64decode(grid["data"]) == bytes([0, 0, 100, 100, 0, 255])
    assert (grid["column_count"], grid["row_stride"], grid["cell_size"]["x"]) == (3, 3, 0.1)
    assert grid["pose"]["position"] == {"x": -1.0, "y": 2.0, "z": 0.0}
