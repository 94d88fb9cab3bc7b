"""save_map: a folder whole or not at all, with the names that were taught, and each code."""

from __future__ import annotations

import gc
import json
from pathlib import Path
from typing import Any

import pytest
from momantu_skills.mapping import results
from momantu_skills.mapping.building import build
from momantu_skills.save_map import SaveMap

from momantu_bt.formats.files import OutputError
from momantu_bt.formats.maps import FREE, OCCUPIED, read_map
from momantu_bt.geometry import Pose2D
from momantu_bt.site_file import Names, SiteFileError, read_names
from momantu_bt.testing import check_skill
from momantu_bt.world import Surface
from tests.skills.mapping.walls import ROUND, driven, logged
from tests.skills.scenery.building import START, TOP, building_of, code, measured


@pytest.fixture
def building(run_tree: Any) -> Any:
    return building_of(run_tree)


def test_it_moves_nothing() -> None:
    """A tree may save the map while another skill drives."""
    assert not SaveMap.uses
    assert set(SaveMap.needs) == {"mapping"}


def test_the_test_kit_saves_a_map_and_leaves_nothing(monkeypatch: Any, tmp_path: Path) -> None:
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    assert check_skill(SaveMap, halts=2) == []
    gc.collect()
    assert not list(tmp_path.iterdir())


def test_only_a_map_is_said_to_be_replaced(building: Any, tmp_path: Path) -> None:
    (tmp_path / "mine.txt").write_text("mine")
    failure = building(f"save_map: {{folder: {tmp_path}}}").failure
    assert failure.code == "MAP_NOT_WRITTEN"
    assert "replace" not in failure.message
    out = tmp_path / "map"
    twice = f"ahead\nsave_map: {{folder: {out}}}\nsave_map: {{folder: {out}}}"
    failure = building(twice).failure
    assert failure.message.endswith("choose another folder, or say `replace: true`")


def test_a_map_is_saved_with_the_names_that_were_taught(building: Any, tmp_path: Path) -> None:
    out = tmp_path / "flat"
    report = building(
        f"""
name_place: {{name: start}}
ahead
measured: {{plane: $plane}}
name_place: {{name: bench, plane: $plane}}
name_place: {{name: there}}
save_map: {{folder: {out}}}
save_map: {{folder: {out}, replace: true}}
""".strip(),
        measured=measured(TOP),
    )
    assert report.status == "SUCCESS", report.failure
    assert {each.name for each in out.iterdir()} == results.FILES
    names = read_names(out / "site.yaml")
    assert names.start == pytest.approx((START.x, START.y, START.yaw), abs=1e-3)
    assert names.places["start"] == pytest.approx((START.x, START.y, START.yaw), abs=0.02)
    assert names.places["there"][0] > START.x + 0.7
    bench = names.surfaces["bench"]
    assert bench.centre[:2] == pytest.approx((START.x + 2.0, START.y + 1.0), abs=0.05)
    assert sorted(bench.size) == pytest.approx([0.6, 1.2], abs=0.02)
    assert bench.height == pytest.approx(0.7, abs=1e-3)
    told = json.loads((out / "report.json").read_text())
    plan = read_map(out / "map.yaml")
    assert told["free_m2"] == pytest.approx((plan.cells() == FREE).sum() * 0.05**2, abs=0.01)
    assert (plan.cells() == OCCUPIED).any()


def test_a_folder_with_a_map_or_other_files_stays_as_it_is(building: Any, tmp_path: Path) -> None:
    out = tmp_path / "held"
    out.mkdir()
    (out / "letter.txt").write_text("dear")
    for replace in ("false", "true"):
        report = building(f"ahead\nsave_map: {{folder: {out}, replace: {replace}}}")
        assert code(report) == "MAP_NOT_WRITTEN"
    assert [each.name for each in out.iterdir()] == ["letter.txt"]
    assert [each.name for each in tmp_path.iterdir()] == ["held"]


def test_where_nothing_can_be_written_nothing_is(building: Any) -> None:
    report = building("ahead\nsave_map: {folder: /dev/null/map}")
    assert code(report) == "MAP_NOT_WRITTEN"


def test_without_scans_there_is_no_map(building: Any, tmp_path: Path) -> None:
    report = building(f"save_map: {{folder: {tmp_path / 'none'}}}")
    assert code(report) == "NOTHING_MAPPED"
    assert not list(tmp_path.iterdir())


def test_a_site_file_reads_back_and_says_what_is_wrong(tmp_path: Path) -> None:
    names = Names.of(
        Pose2D(1.0, 2.0, 0.5),
        {"dock": Pose2D(-1.0, 0.25, 3.0)},
        {"bench": Surface(Pose2D(2.0, 1.0, 0.1), (0.6, 1.2), 0.7, (0.0, 1.5))},
    )
    path = tmp_path / "site.yaml"
    path.write_text(names.text())
    assert read_names(path) == names
    assert read_names(path).surfaces["bench"].surface().size == (0.6, 1.2)
    path.write_text("start: [0, 0, 0]\nplaces: {Dock: [0, 0, 0], hall: [0, x, 0]}\nplace: {}\n")
    with pytest.raises(SiteFileError) as error:
        read_names(path)
    assert "site.yaml:2" in str(error.value)
    assert "site.yaml:3" in str(error.value)


def test_a_full_disk_leaves_the_map_that_was_there(tmp_path: Path, monkeypatch: Any) -> None:
    built = build(logged(driven(ROUND[:2], 0.5), 1), 0.05, lambda *_: False)
    parts = built.plan, built.stamps, built.poses, built.report, None
    results.write_folder(tmp_path / "map", *parts)
    before = (tmp_path / "map" / "map.pgm").read_bytes()

    def full(*_: Any, **__: Any) -> None:
        raise OutputError("no space left on device")

    monkeypatch.setattr(results, "write_map", full)
    with pytest.raises(OutputError):
        results.write_folder(tmp_path / "map", *parts)
    assert (tmp_path / "map" / "map.pgm").read_bytes() == before
    assert [each.name for each in tmp_path.iterdir()] == ["map"]
