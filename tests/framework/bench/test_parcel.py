"""Files of a tree travel: elsewhere they are the same tree, and rows speak of the first place."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from momantu_bt.bench.episodes.parcel import Parcel
from momantu_bt.bench.planning.made_of import made_of
from momantu_bt.tree.load import load
from momantu_bt.tree.model import Document
from momantu_bt.tree.registry import Registry

MAIN = """
momantu_bt: 1
include: [{include}]
main: Main
world: none
trees: {{Main: [Other: {{}}]}}
"""
OTHER = "\ufeffmomantu_bt: 1\r\ntrees: {Other: [succeed]}  # é 木\r\n"
LAYOUTS = [
    ("main.yaml", "other.yaml"),
    ("main.yaml", "parts/deep/other.yaml"),
    ("trees/main.yaml", "../parts/other.yaml"),
    ('trees/a "b"/main.yaml', "../../other.yaml"),
]


def write(folder: Path, main: str, other: str) -> Path:
    """A project of two files; where the main one lies."""
    (folder / ".git").mkdir(parents=True)
    path = folder / main
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(MAIN.format(include=other))
    included = path.parent / other
    included.parent.mkdir(parents=True, exist_ok=True)
    included.write_bytes(OTHER.encode())
    return path


def document(path: Path) -> Document:
    return load(str(path), Registry.installed()).document


@pytest.mark.parametrize(("main", "other"), LAYOUTS)
def test_what_is_unpacked_is_the_same_tree(tmp_path: Path, main: str, other: str) -> None:
    path = write(tmp_path / "here", main, other)
    parcel = Parcel.of(str(path))
    plain = json.loads(json.dumps({"main": parcel.main, "texts": dict(parcel.texts)}))
    there = tmp_path / "there"
    there.mkdir()
    unpacked = Parcel(plain["main"], plain["texts"], {}).unpack(there)
    assert document(unpacked) == document(path)
    registry = Registry.installed()
    assert made_of(document(unpacked), registry) == made_of(document(path), registry)
    assert unpacked.is_relative_to(there)


@pytest.mark.parametrize(("main", "other"), LAYOUTS)
def test_rows_name_the_files_as_they_were_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, main: str, other: str
) -> None:
    write(tmp_path / "here", main, other)
    monkeypatch.chdir(tmp_path / "here")
    parcel, there = Parcel.of(main), tmp_path / "there"
    there.mkdir()
    parcel.unpack(there)
    names = {name: f"{there / name}:3" for name in parcel.texts}
    row = parcel.as_shown(
        {"nodes": names, "seed": 3, "error": f'in "{there / parcel.main}"'}, there
    )
    assert set(row["nodes"].values()) == {f"{shown}:3" for shown in document(Path(main)).source}
    assert (row["seed"], row["error"]) == (3, f'in "{main}"')
