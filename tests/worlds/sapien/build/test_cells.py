"""Cells of a mesh are cut once; the cache is no part of the result."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import trimesh
from momantu_worlds.sapien.build import cells
from momantu_worlds.sapien.build.cells import convex_cells

from momantu_bt.formats.cache import CACHE_VARIABLE
from momantu_bt.robot import Cuts

CUTS = Cuts(x=(0.0,), z=(0.1,))


@pytest.fixture
def mesh(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A mesh file, and a cache of its own."""
    monkeypatch.setenv(CACHE_VARIABLE, str(tmp_path / "cache"))
    path = tmp_path / "box.stl"
    trimesh.creation.box(extents=(1.0, 0.5, 0.5)).export(path)
    return path


def stored(folder: Path) -> list[Path]:
    return sorted((folder / "cache" / "cells").iterdir())


def same(first: list, second: list) -> bool:
    return len(first) == len(second) and all(
        a.dtype == b.dtype == np.float32 and np.array_equal(a, b)
        for a, b in zip(first, second, strict=True)
    )


def test_the_second_time_nothing_is_cut(mesh: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    cut = convex_cells(str(mesh), CUTS)
    assert len(cut) == 4
    monkeypatch.setattr(cells, "_cut", lambda *given: pytest.fail("cut again"))
    assert same(convex_cells(str(mesh), CUTS), cut)


def test_other_cuts_and_another_mesh_are_cut_anew(mesh: Path) -> None:
    assert len(convex_cells(str(mesh), CUTS)) == 4
    assert len(convex_cells(str(mesh), Cuts(x=(0.0,)))) == 2
    trimesh.creation.box(extents=(2.0, 0.5, 0.5)).export(mesh)
    assert np.concatenate(convex_cells(str(mesh), CUTS)).max() == pytest.approx(1.0)


@pytest.mark.parametrize("content", [b"", b"no archive", b"PK\x03\x04 cut off"])
def test_a_damaged_file_is_made_again(mesh: Path, content: bytes, tmp_path: Path) -> None:
    cut = convex_cells(str(mesh), CUTS)
    (file,) = stored(tmp_path)
    whole = file.read_bytes()
    file.write_bytes(content or whole[: len(whole) // 2])
    assert same(convex_cells(str(mesh), CUTS), cut)
    assert file.read_bytes() == whole


def test_without_a_cache_it_cuts(mesh: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(kind: str) -> Path:
        raise PermissionError(kind)

    monkeypatch.setattr(cells, "cache_subfolder", refuse)
    assert len(convex_cells(str(mesh), CUTS)) == 4
