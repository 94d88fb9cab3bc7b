"""What a robot is told of tags: their layout, and where those are that hang."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from momantu_worlds.scenes.catalogue.tags import shown_by
from momantu_worlds.scenes.file.reader import WorldFileError
from momantu_worlds.scenes.geometry.bodies import Picture
from momantu_worlds.scenes.loading import draw_episode, nominal

WORLD = """
momantu_world: 1
name: tagroom
rooms: {living: {corner: [0, 0], size: [6, 5]}}
tables: {desk: {kind: desk, at: [2, 4.4, -90 deg], size: [0.8, 1.5, 0.72], sides: [0 deg]}}
tags:
  mark: {id: 1, edge: 150 mm, on: desk, at: [0.05, 0.0]}
  wall: {grid: {columns: 3, rows: 2, gap: 20 mm, first: 10}, edge: 6 cm, hung: [5.9, 2, 1, 180 deg]}
  odd:
    family: tag25h9
    bundle: [{id: 3, at: [0, 0, 0]}, {id: 4, at: [0.1, 0, 0.02, 0, 20 deg, 0], edge: 4 cm}]
    edge: 5 cm
    hung: [5.9, 1, 1, 180 deg]
start: {at: [4.5, 2.5, 0 deg]}
"""


def write(tmp_path: Path, site: str, more: str = "") -> Path:
    file = tmp_path / "tagroom.yaml"
    file.write_text(WORLD + f"site: {site}\n{more}", encoding="utf-8")
    return file


def test_what_is_told_is_what_hangs_there(tmp_path: Path) -> None:
    file = write(tmp_path, "{tags: {wall: {}, odd: {}, mark: {}}}")
    for _ in range(2):  # read, and from the cache
        told = nominal(file).site.tags
        assert told["wall"].ids == (10, 11, 12, 13, 14, 15)
        assert told["mark"].map_from_bundle is None
    episode = draw_episode(file, 0)
    for name in ("wall", "odd"):
        bundle, body = told[name], episode.body(name)
        assert bundle.map_from_bundle is not None
        for plate, part in zip(bundle.plates, body.parts, strict=True):
            assert isinstance(part.geometry, Picture)
            assert shown_by(part.geometry.pixels) == (bundle.family, plate.tag_id)
            there = body.map_from_body @ part.body_from_part
            expected = bundle.map_from_bundle @ plate.bundle_from_tag
            assert there.position == pytest.approx(expected.position, abs=1e-9)
            assert there.angle_to(expected) < 1e-6
    assert told["odd"].plates[1].edge == 0.04
    assert told["wall"].map_from_bundle is not None
    assert told["wall"].map_from_bundle.rotation[:, 2] == pytest.approx((-1, 0, 0))
    assert np.allclose(told["wall"].map_from_bundle.rotation[:, 1], (0, 0, 1))


def test_tags_of_apriltag_ros_get_their_places_here(tmp_path: Path) -> None:
    tags = tmp_path / "tags.yaml"
    tags.write_text("standalone_tags: [{id: 7, size: 0.12, name: dock}]\n", encoding="utf-8")
    file = write(tmp_path, "{tags_file: tags.yaml, tags: {dock: {place: [1, 2, 0.5]}}}")
    (dock,) = nominal(file).site.tags.values()
    assert dock.map_from_bundle is not None
    assert dock.map_from_bundle.position == pytest.approx((1, 2, 0.5))
    tags.write_text("standalone_tags: [{id: 8, size: 0.12, name: dock}]\n", encoding="utf-8")
    assert nominal(file).site.tags["dock"].ids == (8,)


@pytest.mark.parametrize(
    ("site", "tag", "said"),
    [
        ("{tags: {wal: {}}}", "", "no tag 'wal'; did you mean wall?"),
        ("{tags_file: none.yaml}", "", "cannot be read"),
        (
            "{}",
            "  a: {id: 1, edge: 5 cm, grid: {columns: 2, rows: 2, gap: 2 cm}",
            "write one of id",
        ),
        ("{}", "  a: {id: 40, family: tag25h9, edge: 5 cm", "the ids of tag25h9 go from 0 to 34"),
        ("{}", "  a: {id: 1, family: tag26h9, edge: 5 cm", "tag36h11"),
        (
            "{}",
            "  a: {grid: {columns: 2, rows: 2, gap: 1 cm}, family: tagStandard41h12, edge: 5 cm",
            "the tags would overlap",
        ),
        ("{}", "  a: {bundle: [{id: 1, at: [0,0,0]}, {id: 1, at: [1,0,0]}], edge: 5 cm", "twice"),
    ],
)
def test_what_is_wrong_is_said(tmp_path: Path, site: str, tag: str, said: str) -> None:
    file = write(tmp_path, site)
    if tag:
        text = file.read_text(encoding="utf-8")
        text = text.replace("start:", f"{tag}, hung: [5.9, 4, 1, 180 deg]}}\nstart:")
        file.write_text(text, encoding="utf-8")
    with pytest.raises(WorldFileError) as caught:
        nominal(file)
    assert said in str(caught.value)
