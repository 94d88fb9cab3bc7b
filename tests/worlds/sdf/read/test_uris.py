"""Files that SDF names are found where Gazebo finds them, and nowhere else."""

from pathlib import Path

import pytest
from momantu_worlds.sdf.errors import SdfError
from momantu_worlds.sdf.read.uris import Library, MissingFile, model_file, search_folders

from momantu_bt.formats.places import Place


@pytest.fixture
def folders(tmp_path: Path) -> Path:
    """`worlds/room.sdf`, `models/table/…`, and `secret` beside them."""
    for path in (
        "worlds/room.sdf",
        "models/table/model.sdf",
        "models/table/meshes/t.stl",
        "secret",
    ):
        (tmp_path / path).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / path).write_text("<sdf version='1.6'/>")
    return tmp_path


@pytest.fixture
def place(folders: Path) -> Place:
    return Place(str(folders / "worlds" / "room.sdf"), 7, 3)


@pytest.fixture
def library(folders: Path) -> Library:
    return Library((folders / "models", folders / "worlds"))


@pytest.mark.parametrize(
    "uri",
    [
        "model://table/meshes/t.stl",
        "package://table/meshes/t.stl",
        "https://fuel.gazebosim.org/1.0/somebody/models/table/2/files/meshes/t.stl",
        "../models/table/meshes/t.stl",
        "file://table/meshes/t.stl",
        "file://models/table/meshes/t.stl",
    ],
)
def test_one_file_has_many_names(library, place, folders, uri):
    assert library.resolve(uri, place) == folders / "models/table/meshes/t.stl"


def test_a_model_of_fuel_is_its_folder(library, place, folders):
    for uri in (
        "https://fuel.gazebosim.org/1.0/somebody/models/table",
        "https://fuel.gazebosim.org/1.0/somebody/models/Table/4",
    ):
        assert library.resolve(uri, place) == folders / "models/table"


def test_fuels_cache_has_folders_for_versions(library, place, folders):
    for version in ("2", "10", "tmp"):
        (folders / "models" / "chair" / version).mkdir(parents=True)
    found = library._downloaded("chair", [])
    assert next(found) == folders / "models/chair/10"


def test_a_model_may_be_given_by_its_own_folder(folders, place):
    (folders / "models/table/model.config").write_text("<model/>")
    library = Library((folders / "models" / "table",))
    assert library.resolve("model://table/model.sdf", place).is_file()


@pytest.mark.parametrize(
    "uri", ["model://../secret", "model://table/../../secret", "model:///../secret", "model://"]
)
def test_no_model_leads_out_of_its_folder(library, place, uri):
    with pytest.raises(SdfError, match=f"{place.line}:{place.column}: .*leads out"):
        library.resolve(uri, place)


@pytest.mark.parametrize("uri", ["../secret", "file://../secret", "file://{}/secret", "{}/secret"])
def test_no_path_leads_out_of_the_folders(library, place, folders, uri):
    with pytest.raises(SdfError, match="lies outside every folder"):
        library.resolve(uri.format(folders), place)


def test_what_is_missing_says_where_it_was_looked_for(library, place):
    with pytest.raises(MissingFile, match=r"model://bed.*models.*--models"):
        library.resolve("model://bed", place)
    with pytest.raises(MissingFile, match="ftp://"):
        library.resolve("ftp://host/table", place)
    with pytest.raises(SdfError, match="<uri> is empty"):
        library.resolve("", place)


def test_folders_come_in_gazebos_order(folders):
    for name in ("given", "gazebo"):
        (folders / name).mkdir()
    room = folders / "worlds" / "room.sdf"
    variables = {"GAZEBO_MODEL_PATH": f"{folders / 'gazebo'}:/nowhere"}
    found = search_folders(room, [folders / "given"], variables)
    names = [str(folder.relative_to(folders)) for folder in found]
    assert names == ["given", "gazebo", "worlds", "models"]


def write_config(folder: Path, inside: str) -> None:
    (folder / "model.config").write_text(f"<model><name>x</name>{inside}</model>")


def test_model_config_picks_the_newest_version_that_is_read(folders, place):
    folder = folders / "models" / "table"
    for name in ("a.sdf", "b.sdf", "c.sdf"):
        (folder / name).touch()
    write_config(
        folder,
        "<sdf version='1.9'>a.sdf</sdf><sdf version='1.10'>b.sdf</sdf>"
        "<sdf version='1.99'>c.sdf</sdf><sdf>old.sdf</sdf>",
    )
    assert model_file(folder, place).name == "b.sdf"


def test_a_wrong_model_config_is_told(folders, place):
    folder = folders / "models" / "table"
    assert model_file(folder, place).name == "model.sdf"
    write_config(folder, "<sdf version='1.6'>../../secret</sdf>")
    with pytest.raises(SdfError, match="leads out"):
        model_file(folder, place)
    write_config(folder, "<sdf version='1.6'>none.sdf</sdf>")
    with pytest.raises(MissingFile, match="which is not there"):
        model_file(folder, place)
    write_config(folder, "")
    with pytest.raises(MissingFile, match="names no SDF file"):
        model_file(folder, place)
    with pytest.raises(MissingFile, match=r"neither model\.config nor model\.sdf"):
        model_file(folders / "worlds", place)
