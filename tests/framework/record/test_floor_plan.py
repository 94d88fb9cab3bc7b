"""The site's floor plan, as map_server means it, in the record."""

import base64

import numpy as np
import pytest

from momantu_bt.record.floor_plan import FREE, OCCUPIED, UNKNOWN, read_floor_plan
from momantu_bt.testing import ScriptedWorld, scripted_site

YAML = """
image: map.pgm
resolution: 0.1
origin: [-1.0, 2.0, 0.0]
negate: {negate}
occupied_thresh: 0.65
free_thresh: 0.25
"""
PIXELS = np.array([[0, 254, 150], [254, 254, 0]], dtype=np.uint8)
"""Top row first: occupied, free, unknown; free, free, occupied."""


def write(folder, header=b"P5\n# by hand\n3 2\n255\n", negate=0, pixels=PIXELS):
    (folder / "map.pgm").write_bytes(header + pixels.tobytes())
    (folder / "map.yaml").write_text(YAML.format(negate=negate))
    return folder / "map.yaml"


@pytest.mark.parametrize(
    "header", [b"P5\n# by hand\n3 2\n255\n", b"P5 3 2 255 ", b"P5\n3\n2\n255\n"]
)
def test_rows_begin_at_the_smallest_y(tmp_path, header):
    plan = read_floor_plan(write(tmp_path, header))
    assert plan.cells.tolist() == [[FREE, FREE, OCCUPIED], [OCCUPIED, FREE, UNKNOWN]]
    assert (plan.resolution, plan.origin) == (0.1, (-1.0, 2.0))


def test_a_negated_picture_is_turned_round(tmp_path):
    plain = read_floor_plan(write(tmp_path))
    assert np.array_equal(
        read_floor_plan(write(tmp_path, negate=1, pixels=255 - PIXELS)).cells, plain.cells
    )


@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("map.pgm", b"P2 3 2 255 0 0 0 0 0 0"),
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
    with pytest.raises(ValueError, match=r"map\.yaml is no floor plan"):
        read_floor_plan(file)
    world = ScriptedWorld(site=scripted_site(map_file=file))
    report, recording = record_run("trees: {Main: [{wait: 0.1 s}]}", world=world)
    assert report.status == "SUCCESS"
    assert recording.complete
    assert "/map" not in recording.topics()


def test_the_plan_is_in_the_record_for_viewers(record_run, tmp_path):
    world = ScriptedWorld(site=scripted_site(map_file=write(tmp_path)))
    _, recording = record_run("trees: {Main: [{wait: 0.1 s}]}", world=world)
    ((time, grid),) = recording.messages("/map")
    assert time == 0.0
    assert base64.b64decode(grid["data"]) == bytes([0, 0, 100, 100, 0, 255])
    assert (grid["column_count"], grid["row_stride"], grid["cell_size"]["x"]) == (3, 3, 0.1)
    assert grid["pose"]["position"] == {"x": -1.0, "y": 2.0, "z": 0.0}
