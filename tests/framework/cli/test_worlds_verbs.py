"""`worlds show`, `check` and `preview`: what they ask of a world, print, write and return."""

import json
from collections.abc import Sequence
from pathlib import Path

import pytest

from momantu_bt.cli import main
from momantu_bt.findings import Finding
from momantu_bt.formats.places import Place
from momantu_bt.geometry import Pose2D
from momantu_bt.plugins import PluginError
from momantu_bt.robots.plugins import ROBOTS
from momantu_bt.tree.plugins import WORLDS
from momantu_bt.world import Site, Surface, WorldError

Out = pytest.CaptureFixture[str]
FINDING = Finding("overlap", "a overlaps b", Place("w.yaml", 3, 5), "move a", seeds=(2,))
PICTURE = b"a picture"


class Plain:
    """A world without anything of its own."""

    name, default_robot = "hall", "carrier"
    site_error: str | None = None

    def site(self) -> Site:
        if self.site_error is not None:
            raise WorldError(self.site_error)
        return Site(
            "hall",
            places={"here": Pose2D(1.0, 2.0, 0.0)},
            surfaces={"bench": Surface(Pose2D(0.0, 0.0, 0.0), (1.0, 0.5), 0.6, (0.0,))},
        )

    def open(self, *_: object, **__: object) -> None:
        raise AssertionError("nothing is to be run")


class Rich(Plain):
    """A world that tells, checks and draws itself."""

    def __init__(self, findings: Sequence[Finding] = (), error: str | None = None) -> None:
        self.findings, self.error = findings, error
        self.asked: list[tuple[object, ...]] = []

    def about(self) -> dict[str, dict[str, str]]:
        return {"Goal": {"item": "can"}}

    def check(self, description: object, seeds: Sequence[int]) -> Sequence[Finding]:
        self.asked.append((description, tuple(seeds)))
        return self.findings

    def preview(self, description: object, seed: int, *, view: bool = True) -> bytes:
        self.asked.append((description, seed, view))
        if self.error is not None:
            raise WorldError(self.error)
        return PICTURE


@pytest.fixture
def having(monkeypatch: pytest.MonkeyPatch):
    """`having(world)`: the only world there is; robots are their own names."""

    def put(world: Plain) -> Plain:
        def load(name: str) -> object:
            if name != world.name:
                raise PluginError(f"no world is called {name!r}")
            return world

        monkeypatch.setattr(ROBOTS, "load", lambda name: lambda: f"robot {name}")
        monkeypatch.setattr(WORLDS, "load", load)
        return world

    return put


def test_show_tells_all_sections_in_words_and_as_json(having, capsys: Out) -> None:
    having(Rich())
    assert main(["worlds", "show", "hall"]) == 0
    said = capsys.readouterr().out
    assert "bench: 1 x 0.5 m, 0.6 m high" in said
    assert "Goal\n  item: can\n" in said
    assert main(["worlds", "show", "hall", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["about"] == {"Goal": {"item": "can"}}


def test_show_of_a_world_that_tells_no_more(having, capsys: Out) -> None:
    having(Plain())
    assert main(["worlds", "show", "hall", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["about"] == {}


@pytest.mark.parametrize(("findings", "code"), [([], 0), ([FINDING], 1)])
def test_check_prints_what_is_found(
    having, capsys: Out, findings: list[Finding], code: int
) -> None:
    world = having(Rich(findings))
    assert main(["worlds", "check", "hall", "--seeds", "0:3,7"]) == code
    said = capsys.readouterr().out
    assert ("w.yaml:3:5: error: a overlaps b (overlap) [seed 2]\n    move a" in said) == bool(code)
    assert main(["worlds", "check", "hall", "--robot", "other", "--json"]) == code
    assert len(json.loads(capsys.readouterr().out)["findings"]) == len(findings)
    assert world.asked[0] == ("robot carrier", (0, 1, 2, 7))
    assert world.asked[1] == ("robot other", tuple(range(20)))


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["hall", "--seeds", "5:5"], "is empty"),
        (["hall", "--seeds", "0:5000"], "more than 1000 seeds"),
        (["hal"], "no world is called 'hal'"),
    ],
)
def test_check_refuses_what_it_cannot_do(having, capsys: Out, words: list[str], said: str) -> None:
    having(Rich())
    assert main(["worlds", "check", *words]) == 2
    assert said in capsys.readouterr().err


def test_a_world_that_cannot_check_or_draw_itself(having, capsys: Out, tmp_path: Path) -> None:
    having(Plain())
    assert main(["worlds", "check", "hall"]) == 2
    assert "cannot check itself" in capsys.readouterr().err
    assert main(["worlds", "preview", "hall", "-o", str(tmp_path / "a.png")]) == 2
    assert "cannot draw itself" in capsys.readouterr().err


@pytest.mark.parametrize("plan", [False, True])
def test_preview_writes_the_picture(having, capsys: Out, tmp_path: Path, plan: bool) -> None:
    world, out = having(Rich()), tmp_path / "a.png"
    words = ["worlds", "preview", "hall", "-o", str(out), "--seed", "4"]
    assert main([*words, "--plan"] if plan else words) == 0
    assert out.read_bytes() == PICTURE
    assert world.asked == [("robot carrier", 4, not plan)]
    assert list(tmp_path.iterdir()) == [out]


def test_preview_tells_a_wrong_file_from_a_machine_that_cannot_render(
    having, capsys: Out, tmp_path: Path
) -> None:
    words = ["worlds", "preview", "hall", "-o", str(tmp_path / "a.png")]
    world = having(Rich(error="no Vulkan"))
    assert main(words) == 3
    assert "no Vulkan" in capsys.readouterr().err
    world.site_error = "w.yaml:1:1: empty"
    assert main(words) == 2
    assert "w.yaml:1:1" in capsys.readouterr().err
    assert main(["worlds", "preview", "hall", "-o", str(tmp_path / "a.jpg")]) == 2
    assert main(["worlds", "preview", "hall", "-o", str(tmp_path / "none" / "a.png")]) == 2
    assert list(tmp_path.iterdir()) == []
