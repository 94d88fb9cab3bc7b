"""save_map and name_place: a folder whole or not at all, names that last, and each code."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from momantu_skills.mapping import results
from momantu_skills.mapping.building import build
from momantu_skills.mapping.service import MappingService

from momantu_bt.formats.files import OutputError
from momantu_bt.formats.maps import FREE, OCCUPIED, read_map
from momantu_bt.geometry import Pose, Pose2D, Transform
from momantu_bt.messages import BaseVelocity, SupportPlane
from momantu_bt.robot import Robot
from momantu_bt.site_file import Names, SiteFileError, read_names
from momantu_bt.skill import Needs, Out, Run, Skill
from momantu_bt.testing import scripted_site
from momantu_bt.world import Surface
from tests.skills.mapping.walls import ROUND, driven, logged
from tests.skills.scenery.flat import DESK, ROOMS, START, FlatRobot

TOP = ((-0.3, -0.6), (0.3, -0.6), (0.3, 0.6), (-0.3, 0.6))
"""Outline of a bench's top, m."""


@pytest.fixture
def building(run_tree: Any) -> Any:
    """`building(steps, **skills)`: a tree's steps in the flat world, on a map of its own."""

    def run(steps: str, **skills: type[Skill]) -> Any:
        robot = FlatRobot(START)
        robot.boxes = [*ROOMS, DESK]
        robot.dead.add("wrench")
        body = "".join(f"    - {step}\n" for step in steps.strip().split("\n"))
        tree = f"momantu_bt: 1\nmain: M\nvalues: {{plane: none}}\ntrees:\n  M:\n{body}"
        site = scripted_site(start=START)
        return run_tree(tree, robot=robot, site=site, skills={"ahead": Ahead, **skills})

    return run


class Ahead(Skill):
    """Drive ahead for two seconds, on a map of its own."""

    mapping: Any = Needs()
    failures = {}
    uses = {"base"}

    def run(self, robot: Robot) -> Run:
        """Command it."""
        end = self.clock.now() + 2.0
        while self.clock.now() < end:
            robot.command("base", BaseVelocity(0.5, 0.2))
            yield "ahead"


def measured(outline: tuple[tuple[float, float], ...]) -> type[Skill]:
    """A skill that has measured a surface."""

    class Measured(Skill):
        """Give it."""

        plane: SupportPlane = Out(doc="the surface")
        failures = {}

        def run(self, robot: Robot) -> Run:
            """Give it."""
            yield "measured"
            self.plane = SupportPlane(Pose(Transform((2.0, 1.0, 0.7)), "odom", 0.0), outline)

    return Measured


def code(report: Any) -> str:
    return "" if report.failure is None else innermost(report.failure).code


def innermost(failure: Any) -> Any:
    return failure if failure.cause is None else innermost(failure.cause)


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


@pytest.mark.parametrize("name", ["'Table A'", "9th", "a-b", "''", "x" * 61])
def test_a_name_is_like_the_sites_names(building: Any, name: str) -> None:
    assert code(building(f"ahead\nname_place: {{name: {name}}}")) == "BAD_NAME"


def test_a_place_is_no_surface(building: Any) -> None:
    steps = "ahead\nname_place: {name: spot}\nmeasured: {plane: $plane}\n"
    steps += "name_place: {name: spot, plane: $plane}"
    assert code(building(steps, measured=measured(TOP))) == "BAD_NAME"


def test_a_sliver_is_no_surface(building: Any) -> None:
    steps = "ahead\nmeasured: {plane: $plane}\nname_place: {name: rim, plane: $plane}"
    sliver = ((0.0, 0.0), (0.5, 0.0), (0.5, 0.04))
    assert code(building(steps, measured=measured(sliver))) == "BAD_SURFACE"


def test_who_is_lost_names_nothing(building: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(MappingService, "quality", 0.3)
    assert code(building("ahead\nname_place: {name: spot}")) == "NOT_LOCALIZED"


def test_a_taught_place_is_a_place_of_the_run(building: Any) -> None:
    report = building("name_place: {name: start}\nahead\nnavigate: {in_front_of: start}")
    assert report.status == "SUCCESS", report.failure or report.error


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
    parts = built.plan, built.stamps, built.poses, built.report
    results.write_folder(tmp_path / "map", *parts)
    before = (tmp_path / "map" / "map.pgm").read_bytes()

    def full(*_: Any, **__: Any) -> None:
        raise OutputError("no space left on device")

    monkeypatch.setattr(results, "write_map", full)
    with pytest.raises(OutputError):
        results.write_folder(tmp_path / "map", *parts)
    assert (tmp_path / "map" / "map.pgm").read_bytes() == before
    assert [each.name for each in tmp_path.iterdir()] == ["map"]
