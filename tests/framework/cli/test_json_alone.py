"""`--json` prints one JSON document on standard output, whatever plug-ins print at import."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
import typer
import yaml

from momantu_bt.cli.verbs import VERBS, built_in
from momantu_bt.formats.maps import MapPicture, write_map

np = pytest.importorskip("numpy")

MODULE = '''
import os
print("hello")
os.system("echo from a child")

from momantu_bt.fault_kind import FaultKind
from momantu_bt.service import Service
from momantu_bt.skill import Run, Skill


class Noisy(Skill):
    """Makes noise."""

    def run(self, robot) -> Run:
        print("noise in run")
        yield "noisy"


class Hum(Service):
    """Hums."""

    rate = 10.0

    def update(self, robot) -> None:
        print("hum")


def robot():
    print("a robot")
    raise RuntimeError("no robot")
'''
ENTRIES = """
[momantu_bt.skills]
noisy = noise:Noisy
[momantu_bt.services]
hum = noise:Hum
[momantu_bt.robots]
tin = noise:robot
"""
SDF = (
    '<sdf version="1.9"><world name="w"><model name="m"><static>true</static></model></world></sdf>'
)
URDF = '<robot name="r"><link name="base_link"/></robot>'
LINES = [
    "check tree.yaml --json",
    "skills --json",
    "skills show noisy --json",
    "skills test noisy --json",
    "services --json",
    "services show hum --json",
    "services test hum --json",
    "worlds --json",
    "worlds show small_flat --json",
    "worlds check yard.yaml --seeds 0 --json",
    "worlds import map.yaml -o there.yaml --json",
    "robots --json",
    "robots show fetch --json",
    "robots setup r.urdf -o r --json",
    "robots check tin --json",
    "faults --json",
    "faults show camera.dead --json",
    "doctor --json",
    "replay record --json",
    "diff record record --json",
]


@pytest.fixture(scope="module")
def package(tmp_path_factory: pytest.TempPathFactory, install: Callable[..., Any]) -> Any:
    """The noisy package, with files for all verbs and a recorded run in its folder."""
    found = install(tmp_path_factory.mktemp("noise"), "noise", ENTRIES, {"noise.py": MODULE})
    folder: Path = found.folder
    tree = "momantu_bt: 1\nworld: none\ntrees: {Main: [{wait: 0.1 s}]}\n"
    (folder / "quiet.yaml").write_text(tree)
    (folder / "tree.yaml").write_text("momantu_bt: 1\ntrees: {Main: [noisy]}\n")
    (folder / "w.sdf").write_text(SDF)
    (folder / "r.urdf").write_text(URDF)
    write_map(folder / "map.yaml", MapPicture(np.full((60, 60), 254), 0.05, (0.0, 0.0)))
    yard = {"momantu_world": 1, "name": "yard", "start": {"at": [2, 2, 0]}}
    yard |= {"rooms": {"yard": {"corner": [0, 0], "size": [6, 5]}}}
    (folder / "yard.yaml").write_text(yaml.safe_dump(yard))
    done = found.command("run quiet.yaml -q --record record")
    assert done.returncode == 0, done.stderr
    return found


@pytest.mark.parametrize("line", LINES)
def test_standard_output_is_one_json_document(package: Any, line: str) -> None:
    done = package.command(line)
    json.loads(done.stdout or "null")
    wrong = done.returncode == 2  # then standard error alone says what is wrong
    assert bool(done.stdout) is not wrong, done.stderr
    if "noisy" in line or "hum" in line:
        assert "hello" in done.stderr
        assert "from a child" in done.stderr


def test_every_built_in_verb_with_json_is_tried() -> None:
    tried = {" ".join(line.partition(" --")[0].split()[:2]) for line in LINES}
    firsts = {line.split()[0] for line in LINES}
    for verb in VERBS:
        app = built_in(verb)
        if isinstance(app, typer.Typer):
            for command in app.registered_commands:
                name = command.name or command.callback.__name__  # type: ignore[union-attr]
                if _takes_json(command.callback) and name != "list":
                    assert f"{verb} {name}" in tried
        elif _takes_json(app):
            assert verb in firsts


def _takes_json(function: Any) -> bool:
    hints = repr(getattr(function, "__annotations__", {}))
    return "--json" in hints or "_JSON" in hints
