"""`--map` and `--names` replace what a world tells; a wrong path says what there is."""

from pathlib import Path

import numpy as np
import pytest

import momantu_bt
from momantu_bt.errors import InputError
from momantu_bt.formats.maps import MapPicture, write_map
from momantu_bt.geometry import Pose2D
from momantu_bt.running.told import off_the_map, read_told, told_files
from momantu_bt.site_file import SiteFileError
from momantu_bt.testing import ExampleWorld
from momantu_bt.tree.problems import TreeError

NAMES = """start: [1, 2, 90 deg]
places: {sofa: [1 m, 1.5, 0]}
surfaces:
  shelf: {centre: [2, 1, 0], size: [0.4, 80 cm], height: 0.9, sides: [0]}
"""
PLACES = "momantu_bt: 1\ntrees: {Main: [{navigate: {in_front_of: %s}}]}\n"


@pytest.fixture
def office(tmp_path: Path) -> Path:
    """A map's folder, 3 m x 2 m from (-1, -0.5)."""
    folder = tmp_path / "office"
    folder.mkdir()
    write_map(folder / "map.yaml", MapPicture(np.full((40, 60), 254), 0.05, (-1.0, -0.5)))
    (folder / "site.yaml").write_text(NAMES)
    return folder


def _says(map_: str | None, names: str | None = None) -> str:
    with pytest.raises(InputError) as caught:
        read_told(map_, names)
    return str(caught.value)


def test_nothing_asked_is_nothing_told() -> None:
    assert read_told(None, None) is None


def test_the_map_replaces_the_plan_and_leaves_the_names(office: Path) -> None:
    site = ExampleWorld().site
    told = read_told(str(office), None)
    assert told is not None
    seen = told.of(site)
    assert seen.map_file == office / "map.yaml"
    assert seen.overhang_file is None
    assert seen.area == pytest.approx((-1.0, -0.5, 2.0, 1.5))
    assert seen.surfaces == site.surfaces
    assert seen.start == site.start


def test_names_replace_places_and_surfaces_and_the_start(office: Path) -> None:
    told = read_told(str(office), str(office))
    assert told is not None
    seen = told.of(ExampleWorld().site)
    assert seen.known_places() == ("sofa", "shelf")
    assert seen.surfaces["shelf"].size == (0.4, 0.8)
    assert seen.start == Pose2D(1.0, 2.0, np.pi / 2)
    assert all(tag.map_from_bundle is None for tag in seen.tags.values())


def test_without_a_map_nothing_lies_anywhere_but_what_is_named(office: Path) -> None:
    told, named = read_told("none", None), read_told("none", str(office / "site.yaml"))
    assert told is not None
    assert named is not None
    site = ExampleWorld().site
    assert told.of(site).map_file is None
    assert told.of(site).known_places() == ()
    assert told.of(site).start == Pose2D(0.0, 0.0, 0.0)
    assert named.of(site).start == Pose2D(1.0, 2.0, np.pi / 2)
    assert named.of(site).known_places() == ("sofa", "shelf")
    assert told.of(site).objects == site.objects


ZONES = """zones:
  stairs: {kind: keep_out, corners: [[0, 0], [1 m, 0], [1, 1]]}
  crossing: {kind: slow, speed: 30 cm/s, corners: [[0, 0], [1, 0], [1, 1], [0, 1]]}
"""


def test_zones_come_with_the_names_and_are_written_back(office: Path) -> None:
    (office / "site.yaml").write_text(NAMES + ZONES)
    told = read_told(str(office), str(office))
    assert told is not None
    assert told.names is not None
    seen = told.of(ExampleWorld().site)
    assert {name: zone.kind for name, zone in seen.zones.items()} == {
        "stairs": "keep_out",
        "crossing": "slow",
    }
    assert seen.zones["crossing"].speed == pytest.approx(0.3)
    (office / "site.yaml").write_text(told.names.text())
    again = read_told(None, str(office))
    assert again is not None
    assert again.names is not None
    assert again.names.text() == told.names.text()
    assert again.names.zones == told.names.zones


def test_a_wrong_zone_is_told_with_its_line(office: Path) -> None:
    (office / "site.yaml").write_text(NAMES + ZONES.replace("speed: 30 cm/s, ", ""))
    with pytest.raises(SiteFileError, match=r"site.yaml:7:.*a slow zone needs its `speed`"):
        read_told("none", str(office))


