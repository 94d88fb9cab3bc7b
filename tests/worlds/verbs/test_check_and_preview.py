"""`worlds check` and `worlds preview`: what they take, print, write and return."""

import io
import json
from pathlib import Path

import pytest
from momantu_worlds.preview import page
from momantu_worlds.scenes.loading import world_path
from PIL import Image

from momantu_bt.cli import main
from momantu_bt.world import WorldError
from momantu_bt.world_plugins import WORLDS

Out = pytest.CaptureFixture[str]


@pytest.fixture
def crowded(tmp_path: Path) -> Path:
    """A world file in which a crate reaches into a wall in every episode."""
    text = world_path("four_rooms").read_text(encoding="utf-8")
    crate = "crate_corridor: {kind: crate, at: [-8.20, "
    assert f"{crate}1.35," in text
    path = tmp_path / "crowded.yaml"
    path.write_text(text.replace(f"{crate}1.35,", f"{crate}1.44,"), encoding="utf-8")
    return path


def test_check_tells_that_nothing_is_wrong(capsys: Out) -> None:
    assert main(["worlds", "check", "small_flat", "--seeds", "0:2"]) == 0
    assert capsys.readouterr().out == "small_flat: nothing is wrong\n"


def test_check_prints_what_it_finds_with_place_seeds_and_cure(crowded: Path, capsys: Out) -> None:
    assert main(["worlds", "check", str(crowded), "--seeds", "0:2,3"]) == 1
    said = capsys.readouterr().out
    lines = crowded.read_text(encoding="utf-8").splitlines()
    number = next(i for i, line in enumerate(lines, 1) if "crate_corridor:" in line)
    assert f"{crowded}:{number}:" in said
    assert "crate_corridor overlaps wall_corridor_north_west" in said
    assert "(overlap) [seeds " in said
    assert "move one of them, or make it smaller" in said


def test_check_prints_json_for_another_robot(crowded: Path, capsys: Out) -> None:
    words = ["worlds", "check", str(crowded), "--robot", "kinova_jackal", "--seeds", "1", "--json"]
    assert main(words) == 1
    told = json.loads(capsys.readouterr().out)
    assert told["ok"] is False
    assert {finding["code"] for finding in told["findings"]} == {"overlap"}


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["four_rooms", "--seeds", "5:5"], "is empty"),
        (["four_rooms", "--seeds", "0:5000"], "more than 1000 seeds"),
        (["four_room"], "no world is called 'four_room'"),
        (["four_rooms", "--robot", "fetsch"], "no robot is called 'fetsch'"),
    ],
)
def test_check_refuses_what_it_cannot_do(capsys: Out, words: list[str], said: str) -> None:
    assert main(["worlds", "check", *words]) == 2
    assert said in capsys.readouterr().err


def test_a_world_without_a_world_file_is_refused(
    monkeypatch: pytest.MonkeyPatch, capsys: Out, tmp_path: Path
) -> None:
    monkeypatch.setattr(WORLDS, "load", lambda name: object())
    for words in (["check", "hall"], ["preview", "hall", "-o", str(tmp_path / "a.png")]):
        assert main(["worlds", *words]) == 2
        assert "the world 'hall' is not described by a world file" in capsys.readouterr().err


def test_preview_draws_the_plan_of_an_episode(capsys: Out, tmp_path: Path) -> None:
    first, other = tmp_path / "0.png", tmp_path / "4.png"
    assert main(["worlds", "preview", "small_flat", "-o", str(first), "--plan"]) == 0
    assert capsys.readouterr().out == f"{first}: small_flat, seed 0\n"
    assert main(["worlds", "preview", "small_flat", "-o", str(other), "--plan", "--seed", "4"]) == 0
    assert Image.open(io.BytesIO(first.read_bytes())).format == "PNG"
    assert first.read_bytes() != other.read_bytes()


def test_preview_tells_a_wrong_file_from_a_machine_that_cannot_render(
    monkeypatch: pytest.MonkeyPatch, capsys: Out, tmp_path: Path
) -> None:
    def renders_nothing(*_: object, **__: object) -> bytes:
        raise WorldError("no Vulkan")

    monkeypatch.setattr(page, "page", renders_nothing)
    empty = tmp_path / "empty.yaml"
    empty.write_text("")
    out = tmp_path / "a.png"
    assert main(["worlds", "preview", "small_flat", "-o", str(out)]) == 3
    assert "no Vulkan" in capsys.readouterr().err
    assert main(["worlds", "preview", str(empty), "-o", str(out)]) == 2
    assert f"{empty}:1:1" in capsys.readouterr().err
    assert main(["worlds", "preview", "small_flat", "-o", str(tmp_path / "a.jpg")]) == 2
    assert main(["worlds", "preview", "small_flat", "-o", str(tmp_path / "none" / "a.png")]) == 2
    assert list(tmp_path.iterdir()) == [empty]
