"""What is kept of a world is what its file gives, until the file changes."""

import dataclasses

import numpy as np
import pytest
from momantu_worlds.robots import fetch
from momantu_worlds.scenes import loading
from momantu_worlds.scenes.file.reader import WorldFileError
from momantu_worlds.scenes.loading import load_world, nominal, nominal_site, world_path
from momantu_worlds.scenes.site.cache import cached_nominal
from momantu_worlds.scenes.site.maps import MOST_CACHED, with_maps

from momantu_bt.descriptions.reading import DescriptionError
from momantu_bt.formats.cache import CACHE_VARIABLE
from momantu_bt.formats.files import write_whole
from momantu_bt.formats.maps import MapPicture, write_map
from momantu_bt.robot import laser_band

PATH = world_path("four_rooms")
FETCH = fetch()


@pytest.fixture(autouse=True)
def cache(tmp_path, monkeypatch):
    monkeypatch.setenv(CACHE_VARIABLE, str(tmp_path / "cache"))
    return tmp_path / "cache"


@pytest.fixture
def copy(tmp_path):
    """A copy of the world that may be changed."""
    path = tmp_path / "rooms.yaml"
    path.write_bytes(PATH.read_bytes())
    return path


def change(path, before, after):
    text = path.read_text(encoding="utf-8")
    assert text.count(before) == 1
    path.write_text(text.replace(before, after), encoding="utf-8")


def test_the_site_survives_being_kept():
    first = nominal(PATH)
    assert cached_nominal(PATH.read_bytes()) == first
    assert first.site == nominal_site(load_world("four_rooms"))
    assert first.robot == "fetch"


def test_a_kept_site_spares_reading_the_file(monkeypatch):
    first = nominal(PATH)
    monkeypatch.setattr(loading, "load_world", None)
    assert nominal(PATH) == first


def test_a_changed_file_gives_another_site(copy):
    nominal(copy)
    change(copy, "home: [-4.70, -3.44, 180 deg]", "home: [-5.00, -3.44, 180 deg]")
    assert nominal(copy).site.places["home"].x == -5.0


@pytest.mark.parametrize("damage", ["", "{", "[]", '{"robot": "fetch"}', '{"site": {}}'])
def test_a_damaged_short_form_is_read_anew(cache, damage):
    first = nominal(PATH)
    (file,) = (cache / "sites").iterdir()
    file.write_text(damage)
    assert nominal(PATH) == first


def test_where_no_cache_can_be_written_a_passing_folder_serves(tmp_path, monkeypatch):
    (tmp_path / "file").write_text("")
    monkeypatch.setenv(CACHE_VARIABLE, str(tmp_path / "file"))
    assert "table_a" in nominal(PATH).site.surfaces
    assert all(file.is_file() for file in maps(PATH))


def maps(path, height=FETCH.height):
    world = load_world(path)
    site = with_maps(nominal_site(world), world, laser_band(FETCH), height)
    return site.map_file, site.overhang_file


def test_maps_are_drawn_once_for_one_file_and_robot():
    first = maps(PATH)
    stamps = [file.stat().st_mtime_ns for file in first]
    assert maps(PATH) == first
    assert [file.stat().st_mtime_ns for file in first] == stamps


def test_another_robot_or_a_changed_file_has_maps_of_its_own(copy):
    first = maps(copy)
    assert maps(copy, height=0.4)[1] != first[1]
    change(copy, "center: [-8.428, -1.584]", "center: [-8.428, -1.384]")
    assert (
        maps(copy)[0].with_suffix(".pgm").read_bytes() != first[0].with_suffix(".pgm").read_bytes()
    )


def test_maps_of_a_file_that_is_edited_all_day_do_not_pile_up(cache, copy):
    change(copy, "name: four_rooms", "name: rooms")
    before = "home: [-4.70"
    for step in range(MOST_CACHED + 3):
        after = f"home: [-4.{step:02d}"
        change(copy, before, after)
        last, before = maps(copy), after
    assert len(list((cache / "maps").iterdir())) == MOST_CACHED
    assert all(file.is_file() for file in last)


def test_a_half_written_map_is_drawn_again():
    first = maps(PATH)
    whole = first[0].read_bytes()
    first[0].unlink()
    assert maps(PATH) == first
    assert first[0].read_bytes() == whole


def test_a_map_that_the_file_names_is_taken(copy):
    own = copy.parent / "own.yaml"
    change(copy, "  resolution: 5 cm", "  resolution: 5 cm\n  map: own.yaml")
    with pytest.raises(WorldFileError, match=r"no file 'own.yaml'"):
        load_world(copy)
    write_map(own, MapPicture(np.full((4, 4), 254, dtype=np.uint8), 0.05, (0.0, 0.0)))
    assert maps(copy) == (own, None)


def test_a_missing_world_file_is_told(tmp_path):
    with pytest.raises(DescriptionError, match="cannot be read"):
        nominal(tmp_path / "none.yaml")


def test_files_are_written_whole_or_not_at_all(tmp_path, monkeypatch):
    file = tmp_path / "a.txt"
    write_whole(file, b"one")

    def fails(self, target):
        raise OSError("no")

    monkeypatch.setattr(type(file), "replace", fails)
    with pytest.raises(OSError, match="no"):
        write_whole(file, b"two")
    assert file.read_bytes() == b"one"
    assert list(tmp_path.iterdir()) == [file]


def test_the_site_holds_no_truth():
    names = {field.name for field in dataclasses.fields(nominal(PATH).site)}
    assert names.isdisjoint({"bodies", "goal", "item", "seed"})
