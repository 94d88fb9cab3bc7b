"""What holds for each bundled skill: it is documented, and each of its failures is provoked."""

import re
from pathlib import Path

import pytest

from momantu_bt.robots.plugins import ROBOTS
from momantu_bt.skill import Skill
from momantu_bt.tree.registry import Registry
from momantu_bt.world_plugins import WORLDS

INSTALLED = Registry.installed()
BUNDLED = {
    name: kind
    for name, kind in INSTALLED.skills.items()
    if kind.__module__.startswith("momantu_skills.")
}
HERE = Path(__file__).parent


@pytest.fixture(params=sorted(BUNDLED))
def skill(request: pytest.FixtureRequest) -> tuple[str, type[Skill]]:
    return request.param, BUNDLED[request.param]


def test_it_has_a_test_file_that_names_each_failure_code(skill: tuple[str, type[Skill]]) -> None:
    name, kind = skill
    module = kind.__module__.split(".")
    if module[1] == "nav2":  # a file for each module there
        file = HERE / "nav2" / f"test_{module[-1]}.py"
        file = file if file.exists() else HERE / "nav2" / "test_costmap.py"
        assert re.search(rf"\b{name}\b", file.read_text(encoding="utf-8"))
    else:
        file = HERE / f"test_{name}.py"
    files = sorted({file, *HERE.glob(f"test_{name}_*.py")})
    text = "".join(each.read_text(encoding="utf-8") for each in files)
    untested = [code for code in kind.failures if not re.search(rf"\b{code}\b", text)]
    assert not untested, f"{file} provokes no {', '.join(untested)}"


def test_it_is_documented(skill: tuple[str, type[Skill]]) -> None:
    _, kind = skill
    assert kind.__doc__
    assert all(port.doc for port in kind.ports.values())
    assert all(" " in sentence for sentence in kind.failures.values())


def test_numbers_have_units_or_count(skill: tuple[str, type[Skill]]) -> None:
    _, kind = skill
    bare = [p.name for p in kind.ports.values() if p.type is float and p.unit is None]
    assert not bare, f"{kind.__name__}: {', '.join(bare)} has no unit"


NAMED = {"sapien", *ROBOTS, *WORLDS}
"""What no skill may know by name: the simulator, every robot, every world."""


def test_no_bundled_skill_names_a_robot_or_a_world(skill: tuple[str, type[Skill]]) -> None:
    folder = Path(__import__(skill[1].__module__.split(".")[0]).__file__ or "").parent
    for source in folder.rglob("*.py"):
        words = set(re.findall(r"[a-z_]+", source.read_text(encoding="utf-8").lower()))
        assert not words & NAMED, source
