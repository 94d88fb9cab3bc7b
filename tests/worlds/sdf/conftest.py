"""Small SDF worlds, written to a folder and imported from there."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
from momantu_worlds.sdf.deviations import Deviations
from momantu_worlds.sdf.importing import Import, import_world
from momantu_worlds.sdf.read.model import SdfWorld
from momantu_worlds.sdf.read.uris import search_folders
from momantu_worlds.sdf.read.world import read_world


@pytest.fixture(autouse=True)
def _no_models_of_this_machine(monkeypatch: pytest.MonkeyPatch) -> None:
    for variable in ("GAZEBO_MODEL_PATH", "GZ_SIM_RESOURCE_PATH", "IGN_GAZEBO_RESOURCE_PATH"):
        monkeypatch.delenv(variable, raising=False)


@pytest.fixture
def sdf(tmp_path: Path) -> Callable[..., Path]:
    """Write what stands in a <world> as a file."""

    def write(inside: str, version: str = "1.9", name: str = "room.sdf") -> Path:
        file = tmp_path / name
        text = f"<sdf version='{version}'>\n<world name='room'>\n{inside}\n</world>\n</sdf>\n"
        file.write_text(text, encoding="utf-8")
        return file

    return write


@pytest.fixture
def model(tmp_path: Path) -> Callable[..., Path]:
    """Write a model's folder below `models`, with what stands in its <model>."""

    def write(name: str, inside: str, version: str = "1.9", config: str = "") -> Path:
        folder = tmp_path / "models" / name
        folder.mkdir(parents=True, exist_ok=True)
        said = config or f"<model><sdf version='{version}'>model.sdf</sdf></model>"
        (folder / "model.config").write_text(said, encoding="utf-8")
        text = f"<sdf version='{version}'>\n<model name='{name}'>\n{inside}\n</model>\n</sdf>\n"
        (folder / "model.sdf").write_text(text, encoding="utf-8")
        return folder

    return write


@pytest.fixture
def read(sdf: Callable[..., Path]) -> Callable[..., tuple[SdfWorld, Deviations]]:
    """Read what stands in a <world>."""

    def run(inside: str, version: str = "1.9") -> tuple[SdfWorld, Deviations]:
        file, deviations = sdf(inside, version), Deviations()
        return read_world(file, search_folders(file, (), {}), deviations), deviations

    return run


@pytest.fixture
def imported(sdf: Callable[..., Path]) -> Callable[..., Import]:
    """Import what stands in a <world>."""

    def run(inside: str, version: str = "1.9", **options: bool) -> Import:
        file = sdf(inside, version)
        return import_world(file, file.with_name("room.yaml"), **options)

    return run


def box(name: str, size: str, pose: str = "0 0 0 0 0 0", *, extra: str = "") -> str:
    """A static model that is a box to see and to touch."""
    shape = f"<geometry><box><size>{size}</size></box></geometry>"
    return (
        f"<model name='{name}'><static>1</static><pose>{pose}</pose><link name='link'>"
        f"<collision name='c'>{shape}{extra}</collision><visual name='v'>{shape}</visual>"
        "</link></model>"
    )


@pytest.fixture(name="box")
def _box() -> Callable[..., str]:
    return box
