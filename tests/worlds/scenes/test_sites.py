"""The site that is kept beside the map is the one that the world file gives."""

import shutil
import subprocess
import sys

import pytest
from momantu_worlds.scenes import loading
from momantu_worlds.scenes.loading import FOLDER, map_files, site_from_file, world_path
from momantu_worlds.scenes.sites import kept_site, save_site

from momantu_bt.world import WorldError

NAME = "four_rooms"
KEPT = FOLDER / NAME / "site.json"


def test_the_kept_site_is_the_one_of_the_world_file():
    kept = kept_site(NAME, world_path(NAME), KEPT, map_files(NAME))
    assert kept == site_from_file(NAME), "run python -m momantu_worlds.scenes four_rooms"


def test_a_site_survives_being_kept(tmp_path):
    site = site_from_file(NAME)
    save_site(site, world_path(NAME), tmp_path / "site.json")
    assert kept_site(NAME, world_path(NAME), tmp_path / "site.json", map_files(NAME)) == site


@pytest.fixture
def elsewhere(tmp_path, monkeypatch):
    """A copy of the world in a folder of its own, with one wall moved."""
    shutil.copytree(FOLDER / NAME, tmp_path / NAME)
    text = world_path(NAME).read_text(encoding="utf-8")
    changed = text.replace("center: [-8.428, -1.584]", "center: [-8.428, -1.384]")
    changed = changed.replace("home: [-4.70, -3.44, 180 deg]", "home: [-5.00, -3.44, 180 deg]")
    (tmp_path / f"{NAME}.yaml").write_text(changed, encoding="utf-8")
    monkeypatch.setattr(loading, "FOLDER", tmp_path)
    loading.load_world.cache_clear()
    yield tmp_path
    loading.load_world.cache_clear()


def test_a_changed_world_file_is_read_anew(elsewhere):
    assert loading.nominal_site(NAME).places["home"].x == -5.0


def test_an_episode_of_a_changed_world_file_has_new_maps(elsewhere):
    before = (elsewhere / NAME / "map.pgm").read_bytes()
    site = loading.draw_episode(NAME, 0).site
    assert site.map_file.parent == elsewhere / NAME
    assert (elsewhere / NAME / "map.pgm").read_bytes() != before
    kept = kept_site(NAME, elsewhere / f"{NAME}.yaml", elsewhere / NAME / "site.json", (None, None))
    assert kept is not None
    assert not [path for path in (elsewhere / NAME).iterdir() if path.name.startswith(".")]


def test_maps_that_cannot_be_drawn_anew_are_a_world_error(elsewhere, monkeypatch):
    def refuse(*_):
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(loading, "save_site", refuse)
    with pytest.raises(WorldError, match=r"four_rooms.yaml was changed, but its maps cannot"):
        loading.draw_episode(NAME, 0)


@pytest.mark.parametrize("text", ["", "{", "{}", "[]", '{"made_from": "other"}'])
def test_a_broken_short_form_is_as_good_as_none(tmp_path, text):
    (tmp_path / "site.json").write_text(text, encoding="utf-8")
    assert kept_site(NAME, world_path(NAME), tmp_path / "site.json", map_files(NAME)) is None
    assert kept_site(NAME, world_path(NAME), tmp_path / "none.json", map_files(NAME)) is None


def test_asking_for_the_site_loads_nothing_heavy():
    code = (
        "import sys\n"
        "from momantu_worlds.worlds import four_rooms\n"
        "assert four_rooms.site().surfaces\n"
        "heavy = {'sapien', 'cv2', 'torch', 'av', 'trimesh', 'viser', 'ruamel', 'pydantic'}\n"
        "print(sorted(heavy & set(sys.modules)))\n"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_the_site_names_where_to_stand_and_what_to_look_for():
    site = site_from_file(NAME)
    assert set(site.surfaces) == {"table_a", "table_b"}
    assert site.surfaces["table_b"].height == pytest.approx(0.5)
    assert site.objects["can"].diameter == pytest.approx(0.07)
    assert site.start_sigma[0] == pytest.approx(0.15)
    assert all(path.is_file() for path in (site.map_file, site.overhang_file))
