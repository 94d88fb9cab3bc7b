"""`worlds copy`: the same world under another name, with every file that it names."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from momantu_worlds.scenes.loading import draw_episode, load_world

from momantu_bt.cli import main
from momantu_bt.formats.maps import MapPicture, write_map

Out = pytest.CaptureFixture[str]


@pytest.mark.parametrize("name", ["four_rooms", "small_flat", "warehouse"])
def test_a_bundled_world_is_the_same_under_its_new_name(tmp_path: Path, name: str) -> None:
    file = tmp_path / "deep" / "My-Rooms.yaml"
    assert main(["worlds", "copy", name, str(file)]) == 0
    assert load_world(file).name == "my_rooms"
    copied, original = draw_episode(file, 3), draw_episode(name, 3)
    assert [body.name for body in copied.bodies] == [body.name for body in original.bodies]
    assert replace(copied.site, name="") == replace(original.site, name="")
    comments = [line for line in file.read_text().splitlines() if line.startswith("#")]
    assert comments


def test_files_that_it_names_come_along_and_nothing_is_overwritten(
    tmp_path: Path, capsys: Out
) -> None:
    old = tmp_path / "old"
    old.mkdir()
    assert main(["worlds", "new", str(old / "flat.yaml")]) == 0
    white = np.full((200, 300), 254, dtype=np.uint8)
    write_map(old / "plan.yaml", MapPicture(white, 0.05, (-5.0, -5.0)))
    text = (old / "flat.yaml").read_text()
    (old / "flat.yaml").write_text(text.replace("\nsite:\n", "\nsite:\n  map: plan.yaml\n"))
    new = tmp_path / "new" / "flat.yaml"
    assert main(["worlds", "copy", str(old / "flat.yaml"), str(new)]) == 0
    assert "2 files beside it" in capsys.readouterr().out
    assert {each.name for each in new.parent.iterdir()} == {"flat.yaml", "plan.yaml", "plan.pgm"}
    new.unlink()
    assert main(["worlds", "copy", str(old / "flat.yaml"), str(new)]) == 2
    assert "plan.yaml is there already" in capsys.readouterr().err
    assert not new.exists()


@pytest.mark.parametrize(
    ("world", "file", "said"),
    [
        ("four_room", "a.yaml", "did you mean 'four_rooms'?"),
        ("four_rooms", "a.txt", "ends with neither .yaml nor .yml"),
    ],
)
def test_what_it_refuses(tmp_path: Path, capsys: Out, world: str, file: str, said: str) -> None:
    assert main(["worlds", "copy", world, str(tmp_path / file)]) == 2
    assert said in capsys.readouterr().err


def test_a_file_outside_the_worlds_folder_is_not_copied_silently(
    tmp_path: Path, capsys: Out
) -> None:
    old = tmp_path / "old"
    old.mkdir()
    white = np.full((200, 300), 254, dtype=np.uint8)
    write_map(tmp_path / "plan.yaml", MapPicture(white, 0.05, (-5.0, -5.0)))
    assert main(["worlds", "import", str(tmp_path / "plan.yaml"), "-o", str(old / "b.yaml")]) == 0
    assert main(["worlds", "copy", str(old / "b.yaml"), str(tmp_path / "c.yaml")]) == 2
    assert "not in its folder" in capsys.readouterr().err