def test_an_overhang_map_beside_it_is_used(office: Path) -> None:
    write_map(office / "overhang.yaml", MapPicture(np.full((40, 60), 254), 0.05, (-1.0, -0.5)))
    told = read_told(str(office), None)
    assert told is not None
    assert told.of(ExampleWorld().site).overhang_file == office / "overhang.yaml"
    files = told_files(str(office), str(office))
    assert set(files) == {"map", "map's picture", "overhang", "overhang's picture", "names"}


def test_wrong_paths_say_what_there_is(office: Path) -> None:
    here = office.parent
    assert "did you mean office" in _says(str(here / "offce"))
    assert "there is no such folder or file" in _says(str(here / "else"))
    assert "is not there either" in _says(str(here / "maps" / "office"))
    assert "is the map's picture; did you mean" in _says(str(office / "map.pgm"))
    (office / "map.yaml").rename(office / "plan.yaml")
    assert "it has plan.yaml, site.yaml: name the file itself" in _says(str(office))
    assert read_told(str(office / "plan.yaml"), None) is not None
    (here / "empty").mkdir()
    assert "a map is a folder that `momantu-bt map` wrote" in _says(str(here / "empty"))
    assert "the folder has no site.yaml" in _says("none", str(here / "empty"))
    assert "there is no such file or folder" in _says("none", str(here / "names.yaml"))


def test_a_map_without_floor_is_refused(office: Path) -> None:
    write_map(office / "map.yaml", MapPicture(np.zeros((4, 4)), 0.05, (0.0, 0.0)))
    assert "has no free cell" in _says(str(office))


def test_wrong_names_are_told_with_their_line(office: Path) -> None:
    (office / "site.yaml").write_text(NAMES.replace("height: 0.9", "height: tall"))
    with pytest.raises(SiteFileError, match="site.yaml:4"):
        read_told("none", str(office))


def test_a_start_beside_the_map_is_remarked(office: Path) -> None:
    told = read_told(str(office), None)
    assert told is not None
    assert off_the_map(told, Pose2D(0.0, 0.0, 0.0)) is None
    assert "is it of this place?" in str(off_the_map(told, Pose2D(5.0, 0.0, 0.0)))


def test_a_tree_is_checked_with_what_is_told(office: Path) -> None:
    world = ExampleWorld()
    with pytest.raises(TreeError, match="no place 'table_a'"):
        momantu_bt.run(PLACES % "table_a", world=world, map=office, names=office)
    with pytest.raises(TreeError, match="no place 'sofa'"):
        momantu_bt.run(PLACES % "sofa", world=world, map=office)


def test_a_run_is_told_so_from_its_start_to_its_end(office: Path) -> None:
    tree = "momantu_bt: 1\ntrees: {Main: [{wait: 0.2 s}, {check: localized}]}\n"
    seen = []

    class Site:
        def ticked(self, run: object) -> None:
            seen.append(run.context.body.site)  # type: ignore[attr-defined]

        def close(self) -> None:
            pass

    momantu_bt.run(tree, world=ExampleWorld(), map=office, names=office, watch=lambda run: [Site()])
    assert {site.map_file for site in seen} == {office / "map.yaml"}
    assert seen[-1].known_places() == ("sofa", "shelf")


class Surveyed(ExampleWorld):
    """A world in which somebody can measure where the robot stands at first."""

    start = Pose2D(1.0, 2.0, 0.5)


@pytest.mark.parametrize("world", [Surveyed, ExampleWorld])
@pytest.mark.parametrize("measured", [True, False])
def test_a_measured_start_is_told_exactly_where_a_world_knows_it(
    world: type[ExampleWorld], measured: bool
) -> None:
    told = []

    class Start:
        def ticked(self, run: object) -> None:
            told.append(run.context.body.site)  # type: ignore[attr-defined]

        def close(self) -> None:
            pass

    tree = "momantu_bt: 1\ntrees: {Main: [{wait: 0.1 s}, {check: localized}]}\n"
    momantu_bt.run(tree, world=world(), measured_start=measured, watch=lambda run: [Start()])
    exact = measured and world is Surveyed
    assert told[0].start == (Surveyed.start if exact else ExampleWorld().site.start)
    assert (told[0].start_sigma == (0.0, 0.0)) == exact
