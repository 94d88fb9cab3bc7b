"""`worlds show`: what it asks of a world, and prints."""

import json

import pytest

import momantu_bt
from momantu_bt.cli import main
from momantu_bt.geometry import Pose2D
from momantu_bt.testing.description import small_robot
from momantu_bt.tree.registry import Registry
from momantu_bt.world import Site, Surface, WorldError
from momantu_bt.world_plugins import WORLDS

Out = pytest.CaptureFixture[str]


class Plain:
    """A world without anything of its own."""

    name, default_robot = "hall", "carrier"

    def site(self) -> Site:
        return Site(
            "hall",
            places={"here": Pose2D(1.0, 2.0, 0.0)},
            surfaces={"bench": Surface(Pose2D(0.0, 0.0, 0.0), (1.0, 0.5), 0.6, (0.0,))},
        )

    def open(self, *_: object, **__: object) -> None:
        raise AssertionError("nothing is to be run")


class Rich(Plain):
    """A world that tells more than its site."""

    def about(self) -> dict[str, dict[str, str]]:
        return {"Goal": {"item": "can"}}


def test_show_tells_all_sections_in_words_and_as_json(
    monkeypatch: pytest.MonkeyPatch, capsys: Out
) -> None:
    monkeypatch.setattr(WORLDS, "load", lambda name: Rich())
    assert main(["worlds", "show", "hall"]) == 0
    said = capsys.readouterr().out
    assert "bench: 1 x 0.5 m, 0.6 m high" in said
    assert "Goal\n  item: can\n" in said
    assert main(["worlds", "show", "hall", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["about"] == {"Goal": {"item": "can"}}


def test_show_of_a_world_that_tells_no_more(monkeypatch: pytest.MonkeyPatch, capsys: Out) -> None:
    monkeypatch.setattr(WORLDS, "load", lambda name: Plain())
    assert main(["worlds", "show", "hall", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["about"] == {}


class Torn(Plain):
    """A world whose code raises what nobody expects."""

    def site(self) -> Site:
        raise OSError("the disk is gone")


def test_a_world_whose_site_raises_is_named(monkeypatch: pytest.MonkeyPatch, capsys: Out) -> None:
    monkeypatch.setattr(WORLDS, "load", lambda name: Torn())
    assert main(["worlds", "show", "hall"]) == 2
    said = capsys.readouterr().err
    assert said == "momantu-bt: the world 'hall' cannot be read: OSError: the disk is gone\n"


def test_a_world_that_raises_when_it_opens_could_not_start(tmp_path) -> None:
    class Leaking(Plain):
        def open(self, *_: object, **__: object) -> None:
            raise KeyError("keel")

    path = tmp_path / "t.yaml"
    path.write_text("momantu_bt: 1\ntrees: {Main: succeed}\n", encoding="utf-8")
    registry = Registry(worlds={"hall": Leaking()}, robots={"carrier": small_robot})
    with pytest.raises(WorldError, match="the world 'hall' could not start: KeyError: 'keel'"):
        momantu_bt.run(path, world="hall", registry=registry)
